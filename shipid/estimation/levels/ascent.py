"""The maximum of a likelihood between bounds: Newton's steps with the expected information, damped (Fisher scoring)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

#: Value, gradient and information at a point.
Objective = Callable[[np.ndarray], tuple[float, np.ndarray, np.ndarray]]
#: Longest step of a logarithm, smallest gain of a step that is worth the next one, most evaluations.
_LONGEST, _GAIN, _MOST = 1.5, 1e-2, 120


@dataclass(frozen=True, eq=False)
class Summit:
    """Where a search ended.

    Attributes
    ----------
    at, gradient : ndarray, shape (unknowns,)
        The point, and the gradient there.
    information : ndarray, shape (unknowns, unknowns)
        Fisher's, there.
    value : float
        The logarithm of the likelihood.
    evaluations : int
        How often it was evaluated.
    converged : bool
        Whether a further step would gain nothing.
    """

    at: np.ndarray
    gradient: np.ndarray
    information: np.ndarray
    value: float
    evaluations: int
    converged: bool


def climb(objective: Objective, start: np.ndarray, low: np.ndarray, high: np.ndarray) -> Summit:
    """Return the maximum that a search from a start reaches.

    Parameters
    ----------
    objective : callable
        Value, gradient and information.
    start, low, high : ndarray, shape (unknowns,)
        Where it begins, and the bounds; logarithms, or unknowns of size one.
    """
    at = np.clip(start, low, high)
    value, gradient, information = objective(at)
    damping, evaluations, converged = 1e-2, 1, False
    while evaluations < _MOST and np.isfinite(value):
        held = (low >= high) | ((at <= low) & (gradient < 0)) | ((at >= high) & (gradient > 0))
        free = np.flatnonzero(~held)
        if not free.size:
            converged = True
            break
        part = information[np.ix_(free, free)]
        step = np.zeros_like(at)
        step[free] = np.linalg.solve(part + np.diag(damping * np.diag(part) + 1e-9), gradient[free])
        after = np.clip(at + np.clip(step, -_LONGEST, _LONGEST), low, high)
        found = objective(after)
        evaluations += 1
        if found[0] > value:
            gain = found[0] - value
            at, (value, gradient, information) = after, found
            damping = max(damping / 5, 1e-6)
            if gain < _GAIN:
                converged = True
                break
        else:
            damping *= 4
            if damping > 1e8:
                # No step uphill is left: the gradient is zero to rounding.
                converged = True
                break
    return Summit(at, gradient, information, value, evaluations, converged and bool(np.isfinite(value)))
