"""Robust losses: the square of a small residual, and less than the square of a large one, so that outliers count little.

Minimised by iteratively reweighted least squares: each sample is weighted by the size of its residual, in turns with the
search. A residual is large in comparison with the median size of the residuals of its signal, which a minority of outliers
hardly changes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.identification.problem.output_error import RUNAWAY, Problem

#: Median of the size of a normal variable, in standard deviations.
_MEDIAN = 0.6744897501960817
#: Where a residual begins to count less, in standard deviations. Of the information of normal residuals 5 % (Huber 1964)
#: and 2 % are lost.
_BEND = {"huber": 1.345, "soft-l1": 2.0}


def weights_of(loss: str, residual: np.ndarray, scale: float) -> np.ndarray:
    """Return the weight of each squared residual, 1 for those near the model.

    Parameters
    ----------
    loss : {"linear", "huber", "soft-l1"}
        The loss; rho' of `scipy.optimize.least_squares`.
    residual : ndarray
        Residuals.
    scale : float
        Their standard deviation without the outliers.
    """
    if loss == "linear":
        return np.ones_like(residual)
    size = np.abs(residual) / (_BEND[loss] * scale)
    return np.asarray(1 / np.maximum(size, 1.0) if loss == "huber" else 1 / np.sqrt(1 + size**2))


def curvature_of(loss: str, weights: np.ndarray) -> np.ndarray:
    """Return the second derivative of the loss by the residual, which sets the information of a sample, from its weight.

    Parameters
    ----------
    loss : {"linear", "huber", "soft-l1"}
        The loss.
    weights : ndarray
        Of `weights_of`.
    """
    return np.where(weights < 1.0, 0.0, 1.0) if loss == "huber" else weights**3 if loss == "soft-l1" else weights


def robust_scale(residual: np.ndarray) -> float:
    """Return the standard deviation that residuals have without the outliers, from their median size.

    Parameters
    ----------
    residual : ndarray
        Residuals about zero; NaN where a sample is missing.
    """
    return float(np.nanmedian(np.abs(residual))) / _MEDIAN


def unweighted(problem: Problem, residual: np.ndarray) -> list[list[np.ndarray]]:
    """Return the residuals of each trial and signal as they are without the weights of a loss.

    Parameters
    ----------
    problem : Problem
        With its weights.
    residual : ndarray, shape (M,)
        Its weighted residuals.
    """
    split = problem.by_signal(residual)
    if problem.weights is None:
        return split
    return [[r / np.sqrt(w) for r, w in zip(*both)] for both in zip(split, problem.weights)]


def reweighted(problem: Problem, residual: np.ndarray) -> Problem:
    """Return the problem with the weights that follow from its residuals.

    Parameters
    ----------
    problem : Problem
        With a loss.
    residual : ndarray, shape (M,)
        Its residuals, under the weights it has.
    """
    if problem.loss == "linear":
        return problem
    split = unweighted(problem, residual)
    scales = [robust_scale(np.concatenate([trial[j] for trial in split])) for j in range(len(problem.signals))]
    if not min(scales) > 0 or max(scales) >= RUNAWAY:
        return replace(problem, weights=None)
    weights = tuple(
        np.nan_to_num([weights_of(problem.loss, r, s) for r, s in zip(trial, scales)], nan=1.0) for trial in split
    )
    return replace(problem, weights=weights)


def change_of(one: Problem, other: Problem) -> float:
    """Return the largest change of the weights from one problem to another.

    Parameters
    ----------
    one, other : Problem
        The same trials.
    """
    if one.weights is None or other.weights is None:
        return 0.0 if one.weights is other.weights else 1.0
    return max(float(np.abs(a - b).max()) for a, b in zip(one.weights, other.weights))


def bends(problem: Problem) -> list[float]:
    """Return for each signal the root of the mean curvature of the loss: 1 where no residual is large.

    The search takes the weights as fixed, and so it overstates the information.

    Parameters
    ----------
    problem : Problem
        With its weights.
    """
    if problem.weights is None:
        return [1.0] * len(problem.signals)
    together = [
        np.concatenate([w[j][data.there[j]] for w, data in zip(problem.weights, problem.trials)])
        for j in range(len(problem.signals))
    ]
    return [float(np.sqrt(curvature_of(problem.loss, w).mean())) for w in together]
