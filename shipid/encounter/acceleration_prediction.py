"""Where a target goes if her acceleration is a first-order autoregression: Song et al. (2018), equations 1 to 7.

Positions are sampled at equal intervals; velocity and acceleration are differences of them, per interval.
"""

from __future__ import annotations

import numpy as np

from shipid.encounter.errors import EncounterRequestError, TargetError

#: Points that one factor of the autoregression needs: two accelerations.
LEAST = 4


def acceleration_factor(points: np.ndarray, limit: float | None = None) -> np.ndarray:
    """Return the factor of the autoregression of the acceleration by least squares over the points.

    Equation 6, whose sum runs over the N - 3 pairs of successive accelerations of N points: with four points there is one pair,
    and the factor has no bound.

    Parameters
    ----------
    points : ndarray, shape (..., N, 2)
        Positions at equal intervals, the last one now; N is 4 or more.
    limit : float, optional
        Largest size of the factor.

    Returns
    -------
    ndarray, shape (...)
        Zero where there is no acceleration.

    Raises
    ------
    TargetError
        If there are fewer than four points, or one is not finite.
    """
    if points.shape[-2:-1] < (LEAST,) or points.shape[-1] != 2:
        raise TargetError(f"positions of shape {points.shape} are not {LEAST} or more points with two coordinates.")
    if not np.isfinite(points).all():
        raise TargetError("a position is missing or not finite; predict from positions that are there.")
    accelerations = np.diff(points, 2, axis=-2)
    before, after = accelerations[..., :-1, :], accelerations[..., 1:, :]
    size = np.sum(before**2, axis=(-2, -1))
    factor = np.sum(before * after, axis=(-2, -1)) / np.where(size > 0, size, 1.0)
    return np.asarray(factor if limit is None else np.clip(factor, -limit, limit))


def predicted_positions(points: np.ndarray, steps: int, limit: float | None = None) -> np.ndarray:
    """Return the positions that the autoregression predicts.

    ``p(t + k) = p + k v + sum_{i=1..k} (k + 1 - i) beta^i a``: equation 5 for a constant factor, its misprinted indices
    corrected by repeating equation 4.

    Parameters
    ----------
    points : ndarray, shape (..., N, 2)
        Positions at equal intervals, the last one now; N is 4 or more.
    steps : int
        How many intervals ahead.
    limit : float, optional
        Largest size of the factor; none in the paper.

    Returns
    -------
    ndarray, shape (..., steps, 2)
        At 1, 2, ... intervals from now.

    Raises
    ------
    EncounterRequestError
        If there is no step to predict.
    """
    if steps < 1:
        raise EncounterRequestError(f"a prediction of {steps} steps ahead is none; ask for 1 or more.")
    beta = acceleration_factor(points, limit)
    velocity = points[..., -1, :] - points[..., -2, :]
    acceleration = velocity - (points[..., -2, :] - points[..., -3, :])
    k = np.arange(1, steps + 1)
    with np.errstate(over="ignore"):
        weights = np.cumsum(np.cumsum(beta[..., None] ** k, axis=-1), axis=-1)
        return np.asarray(
            points[..., -1, None, :]
            + k[:, None] * velocity[..., None, :]
            + weights[..., None] * acceleration[..., None, :]
        )
