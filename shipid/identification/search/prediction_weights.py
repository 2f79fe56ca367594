"""Weights of the signals: the error of a low-order model, or the residuals of the record, whichever is larger.

In a towing tank the error is that of the model's structure, and in relative terms about the same for every ship. At sea
and on a pond waves, wind and current move the ship as well: a signal they disturb holds less information, and the
prior counts more. The same holds for a signal whose error lasts: a drifting heading counts as few independent samples. Where
residuals do not last they are noise, and the error of a structure does not count: the weights are those of the noise.

A model whose residuals last and are larger than those of a good model of low order is off at the start as well, so that its
initial states may lie as far from what was measured.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.fft import next_fast_len

from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.problem.prior import Prior
from shipid.identification.search.least_squares import minimise_robustly, thinned_to
from shipid.identification.search.solution import Solution, residual_levels

#: Change of a weight below which it has converged, and how often it may change.
_SETTLED = 0.02
_TURNS = 6
#: A model whose residuals are so many times smaller than the error of a low-order model has no such error.
_EXACT = 10.0
#: Share of the time of independence up to which residuals last no longer than noise, and runs that show whether they do.
_WHITE = 0.05
_TRIED = 30
#: Samples in L/U that are enough: residuals last for longer, and a rudder takes longer to be put over.
_ENOUGH = 40


def independent_samples(problem: Problem, unit_time: float) -> Problem:
    """Return the problem on as many samples as add information.

    Parameters
    ----------
    problem : Problem
        On every sample.
    unit_time : float
        L/U in s.
    """
    return thinned_to(problem, [int(_ENOUGH * data.trial.duration / unit_time) + 1 for data in problem.trials])


def weigh_again(solution: Solution, box: Box, least: np.ndarray, independent: float) -> Solution:
    """Return the solution under weights by which each signal counts as many independent samples as its residuals are.

    Parameters
    ----------
    solution : Solution
        Found under any weights.
    box : Box
        Bounds of the parameters.
    least : ndarray, shape (signals,)
        Error that a model of low order has in each signal, SI: it counts as far as residuals last.
    independent : float
        Time in s for which a residual lasts where only the structure of the model is wrong.

    Returns
    -------
    Solution
        The same where its weights hardly change.
    """
    for _ in range(_TURNS):
        own, lasting, structural = _levels(solution, independent)
        floor = np.minimum(least, _EXACT * own) * np.sqrt(structural)
        sigma = np.maximum(floor, own * np.sqrt(lasting))
        if np.abs(np.log(sigma / solution.problem.sigma)).max() < _SETTLED:
            break
        beyond = np.sqrt(np.maximum(own**2 * structural - least**2, 0.0))
        weighed = replace(solution.problem, sigma=sigma, prior=_off_at_the_start(solution.problem, beyond))
        again = minimise_robustly(weighed, solution.q, box, most=100, tolerance=1e-6)
        solution = replace(again, evaluations=solution.evaluations + again.evaluations)
    return solution


def weigh_first(solution: Solution, box: Box, least: np.ndarray, independent: float) -> Solution:
    """Return the solution as `weigh_again` does, from the weights of noise where residuals are noise under them.

    Weights of a wrong structure hold a model to its prior, so that the residuals of a right one may last, too: only the weights of
    noise show whether they do.

    Parameters
    ----------
    solution, box, least, independent
        See `weigh_again`.

    Returns
    -------
    Solution
    """
    found = weigh_again(solution, box, least, independent)
    if not found.finite or not _lasts(found, independent):
        return found
    problem = found.problem
    sigma = np.sqrt(_single(problem, independent)) * _noise_levels(found)
    as_noise = replace(problem, sigma=sigma, prior=_off_at_the_start(problem, np.zeros(sigma.size)))
    other = minimise_robustly(as_noise, found.q, box, most=_TRIED, tolerance=1e-4)
    other = replace(other, evaluations=found.evaluations + other.evaluations)
    if not other.finite or _lasts(other, independent):
        return replace(found, evaluations=other.evaluations)
    return weigh_again(other, box, least, independent)


def lasting_errors(solution: Solution, independent: float) -> np.ndarray:
    """Return the part of each signal's residuals that lasts, SI, shape (signals,): nothing of white noise.

    Parameters
    ----------
    solution : Solution
        At its optimum.
    independent : float
        Time in s for which a residual lasts where only the structure of the model is wrong.
    """
    own, _, structural = _levels(solution, independent)
    return np.asarray(own * np.sqrt(structural))


def _levels(solution: Solution, independent: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Standard deviation of the residuals, how long they last in shares of the time of independence, and the share beyond one sample."""
    single = _single(solution.problem, independent)
    # White noise lasts for one sample.
    lasting = np.maximum(correlation_times(solution) / independent, np.minimum(single, 1.0))
    return residual_levels(solution), lasting, np.clip(lasting - single, 0.0, 1.0)


def _single(problem: Problem, independent: float) -> np.ndarray:
    """How long one sample of each signal lasts, in shares of the time of independence."""
    steps = [[d.step_of(j) for j in range(len(problem.signals))] for d in problem.trials]
    return np.asarray(np.mean(steps, axis=0) / independent)


def _lasts(solution: Solution, independent: float) -> bool:
    """Whether the residuals of a signal last for longer than noise does: the next sample may share it by chance."""
    longest = np.maximum(_WHITE, _single(solution.problem, independent))
    return bool((_levels(solution, independent)[2] > longest).any())


def _noise_levels(solution: Solution) -> np.ndarray:
    """Standard deviation of the part of each signal's residuals that changes from sample to sample, SI, shape (signals,)."""
    own = residual_levels(solution)
    for j in range(own.size):
        steps = [np.diff(r[np.isfinite(r)]) for r in (t[j] for t in solution.problem.by_signal(solution.residual))]
        together = np.concatenate(steps)
        if together.size:
            size = float(np.std(together) / np.sqrt(2)) * solution.problem.sigma[j]
            own[j] = np.clip(size, 1e-3 * own[j], own[j])
    return own


def _off_at_the_start(problem: Problem, beyond: np.ndarray) -> Prior | None:
    """The prior with the lasting error of each signal, as far as it is beyond that of a model of low order.

    The residuals of a model that is wrong last from the first sample on. Held to the measured state at the start, such a
    model misses the record by more and more: its signals lose weight, and the prior holds it to the start even more.
    """
    return problem.prior and replace(problem.prior, lasting=dict(zip(problem.signals, beyond.tolist())))


def correlation_times(solution: Solution) -> np.ndarray:
    """Return the time in s for which a residual of each signal lasts, mean of the trials, shape (signals,).

    It is the sum of the autocorrelation up to its first zero.

    Parameters
    ----------
    solution : Solution
        At its optimum.
    """
    problem = solution.problem
    times = np.zeros((len(problem.trials), len(problem.signals)))
    for i, (data, trial) in enumerate(zip(problem.trials, problem.by_signal(solution.residual))):
        for j, residual in enumerate(trial):
            # A signal with missing samples on its own clock, from sample to sample.
            residual = residual[np.isfinite(residual)]
            count = residual.size
            if count < 2:
                continue
            power = np.abs(np.fft.rfft(residual - residual.mean(), next_fast_len(2 * count))) ** 2
            lags = np.fft.irfft(power)[:count]
            if lags[0] > 0:
                zero = int(np.argmax(lags < 0)) or count
                times[i, j] = (2 * lags[:zero].sum() / lags[0] - 1) * data.step_of(j)
    return np.asarray(times.mean(axis=0))
