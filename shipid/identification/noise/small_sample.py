"""Uncertainty of coefficients when noise levels are estimated from the same short record.

The inverse information at the estimated levels takes them for known. Three corrections of mixed linear models are made: the
levels move to the maximum of the restricted likelihood, which counts what the coefficients absorb (Patterson and Thompson 1971);
the covariance gets what the coefficients move with the levels, once for their scatter and once for the levels that fit this record
too well (Kackar and Harville 1984; Kenward and Roger 1997); and the interval takes Student's quantile, with degrees of freedom
by which the variance itself is known (Satterthwaite 1946).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from shipid.identification.search.unseen import covariance_by

#: Step in the logarithm of a level for differences of the information, and the largest move of a level.
_STEP, _FARTHEST = 0.01, 1.0
#: Steps towards the restricted maximum, and one after which no further is made: the information changes by a twenty-fifth.
_STEPS, _CLOSE = 4, 0.02
#: Fewer degrees of freedom are not told from these; so many are as good as normal.
_FEWEST, MANY = 4.0, 1e6


@dataclass(frozen=True, eq=False)
class SmallSample:
    """Covariance of all unknowns with the degrees of freedom of each variance.

    Attributes
    ----------
    q : ndarray, shape (unknowns,)
        The unknowns, with the levels at the maximum of the restricted likelihood.
    information : ndarray, shape (unknowns, unknowns)
        There.
    added : ndarray, shape (unknowns, unknowns)
        What the covariance of the others gets because they move with the levels.
    degrees : ndarray, shape (unknowns,)
        Degrees of freedom; those of the levels themselves are not meant.
    """

    q: np.ndarray
    information: np.ndarray
    added: np.ndarray
    degrees: np.ndarray


def small_sample(
    slopes_at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], q: np.ndarray, levels: np.ndarray
) -> SmallSample:
    """Correct for levels that are estimated.

    Parameters
    ----------
    slopes_at : callable
        From unknowns to the gradient of the log-likelihood, shape (unknowns,), and the expected information,
        shape (unknowns, unknowns).
    q : ndarray, shape (unknowns,)
        The maximum of the likelihood.
    levels : ndarray of int
        Where the logarithms of levels (and correlation times) stand whose uncertainty counts.

    Returns
    -------
    SmallSample
    """
    gradient, information = slopes_at(q)
    others = np.setdiff1d(np.arange(q.size), levels)
    others = others[np.diag(information)[others] > 0]
    inside, at = np.ix_(others, others), np.ix_(levels, levels)
    cover, added = covariance_by(information)[inside], np.zeros((q.size, q.size))
    if not levels.size or not np.isfinite(cover).all():
        return SmallSample(q, information, added, np.full(q.size, MANY))
    slopes, pulls = [], []
    for k in levels:
        moved = q.copy()
        moved[k] += _STEP
        there = slopes_at(moved)
        pulls.append((there[0][others] - gradient[others]) / _STEP)
        slopes.append((there[1][inside] - information[inside]) / _STEP)
    spread = covariance_by(information)[at]
    known = np.isfinite(np.diag(spread))
    spread = np.where(np.outer(known, known), spread, 0.0)
    # Where the maximum over the others goes when a level moves.
    moves = cover @ np.array(pulls).T
    added[inside] = 2 * moves @ spread @ moves.T
    # Relative to the information its slopes hardly change with the levels, so that this pull stays as it is here.
    restricted = np.array([-0.5 * np.trace(cover @ slope) for slope in slopes])
    better, last = _restricted(slopes_at, (q, gradient, information), levels, restricted)
    # d(I^-1) = -I^-1 dI I^-1, on the diagonal; relative to the variance it hardly changes with the level.
    changes = np.array([np.einsum("ij,jk,ik->i", cover, slope, cover) for slope in slopes])
    variance = np.einsum("ki,kl,li->i", changes, spread, changes)
    degrees = np.full(q.size, MANY)
    with np.errstate(divide="ignore"):
        degrees[others] = np.clip(2 * np.diag(cover) ** 2 / variance, _FEWEST, MANY)
    return SmallSample(better, last, np.where(np.isfinite(added), added, 0.0), degrees)


def _restricted(
    slopes_at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    found: tuple[np.ndarray, np.ndarray, np.ndarray],
    levels: np.ndarray,
    restricted: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The unknowns with the levels at the maximum of the restricted likelihood, and the information there: by Newton's steps."""
    first, gradient, information = found
    q = first
    for _ in range(_STEPS):
        cover = covariance_by(information)
        known = np.isfinite(np.diag(cover))
        pull = gradient.copy()
        pull[levels] += restricted
        moved = q.copy()
        moved[levels] += (np.where(np.outer(known, known), cover, 0.0) @ pull)[levels]
        moved[levels] = first[levels] + np.clip(moved[levels] - first[levels], -_FARTHEST, _FARTHEST)
        gradient, there = slopes_at(moved)
        if not np.isfinite(there).all() or not there.any():
            break
        step, q, information = np.abs(moved - q).max(), moved, there
        if step < _CLOSE:
            break
    return q, information
