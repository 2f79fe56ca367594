"""Prediction error: coefficients, process noise and sensor noise from the likelihood through the filter.

Output error treats all residuals as sensor noise. Where wind, waves or effects that the model does not describe
drive the states themselves, the likelihood of every sample given those before it is the right measure: it comes from the Kalman
filter. Its exact gradient and expected information come with it (`shipid.estimation.records.likelihood`), and the
search is Newton's with that information (Fisher scoring), damped as in Madsen, Nielsen and Tingleff (2004), section 3.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import expit

from shipid.estimation.records.likelihood import Likelihood
from shipid.foundation.numbers import brief
from shipid.identification.noise.gusts import Gust, rate_of, state_of
from shipid.identification.noise.innovations import Stretch, scatter_of, whiteness
from shipid.identification.noise.noisy_filter import make_filter, record_of
from shipid.identification.noise.small_sample import MANY, small_sample
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.search.noise_levels import NoiseLevels, mean_over
from shipid.identification.search.unseen import covariance_by

#: Prior standard deviation of the logarithm of a noise level: a level without information stays finite.
_LEVEL_PRIOR = 3.0
#: Shortest correlation time of a gust, in L/U: what is shorter moves a ship as white noise does.
_LASTING = 0.1
#: Loss of log-likelihood from which gusts are out of the question, and the probability from which the other noise is.
_HOPELESS, _CERTAIN = 4.0, 0.99
#: Information, as a share of what two directions have alone, that is rounding.
_NOTHING = 1e-10
#: Smallest ratio of variances in one step: near none, residuals do not tell how small it is.
_SMALLER = 0.03


def fit_levels(
    problem: Problem, box: Box, start: np.ndarray, unit_time: float, tell: Callable[[str], None] = lambda _: None
) -> NoiseLevels:
    """Maximise the likelihood over coefficients, biases and noise levels.

    Noise that drives the states is white, or gusts that last, on those states on which they do last: the likelier of the two, by
    the evidence for each (Laplace's approximation). Where neither is out of the question the covariance is the mean over both.

    Parameters
    ----------
    problem : Problem
        Its `sigma` are the residuals of output error, from which the levels start.
    box : Box
        Bounds of the coefficients.
    start : ndarray, shape (parameters,)
        Where they start: at output error's.
    unit_time : float
        L/U in s.
    tell : callable
        Called with a line of text as it goes.

    Returns
    -------
    NoiseLevels
    """
    white = _Search(problem, box, start, unit_time)
    plain = white.climbed(white.first, tell)
    spent, driven = plain.evaluations, white.driving(plain)
    while driven:
        gusty = _Search(problem, box, start, unit_time, gusts=driven)
        begin = gusty.from_white(white, plain.q)
        value, gradient, information = gusty.objective(begin)
        spent += 1
        # What a Newton step promises, before it is worth a search.
        gain = 0.5 * gradient @ np.linalg.lstsq(information, gradient, rcond=1e-12)[0]
        if not value + gain > plain.value - _HOPELESS:
            break
        found = gusty.climbed(begin, tell)
        spent += found.evaluations
        lasting = gusty.lasting(found.q, _LASTING * unit_time)
        if lasting == driven:
            # Two more levels for each gust, each with its prior.
            evidence = gusty.evidence(found) - white.evidence(plain) - 2 * len(driven) * np.log(_LEVEL_PRIOR)
            share = float(expit(evidence))
            first, second = (gusty, found), (white, plain)
            if share < 0.5:
                first, second, share = second, first, 1 - share
            likelier = first[0].result(replace(first[1], evaluations=spent))
            return likelier if share > _CERTAIN else mean_over(likelier, second[0].result(second[1]), share)
        driven = lasting
    return white.result(replace(plain, evaluations=spent))


def levels_at(
    problem: Problem, values: np.ndarray, unit_time: float, tell: Callable[[str], None] = lambda _: None
) -> NoiseLevels:
    """Maximise the likelihood over biases and white noise levels, at given coefficients.

    Parameters
    ----------
    problem : Problem
        As for `fit_levels`.
    values : ndarray, shape (parameters,)
        The coefficients, SI.
    unit_time : float
        L/U in s.
    tell : callable
        Called with a line of text as it goes.

    Returns
    -------
    NoiseLevels
        Its covariance is not that of the coefficients, which were not searched.
    """
    search = _Search(problem, Box(values, values, values), values, unit_time)
    return replace(search.result(search.climbed(search.first, tell)), degrees=None)


@dataclass(frozen=True, eq=False)
class _Found:
    """Where a search for the maximum ended."""

    q: np.ndarray
    value: float
    information: np.ndarray
    converged: bool
    message: str
    evaluations: int


class _Search:
    """The likelihood of all trials through one filter: q = [coefficients, levels, biases of each trial]."""

    def __init__(
        self, problem: Problem, box: Box, start: np.ndarray, unit_time: float, *, gusts: Sequence[str] = ()
    ) -> None:
        self.problem, self.shared = problem, len(problem.estimated)
        values = {**problem.fixed, **dict(zip(problem.estimated, start))}
        kalman = make_filter(problem, values, unit_time, gusts)
        self.process = [s.name for s in kalman.design.sources]
        self.driven = [n for n in self.process if state_of(n) in self.process]
        self.levels = [*(f"noise:{n}" for n in self.process), *(f"sensor:{n}" for n in problem.signals)]
        self.levels += [rate_of(n) for n in self.driven]
        unknowns = [*problem.estimated, *self.levels, *(f"bias:{n}" for n in problem.biases)]
        inputs = kalman.model.inputs
        self.likelihoods = [
            kalman.likelihood(record_of(data, inputs, problem.signals), unknowns, filled=True)
            for data in problem.trials
        ]
        self.common = self.shared + len(self.levels)
        first = np.concatenate([start, self.likelihoods[0].start[self.shared : self.common]])
        self.objective = _Objective(problem, box, self.likelihoods, first, len(problem.biases))
        self.first = np.concatenate([first, np.zeros(len(problem.trials) * len(problem.biases))])

    def at(self, name: str) -> int:
        """Where a level stands."""
        return self.shared + self.levels.index(name)

    def from_white(self, white: _Search, q: np.ndarray) -> np.ndarray:
        """The unknowns that a search without gusts found, with gusts of about the power of its noise."""
        begin = self.first.copy()
        begin[: self.shared] = q[: self.shared]
        begin[self.common :] = q[white.common :]
        for name in white.levels:
            begin[self.at(name)] = q[white.at(name)]
        for name in self.driven:
            level = q[white.at(f"noise:{name}")]
            begin[self.at(f"noise:{state_of(name)}")] = level + begin[self.at(rate_of(name))]
            begin[self.at(f"noise:{name}")] = level - 1.0
        return begin

    def lasting(self, q: np.ndarray, least: float) -> tuple[str, ...]:
        """The states whose gusts last for so many seconds; of one that is next to nothing no time is told."""
        there = [n for n in self.driven if self._there(q, state_of(n))]
        return tuple(n for n in there if np.exp(-q[self.at(rate_of(n))]) >= least)

    def driving(self, found: _Found) -> tuple[str, ...]:
        """The states whose noise is more than next to nothing."""
        return tuple(n for n in self.process if np.isfinite(found.value) and self._there(found.q, n))

    def _there(self, q: np.ndarray, state: str) -> bool:
        return not self.objective.unexpected(q, *self.objective(q)[1:])[self.at(f"noise:{state}")] > 0

    def evidence(self, found: _Found) -> float:
        """Logarithm of the probability of the records, but for a constant and what the priors of the levels are divided by."""
        size = np.sqrt(np.diag(found.information))
        size = np.where(size > 0, size, 1.0)
        # Directions of which the records say nothing have the same volume with every noise.
        seen = np.maximum(np.linalg.eigvalsh(found.information / np.outer(size, size)), _NOTHING)
        return found.value - float(np.log(size).sum() + 0.5 * np.log(seen).sum())

    def climbed(self, q: np.ndarray, tell: Callable[[str], None]) -> _Found:
        """The maximum from a start."""
        q, information, converged, message, evaluations = _newton(self.objective, q, tell)
        return _Found(q, self.objective(q)[0], information, converged, message, evaluations)

    def result(self, found: _Found) -> NoiseLevels:
        """Levels, covariance and whiteness at the maximum."""
        q, problem, shared = found.q, self.problem, self.shared
        if not np.isfinite(found.value):
            covariance = np.full((shared, shared), 0.0) + np.diag(np.full(shared, np.inf))
            return self._named(found, q, covariance, np.full(shared, MANY), {})
        driving = np.array([self.at(n) for n in self.levels if not n.startswith("sensor:")])
        small = small_sample(lambda p: self.objective(p)[1:], q, driving)
        stretches = self._innovations(small.q)
        inverse = covariance_by(small.information)
        known = np.isfinite(np.diag(inverse))
        tests = {s: whiteness(stretches, k).p_value for k, s in enumerate(problem.signals)}
        scatter = scatter_of(stretches, small.information, np.where(np.outer(known, known), inverse, 0.0))
        covariance = covariance_by(small.information, scatter) + small.added
        return self._named(found, small.q, covariance[:shared, :shared], small.degrees[:shared], tests)

    def _innovations(self, q: np.ndarray) -> list[Stretch]:
        """Innovations of all trials, their slopes by all unknowns."""
        stretches = []
        for i, likelihood in enumerate(self.likelihoods):
            at = self.objective.places(i)
            for series, slopes in likelihood.innovations(q[at]):
                whole = np.zeros((*series.shape, q.size))
                whole[:, :, at] = slopes
                stretches.append((series, whole))
        return stretches

    def _named(
        self, found: _Found, q: np.ndarray, covariance: np.ndarray, degrees: np.ndarray, tests: dict[str, float]
    ) -> NoiseLevels:
        problem = self.problem
        level = {n: float(np.exp(q[self.at(n)])) for n in self.levels}
        gusts = {}
        for name in self.driven:
            time = 1 / level[rate_of(name)]
            gusts[name] = Gust(level[f"noise:{state_of(name)}"] * np.sqrt(time / 2), time)
        return NoiseLevels(
            found.q[: self.shared],
            found.q[self.common :].reshape(len(problem.trials), len(problem.biases)),
            {n: level[f"noise:{n}"] for n in self.process if n not in map(state_of, self.driven)},
            {n: level[f"sensor:{n}"] for n in problem.signals},
            covariance,
            found.value,
            found.converged,
            found.message,
            found.evaluations,
            gusts,
            degrees,
            tests,
        )


class _Objective:
    """Log-likelihood of all trials plus the prior, with gradient and information."""

    def __init__(
        self, problem: Problem, box: Box, likelihoods: list[Likelihood], first: np.ndarray, biases: int
    ) -> None:
        self.likelihoods, self.common, self.biases = likelihoods, first.size, biases
        self.box, self.first, self.shared = box, first, len(problem.estimated)
        prior = problem.prior
        reach = np.deg2rad(2.0)
        self.spreads = [
            (prior.mean_biases.get(n) or prior.own.get(n) or reach) if prior is not None else reach
            for n in problem.biases
        ]

        self.levels = slice(self.shared, self.common)

    def unexpected(self, q: np.ndarray, gradient: np.ndarray, information: np.ndarray) -> np.ndarray:
        """What curves the likelihood more than is expected, unknown by unknown: a level that is next to nothing.

        There it falls with the variance, so that its second derivative by the logarithm is twice the first, while the expected one goes
        with the square of the variance: steps with that alone jump to and fro across the maximum with the prior.
        """
        more, prior = np.zeros(q.size), 1 / _LEVEL_PRIOR**2
        slope = gradient[self.levels] + prior * (q[self.levels] - self.first[self.levels])
        more[self.levels] = np.maximum(-2 * slope - (np.diag(information)[self.levels] - prior), 0.0)
        return more

    def places(self, index: int) -> np.ndarray:
        """Where the unknowns of one trial stand."""
        own = self.common + index * self.biases
        return np.concatenate([np.arange(self.common), np.arange(own, own + self.biases)])

    def __call__(self, q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        common, size = self.common, q.size
        value, gradient, information = 0.0, np.zeros(size), np.zeros((size, size))
        for i, likelihood in enumerate(self.likelihoods):
            at = self.places(i)
            own = at[common:]
            v, g, h = likelihood(q[at])
            value += v
            gradient[at] += g
            information[np.ix_(at, at)] += h
            for k, spread in zip(own.tolist(), self.spreads):
                value -= 0.5 * (q[k] / spread) ** 2
                gradient[k] -= q[k] / spread**2
                information[k, k] += 1 / spread**2
        for k in range(self.shared, common):
            away = q[k] - self.first[k]
            value -= 0.5 * (away / _LEVEL_PRIOR) ** 2
            gradient[k] -= away / _LEVEL_PRIOR**2
            information[k, k] += 1 / _LEVEL_PRIOR**2
        return value, gradient, information


def _newton(
    objective: _Objective, q: np.ndarray, tell: Callable[[str], None], most: int = 60
) -> tuple[np.ndarray, np.ndarray, bool, str, int]:
    """Fisher scoring with Levenberg's damping, within the bounds of the coefficients."""
    low, high = np.full(q.size, -np.inf), np.full(q.size, np.inf)
    low[: objective.shared], high[: objective.shared] = objective.box.low, objective.box.high
    value, gradient, information = objective(q)
    damping, harder, evaluations = 1e-3, 4.0, 1
    if not np.isfinite(value):
        return q, information, False, "the filter diverges at the estimate of output error.", evaluations
    while evaluations < most:
        curved = information + np.diag(objective.unexpected(q, gradient, information))
        scale = np.maximum(np.diag(curved), 1e-12)
        # Unknowns at a bound that the gradient pushes further out stay there.
        held = ((q <= low) & (gradient < 0)) | ((q >= high) & (gradient > 0))
        free = np.flatnonzero(~held)
        damped = curved[np.ix_(free, free)] + damping * np.diag(scale[free])
        step = np.zeros(q.size)
        step[free] = np.linalg.solve(damped, gradient[free])
        promised = float(gradient[free] @ step[free])
        step[objective.levels] = _in_variance(step[objective.levels])
        trial = np.clip(q + step, low, high)
        new = objective(trial)
        evaluations += 1
        gain = new[0] - value
        if np.isfinite(new[0]) and gain >= 0:
            q, (value, gradient, information) = trial, new
            # The more of what was promised comes, the less is damped.
            kept = 2 * gain / max(promised, 1e-300)
            damping, harder = max(damping * min(max(0.2, 1 - (2 * kept - 1) ** 3), 3.0), 1e-6), 4.0
            tell(f"prediction error: log-likelihood {brief(value, 6)}")
            # The remaining gain, by the quadratic model, is a small part of one sample's.
            if gain < 1e-6 * max(1.0, abs(value)) and promised < 1e-2:
                return q, information, True, "the likelihood is at its maximum.", evaluations
        else:
            damping, harder = damping * harder, 2 * harder
            if damping > 1e8:
                small = promised < 1e-2
                message = "the likelihood is at its maximum." if small else "no step increases the likelihood."
                return q, information, small, message, evaluations
    return q, information, False, f"not at its maximum after {most} passes.", evaluations


def _in_variance(step: np.ndarray) -> np.ndarray:
    """Steps of logarithms of standard deviations, made in the variance, in which a likelihood asks for them.

    Squares of residuals tell how many times too small or too large a variance is: 1 + 2 s for a step s. Along the logarithm, that of a
    variance a hundred times too small would go twenty times too far, and that of one a hundred times too large a fifth of the way.
    """
    return np.asarray(0.5 * np.log(np.maximum(1 + 2 * step, _SMALLER)))
