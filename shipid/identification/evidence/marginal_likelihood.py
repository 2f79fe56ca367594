"""The spread of the rudder biases, from the marginal likelihood of the trials.

A bias that is free in every trial absorbs the error of the model; one that trials share by force makes the intervals too
narrow where the rudder's zero does move. So the biases are random effects: each is drawn about a common mean, and the standard
deviation about it is estimated by the likelihood in which all other unknowns are integrated out, by Laplace's approximation
(Tierney and Kadane 1986). It is small in a tank and large at sea.

The unknowns are searched for at each of several spreads. The coefficients are those at the mean of the logarithm of the
spread; their covariance is the mean over the spreads, with the scatter of the coefficients from spread to spread.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shipid.foundation.numbers import brief
from shipid.identification.evidence.bias_spread import EXPECTED, BiasSpread, probability_of_common
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.search.least_squares import Progress, minimise_robustly
from shipid.identification.search.prediction_weights import lasting_errors, weigh_again, weigh_first
from shipid.identification.search.solution import Solution, SolutionAtSpread
from shipid.identification.uncertainty.covariance import covariance_of

#: The input whose bias is a random effect.
_INPUT = "delta"
#: Spreads that are tried, in rad, and the one at which the first weights are found: wide enough for a bias at sea.
_SPREADS = np.deg2rad([0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6])
_WIDE = 4
#: Probability below which a spread does not count in the covariance.
_NEGLIGIBLE = 1e-3
#: Relative change of the weights of the signals below which the spread is not estimated again, and how often it may be.
_SETTLED = 0.05
_TURNS = 2
#: Share of the error of a structure from which on residuals that last are taken to be one.
_STRUCTURAL = 0.5


@dataclass(frozen=True, eq=False)
class Weighing:
    """How the signals are weighted while the spread is estimated.

    Attributes
    ----------
    least : ndarray, shape (signals,)
        Error that a model of low order has, SI (`shipid.identification.search.prediction_weights`).
    given : bool
        Whether the weights are given, and stay.
    independent : float
        Time in s for which a residual lasts where only the structure of the model is wrong.
    tell : callable
        Called with a line of text after each stage.
    records : int
        Records that the trials come from: the stretches of one record have one rudder, and tell nothing of the spread.
    """

    least: np.ndarray
    given: bool
    independent: float
    tell: Progress
    records: int

    def again(self, solution: Solution, box: Box) -> Solution:
        """Return the solution under the weights of its own residuals.

        Parameters
        ----------
        solution : Solution
            A solution.
        box : Box
            Bounds of the parameters.
        """
        return solution if self.given else weigh_again(solution, box, self.least, self.independent)

    def first(self, solution: Solution, box: Box) -> Solution:
        """Return the solution under the weights of its own residuals, which may be mere noise.

        Parameters
        ----------
        solution : Solution
            The end of a search.
        box : Box
            Bounds of the parameters.
        """
        return solution if self.given else weigh_first(solution, box, self.least, self.independent)


def conclude(found: Solution, problem: Problem, box: Box, weighing: Weighing) -> tuple[Solution, BiasSpread | None]:
    """Return the solution on every sample with the spread of the biases estimated.

    Parameters
    ----------
    found : Solution
        The end of a search on samples that are enough.
    problem : Problem
        On every sample, with a prior.
    box : Box
        Bounds of the parameters.
    weighing : Weighing
        How the signals are weighted.

    Returns
    -------
    solution : Solution
        Under the weights it was searched with; `Solution.others` holds those at other spreads, for the covariance.
    spread : BiasSpread or None
        None where there is one record, or the rudder has no bias.
    """
    if not found.finite or not problem.size:
        return _on_every_sample(found, problem, box, weighing), None
    prior = problem.prior
    if prior is None or _INPUT not in prior.biases or weighing.records < 2:
        return _on_every_sample(weighing.first(found, box), problem, box, weighing), None
    at = weighing.first(_at(found, float(_SPREADS[_WIDE]), box), box)
    for _ in range(_TURNS):
        if not at.finite:
            return at, None
        tried = _tried(at, box)
        share = _probabilities(tried, box)
        middle = float(np.exp(share @ np.log(_SPREADS)))
        nearest = tried[int(np.argmin(np.abs(np.log(_SPREADS / middle))))]
        at = _at(nearest, middle, box)
        weighing.tell(f"spread of the rudder biases: {brief(np.rad2deg(middle), 2)} deg")
        before = at.problem.sigma
        at = weighing.again(at, box)
        if np.abs(np.log(at.problem.sigma / before)).max() < _SETTLED:
            break
    if not at.finite:
        return at, None
    evaluations = at.evaluations + sum(s.evaluations for s in tried)
    end = _on_every_sample(replace(at, evaluations=evaluations), problem, box, weighing)
    if not end.finite:
        return end, None
    moved = [_moved(s, at, end) for s in tried]
    counted = np.where(share > _NEGLIGIBLE, share, 0.0)
    others = (SolutionAtSpread(float(c), m.problem, m.q) for c, m in zip(counted / counted.sum(), moved) if c)
    end = replace(end, others=tuple(others))
    structural = bool((lasting_errors(end, weighing.independent) > _STRUCTURAL * weighing.least).any())
    return end, _spread(middle, share, moved[-1], structural)


def _with_spread(problem: Problem, spread: float) -> Problem:
    prior = problem.prior
    return problem if prior is None else replace(problem, prior=replace(prior, biases={**prior.biases, _INPUT: spread}))


def _at(solution: Solution, spread: float, box: Box) -> Solution:
    """The solution at another spread."""
    return minimise_robustly(_with_spread(solution.problem, spread), solution.q, box, most=100, tolerance=1e-6)


def _on_every_sample(solution: Solution, problem: Problem, box: Box, weighing: Weighing) -> Solution:
    """The solution on every sample, at its own spread and lasting errors."""
    prior, own = problem.prior, solution.problem.prior
    if prior is not None and own is not None:
        prior = replace(prior, biases=own.biases, lasting=own.lasting)
    whole = replace(problem, sigma=solution.problem.sigma, prior=prior)
    found = minimise_robustly(whole, solution.q, box, most=200)
    found = replace(found, evaluations=solution.evaluations + found.evaluations)
    if not found.finite:
        return found
    # How long noise lasts in a sample of its own shows only here; then once more, to the end.
    weighed = weighing.again(found, box)
    if weighed is found:
        return found
    end = minimise_robustly(weighed.problem, weighed.q, box, most=200)
    return replace(end, evaluations=weighed.evaluations + end.evaluations)


def _tried(middle: Solution, box: Box) -> list[Solution]:
    """Solutions at all spreads, each from its neighbour."""
    found = {_WIDE: _at(middle, float(_SPREADS[_WIDE]), box)}
    for k in (*range(_WIDE - 1, -1, -1), *range(_WIDE + 1, len(_SPREADS))):
        found[k] = _at(found[k + 1 if k < _WIDE else k - 1], float(_SPREADS[k]), box)
    return [found[k] for k in range(len(_SPREADS))]


def _probabilities(tried: list[Solution], box: Box) -> np.ndarray:
    """Probability of each spread: marginal likelihood by Laplace's approximation, times what is expected beforehand."""
    first = tried[_WIDE]
    strength = 1.0 if first.problem.prior is None else first.problem.prior.strength
    scale = np.where(norms := np.linalg.norm(_by_logs(first, box), axis=0), norms, 1.0)
    evidence = []
    for spread, width, solution in zip(_SPREADS, np.diff(_edges()), tried):
        sizes = np.linalg.svd(_by_logs(solution, box) / scale, compute_uv=False)
        # Directions that no residual shows have the same volume at every spread.
        volume = float(np.log(np.maximum(sizes, 1e-8)).sum())
        normal = (len(solution.problem.trials) - 1) * np.log(spread)
        # Each stands for its neighbourhood in the logarithm: a density of the spread counts with the spread.
        beforehand = np.log(spread * width) - np.log1p((spread / EXPECTED) ** 2)
        evidence.append(-solution.cost / strength - volume - normal + beforehand)
    found = np.where([s.finite for s in tried], evidence, -np.inf)
    share = np.exp(found - found.max())
    return np.asarray(share / share.sum())


