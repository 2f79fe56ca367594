"""The maximum of a likelihood between bounds: Newton's steps with the expected information, damped (Fisher scoring)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

#: Longest step of a logarithm, smallest gain of a step that is worth the next one, most evaluations.
_LONGEST, _GAIN, _MOST = 1.5, 1e-2, 150


class Objective(Protocol):
    """The logarithm of a likelihood."""

    def value(self, z: np.ndarray) -> float:
        """Return it at a point.

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The point.
        """

    def slopes(self, z: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return gradient and expected information at a point, shapes (unknowns,) and (unknowns, unknowns).

        Parameters
        ----------
        z : ndarray, shape (unknowns,)
            The point.
        free : ndarray of bool, shape (unknowns,)
            By which unknowns; the others have zeros.
        """


@dataclass(frozen=True, eq=False)
class Summit:
    """Where a search ended.

    Attributes
    ----------
    at : ndarray, shape (unknowns,)
        The point.
    information : ndarray, shape (unknowns, unknowns)
        Fisher's, there; zero for unknowns that were held.
    free : ndarray of bool, shape (unknowns,)
        Which were not.
    value : float
        The logarithm of the likelihood.
    evaluations : int
        How many steps were tried.
    converged : bool
        Whether a further step would gain nothing.
    """

    at: np.ndarray
    information: np.ndarray
    free: np.ndarray
    value: float
    evaluations: int
    converged: bool


def climb(objective: Objective, start: np.ndarray, low: np.ndarray, high: np.ndarray, most: int = _MOST) -> Summit:
    """Return the maximum that a search from a start reaches.

    Parameters
    ----------
    objective : Objective
        The likelihood.
    start, low, high : ndarray, shape (unknowns,)
        Where it begins, and the bounds: logarithms, or unknowns of size one. One with equal bounds is held.
    most : int
        Largest number of steps that are tried.
    """
    at, free = np.clip(start, low, high), low < high
    value = objective.value(at)
    information = np.zeros((at.size, at.size))
    damping, evaluations, moved, converged = 1e-2, 1, True, False
    while evaluations < most and np.isfinite(value):
        if moved:
            gradient, information = objective.slopes(at, free)
        bound = ((at <= low) & (gradient < 0)) | ((at >= high) & (gradient > 0))
        moving = np.flatnonzero(free & ~bound)
        part = information[np.ix_(moving, moving)]
        step = np.zeros_like(at)
        step[moving] = np.linalg.solve(part + np.diag(damping * np.diag(part) + 1e-9), gradient[moving])
        after = np.clip(at + np.clip(step, -_LONGEST, _LONGEST), low, high)
        reached = objective.value(after)
        evaluations += 1
        moved = reached > value
        # What a step promises is worked out from the gradient: a short step because of the damping is no end.
        promised = float(gradient[moving] @ step[moving])
        if moved:
            at, value, damping = after, reached, max(damping / 5, 1e-6)
        else:
            damping *= 4
        if not moving.size or (promised < _GAIN and (damping < 1.0 or not moved)) or damping > 1e10:
            converged = True
            break
    if moved and np.isfinite(value):
        _, information = objective.slopes(at, free)
    return Summit(at, information, free, value, evaluations, converged)
