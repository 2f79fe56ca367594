"""What is stated of a simulated ship beside her helm: values of her own, inputs that are held, and waves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.autopilot.course_changes.weather import Weather, standard_weather
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.trials.manoeuvres.flows import Flow, flow_of, number
from shipid.trials.manoeuvres.sea import driven_by


def stated_inputs(model: Model, inputs: Mapping[str, str | float] | None) -> dict[str, float]:
    """Return constant inputs of a model, SI.

    Parameters
    ----------
    model : Model
        The model.
    inputs : mapping of str to str or float, optional
        With units or in SI.

    Raises
    ------
    UsageError
        If the model reads no such input.
    """
    found = {}
    for name, value in (inputs or {}).items():
        if name not in model.inputs:
            raise UsageError(f"model {model.name} reads no input '{name}'; it reads {', '.join(model.inputs)}.")
        found[name] = (
            to_si(value, model[name].given_unit, f"input '{name}'") if isinstance(value, str) else float(value)
        )
    return found


def stated_values(model: Model, values: Mapping[str, str | float] | None) -> dict[str, float]:
    """Return values of the ship that go before those of her set, SI.

    Parameters
    ----------
    model : Model
        What is sailed.
    values : mapping of str to str or float, optional
        With units or in SI.

    Raises
    ------
    UnknownNameError
        If a value is none of the model's coefficients.
    """
    lost = [n for n in values or {} if n not in (*model.parameters, *model.constants)]
    if lost:
        raise UnknownNameError(f"coefficient of model {model.name} called", lost[0], model.parameters)
    return {n: number(v, model[n].unit, f"'{n}'") for n, v in (values or {}).items()}


def with_waves(
    model: Model,
    waves: Flow,
    known: dict[str, float],
    acting: dict[str, float | np.ndarray],
    length: float,
    speed: float,
    step: float,
    count: int,
    seed: int,
) -> tuple[dict[str, float], dict[str, float | np.ndarray]]:
    """Return coefficients and inputs with waves of a size, at the frequency of the standard weather.

    Parameters
    ----------
    model : Model
        What is sailed.
    waves : str or tuple
        Root mean square of the heading by waves, or of waves that move the model their significant height; and the direction they
        run TO, with units or in SI.
    known : dict of str to float
        Coefficients, SI.
    acting : dict of str to float or ndarray
        Inputs, SI.
    length, speed : float
        Of the ship, in m and m/s.
    step : float
        Time between two values of the noise that drives the waves, in s.
    count : int
        How many there are.
    seed : int
        Of the noise.

    Returns
    -------
    known, acting : dict
        The noise among the inputs is an array, shape (count,).
    """
    driven, unit, share = driven_by(model)
    size, direction = flow_of(waves, "waves", unit) or (0.0, 0.0)
    damping = float(known.get("wave_damping", Weather.damping))
    sea = replace(standard_weather(length, speed), wave_heading=share * size, damping=damping)
    known = known | {"wave_frequency": sea.wave_frequency, "wave_damping": damping}
    noise = sea.noise(count, np.array([step]), seed)[:, 0]
    return known, acting | {driven: noise, "wave_direction": direction}
