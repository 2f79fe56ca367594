"""When each sentence was written: by the logger's stamps, or by the UTC that some sentences carry."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, date, datetime

import numpy as np

from shipid.foundation.numbers import brief, counted
from shipid.trials.errors import ClockError
from shipid.trials.logs.clocks.course import over_summer_time
from shipid.trials.logs.nmea.errors import NoTimeError
from shipid.trials.logs.nmea.log import NmeaLog, Origin, Records
from shipid.trials.logs.nmea.sentences.lines import DAY
from shipid.trials.logs.nmea.settings import NmeaFormat

DISORDER = 0.5
"""Loggers with a thread a port swap lines; stamps of different sources may run back by this much [s]."""
LATE = 2.0
"""Of two receivers with one talker, one may be late by this much [s]; its UTC is not taken for the time of the line."""
LONGEST = 10.0
"""No sentence is timed between two of UTC further apart than this, or than five of their intervals [s]."""

_WITH_UTC = ("RMC", "ZDA", "GGA", "GLL")


@dataclass(frozen=True)
class LogClock:
    """The time of every sentence of a log.

    Attributes
    ----------
    times : ndarray, shape (n,)
        Seconds since the first that is known; NaN where a sentence cannot be timed.
    notes : tuple of str
        Where the time comes from, when it begins, and what was done.
    """

    times: np.ndarray
    notes: tuple[str, ...]


def read_clock(log: NmeaLog, fmt: NmeaFormat) -> LogClock:
    """Find the time of every sentence.

    Parameters
    ----------
    log : NmeaLog
        The log.
    fmt : NmeaFormat
        May say the date.

    Returns
    -------
    LogClock

    Raises
    ------
    NoTimeError
        If there are neither stamps nor UTC.
    ClockError
        If the clock jumps back; the message names the line.
    """
    stamped = np.isfinite(log.stamps)
    utc = _best_utc(log)
    if stamped.mean() < 0.5 and utc is not None:
        times, dated, notes = _by_utc(log, utc)
    elif stamped.any():
        times, dated, notes = _by_stamps(log)
    else:
        raise NoTimeError(
            f"{log.where}: nothing says when a line was written: no time stamp stands in front of the sentences, and "
            f"no two of ZDA, RMC, GGA or GLL carry a valid UTC. Seen were {log.seen()}. If the lines do begin with a "
            "time, state its layout as stamp in [nmea] of a format file."
        )
    known = times[np.isfinite(times)]
    start = float(known.min())
    lost = int(np.isnan(times).sum())
    if lost:
        notes.append(f"{counted(lost, 'sentence')} without a known time left out.")
    if not dated and fmt.date is not None:
        start += (fmt.date - date(1970, 1, 1)).days * DAY
        notes.append(f"The date {fmt.date} is the format file's.")
    return LogClock(times - float(known.min()), (f"t = 0 is {_moment(start, dated or fmt.date is not None)}.", *notes))


def _moment(seconds: float, dated: bool) -> str:
    try:
        moment = datetime.fromtimestamp(round(seconds, 3), UTC)
    except (OverflowError, OSError, ValueError):
        return f"{seconds:.3f} s of the logger's clock"
    if dated and seconds > 366 * DAY:
        return f"{moment:%Y-%m-%d %H:%M:%S}.{moment.microsecond // 1000:03d}"
    if dated:
        return f"{seconds:.3f} s of the logger's clock"
    return f"{moment:%H:%M:%S}.{moment.microsecond // 1000:03d} of a day that nothing names"


def _unrolled(seconds: np.ndarray) -> tuple[np.ndarray, int]:
    """Let times of day run on over midnight; also the number of midnights."""
    step = np.diff(seconds)
    days = np.rint(step / DAY)
    return np.concatenate((seconds[:1], seconds[0] + np.cumsum(step - days * DAY))), int(-days.sum())


def _jumped(log: NmeaLog, before: int, after: int, back: float, what: str) -> ClockError:
    return ClockError(
        f"{log.where}, line {log.numbers[after]}: the clock jumps back by {brief(back, 4)} s against line "
        f"{log.numbers[before]} ({what}). Cut the log there and read the parts one by one, or correct the stamps."
    )


def _midnights(days: int) -> list[str]:
    return (
        [f"The clock passes midnight {days} times." if days > 1 else "The clock passes midnight once."] if days else []
    )


def _by_stamps(log: NmeaLog) -> tuple[np.ndarray, bool, list[str]]:
    at = np.flatnonzero(np.isfinite(log.stamps))
    stamps, notes = log.stamps[at], ["The time of a sentence is the logger's stamp."]
    stray = _stray(stamps, log.dated)
    if stray.any():
        lines = log.numbers[at[stray]]
        notes.append(
            f"{counted(int(stray.sum()), 'stamp lies', 'stamps lie')} before or behind both of the neighbours and {'was' if stray.sum() == 1 else 'were'} not used, the first in line {lines[0]}."
        )
        at, stamps = at[~stray], stamps[~stray]
    if not log.dated:
        stamps, days = _unrolled(stamps)
        notes += _midnights(days)
    else:
        stamps, summer = over_summer_time(stamps)
        notes += summer
    latest = np.maximum.accumulate(stamps)
    behind = latest - stamps
    far = np.flatnonzero(behind > DISORDER)
    if far.size:
        k = int(far[0])
        before = int(at[np.flatnonzero(stamps[:k] == latest[k])[-1]])
        raise _jumped(log, before, int(at[k]), float(behind[k]), "logger's stamps")
    times = np.full(len(log.stamps), np.nan)
    times[at] = stamps
    for origin, records in log.records.items():
        own = records.order[np.isfinite(times[records.order])]
        back = np.flatnonzero(np.diff(times[own]) < 0)
        if back.size:
            k = int(back[0])
            raise _jumped(
                log, int(own[k]), int(own[k + 1]), times[own[k]] - times[own[k + 1]], f"stamps of {origin.name}"
            )
    swapped = int((behind > 0).sum())
    if swapped:
        notes.append(f"{counted(swapped, 'line')} of different sources in another order than the stamps: sorted.")
    bare = len(times) - len(at)
    if bare:
        # The last stamp before them; before the first stamp there is none.
        seen = np.maximum.accumulate(np.where(np.isfinite(times), np.arange(len(times)), -1))
        times = np.where(seen >= 0, times[np.maximum(seen, 0)], np.nan)
        notes.append(
            f"{counted(bare, 'sentence without a stamp has', 'sentences without a stamp have')} that of the line before."
        )
    if not log.exact:
        times, spread = _spread(log, times)
        notes.append(
            "The stamps are whole seconds: sentences that come several times in a second were spread evenly over it, so times are "
            "right to about half a second."
            if spread
            else "The stamps are whole seconds, so times are right to about a second; sentences of one second are taken together."
        )
    return times, log.dated, notes


def _stray(stamps: np.ndarray, dated: bool) -> np.ndarray:
    """Which stamps are garbled: the ones before and after them are in order, and they are not between them."""
    stray = np.zeros(stamps.size, dtype=bool)
    if stamps.size < 3:
        return stray
    into, out, across = np.diff(stamps)[:-1], np.diff(stamps)[1:], stamps[2:] - stamps[:-2]
    if not dated:  # a midnight is no step back
        into, out, across = ((step + DAY / 2) % DAY - DAY / 2 for step in (into, out, across))
    stray[1:-1] = (across >= -DISORDER) & (
        (into < -DISORDER) & (out > across + DISORDER) | (out < -DISORDER) & (into > across + DISORDER)
    )
    return stray


def _spread(log: NmeaLog, times: np.ndarray) -> tuple[np.ndarray, bool]:
    """Spread the sentences of one whole second over it, by those that come most often."""
    known = np.flatnonzero(np.isfinite(times))
    order = known[np.argsort(times[known], kind="stable")]
    _, group, count = np.unique(times[order], return_inverse=True, return_counts=True)
    if count.max() == 1:
        return times, False
    result = times.copy()
    result[order] += _places(log, order, group, 0.0)
    return result, bool((result != times).any())


def _places(log: NmeaLog, order: np.ndarray, group: np.ndarray, alone: float) -> np.ndarray:
    """Where in its interval a sentence stands, between 0 and 1.

    Devices that speak once in it may do so together or apart: nothing tells, and their signals are taken at one moment. A device
    that speaks several times does so evenly, and the others stand among its sentences as their lines do.

    Parameters
    ----------
    log : NmeaLog
        The log.
    order : ndarray of int, shape (n,)
        Sentences, in the order of their time.
    group : ndarray of int, shape (n,)
        The interval of each, counted from 0, not falling.
    alone : float
        Where a sentence stands of which there is one: 0 at the beginning, 0.5 in the middle.
    """
    label = np.zeros(len(log.numbers), dtype=int)
    for k, records in enumerate(log.records.values(), start=1):
        label[records.order] = k
    own = label[order]
    counts = np.bincount(own)
    counts[0] = 0  # sentences that are not read
    leads = own == int(np.argmax(counts))
    behind, many = _counted(leads, group)
    place = np.where(many > 1, np.maximum(behind - 1 + alone, 0.0) / np.maximum(many, 1), alone)
    place[~leads] = (
        np.where(many > 1, np.minimum(behind, many - 1 + alone) / np.maximum(many, 1), alone)[~leads]
        if alone
        else place[~leads]
    )
    for k in np.unique(own[own > 0]):
        mine = own == k
        rank, several = _counted(mine, group)
        place = np.where(mine & (several > 1), (rank - 1 + alone) / np.maximum(several, 1), place)
    return np.asarray(place)


def _counted(chosen: np.ndarray, group: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How many of the chosen stand in a sentence's interval up to it, and in all of it."""
    total = np.bincount(group, weights=chosen).astype(int)
    before = np.concatenate(([0], np.cumsum(total)))[group]
    return np.cumsum(chosen) - before, total[group]