def _by_logs(solution: Solution, box: Box) -> np.ndarray:
    """The Jacobian by the unknowns as they are searched for, positive ones by their logarithm."""
    slope = np.ones(solution.q.size)
    slope[: box.in_log.size] = np.where(box.in_log, solution.parameters, 1.0)
    return np.asarray(solution.jacobian * slope)


def _moved(one: Solution, at: Solution, end: Solution) -> Solution:
    """A solution at another spread, on every sample: as far from the end as it is from the solution on fewer."""
    prior = one.problem.prior
    problem = end.problem if prior is None else _with_spread(end.problem, prior.biases[_INPUT])
    q = end.q + (one.q - at.q)
    residual, jacobian = problem.residuals(q)
    return replace(end, problem=problem, q=q, residual=residual, jacobian=jacobian)


def _spread(value: float, share: np.ndarray, free: Solution, structural: bool) -> BiasSpread:
    """The result, with the biases of the widest spread, at which each is nearly free."""
    problem, count = free.problem, len(free.problem.trials)
    k = len(problem.initial) + problem.biases.index(_INPUT)
    places = [problem.own(i).start + k for i in range(count)]
    bias, matrix = free.q[places], covariance_of(free).matrix[np.ix_(places, places)]
    matrix = np.where(np.isfinite(matrix), matrix, 0.0)
    names = [data.trial.name for data in problem.trials]
    alone = {n: (float(b), float(s)) for n, b, s in zip(names, bias, np.sqrt(np.diag(matrix)))}
    return BiasSpread(value, _interval(share), alone, probability_of_common(bias, matrix), structural)


def _edges() -> np.ndarray:
    """Logarithms of the spreads between which each that is tried stands for all."""
    logs = np.log(_SPREADS)
    return np.concatenate([[logs[0]], 0.5 * (logs[1:] + logs[:-1]), [logs[-1]]])


def _interval(share: np.ndarray) -> tuple[float, float]:
    """Between which spreads 95 % of the probability lies."""
    below = np.concatenate([[0.0], np.cumsum(share)])
    low, high = np.interp([0.025, 0.975], below, _edges())
    return float(np.exp(low)), float(np.exp(high))
