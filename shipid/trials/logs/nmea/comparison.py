"""What another source of a signal shows against the one that is taken: how much later, and how far off."""

from __future__ import annotations

import numpy as np

from shipid.foundation.numbers import brief
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.nmea.sources import SignalSource

_FEWEST = 60
"""Fewer common instants say nothing about a delay."""
_MOST = 200_000
"""So many say how two sources differ; a clock that jumps would make millions."""
_UNLIKE = 0.8
"""Below this correlation, sources of one signal do not agree."""
_BETTER = 0.7
"""A delay is told where it lets at most this share of the disagreement stand that there is without it."""
_HARDLY_MORE = 1.05
"""A delay is not excluded where the sources disagree by at most so much more than at the best one."""
_LONGEST = 20.0
"""Longest delay that is looked for [s]."""


def described(taken: SignalSource) -> str:
    """Return what a source is, and the others of its signal with what they show against it, in words.

    Parameters
    ----------
    taken : SignalSource
        The source.

    Returns
    -------
    str
    """
    others = ", ".join(f"{other.origin.name} ({compared(taken, other)})" for other in taken.others)
    return taken.describe() + (f"; not used: {others}" if others else "")


def compared(taken: SignalSource, other: SignalSource) -> str:
    """Return what another source shows against the one that is taken, in words.

    Parameters
    ----------
    taken, other : SignalSource
        Of one signal; positions in degrees, headings in degrees.

    Returns
    -------
    str
        Its rate, and where they tell it the delay and the distance: ``10 a second, 8.9 s later``.
    """
    words = [f"{brief(1 / other.interval, 3)} a second"]
    step = max(taken.interval, other.interval, 0.05)
    begin, end = max(taken.t[0], other.t[0]), min(taken.t[-1], other.t[-1])
    last = min(end, begin + _MOST * step)
    t = np.arange(begin, last, step)
    if last < end:
        words.append(f"compared over the first {brief((last - begin) / 3600, 2)} h")
    if taken.fields[0] == "lat":
        if t.size:
            apart = np.hypot(*(_metres(taken, other, t)))
            words.append(f"{brief(float(np.median(apart)), 2)} m away")
        return ", ".join(words)
    if t.size < _FEWEST or len(taken.fields) > 1 or len(other.fields) > 1:
        return ", ".join(words)
    turns = taken.fields[0] in ("heading", "magnetic", "yaw")
    one, two = (np.interp(t, s.t, _scalar(s, turns)) for s in (taken, other))
    if turns:
        apart = float(np.median((two - one + 180) % 360 - 180))
        words.append(f"{apart:+.2g} deg off")
        one, two = np.gradient(one), np.gradient(two)
    (first, delay, last), likeness, without = _delay(one, two, step)
    if likeness >= _UNLIKE:
        if abs(delay) >= 2 * step and 1 - likeness < _BETTER * (1 - without):
            near, far = sorted((abs(first), abs(last)))
            known = brief(abs(delay), 2) if far - near < 0.2 * abs(delay) else f"{brief(near, 2)} to {brief(far, 2)}"
            words.append(f"{known} s {'later' if delay > 0 else 'earlier'}")
    else:
        words.append(f"does not show the same: correlation {brief(likeness, 2)} at best")
    return ", ".join(words)


def _scalar(source: SignalSource, turns: bool) -> np.ndarray:
    values = source.values[:, 0]
    return np.asarray(np.unwrap(values, period=360) if turns else values)


def _metres(taken: SignalSource, other: SignalSource, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    origin = float(np.radians(taken.values[0, 0])), float(np.radians(taken.values[0, 1]))
    tracks = [to_local(np.radians(s.values[:, 0]), np.radians(s.values[:, 1]), origin) for s in (taken, other)]
    places = [[np.interp(t, s.t, axis) for axis in track] for s, track in zip((taken, other), tracks)]
    return places[1][0] - places[0][0], places[1][1] - places[0][1]


def _delay(one: np.ndarray, two: np.ndarray, step: float) -> tuple[tuple[float, float, float], float, float]:
    """By how much the second comes after the first [s], by the peak of their correlation; the correlation there and without.

    The delay stands between the least and the largest one at which the two disagree hardly more.
    """
    from scipy.signal import correlate  # loads all of scipy.signal, half a second

    n = one.size
    one, two = one - one.mean(), two - two.mean()
    most = min(round(_LONGEST / step), n // 3)
    lags = np.arange(-most, most + 1)
    count = n - np.abs(lags)
    # What of each is compared at a lag: the first of the one and the last of the other, or the reverse.
    head, tail = np.maximum(-lags, 0), np.minimum(n, n - lags)
    sums = [_between(s, head + k * lags, tail + k * lags) for k, s in ((0, one), (0, one**2), (1, two), (1, two**2))]
    both = correlate(two, one, mode="full")[n - 1 - most : n + most]
    spread = (sums[1] - sums[0] ** 2 / count) * (sums[3] - sums[2] ** 2 / count)
    moves = spread > 1e-12 * max(float(spread.max()), 1e-300)
    likeness = np.where(moves, both - sums[0] * sums[2] / count, 0.0) / np.sqrt(np.where(moves, spread, 1.0))
    # Numbers that overflow are like nothing, and rounding makes nothing more than alike.
    likeness = np.clip(np.nan_to_num(likeness, nan=0.0, posinf=0.0, neginf=0.0), -1.0, 1.0)
    best = int(np.argmax(likeness))
    near = np.flatnonzero(1 - likeness <= _HARDLY_MORE * (1 - likeness[best]))
    # A flat peak, as of a damped sensor in a steady turn, does not tell the delay closely.
    same = near[np.sign(lags[near]) == np.sign(lags[best])]
    found = tuple(float(lags[k] * step) for k in (same[0], best, same[-1]))
    return (found[0], found[1], found[2]), float(likeness[best]), float(likeness[most])


def _between(values: np.ndarray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Sums of stretches of a series."""
    total = np.append(0.0, np.cumsum(values))
    return np.asarray(total[stop] - total[start])
