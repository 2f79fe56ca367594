"""Small numerical helpers for measuring: values, crossings and extremes of noisy series."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import savgol_filter


def smoothed(t: np.ndarray, y: np.ndarray, width: float) -> np.ndarray:
    """Return the moving average over a width in time.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and series; the clock is taken to be about regular.
    width : float
        Width of the average [s]; below two samples nothing is smoothed.

    Returns
    -------
    ndarray, shape (n,)
    """
    size = int(width / float(np.median(np.diff(t)))) | 1
    return y if size < 3 else uniform_filter1d(y, min(size, (len(y) - 1) | 1), mode="nearest")


def value_at(t: np.ndarray, y: np.ndarray, when: float, half: float, degree: int = 2) -> float:
    """Return the value of a noisy series at a time: a local polynomial by least squares.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and series.
    when : float
        The time wanted [s].
    half : float
        Half width of the stretch that is fitted [s]; widened to hold five samples.
    degree : int
        Degree of the polynomial.

    Returns
    -------
    float
    """
    first, last = np.searchsorted(t, [when - half, when + half])
    if last - first < degree + 3:
        # Too few samples to smooth over: the value is interpolated between neighbours.
        return float(np.interp(when, t, y))
    x = (t[first:last] - when) / half
    return float(_fitted(x, y[first:last], degree)[0])


def _fitted(x: np.ndarray, y: np.ndarray, degree: int) -> np.ndarray:
    """Coefficients of a polynomial by least squares, the constant first, of an x of order one.

    As numpy's ``polyfit``, whose preparations take several times as long as the solution of so few samples.
    """
    return np.asarray(np.linalg.lstsq(np.vander(x, degree + 1, increasing=True), y, rcond=None)[0])


def local_values(t: np.ndarray, y: np.ndarray, half: float) -> np.ndarray:
    """Return `value_at` of degree two at every sample of a noisy series.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and series; the clock is taken to be about regular.
    half : float
        Half width of the stretch that is fitted [s]; below five samples nothing is smoothed.

    Returns
    -------
    ndarray, shape (n,)
    """
    if len(y) < 5:
        return y
    size = min(2 * int(half / float(np.median(np.diff(t)))) + 1, (len(y) - 1) | 1)
    return y if size < 5 else np.asarray(savgol_filter(y, size, 2))


def crossing(t: np.ndarray, y: np.ndarray, level: float) -> float | None:
    """Return the time at which a series first reaches a level from below, interpolated.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and series.
    level : float
        The level.

    Returns
    -------
    float or None
        None where it never does.
    """
    above = y >= level
    if not above.any():
        return None
    k = int(np.argmax(above))
    if k == 0:
        return float(t[0])
    return float(np.interp(level, [y[k - 1], y[k]], [t[k - 1], t[k]]))


def maximum(t: np.ndarray, y: np.ndarray, width: float) -> tuple[float, float] | None:
    """Return time and value of the maximum of a noisy series, refined by a local polynomial.

    The top is found on the moving average; a cubic is then fitted, by least squares, to the cap around it that
    makes a fifth of the rise since the first sample, and its vertex is taken.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and series.
    width : float
        Width of the moving average [s].

    Returns
    -------
    tuple of float, or None
        None where the series is still rising at its last sample, so that no maximum was reached. A rise slowed to
        a tenth of what it was counts as reached: what is missing is of the order of its square, one per cent.
    """
    if len(t) < 5:
        return None
    calm = smoothed(t, y, width)
    top = int(np.argmax(calm))
    if top >= len(y) - 2:
        size = max(5, int(np.sum(t > t[-1] - width)))
        if len(t) < 3 * size:
            return None
        begin = float(np.polynomial.polynomial.polyfit(t[:size], y[:size], 1)[1])
        end = float(np.polynomial.polynomial.polyfit(t[-size:], y[-size:], 1)[1])
        return (float(t[top]), float(calm[top])) if end < 0.1 * begin else None
    floor = calm[top] - 0.2 * max(float(calm[top] - calm[0]), 0.0)
    below = np.flatnonzero(calm < floor)
    left = below[below < top]
    right = below[below > top]
    first = int(left[-1]) + 1 if left.size else 0
    last = int(right[0]) if right.size else len(t)
    if last - first < 6:
        # A sharp or coarsely sampled top: the parabola through the three highest samples.
        first, last = max(0, top - 1), min(len(t), top + 2)
    degree = min(3, last - first - 1)
    if degree < 2:
        return float(t[top]), float(y[top])
    span = 0.5 * (t[last - 1] - t[first])
    x = (t[first:last] - t[top]) / span
    fit = _fitted(x, y[first:last], degree)
    fine = np.linspace(x[0], x[-1], 401)
    values = np.polynomial.polynomial.polyval(fine, fit)
    best = int(np.argmax(values))
    return float(t[top] + span * fine[best]), float(values[best])
