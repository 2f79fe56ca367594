"""Values between the samples of a channel: held for an order, interpolated for a measurement, and none across a hole."""

from __future__ import annotations

import numpy as np

#: An interval this many times the usual one of its channel is a hole (of a clock: a gap).
GAP = 5.0
#: Where short intervals make less than this share of the time, between more pauses than this, samples come in bursts.
_LIVE, _BURSTS = 0.2, 10
#: Share of the intervals, longer than the median one, beyond which samples are irregular.
_IRREGULAR = 1 / 3


def usual_interval(t: np.ndarray, values: np.ndarray | None = None) -> float:
    """Return the usual interval between the samples of a channel: the median one where they are regular.

    Where many samples are left out at random it is the mean of the intervals that are no holes. Samples that come in bursts (several
    sensors that write at nearly the same time) count as one for each burst.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    values : ndarray, shape (n,), optional
        The channel, NaN where a sample is missing; by default every time is one of a sample.

    Returns
    -------
    float
        In s; NaN where there are fewer than two samples.
    """
    times = t if values is None else t[np.isfinite(values)]
    if times.size < 2:
        return float("nan")
    step = np.diff(times)
    median = float(np.median(step))
    short = step <= GAP * median
    if np.count_nonzero(~short) > _BURSTS and step[short].sum() < _LIVE * step.sum():
        return usual_interval(times[np.concatenate([[True], ~short])])
    # Where every other sample is missing the median lies between two intervals, and changes by chance.
    irregular = np.mean(step[short] > 1.5 * median) > _IRREGULAR
    return float(step[short].mean()) if irregular else median


def samples_of(t: np.ndarray, values: np.ndarray) -> tuple[int, int]:
    """Return how many samples of a channel are there, and how many there might be.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    values : ndarray, shape (n,)
        The channel, NaN where a sample is missing.

    Returns
    -------
    there, possible : int
        Of a channel that keeps a regular clock there might be one at each of its intervals, of any other one in each row.
    """
    there = np.isfinite(values)
    count = int(there.sum())
    if count < 3 or count == t.size:
        return count, int(t.size)
    step = np.diff(t[there])
    own = float(np.median(step))
    regular = np.mean(np.abs(step - own) < 0.2 * own) > 0.9
    return count, max(count, round((t[there][-1] - t[there][0]) / own) + 1) if regular else int(t.size)


def interpolated(t: np.ndarray, values: np.ndarray, at: np.ndarray | None = None) -> np.ndarray:
    """Return a measurement between its samples, by straight lines.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    values : ndarray, shape (n,)
        The channel, NaN where a sample is missing; an angle unwrapped.
    at : ndarray, shape (m,), optional
        Where it is wanted [s]; at `t` by default.

    Returns
    -------
    ndarray, shape (m,)
        NaN before the first sample, behind the last, and inside a hole: an interval longer than `GAP` usual ones.
    """
    return _between(t, values, at, held=False)


def held(t: np.ndarray, values: np.ndarray, at: np.ndarray | None = None) -> np.ndarray:
    """Return an order between its samples: the last one holds.

    Parameters
    ----------
    t, values, at
        As for `interpolated`.

    Returns
    -------
    ndarray, shape (m,)
        NaN before the first sample, and inside a hole or behind the last sample, `GAP` usual intervals after it.
    """
    return _between(t, values, at, held=True)


def slope(t: np.ndarray, values: np.ndarray, over: float) -> np.ndarray:
    """Return the slope of a measurement at its samples, from the difference between a sample before and one behind.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    values : ndarray, shape (n,)
        The channel, NaN where a sample is missing; an angle unwrapped.
    over : float
        How far the two samples are apart [s]; two usual intervals at least.

    Returns
    -------
    ndarray, shape (n,)
        NaN where the channel has no sample, and where a hole lies between the two.
    """
    result = np.full(t.shape, np.nan)
    there = np.isfinite(values)
    times, samples = t[there], values[there]
    if times.size < 2:
        return result
    usual = usual_interval(times)
    half = max(1, round(0.5 * over / usual))
    place = np.arange(times.size)
    before, behind = np.maximum(place - half, 0), np.minimum(place + half, times.size - 1)
    span = times[behind] - times[before]
    found = (samples[behind] - samples[before]) / span
    found[span > (2 * half - 1 + GAP) * usual] = np.nan
    result[there] = found
    return result


def _between(t: np.ndarray, values: np.ndarray, at: np.ndarray | None, *, held: bool) -> np.ndarray:
    at = t if at is None else np.asarray(at, dtype=float)
    there = np.isfinite(values)
    result = np.full(at.shape, np.nan)
    times, samples = t[there], values[there]
    if not times.size:
        return result
    before = np.searchsorted(times, at, side="right") - 1
    on = (before >= 0) & (times[before.clip(0)] == at)
    if times.size == 1:
        result[on] = samples[0]
        return result
    longest = GAP * usual_interval(times)
    if held:
        valid = (before >= 0) & (at - times[before.clip(0)] <= longest)
        result[valid] = samples[before[valid]]
        return result
    after = (before + 1).clip(0, times.size - 1)
    inside = (before >= 0) & (before < times.size - 1) & (times[after] - times[before.clip(0)] <= longest)
    result[inside] = np.interp(at[inside], times, samples)
    result[on] = samples[before[on]]
    return result
