"""Current and wind that act on a simulated ship: a speed and the direction they flow to."""

from __future__ import annotations

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.foundation.errors import UsageError

#: Speed and direction of a current or a wind, each with a unit or in SI.
Flow = tuple["str | float", "str | float"]


def number(value: str | float, unit: str, what: str) -> float:
    """Return a number in SI.

    Parameters
    ----------
    value : str or float
        With a unit, or in SI.
    unit : str
        The unit inside.
    what : str
        What it is, for the message.
    """
    return to_si(value, unit, what) if isinstance(value, str) else float(value)


def check_flows(model: Model, current: Flow | None, wind: Flow | None) -> None:
    """Raise an error for a current or a wind that does not act on a model.

    Parameters
    ----------
    model : Model
        A ship model.
    current, wind : tuple, optional
        What is asked for.

    Raises
    ------
    UsageError
        If the model does not read what the current or the wind states.
    """
    for flow, asked, quantity in (("current", current, "current_north"), ("wind", wind, "r_disturbance")):
        if asked is not None and quantity not in model.inputs:
            raise UsageError(f"model {model.name} reads no '{quantity}', so a {flow} does not act on it: leave it out.")


def flow_inputs(current: Flow | None, wind: Flow | None) -> dict[str, float]:
    """Return current and wind as inputs of a model, SI.

    Parameters
    ----------
    current, wind : tuple, optional
        Speed and direction.
    """
    inputs: dict[str, float] = {}
    if current is not None:
        rate, direction = (
            number(current[0], "m/s", "the current"),
            number(current[1], "rad", "direction of the current"),
        )
        inputs |= {"current_north": float(rate * np.cos(direction)), "current_east": float(rate * np.sin(direction))}
    if wind is not None:
        inputs["wind_speed"] = number(wind[0], "m/s", "the wind")
        inputs["wind_direction"] = number(wind[1], "rad", "direction of the wind")
    return inputs
