"""Prediction error: coefficients, process noise and sensor noise from the likelihood through the filter.

Output error treats all residuals as sensor noise. Where wind, waves or effects that the model does not describe
drive the states themselves, the likelihood of every sample given those before it is the right measure: it comes from the Kalman
filter. Its exact gradient and expected information come with it (`shipid.estimation.records.likelihood`), and the
search is Newton's with that information, in a trust region (Fisher scoring).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from shipid.declaration.scale import Scale
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.records.likelihood import Likelihood
from shipid.generation.reduction import reduced
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.problem.trial_data import TrialData
from shipid.identification.search.noise_levels import NoiseLevels
from shipid.identification.search.unseen import covariance_by

#: Prior standard deviation of the logarithm of a noise level: a level without information stays finite.
_LEVEL_PRIOR = 3.0
#: Share of output error's residuals from which sensor noise and the noise of a state start.
_SENSOR_SHARE = 0.3


def record_of(data: TrialData, model_inputs: tuple[str, ...], signals: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Return a trial as columns for a filter, SI.

    Parameters
    ----------
    data : TrialData
        The trial as the model reads it.
    model_inputs, signals : tuple of str
        Names along its inputs and measured signals.
    """
    # A fitted signal replaces an input of the same name: a speed that is both is measured.
    return {"t": data.t} | dict(zip(model_inputs, data.inputs)) | dict(zip(signals, data.measured))


def make_filter(problem: Problem, values: Mapping[str, float], unit_time: float) -> ExtendedKalmanFilter:
    """Return the filter of a problem: its signals measured, white noise on every state that has a rate of its own.

    Parameters
    ----------
    problem : Problem
        Model, signals and weights.
    values : mapping of str to float
        Coefficients, SI.
    unit_time : float
        L/U in s, in which a state gathers noise.
    """
    model = reduced(problem.model, problem.signals)
    sensors = {s: (float(w) * _SENSOR_SHARE, model[s].unit) for s, w in zip(problem.signals, problem.sigma)}
    return ExtendedKalmanFilter(
        model,
        values=values,
        measured=sensors,
        noise=_first_noise(problem, model.states, unit_time),
        gate=None,
        model_noise=False,
    )


def _first_noise(problem: Problem, states: tuple[str, ...], time: float) -> dict[str, tuple[float, str]]:
    """Noise on the states that are no mere integral of another: a share of the residuals, gathered in one L/U."""
    own = [s for s in states if s not in ("x", "y", "psi")] or list(states)
    speed = abs(problem.trials[0].speed)
    levels = {}
    for name in own:
        unit = problem.model[name].unit
        at = problem.signals.index(name) if name in problem.signals else None
        size = float(problem.sigma[at]) if at is not None else 0.05 * Scale(speed * time, speed).factor(unit)
        levels[name] = (size / np.sqrt(time), f"({unit})*1/s^0.5" if unit != "1" else "1/s^0.5")
    return levels


def fit_levels(
    problem: Problem, box: Box, start: np.ndarray, unit_time: float, tell: Callable[[str], None] = lambda _: None
) -> NoiseLevels:
    """Maximise the likelihood over coefficients, biases and noise levels.

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
    shared, trials = len(problem.estimated), len(problem.trials)
    kalman = make_filter(problem, {**problem.fixed, **dict(zip(problem.estimated, start))}, unit_time)
    process = [s.name for s in kalman.design.sources]
    level_names = [f"noise:{n}" for n in process] + [f"sensor:{n}" for n in problem.signals]
    unknowns = [*problem.estimated, *level_names, *(f"bias:{n}" for n in problem.biases)]
    inputs = kalman.model.inputs
    likelihoods = [
        kalman.likelihood(record_of(data, inputs, problem.signals), unknowns, filled=True) for data in problem.trials
    ]
    q0 = np.concatenate([start, likelihoods[0].start[shared : shared + len(level_names)]])
    objective = _Objective(problem, box, likelihoods, q0, len(problem.biases))
    found = _newton(objective, np.concatenate([q0, np.zeros(trials * len(problem.biases))]), tell)
    q, information, converged, message, evaluations = found
    value, _, _ = objective(q)
    covariance = covariance_by(information)[:shared, :shared]
    levels = np.exp(q[shared : shared + len(level_names)])
    return NoiseLevels(
        q[:shared],
        q[shared + len(level_names) :].reshape(trials, len(problem.biases)),
        dict(zip(process, levels.tolist())),
        dict(zip(problem.signals, levels[len(process) :].tolist())),
        covariance,
        value,
        converged,
        message,
        evaluations,
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

    def __call__(self, q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        common, size = self.common, q.size
        value, gradient, information = 0.0, np.zeros(size), np.zeros((size, size))
        for i, likelihood in enumerate(self.likelihoods):
            own = np.arange(common + i * self.biases, common + (i + 1) * self.biases)
            at = np.concatenate([np.arange(common), own])
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
    damping, evaluations = 1e-3, 1
    if not np.isfinite(value):
        return q, information, False, "the filter diverges at the estimate of output error.", evaluations
    while evaluations < most:
        scale = np.maximum(np.diag(information), 1e-12)
        # Unknowns at a bound that the gradient pushes further out stay there.
        held = ((q <= low) & (gradient < 0)) | ((q >= high) & (gradient > 0))
        free = np.flatnonzero(~held)
        damped = information[np.ix_(free, free)] + damping * np.diag(scale[free])
        step = np.zeros(q.size)
        step[free] = np.linalg.solve(damped, gradient[free])
        trial = np.clip(q + step, low, high)
        new = objective(trial)
        evaluations += 1
        gain = new[0] - value
        if np.isfinite(new[0]) and gain >= 0:
            q, (value, gradient, information) = trial, new
            damping = max(damping / 5, 1e-9)
            tell(f"prediction error: log-likelihood {value:.6g}")
            # The remaining gain, by the quadratic model, is a small part of one sample's.
            if gain < 1e-6 * max(1.0, abs(value)) and float(gradient[free] @ step[free]) < 1e-2:
                return q, information, True, "the likelihood is at its maximum.", evaluations
        else:
            damping *= 10
            if damping > 1e8:
                small = float(gradient[free] @ step[free]) < 1e-2
                message = "the likelihood is at its maximum." if small else "no step increases the likelihood."
                return q, information, small, message, evaluations
    return q, information, False, f"not at its maximum after {most} passes.", evaluations
