"""Directions of the unknowns on which no residual depends: along them the coefficients stay where they came from.

A search from random starts leaves such a direction at whatever its start was drawn as. Here the coefficients are moved along it
to the point that is nearest to their first values, which costs nothing in the residuals and is the same from every start. A
single coefficient without influence returns to its first value; of two that show only in combination the combination is kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from shipid.identification.problem.box import Box
from shipid.identification.search.solution import Solution
from shipid.identification.search.trust_region import triangle

#: A direction is unseen where the residuals change by less than this part of what they change in the best seen one.
UNSEEN = 1e-8
#: Weight from which an unknown takes part in a direction.
PART = 1e-3
#: Turns along a curved valley, and the move, in the usual size of the coefficients, at which it has ended.
_TURNS = 20
_STILL = 1e-9
#: Part of the largest singular value of an information matrix that counts as none.
_ROUNDING = 1e-12
#: Largest relative growth of the cost by rounding.
_SAME = 1e-6


def unseen_directions(jacobian: np.ndarray, shared: int) -> np.ndarray:
    """Return the directions on which residuals do not depend and in which coefficients take part, shape (directions, unknowns).

    Parameters
    ----------
    jacobian : ndarray, shape (M, unknowns)
        Derivatives of the residuals.
    shared : int
        The first so many unknowns are coefficients.
    """
    norms = np.linalg.norm(jacobian, axis=0)
    scale = np.where(norms > 0, norms, 1.0)
    _, singular, rows = np.linalg.svd(jacobian / scale, full_matrices=True)
    sizes = np.zeros(jacobian.shape[1])
    sizes[: singular.size] = singular
    unseen = rows[sizes <= UNSEEN * sizes.max(initial=0.0)]
    return np.asarray(unseen[(np.abs(unseen[:, :shared]) > PART).any(axis=1)] / scale)


def covariance_by(information: np.ndarray, scatter: np.ndarray | None = None) -> np.ndarray:
    """Return the inverse of an information matrix, with an infinite variance of unknowns about which it holds nothing.

    Parameters
    ----------
    information : ndarray, shape (unknowns, unknowns)
        Of all unknowns; symmetric, or the product of instruments and regressors.
    scatter : ndarray, shape (unknowns, unknowns), optional
        Covariance of the gradient where it is not the information: that of the unknowns is then the sandwich of both.

    Returns
    -------
    ndarray, shape (unknowns, unknowns)
    """
    scale = np.sqrt(np.abs(np.diag(information)))
    seen = np.flatnonzero(scale > 0)
    matrix = np.zeros_like(information)
    lost = scale == 0
    if seen.size:
        inside = np.outer(scale[seen], scale[seen])
        left, singular, right = np.linalg.svd(information[np.ix_(seen, seen)] / inside)
        # The information is the square of the slopes: rounding leaves more of a direction that it does not hold.
        small = singular <= _ROUNDING * singular[0]
        inverse = (right.T * np.where(small, 0.0, 1 / np.where(small, 1.0, singular))) @ left.T
        if scatter is not None:
            inverse = inverse @ (scatter[np.ix_(seen, seen)] / inside) @ inverse.T
        matrix[np.ix_(seen, seen)] = inverse / inside
        lost[seen] |= (np.abs(right[small]) > PART).any(axis=0)
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    return matrix


def nearest_to_start(solution: Solution, box: Box, again: Callable[[Solution], Solution]) -> Solution:
    """Return an equally good solution whose coefficients are the nearest to their first values.

    Parameters
    ----------
    solution : Solution
        The end of a search.
    box : Box
        Bounds and first values, and how far each may lie from its first value.
    again : callable
        Goes on searching from a solution: a step along a curved valley leaves its bottom.

    Returns
    -------
    Solution
        The one given where every direction of the coefficients is seen.
    """
    shared = len(solution.problem.estimated)
    if not shared or not solution.finite:
        return solution
    logs = np.zeros(solution.q.size, dtype=bool)
    logs[:shared] = box.in_log
    for _ in range(_TURNS):
        slope = np.where(logs, solution.q, 1.0)
        rows = triangle(solution.residual, solution.jacobian)[:, :-1] * slope
        unseen = unseen_directions(rows, shared)
        if not len(unseen):
            return solution
        along = unseen[:, :shared] / box.reach
        amount = np.linalg.lstsq(along.T, _distance(solution.parameters, box) / box.reach, rcond=1e-10)[0]
        step = -(amount @ unseen)
        if np.abs(step[:shared] / box.reach).max() < _STILL:
            return solution
        q = solution.q + np.where(logs, 0.0, step)
        q[logs] = solution.q[logs] * np.exp(step[logs])
        q[:shared] = np.clip(q[:shared], box.low, box.high)
        residual, jacobian = solution.problem.residuals(q)
        moved = replace(solution, q=q, residual=residual, jacobian=jacobian)
        if moved.cost > (1 + UNSEEN) * solution.cost:
            moved = again(moved)
        if not moved.finite or moved.cost > (1 + _SAME) * solution.cost:
            return solution
        solution = moved
    return solution


def _distance(values: np.ndarray, box: Box) -> np.ndarray:
    """How far coefficients are from their first values, in the coordinates of the search."""
    ratio = np.where(box.in_log, values, 1.0) / np.where(box.in_log, box.start, 1.0)
    return np.where(box.in_log, np.log(ratio), values - box.start)
