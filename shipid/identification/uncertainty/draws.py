"""Parameter sets that the trials allow: drawn from the covariance of a fit, in the coordinates of the search.

Positive parameters are drawn by their logarithm, and all of them within their bounds. What the trials do not determine is
spread over its bounds, so that a prediction that depends on it gets a wide band.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.foundation.statistics import NORMAL_95
from shipid.identification.identified import Identified
from shipid.identification.problem.box import Box
from shipid.identification.uncertainty.covariance import covariance_of
from shipid.parameters.draws import normal_draws

#: Draws: enough for the standard deviation of a band to be known to a seventh of itself.
DRAWS = 24
#: Spread of a parameter without information: of its logarithm, or in its own size.
_LOOSE = 1.0


@dataclass(frozen=True, eq=False)
class Draws:
    """Unknowns of a fit, drawn.

    Attributes
    ----------
    names : tuple of str
        The parameters.
    values : ndarray, shape (draws, parameters)
        Their values, SI.
    unknowns : ndarray, shape (draws, unknowns)
        All unknowns: the parameters, then the initial states and biases of each trial, drawn with them.
    """

    names: tuple[str, ...]
    values: np.ndarray
    unknowns: np.ndarray


def draws_of(identified: Identified, count: int = DRAWS, seed: int = 0, errors: np.ndarray | None = None) -> Draws:
    """Draw unknowns from the covariance of an identification.

    Parameters
    ----------
    identified : Identified
        What was identified.
    count : int
        Number of draws.
    seed : int
        Of the draws, which are the same each time by default.
    errors : ndarray, shape (unknowns, unknowns), optional
        Mean products of errors that come on top of those by noise: of an effect that the model lacks.

    Returns
    -------
    Draws
    """
    problem, q, box = identified.problem, identified.solution.q, identified.box
    shared = len(problem.estimated)
    spread = _spread(box)
    for name, stated in identified.spreads.items():
        spread[problem.estimated.index(name)] = stated
    covariance = covariance_of(identified.solution, spread).matrix
    # A variance that is still infinite is that of an initial state without information: it keeps its value.
    covariance = np.where(np.isfinite(covariance), covariance, 0.0) + (0.0 if errors is None else errors)
    slope = np.ones(problem.size)
    slope[:shared][box.in_log] = q[:shared][box.in_log]
    values, vectors = np.linalg.eigh(covariance / np.outer(slope, slope))
    steps = normal_draws(problem.size, count, seed) @ (vectors * np.sqrt(np.clip(values, 0.0, None))).T
    unknowns = q + steps
    logs = np.flatnonzero(box.in_log)
    unknowns[:, logs] = q[logs] * np.exp(np.clip(steps[:, logs], -20.0, 20.0))
    unknowns[:, :shared] = np.clip(unknowns[:, :shared], box.low, box.high)
    return Draws(problem.estimated, unknowns[:, :shared], unknowns)


def _spread(box: Box) -> np.ndarray:
    """Standard deviation of each parameter where nothing but its bounds is known, in its own unit."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = np.where(box.in_log, np.log(box.high / np.where(box.in_log, box.low, 1.0)), box.high - box.low) / 4
    size = np.maximum(np.abs(box.start), 1e-3 * np.where(np.isfinite(box.high), np.abs(box.high), 1.0))
    loose = np.where(box.in_log, _LOOSE, _LOOSE * size)
    return np.minimum(np.where(np.isfinite(inside), inside, loose), loose) * np.where(box.in_log, box.start, 1.0)


def band_of(point: float | None, drawn: list[float | None]) -> tuple[float, float] | None:
    """Return the 95 % band about a prediction: 1.96 standard deviations to either side, each side with its own.

    Parameters
    ----------
    point : float or None
        The prediction.
    drawn : list of float or None
        The same for each draw; None where it was not reached.

    Returns
    -------
    tuple of float or None
        None where the prediction or more than one draw in twenty was not reached.
    """
    reached = np.array([d for d in drawn if d is not None and np.isfinite(d)])
    if point is None or not np.isfinite(point) or not len(drawn) or reached.size < 0.95 * len(drawn):
        return None
    away = reached - point
    sides = [float(np.sqrt(np.mean(s**2))) if s.size else 0.0 for s in (away[away < 0], away[away > 0])]
    return point - NORMAL_95 * sides[0], point + NORMAL_95 * sides[1]
