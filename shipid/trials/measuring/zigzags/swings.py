"""Swings of a heading between rudder reversals: overshoot, extreme heading and its time."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from shipid.trials.signals import series

#: Local fits and averages span this share of the time between two reversals, on either side.
WIDTH = 0.03


def overshoots_of(
    t: np.ndarray,
    psi: np.ndarray,
    executes: Sequence[float],
    *,
    side: int | None = None,
    end: float | None = None,
) -> tuple[float | None, ...]:
    """Return the overshoot angle after each execute: how far the heading goes on beyond its value there.

    With the executes of a measured trial and a predicted heading, these are the predicted overshoots.

    Parameters
    ----------
    t, psi : array_like, shape (n,)
        Time [s] and heading, unwrapped [rad].
    executes : sequence of float, length m
        Times of the rudder reversals [s]: the second execute and on.
    side : {1, -1}, optional
        Side to which the heading overshoots after the first of them (1 is starboard); None reads it from the
        heading.
    end : float, optional
        When the last swing ends [s]; the end of the record by default.

    Returns
    -------
    tuple of float or None, length m
        Overshoot angles [rad]; None where the record ends before the heading turns back.
    """
    t, psi = np.asarray(t, dtype=float), np.asarray(psi, dtype=float)
    return tuple(swing[0] for swing in swings(t, psi, executes, side=side, end=end))


def swings(
    t: np.ndarray, psi: np.ndarray, executes: Sequence[float], *, side: int | None, end: float | None
) -> list[tuple[float | None, float | None, float]]:
    """Return overshoot [rad], time of the extreme heading [s] and heading at the execute [rad], a reversal each.

    Parameters
    ----------
    t, psi, executes, side, end
        As for `overshoots_of`.
    """
    if not len(executes):
        return []
    stop = float(t[-1]) if end is None else end
    bounds = [*(float(e) for e in executes), stop]
    half = WIDTH * half_period_of(bounds)
    at = [series.value_at(t, psi, when, half, 1) for when in bounds[:-1]]
    first = side or _first_side(t, psi, at, bounds[0])
    result: list[tuple[float | None, float | None, float]] = []
    for k, (start, finish) in enumerate(pairwise(bounds)):
        sign = first * (-1) ** k
        a, b = np.searchsorted(t, [start, finish], side="left")
        stretch = slice(int(a), min(int(b) + 1, len(t)))
        top = series.maximum(t[stretch], sign * psi[stretch], half)
        if top is None:
            result.append((None, None, at[k]))
        else:
            result.append((max(0.0, top[1] - sign * at[k]), top[0], at[k]))
    return result


def half_period_of(bounds: Sequence[float]) -> float:
    """Return the median time between reversals [s].

    Parameters
    ----------
    bounds : sequence of float
        Times of the reversals, and of the end of the last swing [s].
    """
    # The last bound is the end of the record, not a reversal; alone it still gives the order of magnitude.
    steps = np.diff(bounds[:-1]) if len(bounds) > 2 else np.diff(bounds)
    return max(float(np.median(steps)), 0.0)


def _first_side(t: np.ndarray, psi: np.ndarray, at: Sequence[float], start: float) -> int:
    """The side the heading has gone to by the first reversal."""
    if len(at) > 1:
        signs = (-1.0) ** np.arange(len(at))
        return 1 if float(signs @ (np.array(at) - np.mean(at))) >= 0 else -1
    before = psi[t <= start]
    return 1 if not before.size or at[0] >= before[0] else -1
