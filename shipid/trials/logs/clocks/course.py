"""The course of a clock: midnight is passed, summer time ends, several samples share a stamp of low resolution."""

from __future__ import annotations

from datetime import datetime, timedelta

import numpy as np

from shipid.trials.filling import GAP

DAY = 86400.0
HOUR = 3600.0
#: A clock whose stamps repeat this often has too few digits; where fewer repeat, samples stand twice.
COARSE = 0.1
#: Resolutions of clocks that loggers print [s].
_RESOLUTIONS = (0.001, 0.01, 0.1, 1.0, 60.0)


def unrolled(seconds: np.ndarray, period: float) -> tuple[np.ndarray, int]:
    """Let a clock that begins again after a period run on; gaps stay.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        The clock; NaN where there is no stamp.
    period : float
        A day, or a week of the GPS [s].

    Returns
    -------
    seconds : ndarray, shape (n,)
        Running on.
    count : int
        How often it began again.
    """
    at = np.flatnonzero(np.isfinite(seconds))
    again = np.diff(seconds[at]) < -period / 2
    result = seconds.copy()
    result[at[1:]] += period * np.cumsum(again)
    return result, int(again.sum())


def hour_back(seconds: np.ndarray) -> int | None:
    """Return the sample at which a clock has jumped back by an hour, or None.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        The clock; NaN where there is no stamp.

    Returns
    -------
    int or None
        The first sample after the jump.
    """
    at = np.flatnonzero(np.isfinite(seconds))
    step = np.diff(seconds[at])
    if step.size < 2:
        return None
    usual = float(np.median(step[step > 0])) if (step > 0).any() else 1.0
    back = np.flatnonzero(np.abs(step + HOUR - usual) <= max(GAP * usual, 1.0))
    return int(at[back[0] + 1]) if back.size else None


def hour_on(seconds: np.ndarray) -> int | None:
    """Return the sample at which a clock has jumped on by an hour from the end of one hour to the beginning of the next but one, or None.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        The clock; NaN where there is no stamp.

    Returns
    -------
    int or None
        The first sample after the jump.
    """
    at = np.flatnonzero(np.isfinite(seconds))
    step = np.diff(seconds[at])
    if step.size < 2 or not (step > 0).any():
        return None
    usual = float(np.median(step[step > 0]))
    jumps = np.flatnonzero(np.abs(step - HOUR - usual) <= 0.5 * usual)
    after = np.mod(seconds[at[jumps + 1]], HOUR)
    jumps = jumps[(after < usual) & (np.mod(-seconds[at[jumps]], HOUR) <= usual)]
    return int(at[jumps[0] + 1]) if jumps.size == 1 else None


def over_summer_time(stamps: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Let the local stamps of lines run on where summer time ends or begins.

    Parameters
    ----------
    stamps : ndarray, shape (n,)
        With their day [s since 1970]; several lines may share one.

    Returns
    -------
    stamps : ndarray, shape (n,)
        Running on.
    notes : list of str
        What was done.
    """
    seconds = np.floor(stamps)
    for k, hour, words in (
        (hour_back(seconds), HOUR, "goes back by an hour at {}, where summer time ends: it was let run on"),
        (_on(seconds), -HOUR, "goes on by an hour at {}, where summer time begins: the hour was taken out"),
    ):
        if k is not None and ends_summer(float(stamps[k - 1])):
            before = datetime(1970, 1, 1) + timedelta(seconds=float(stamps[k - 1]))
            words = words.format(f"{before:%Y-%m-%dT%H:%M:%S}")
            return np.where(np.arange(stamps.size) >= k, stamps + hour, stamps), [f"WARNING: the clock {words}."]
    return stamps, []


def _on(seconds: np.ndarray) -> int | None:
    """The line at which whole seconds go on from the last of an hour to the first of the next but one."""
    k = np.flatnonzero(begins_summer(seconds[:-1], seconds[1:]))
    return int(k[0] + 1) if k.size == 1 else None


def begins_summer(before: np.ndarray | float, after: np.ndarray | float) -> np.ndarray:
    """Return whether a clock goes on by an hour from one stamp to the next, at the full hour, but for two seconds.

    Parameters
    ----------
    before, after : ndarray or float
        The stamps [s since 1970].
    """
    near = (np.mod(after, HOUR) <= 2.0) & (np.mod(-np.asarray(before), HOUR) <= 2.0)
    on: np.ndarray = near & (np.abs(np.asarray(after) - before - HOUR) <= 2.0)
    return on


def ends_summer(before: float) -> bool:
    """Return whether summer time can end or begin at a moment: in the small hours of a Sunday in spring or autumn.

    Parameters
    ----------
    before : float
        Local time of the last stamp before the jump [s since 1970].
    """
    moment = datetime(1970, 1, 1) + timedelta(seconds=before)
    return moment.weekday() == 6 and moment.month in (3, 4, 9, 10, 11) and moment.hour < 4


def spread(seconds: np.ndarray, twice: np.ndarray | None = None) -> tuple[np.ndarray, float | None]:
    """Spread samples that share a stamp of low resolution evenly over it.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        The clock, not falling; NaN where there is no stamp.
    twice : ndarray of bool, shape (n,), optional
        Rows that stand twice; where most of the stamps that repeat do so for them, nothing is spread.

    Returns
    -------
    seconds : ndarray, shape (n,)
        Rising. At the ends of the record the group of a stamp may be cut: the first is taken from its end.
    resolution : float or None
        Of the stamps [s]; None where nothing was spread.
    """
    at = np.flatnonzero(np.isfinite(seconds))
    known = seconds[at]
    step = np.diff(known)
    if step.size < 2 or (step < 0).any() or not (step > 0).any() or np.mean(step == 0) < COARSE:
        return seconds, None
    if twice is not None and twice[at[1:]][step == 0].mean() > 0.5:
        return seconds, None
    resolution = next((r for r in reversed(_RESOLUTIONS) if _multiples(known, r)), None)
    if resolution is None:
        return seconds, None
    stamps, first, group, count = np.unique(known, return_index=True, return_inverse=True, return_counts=True)
    place = np.arange(known.size) - first[group]
    full = int(np.median(count))
    share = np.maximum(count[group], 1).astype(float)
    for end in (0, len(stamps) - 1):
        mine = group == end
        if count[end] < full:
            share[mine] = full
            place[mine] += full - count[end] if end == 0 else 0
    result = seconds.copy()
    result[at] = known + resolution * place / share
    return result, resolution


def _multiples(known: np.ndarray, resolution: float) -> bool:
    return bool(np.allclose(known, np.round(known / resolution) * resolution, rtol=0, atol=1e-6))
