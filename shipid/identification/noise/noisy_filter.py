"""The filter through which a record is likely or not: its signals measured, noise on every state that has a rate of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from shipid.declaration.scale import Scale
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.generation.reduction import reduced
from shipid.identification.noise.gusts import rate_of, state_of, with_gusts
from shipid.identification.problem.output_error import Problem
from shipid.identification.problem.trial_data import TrialData

#: First standard deviation of a gust, in what is expected of it.
_WIDE = 3.0
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


def make_filter(
    problem: Problem, values: Mapping[str, float], unit_time: float, gusts: Sequence[str] = ()
) -> ExtendedKalmanFilter:
    """Return the filter of a problem: its signals measured, noise on every state that has a rate of its own.

    Parameters
    ----------
    problem : Problem
        Model, signals and weights.
    values : mapping of str to float
        Coefficients, SI.
    unit_time : float
        L/U in s, in which a state gathers noise.
    gusts : sequence of str
        Which of these states gusts that last drive, beside the white noise.
    """
    model = reduced(problem.model, problem.signals)
    sensors = {s: (float(w) * _SENSOR_SHARE, model[s].unit) for s, w in zip(problem.signals, problem.sigma)}
    noise = _first_noise(problem, model.states, unit_time)
    first: dict[str, tuple[float, str]] = {}
    if gusts:
        model = with_gusts(model, gusts)
        values = {**values, **{rate_of(n): -float(np.log(unit_time)) for n in gusts}}
        for name in gusts:
            # A gust that lasts for one L/U and gathers there as much as the white noise.
            size, unit = noise[name][0] / np.sqrt(unit_time), model[state_of(name)].unit
            noise[state_of(name)] = (size * np.sqrt(2 / unit_time), f"({unit})*1/s^0.5")
            first[state_of(name)] = (_WIDE * size, unit)
    return ExtendedKalmanFilter(
        model, values=values, measured=sensors, noise=noise, initial=first, gate=None, model_noise=False
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
