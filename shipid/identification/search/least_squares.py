"""Solving: trust-region least squares with bounds, logarithms of positive parameters and weights.

Starts are tried on thinned records, where a step costs little; the best goes on over every sample. Which starts, and what
is tried where they fail, is the ladder's (`shipid.identification.search.ladder`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from shipid.identification.problem.losses import change_of, reweighted, robust_scale, unweighted
from shipid.identification.problem.output_error import RUNAWAY, Problem
from shipid.identification.search.noise_levels import Levels
from shipid.identification.search.trust_region import search, triangle

#: Samples of a trial that are enough to tell a good start from a bad one.
_THIN = 400
_SPREAD = 1.0
#: Times the weights of a robust loss follow the residuals at the most, and the change of a weight that counts as none.
_TURNS = 30
_SETTLED = 2e-3
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Box:
    """Bounds and first value of each estimated parameter, SI, shapes (parameters,)."""

    start: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def in_log(self) -> np.ndarray:
        """Which are searched by their logarithm: those that are positive."""
        return self.low > 0


@dataclass(frozen=True, eq=False)
class Solution:
    """Where the search ended.

    Attributes
    ----------
    problem : Problem
        With the weights it ended with.
    q : ndarray, shape (unknowns,)
        The unknowns.
    residual : ndarray, shape (M,)
        Weighted residuals.
    jacobian : ndarray, shape (M, unknowns)
        Of the weighted residuals by the unknowns.
    converged : bool
        Whether the search met its tolerances, on finite residuals.
    message : str
        What the search said.
    evaluations : int
        Runs of all trials, over all starts.
    covariance : ndarray or None
        Of the unknowns, where they are not the minimum of these residuals but come from another method.
    levels : Levels or None
        What drives the states and the noise of the sensors, where the likelihood through the filter found them
        (`shipid.identification.search.prediction_error`).
    """

    problem: Problem
    q: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    converged: bool
    message: str
    evaluations: int
    covariance: np.ndarray | None = None
    levels: Levels | None = None

    @property
    def finite(self) -> bool:
        """Whether the model runs away nowhere."""
        return bool((np.abs(self.residual) < RUNAWAY).all())

    @property
    def cost(self) -> float:
        """Half the sum of the squared weighted residuals."""
        return float(0.5 * self.residual @ self.residual)


def make_starts(box: Box, count: int, seed: int) -> list[np.ndarray]:
    """Return the first value and random others: log-normal around it where positive, normal where the sign is free."""
    rng = np.random.default_rng([seed, 2])
    starts = [box.start]
    for _ in range(count - 1):
        draw = rng.standard_normal(box.start.size) * _SPREAD
        size = np.maximum(np.abs(box.start), 0.1 * np.minimum(np.abs(box.low), np.abs(box.high)))
        moved = np.where(box.in_log, box.start * np.exp(draw), box.start + draw * size)
        starts.append(np.clip(moved, box.low, box.high))
    return starts


def minimise(problem: Problem, q0: np.ndarray, box: Box, most: int, tolerance: float = 1e-8) -> Solution:
    """Minimise the squared weighted residuals from one start.

    Parameters
    ----------
    problem : Problem
        What to solve.
    q0 : ndarray, shape (unknowns,)
        Start.
    box : Box
        Bounds of the parameters.
    most : int
        Largest number of runs.
    tolerance : float
        Relative change of cost and unknowns at which the search ends.
    """
    if not problem.size:
        residual, jacobian = problem.residuals(q0)
        return Solution(problem, q0, residual, jacobian, True, "nothing to estimate", 1)
    logs = np.zeros(problem.size, dtype=bool)
    logs[: len(problem.estimated)] = box.in_log

    def condensed(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rows = triangle(*problem.residuals(q))
        return rows[:, -1], rows[:, :-1]

    found = search(condensed, q0, logs, *bounds_of(problem, box), most, tolerance)
    residual, jacobian = problem.residuals(found.q)
    end = Solution(problem, found.q, residual, jacobian, found.converged, found.message, found.evaluations)
    if end.finite:
        return end
    return replace(end, converged=False, message="the model runs away in every neighbourhood of the best point.")


def bounds_of(problem: Problem, box: Box) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of all unknowns: those of the parameters, and of the biases of each trial.

    Parameters
    ----------
    problem : Problem
        The problem.
    box : Box
        Bounds of the parameters.
    """
    low, high = np.full(problem.size, -np.inf), np.full(problem.size, np.inf)
    low[: len(box.low)], high[: len(box.high)] = box.low, box.high
    for i, sailed in enumerate(problem.sailed):
        begin = problem.own(i).start + len(problem.initial)
        for j, name in enumerate(problem.biases):
            # A rudder bias beyond 10 degrees, or half the speed, is another fault than a bias.
            reach = np.deg2rad(10) if name == "delta" else 0.5 * sailed.speed
            low[begin + j], high[begin + j] = -reach, reach
    return low, high


