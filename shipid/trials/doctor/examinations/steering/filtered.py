"""Rudder and rate of turn through one low-pass filter: their derivatives without differencing noise.

State variable filters (Young 1981): what holds between rudder and rate of turn holds between the filtered signals, whose
derivatives are states of the filter.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.filling import GAP

_MOST = 3000
_ORDER = 3


@dataclass(frozen=True, eq=False)
class Signals:
    """Rudder and rate of turn on a regular clock.

    Attributes
    ----------
    t : ndarray, shape (m,)
        Time [s].
    step : float
        Its interval [s].
    delta, r : ndarray, shape (m,)
        Rudder angle [rad] and rate of turn [rad/s].
    known : ndarray of bool, shape (m,)
        Where both were measured.
    """

    t: np.ndarray
    step: float
    delta: np.ndarray
    r: np.ndarray
    known: np.ndarray


def regular_signals(p: WorkingCopy, name: str) -> Signals | None:
    """Return rudder and rate of turn on a regular clock.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs and units put right.
    name : str
        The column of the rudder.

    Returns
    -------
    Signals or None
        None where the record is too short, or holds no rudder, or neither rate nor heading.
    """
    if len(p) < 40 or not p.has(name) or not (p.has("r") or p.has("psi")):
        return None
    span = float(p.t[-1] - p.t[0])
    heading = "r" if p.has("r") else "psi"
    step = max(p.interval(name), p.interval(heading), span / _MOST)
    if not 0 < step < np.inf or not np.isfinite(span) or span / step < 40:
        return None
    t = p.t[0] + step * np.arange(int(span / step))
    r = np.interp(t, p.t, p[heading])
    if heading == "psi":
        r = np.gradient(r, step)
    known = np.interp(t, p.t, p.blind(name, heading).astype(float)) == 0
    # A gap of the clock has no rows that could be blind.
    after = np.clip(np.searchsorted(p.t, t), 1, len(p) - 1)
    known &= p.t[after] - p.t[after - 1] <= GAP * step
    return Signals(t, step, np.interp(t, p.t, p[name]), r, known)


def filtered(signals: Signals, values: np.ndarray, constant: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a signal through a third-order low-pass filter, and its first and second derivative.

    Parameters
    ----------
    signals : Signals
        For the clock.
    values : ndarray, shape (m,)
        The signal.
    constant : float
        Time constant of the filter [s].

    Returns
    -------
    tuple of ndarray, shape (m,)
    """
    from scipy.signal import lfilter  # loads all of scipy.signal, half a second

    # In units of the sampling interval: the numbers stay near one whatever the clock counts in.
    start = float(values[0])
    found = [lfilter(b, a, values - start) for b, a in _coefficients(constant / signals.step)]
    return found[0] + start, found[1] / signals.step, found[2] / signals.step**2


def damping(signals: Signals, constant: float) -> tuple[np.ndarray, np.ndarray]:
    """Return what damps a turn, ``r``, ``r|r|``, ``r^3`` and a constant, filtered, and the acceleration in turning beside it.

    Parameters
    ----------
    signals : Signals
        The signals.
    constant : float
        Time constant of the filter [s].

    Returns
    -------
    tuple of ndarray
        Shapes (m, 4) and (m,).
    """
    r, slope, _ = filtered(signals, signals.r, constant)
    others = (filtered(signals, power, constant)[0] for power in (signals.r * np.abs(signals.r), signals.r**3))
    return np.column_stack([r, *others, np.ones_like(r)]), slope


@lru_cache(maxsize=64)
def _coefficients(width: float) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Numerators and denominators of the filter and its first two derivatives, for a width in samples."""
    from scipy.signal import cont2discrete

    denominator = np.poly([-1 / width] * _ORDER)
    gain = width**-_ORDER
    found = []
    for numerator in ([gain], [gain, 0.0], [gain, 0.0, 0.0]):
        b, a, _ = cont2discrete((numerator, denominator), 1.0, method="foh")
        found.append((np.ravel(b), a))
    return tuple(found)


def settled(signals: Signals, constant: float) -> np.ndarray:
    """Return where a filter has forgotten the beginning of the record and every hole.

    Parameters
    ----------
    signals : Signals
        The signals.
    constant : float
        Time constant of the filter [s].

    Returns
    -------
    ndarray of bool, shape (m,)
    """
    lost = np.concatenate(([0], np.flatnonzero(~signals.known)))
    index = np.arange(len(signals.t))
    last = lost[np.searchsorted(lost, index, side="right") - 1]
    result: np.ndarray = index - last > 6 * constant / signals.step
    return result


def squares(design: np.ndarray, target: np.ndarray) -> float:
    """Return the sum of squares of what a linear model leaves of the target.

    Parameters
    ----------
    design : ndarray, shape (m, p)
        Regressors.
    target : ndarray, shape (m,)
        What they explain.
    """
    scaled = design / np.maximum(np.abs(design).max(axis=0), 1e-300)
    rest = target - scaled @ np.linalg.lstsq(scaled, target, rcond=None)[0]
    return float(rest @ rest)


def squares_of_each(columns: np.ndarray, design: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Return the sums of squares of many linear models that differ in one regressor.

    Parameters
    ----------
    columns : ndarray, shape (m, n)
        The regressor of each model.
    design : ndarray, shape (m, p)
        The regressors that all have.
    target : ndarray, shape (m,)
        What they explain.

    Returns
    -------
    ndarray, shape (n,)
    """
    # What the common regressors explain is taken out of both sides once (Frisch and Waugh 1933).
    scaled = design / np.maximum(np.abs(design).max(axis=0), 1e-300)
    basis, size, _ = np.linalg.svd(scaled, full_matrices=False)
    basis = basis[:, size > size[0] * np.finfo(float).eps * len(target)]
    target = target - basis @ (basis.T @ target)
    columns = columns / np.maximum(np.abs(columns).max(axis=0), 1e-300)
    shares = basis.T @ columns
    whole = np.einsum("mn,mn->n", columns, columns)
    own = whole - np.einsum("pn,pn->n", shares, shares)
    # A regressor that the others explain to rounding explains nothing more.
    gain = np.where(own > 1e-12 * whole, (columns.T @ target) ** 2 / np.maximum(own, 1e-300), 0.0)
    return np.maximum(float(target @ target) - gain, 0.0)
