"""The source of a signal: one sentence of one talker, of all that carry it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.foundation.numbers import brief
from shipid.trials.logs.nmea.errors import NoSuchSourceError
from shipid.trials.logs.nmea.log import NmeaLog, Origin
from shipid.trials.logs.nmea.settings import NmeaFormat

FEWEST = 10
"""Fewer values than this are not a signal, where another source has more."""

#: Sentence and the fields of it that make up the signal.
Wanted = tuple[str, tuple[str, ...]]


@dataclass(frozen=True, eq=False)
class SignalSource:
    """The source of a signal.

    Attributes
    ----------
    origin : Origin
        Sentence, talker and stream.
    fields : tuple of str
        The fields that were taken.
    t : ndarray, shape (n,)
        Time [s], strictly increasing.
    values : ndarray, shape (n, k)
        As the sentence counts them.
    lines : ndarray of int, shape (n,)
        Lines of the log.
    rejected, repeated : int
        Sentences without a valid value, and such with the time of the one after.
    others : tuple of SignalSource
        Sources of the same signal that were not taken.
    """

    origin: Origin
    fields: tuple[str, ...]
    t: np.ndarray
    values: np.ndarray
    lines: np.ndarray
    rejected: int
    repeated: int
    others: tuple[SignalSource, ...] = ()

    @property
    def interval(self) -> float:
        """Median interval [s]."""
        return float(np.median(np.diff(self.t)))

    def describe(self) -> str:
        """Return origin, rate and rejections in words."""
        kind, talker, stream = self.origin
        if kind.isdigit():
            text = f"PGN {kind} of source {stream}"
        else:
            text = f"{kind} of talker {talker}" if talker else f"{kind} without a talker"
            text += f" (stream {stream})" if stream else ""
        text += f", {len(self.t)} values, {brief(1 / self.interval)} a second"
        if self.rejected:
            text += f", {self.rejected} rejected (empty or not valid)"
        if self.repeated:
            text += f", {self.repeated} with a time that repeats were left out"
        return text


def take(log: NmeaLog, times: np.ndarray, origin: Origin, fields: tuple[str, ...]) -> SignalSource | None:
    """Return the values of one origin; None where fewer than two are valid.

    Parameters
    ----------
    log : NmeaLog
        The log.
    times : ndarray, shape (n,)
        Time of every sentence [s], NaN where it is not known.
    origin : Origin
        Sentence, talker and stream.
    fields : tuple of str
        Its fields; a sentence counts where all of them are valid.

    Returns
    -------
    SignalSource or None
    """
    records = log.records[origin]
    values = np.column_stack([records.column(name) for name in fields])
    valid = np.isfinite(values).all(axis=1)
    timed = valid & np.isfinite(times[records.order])
    order = records.order[timed]
    t = times[order]
    last = np.append(np.diff(t) > 0, True) if len(t) else np.zeros(0, dtype=bool)
    if last.sum() < 2:
        return None
    rejected, repeated = int((~valid).sum()), int((~last).sum())
    return SignalSource(origin, fields, t[last], values[timed][last], log.numbers[order[last]], rejected, repeated)


def answers(origin: Origin, asked: str) -> bool:
    """Return whether an origin is the one that is asked for: ``HDT``, ``HEHDT``, ``HEHDT#2``, ``127250``, ``127250#52``.

    Parameters
    ----------
    origin : Origin
        Of the log.
    asked : str
        Sentence, with the talker and the stream or without; empty for any.
    """
    address, _, stream = asked.partition("#")
    return (origin.talker + origin.kind).endswith(address) and stream in ("", origin.stream)


def check_sources(log: NmeaLog, sources: Mapping[str, str]) -> None:
    """Refuse a format file that names a source the log does not hold.

    Parameters
    ----------
    log : NmeaLog
        The log.
    sources : Mapping of str to str
        Sentence, or talker and sentence, by signal.

    Raises
    ------
    NoSuchSourceError
        With the sentences that were seen.
    """
    for signal, asked in sources.items():
        if not any(answers(origin, asked) for origin in log.records):
            raise NoSuchSourceError(
                f"{log.where} holds no sentence {asked}, which the format file names as the source of {signal}. Seen were "
                f"{log.seen()}."
            )


def choose(
    log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, signal: str, tiers: Sequence[Sequence[Wanted]]
) -> SignalSource | None:
    """Choose the source of a signal.

    The format file's choice counts. Else the first tier with a source that goes on for at least half as long as the
    longest one does; in it the source with the most values, and among equals (within a tenth) the sentence named first.

    Parameters
    ----------
    log : NmeaLog
        The log.
    times : ndarray, shape (n,)
        Time of every sentence [s].
    fmt : NmeaFormat
        May name sentence and talker.
    signal : str
        One of `shipid.trials.logs.nmea.settings.SIGNALS`.
    tiers : sequence of sequence of (str, tuple of str)
        Sentences and their fields, those to be preferred first.

    Returns
    -------
    SignalSource or None
        None where no sentence carries the signal.
    """
    if signal in fmt.leave_out:
        return None
    asked = fmt.sources.get(signal, "")
    found: list[list[SignalSource]] = []
    for tier in tiers:
        level = []
        for kind, fields in tier:
            origins = sorted(origin for origin in log.records if origin.kind == kind and answers(origin, asked))
            level += [f for origin in origins if (f := take(log, times, origin, fields)) is not None]
        found.append(level)
    every = [f for level in found for f in level]
    many = [f for f in every if len(f.t) >= FEWEST] or every
    if not many:
        return None
    longest = max(f.t[-1] - f.t[0] for f in many)
    for level in found:
        able = [f for f in level if f in many and f.t[-1] - f.t[0] >= 0.5 * longest]
        if able:
            most = max(len(f.t) for f in able)
            chosen = next(f for f in able if len(f.t) >= 0.9 * most)
            others = {f.origin: f for f in reversed(every) if f.origin != chosen.origin}
            return replace(chosen, others=tuple(reversed(others.values())))
    return None
