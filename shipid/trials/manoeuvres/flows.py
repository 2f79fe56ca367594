"""Current and wind that act on a simulated ship: a speed and the direction they flow to."""

from __future__ import annotations

import re
from typing import TypeAlias

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.units import Typed, to_si
from shipid.foundation.errors import UsageError
from shipid.parts.wind import Wind

#: A current, a wind or waves: ``"3 kn to 30 deg"``, or a size and the direction they flow TO, each with a unit or in SI.
Flow: TypeAlias = "str | tuple[str | float, str | float]"
#: What is written, and what its size is called, by its unit.
_EXAMPLES = {
    "m/s": ("3 kn to 30 deg", "10 m/s from 270 deg"),
    "rad": ("0.5 deg from 300 deg", "0.5 deg to 120 deg"),
    "m": ("2 m from 300 deg", "2 m to 120 deg"),
}
_SIZES = {"m/s": "speed of", "rad": "heading by", "m": "significant height of"}
_SAID = re.compile(r"\s*(.+?)\s+(to|from)\s+(.+?)\s*")


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


def flow_of(flow: Flow | None, what: str, unit: str = "m/s") -> tuple[float, float] | None:
    """Return what flows as size and direction it flows TO, SI; None for none.

    Parameters
    ----------
    flow : str or tuple, optional
        ``"3 kn to 30 deg"``, ``"10 m/s from 270 deg"``, or size and direction TO.
    what : str
        current, wind or waves: for the message.
    unit : str
        Of its size, SI.

    Raises
    ------
    UsageError
        If a text does not say where it flows.
    """
    if flow is None:
        return None
    turned = 0.0
    if isinstance(flow, str):
        said = _SAID.fullmatch(flow)
        if not said:
            example, more = _EXAMPLES[unit]
            raise UsageError(f"the {what} '{flow}' does not say where it flows: write '{example}' or '{more}'.")
        size, way, direction = said.groups()
        flow, turned = (Typed(size), Typed(direction)), np.pi if way == "from" else 0.0
    size_of = f"{_SIZES[unit]} the {what}"
    return number(flow[0], unit, size_of), number(flow[1], "rad", f"direction of the {what}") + turned


def said_of(flow: Flow, unit: str = "m/s") -> str:
    """Return what flows in words, as it was given; a bare number gets its unit.

    Parameters
    ----------
    flow : str or tuple
        See `flow_of`.
    unit : str
        Of its size, SI.
    """
    if isinstance(flow, str):
        return flow
    size, direction = (f if isinstance(f, str) else f"{f:.4g} {u}" for f, u in zip(flow, (unit, "rad")))
    return f"{size} to {direction}"


def met_words(current: Flow | None, wind: Flow | None, waves: Flow | None, unit_of_waves: str = "rad") -> str:
    """Return what a simulated ship met in words, as ``"; wind 10 m/s from 270 deg"``; empty for nothing.

    Parameters
    ----------
    current, wind, waves : str or tuple, optional
        See `said_of`.
    unit_of_waves : str
        Of the size of the waves, SI.
    """
    all_of_it = (("current", current, "m/s"), ("wind", wind, "m/s"), ("waves", waves, unit_of_waves))
    return "".join(f"; {what} {said_of(flow, unit)}" for what, flow, unit in all_of_it if flow is not None)


def check_flows(model: Model, current: Flow | None, wind: Flow | None) -> None:
    """Raise an error for a current or a wind that does not act on a model.

    Parameters
    ----------
    model : Model
        A ship model.
    current, wind : str or tuple, optional
        What is asked for.

    Raises
    ------
    UsageError
        If the model does not read what the current or the wind states.
    """
    acts = {"current": ("current_north",), "wind": ("r_disturbance", "wind_speed")}
    for (flow, quantities), asked in zip(acts.items(), (current, wind)):
        if asked is not None and not set(quantities) & set(model.inputs):
            quantity = quantities[0]
            raise UsageError(f"model {model.name} reads no '{quantity}', so a {flow} does not act on it: leave it out.")


def parts_in_wind(model: Model, wind: Flow | None) -> tuple[type[Component], ...]:
    """Return the components through which a wind acts on a model; none where the model reads the wind itself.

    Parameters
    ----------
    model : Model
        A ship model.
    wind : str or tuple, optional
        The wind.
    """
    return (Wind,) if wind is not None and "wind_speed" not in model.inputs else ()


def flow_inputs(current: Flow | None, wind: Flow | None) -> dict[str, float]:
    """Return current and wind as inputs of a model, SI.

    Parameters
    ----------
    current, wind : str or tuple, optional
        See `flow_of`.
    """
    inputs: dict[str, float] = {}
    if (flow := flow_of(current, "current")) is not None:
        rate, direction = flow
        inputs |= {"current_north": float(rate * np.cos(direction)), "current_east": float(rate * np.sin(direction))}
    if (flow := flow_of(wind, "wind")) is not None:
        inputs["wind_speed"], inputs["wind_direction"] = flow
    return inputs
