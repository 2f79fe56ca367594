"""Gaussian mixtures as expressions: mean and covariance of several estimates, and the interaction of modes."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from shipid.foundation.aliases import Expression


def nearby(difference: Expression, wraps: Sequence[bool]) -> Expression:
    """Return differences of states, those of angles that wrap within half a turn.

    Parameters
    ----------
    difference : casadi.SX, shape (n,)
        Differences.
    wraps : sequence of bool, shape (n,)
        Which are of angles that wrap.
    """
    near = difference + 0
    for k in np.flatnonzero(wraps).tolist():
        near[k] = difference[k] - 2 * np.pi * ca.floor(difference[k] / (2 * np.pi) + 0.5)
    return near


def merged(
    weights: Sequence[Expression],
    parts: Sequence[tuple[Expression, Expression]],
    reference: Expression,
    wraps: Sequence[bool],
) -> tuple[Expression, Expression]:
    """Return mean and covariance of a mixture, computed around a reference so that large coordinates lose no digits.

    Parameters
    ----------
    weights : sequence of casadi.SX
        They sum to one.
    parts : sequence of tuple of casadi.SX, shapes (n,) and (n, n)
        Mean and covariance of each part.
    reference : casadi.SX, shape (n,)
        A point near the means, one of them.
    wraps : sequence of bool, shape (n,)
        Which states are angles that wrap.
    """
    n = reference.shape[0]
    if len(parts) == 1:
        return parts[0]
    away = [ca.SX.zeros(n) if ca.is_equal(m, reference) else nearby(m - reference, wraps) for m, _ in parts]
    shift = sum((w * d for w, d in zip(weights, away)), ca.SX.zeros(n))
    covariance = ca.SX(n, n)
    apart = [d - shift for d in away]
    covariances = [P for _, P in parts]
    for column in range(n):
        for row in range(column + 1):
            value = sum(w * (P[row, column] + d[row] * d[column]) for w, P, d in zip(weights, covariances, apart))
            covariance[row, column] = covariance[column, row] = value
    return reference + shift, covariance