def minimise_robustly(problem: Problem, q0: np.ndarray, box: Box, most: int, tolerance: float = 1e-8) -> Solution:
    """Minimise under the loss of the problem, by least squares whose weights follow the residuals.

    Parameters
    ----------
    problem : Problem
        What to solve; with the weights to begin with.
    q0 : ndarray, shape (unknowns,)
        Start.
    box : Box
        Bounds of the parameters.
    most : int
        Largest number of runs for each set of weights.
    tolerance : float
        Relative change of cost and unknowns at which the search ends.
    """
    found = minimise(problem, q0, box, most, tolerance)
    if problem.loss == "linear":
        return found
    evaluations = found.evaluations
    for _ in range(_TURNS):
        if not found.finite:
            break
        turned = reweighted(found.problem, found.residual)
        settled = change_of(found.problem, turned) < _SETTLED
        if settled:
            break
        found = minimise(turned, found.q, box, most, tolerance)
        evaluations += found.evaluations
    else:
        found = replace(found, converged=False, message="the weights of the loss did not settle.")
    return replace(found, evaluations=evaluations)


def refine(problem: Problem, best: Solution, box: Box, weigh: bool, tell: Progress) -> Solution:
    """Go on from a start that was found on thinned records: weights first, then every sample.

    Parameters
    ----------
    problem : Problem
        With every sample.
    best : Solution
        Where to begin, on thinned records.
    box : Box
        Bounds of the parameters.
    weigh : bool
        Whether the standard deviations are estimated from the residuals (in turns with the parameters: the maximum
        of the likelihood with unknown noise levels), or stay as given.
    tell : callable
        Called with a line of text after each stage.
    """
    evaluations = best.evaluations
    best = replace(best, problem=reweighted(best.problem, best.residual))
    if weigh:
        for turn in range(4):
            sigma = noise_levels(best)
            change = np.abs(np.log(sigma / best.problem.sigma)).max()
            best = minimise_robustly(replace(best.problem, sigma=sigma), best.q, box, most=40, tolerance=1e-6)
            evaluations += best.evaluations
            tell(f"weights, turn {turn + 1}: cost {best.cost:.4g}")
            if change < 0.05:
                break
    best = minimise_robustly(replace(problem, sigma=best.problem.sigma), best.q, box, most=200)
    evaluations += best.evaluations
    tell(f"all samples: cost {best.cost:.4g}")
    if weigh:
        final = replace(best.problem, sigma=noise_levels(best))
        best = minimise_robustly(final, best.q, box, most=100)
        evaluations += best.evaluations
    return replace(best, evaluations=evaluations)


def thinned(problem: Problem, unit_time: float | None) -> Problem:
    """Return the same problem on fewer samples, its beliefs weakened as much as its data.

    Parameters
    ----------
    problem : Problem
        With every sample.
    unit_time : float or None
        L/U in s: no thinned record is coarser than a tenth of it.
    """
    return thinned_to(problem, [_thin(s.trial.duration, unit_time) for s in problem.sailed])


def thinned_to(problem: Problem, samples: list[int]) -> Problem:
    """Return the same problem on so many samples, its beliefs weakened as much as its data.

    Parameters
    ----------
    problem : Problem
        With every sample.
    samples : list of int
        How many to keep of each trial, about.
    """
    sailed = tuple(s.thinned(n) for s, n in zip(problem.sailed, samples))
    kept = sum(s.intervals.size for s in sailed) / sum(s.intervals.size for s in problem.sailed)
    prior = problem.prior and replace(problem.prior, strength=max(1.0, problem.prior.strength * kept))
    return replace(problem, sailed=sailed, prior=prior)


def _thin(duration: float, unit_time: float | None) -> int:
    return _THIN if not unit_time else max(_THIN, int(10 * duration / unit_time))


def noise_levels(solution: Solution) -> np.ndarray:
    """Return the standard deviation of each signal's residuals, SI, with the degrees of freedom of the fit.

    Parameters
    ----------
    solution : Solution
        A solution under any weights.
    """
    problem = solution.problem
    split = unweighted(problem, solution.residual)
    spent = problem.size / len(problem.signals)
    levels = np.empty(len(problem.signals))
    for j in range(len(problem.signals)):
        together = np.concatenate([trial[j] for trial in split]) * problem.sigma[j]
        mean = together @ together / together.size if problem.loss == "linear" else robust_scale(together) ** 2
        levels[j] = np.sqrt(mean * together.size / max(together.size - spent, 1.0))
        scale = max(float(np.abs(s.measured[j]).max()) for s in problem.sailed)
        levels[j] = max(levels[j], 1e-9 * max(scale, 1e-9))
    return levels


def seen_with_own_noise(solution: Solution) -> Solution:
    """Return the same unknowns with residuals in units of their own standard deviation, for the uncertainty.

    Parameters
    ----------
    solution : Solution
        Found under weights that are not the noise levels.
    """
    problem = replace(solution.problem, sigma=noise_levels(solution))
    residual, jacobian = problem.residuals(solution.q)
    return replace(solution, problem=problem, residual=residual, jacobian=jacobian)


def box_of(bounds: Mapping[str, tuple[float, float, float]]) -> Box:
    """Return a box from ``{name: (start, low, high)}``."""
    start, low, high = (np.array(c, dtype=float) for c in zip(*bounds.values())) if bounds else (np.zeros(0),) * 3
    return Box(np.clip(start, low, high), low, high)
