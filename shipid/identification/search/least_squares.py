"""Solving: trust-region least squares with bounds, logarithms of positive parameters and weights.

Starts are tried on thinned records, where a step costs little; the best goes on over every sample. Which starts, and what
is tried where they fail, is the ladder's (`shipid.identification.search.ladder`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from shipid.foundation.numbers import brief
from shipid.identification.problem.box import Box
from shipid.identification.problem.losses import change_of, reweighted
from shipid.identification.problem.output_error import Problem
from shipid.identification.search.solution import Solution, residual_levels
from shipid.identification.search.trust_region import search, triangle
from shipid.identification.search.unseen import nearest_to_start

#: Samples of a trial that are enough to distinguish a good start from a bad one.
_THIN = 400
_SPREAD = 1.0
#: Largest number of updates of the weights of a robust loss, and the change of a weight below which they have converged.
_TURNS = 30
_SETTLED = 2e-3
Progress = Callable[[str], None]


def make_starts(box: Box, count: int, seed: int) -> list[np.ndarray]:
    """Return the first value and random others: log-normal around it where positive, normal where the sign is free.

    Parameters
    ----------
    box : Box
        First values and bounds.
    count : int
        How many starts.
    seed : int
        Of the random ones.
    """
    rng = np.random.default_rng([seed, 2])
    starts = [box.start]
    for _ in range(count - 1):
        draw = rng.standard_normal(box.start.size) * _SPREAD
        nearer = np.minimum(np.abs(box.low), np.abs(box.high))
        size = np.maximum(np.abs(box.start), np.where(np.isfinite(nearer), 0.1 * nearer, 0.0))
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

    Returns
    -------
    Solution
    """
    if not problem.size:
        residual, jacobian = problem.residuals(q0)
        return Solution(problem, q0, residual, jacobian, True, "nothing to estimate", 1)
    logs = np.zeros(problem.size, dtype=bool)
    logs[: len(problem.estimated)] = box.in_log

    def condensed(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rows = triangle_of(problem, q)
        return rows[:, -1], rows[:, :-1]

    found = search(condensed, q0, logs, *bounds_of(problem, box), most, tolerance)
    residual, jacobian = problem.residuals(found.q)
    end = Solution(problem, found.q, residual, jacobian, found.converged, found.message, found.evaluations)
    if end.finite:
        return end
    return replace(end, converged=False, message="the model runs away in every neighbourhood of the best point.")


def triangle_of(problem: Problem, q: np.ndarray) -> np.ndarray:
    """Return the triangle of all residuals of a problem, see `shipid.identification.search.trust_region.triangle`.

    Of several trials it is made of that of each: most columns of the whole are those of other trials, and zero.

    Parameters
    ----------
    problem : Problem
        The problem.
    q : ndarray, shape (unknowns,)
        The unknowns.
    """
    if len(problem.trials) == 1:
        return triangle(*problem.residuals(q))
    rows = []
    for residual, slope, columns in problem.blocks(q):
        part = triangle(residual, slope)
        row = np.zeros((len(part), problem.size + 1))
        row[:, columns], row[:, -1] = part[:, :-1], part[:, -1]
        rows.append(row)
    return np.asarray(np.linalg.qr(np.concatenate(rows), mode="r"))


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
    for i, data in enumerate(problem.trials):
        begin = problem.own(i).start + len(problem.initial)
        for j, name in enumerate(problem.biases):
            # A rudder bias beyond 10 degrees, or half the speed, is a fault and no bias.
            reach = np.deg2rad(10) if name == "delta" else 0.5 * data.speed
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

    Returns
    -------
    Solution
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
        found = replace(found, converged=False, message="the weights of the loss did not converge.")
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

    Returns
    -------
    Solution
        Along directions on which no residual depends, the one nearest to the first values of the coefficients.
    """
    evaluations = best.evaluations
    best = replace(best, problem=reweighted(best.problem, best.residual))
    if weigh:
        for turn in range(4):
            sigma = residual_levels(best)
            change = np.abs(np.log(sigma / best.problem.sigma)).max()
            best = minimise_robustly(replace(best.problem, sigma=sigma), best.q, box, most=40, tolerance=1e-6)
            evaluations += best.evaluations
            tell(f"weights, turn {turn + 1}: cost {brief(best.cost, 4)}")
            if change < 0.05:
                break
    best = minimise_robustly(replace(problem, sigma=best.problem.sigma), best.q, box, most=200)
    evaluations += best.evaluations
    tell(f"all samples: cost {brief(best.cost, 4)}")
    if weigh:
        final = replace(best.problem, sigma=residual_levels(best))
        best = minimise_robustly(final, best.q, box, most=100)
        evaluations += best.evaluations
    best = nearest_to_start(best, box, lambda s: minimise_robustly(s.problem, s.q, box, most=100))
    return replace(best, evaluations=evaluations)


def thinned(problem: Problem, unit_time: float | None) -> Problem:
    """Return the same problem on fewer samples, its prior weakened as much as its data.

    Parameters
    ----------
    problem : Problem
        With every sample.
    unit_time : float or None
        L/U in s: no thinned record is coarser than a tenth of it.
    """
    return thinned_to(problem, [_thin(data.trial.duration, unit_time) for data in problem.trials])


def thinned_to(problem: Problem, samples: list[int]) -> Problem:
    """Return the same problem on so many samples, its prior weakened as much as its data.

    Parameters
    ----------
    problem : Problem
        With every sample.
    samples : list of int
        How many to keep of each trial, about.
    """
    trials = tuple(data.thinned(n) for data, n in zip(problem.trials, samples))
    kept = sum(int(data.there.sum()) for data in trials) / sum(int(data.there.sum()) for data in problem.trials)
    prior = problem.prior and replace(problem.prior, strength=max(1.0, problem.prior.strength * kept))
    return replace(problem, trials=trials, prior=prior)


def _thin(duration: float, unit_time: float | None) -> int:
    return _THIN if not unit_time else max(_THIN, int(10 * duration / unit_time))