def _utc_of(records: Records) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Sentences, UTC of day [s] and day, where the UTC is valid."""
    utc = records.column("utc")
    has = np.isfinite(utc)
    days = records.column("day")[has] if "day" in records.fields else None
    return records.order[has], utc[has], days


def _best_utc(log: NmeaLog) -> Origin | None:
    """The sentence and talker that says UTC most often; one alone, because each lags by its own."""
    counts = {
        origin: len(np.unique(_utc_of(records)[1]))
        for origin, records in log.records.items()
        if origin.kind in _WITH_UTC
    }
    counts = {origin: n for origin, n in counts.items() if n > 1}
    return max(counts, key=lambda o: (counts[o], -_WITH_UTC.index(o.kind))) if counts else None


def _by_utc(log: NmeaLog, origin: Origin) -> tuple[np.ndarray, bool, list[str]]:
    order, utc, days = _utc_of(log.records[origin])
    notes = [
        f"The time of a sentence is the UTC of {origin.name}, and the lines between two of them lie between; how long "
        "after a fix its sentence was sent is not known."
    ]
    dated = days is not None and bool(np.isfinite(days).all())
    if dated and days is not None:
        moments = days * DAY + utc
        notes += _midnights(int(np.count_nonzero(np.diff(days))))
    else:
        moments, passed = _unrolled(utc)
        notes += _midnights(passed)
    latest = np.maximum.accumulate(moments)
    behind = latest - moments
    # A clock that jumps does so once; a second receiver is late all the time.
    far = np.flatnonzero(behind > (LATE if np.mean(np.diff(moments) < 0) > 0.2 else 0.0))
    if far.size:
        k = int(far[0])
        raise _jumped(log, int(order[k - 1]), int(order[k]), float(behind[k]), f"UTC of {origin.name}")
    fresh = np.append(True, moments[1:] > latest[:-1])
    order, moments = order[fresh], moments[fresh]
    step = np.diff(moments)
    sentences = np.arange(len(log.numbers))
    times = np.interp(sentences, order, moments, left=np.nan, right=np.nan)
    between = np.setdiff1d(sentences[order[0] : order[-1]], order)
    group = np.searchsorted(order, between) - 1
    times[between] = moments[group] + step[group] * _places(log, between, group, 0.5)
    times = _with_own_utc(log, times, origin, float(np.median(step)))
    limit = max(LONGEST, 5 * float(np.median(step)))
    for before in np.flatnonzero(step > limit):
        times[order[before] + 1 : order[before + 1]] = np.nan
    if (step > limit).any():
        notes.append(f"Between sentences of UTC more than {brief(limit, 3)} s apart no time is known.")
    if not dated:
        times, dated, more = _with_date(log, times)
        notes += more
    return times, dated, notes


def _with_own_utc(log: NmeaLog, times: np.ndarray, leading: Origin, step: float) -> np.ndarray:
    """The times of sentences that carry a UTC of their own, where it is that of the lines around them."""
    result = times.copy()
    for origin, records in log.records.items():
        if origin.kind not in _WITH_UTC or origin == leading:
            continue
        order, utc, _ = _utc_of(records)
        off = (utc - times[order] + DAY / 2) % DAY - DAY / 2
        near = np.abs(off) <= 1.5 * step
        result[order[near]] += off[near]
    return result


def _with_date(log: NmeaLog, times: np.ndarray) -> tuple[np.ndarray, bool, list[str]]:
    """Add the date of another sentence, where one says it."""
    for origin, records in log.records.items():
        if "day" not in records.fields:
            continue
        order, utc, days = _utc_of(records)
        assert days is not None
        both = np.flatnonzero(np.isfinite(days) & np.isfinite(times[order]))
        if both.size:
            k = int(both[0])
            midnight = round((days[k] * DAY + utc[k] - times[order[k]]) / DAY) * DAY
            return times + midnight, True, [f"The date is that of {origin.name}."]
    return times, False, []
