"""Current and wind that act on a simulated ship: a speed and the direction they flow to."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TypeAlias

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.units import Typed, to_si
from shipid.declaration.vocabulary import FIELDS, angle
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief
from shipid.parameters.held_inputs import held_inputs
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
#: No current and no wind is faster, m/s.
_MOST = {"current": 15.0, "wind": 150.0}
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
        If a text does not say where it flows, or its size is below zero or that of no current and no wind.
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
    found = number(flow[0], unit, size_of)
    most = _MOST.get(what, np.inf) if unit == "m/s" else np.inf
    if not 0 <= found <= most:
        raise UsageError(
            f"the {size_of} is {flow[0]}: it is a size, not below zero"
            + (f", nor above {most:g} m/s, which no {what} reaches" if np.isfinite(most) else "")
            + ". Turn the direction over instead of the sign."
        )
    return found, number(flow[1], "rad", f"direction of the {what}") + turned


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
    size, direction = flow
    size = size if isinstance(size, str) else f"{brief(size, 4)} {unit}"
    return f"{size} to {direction if isinstance(direction, str) else angle(direction)}"


def met_words(
    current: Flow | None,
    wind: Flow | None,
    waves: Flow | None,
    unit_of_waves: str = "rad",
    values: Mapping[str, str | float] | None = None,
) -> str:
    """Return what a simulated ship met in words, as ``"; wind 10 m/s from 270 deg"``; empty for nothing.

    Parameters
    ----------
    current, wind, waves : str or tuple, optional
        See `said_of`.
    unit_of_waves : str
        Of the size of the waves, SI.
    values : mapping of str to str or float, optional
        Values of the ship that were replaced.
    """
    replaced = "".join(f"; {n} {value}" for n, value in (values or {}).items())
    all_of_it = (("current", current, "m/s"), ("wind", wind, "m/s"), ("waves", waves, unit_of_waves))
    return replaced + "".join(f"; {what} {said_of(flow, unit)}" for what, flow, unit in all_of_it if flow is not None)


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


def logged_beside(
    model: Model, wind: Flow | None, values: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, str]]:
    """Return what the log of a simulated ship has besides her sensors: the wind, as an anemometer shows it, and the held inputs.

    The wind is logged as well where the model does not read it: whoever reads the log has to know what she met.

    Parameters
    ----------
    model : Model
        The ship model.
    wind : str or tuple, optional
        See `flow_of`.
    values : mapping of str to float
        Inputs that are held, and the ship's values of the constants that hold them, SI.

    Returns
    -------
    columns : dict of str to float
        SI.
    units : dict of str to str
        Of those columns that are not in the vocabulary.
    """
    known = {n: model[n].number("default") for n in held_inputs(model).values()} | dict(values)
    told = {n: known[c] for n, c in held_inputs(model).items()} | {n: known[n] for n in model.inputs if n in known}
    if (flow := flow_of(wind, "wind")) is not None:
        told |= {"wind_speed": flow[0], "wind_direction": flow[1] % (2 * np.pi)}
    columns = {n: float(value) for n, value in told.items() if value is not None}
    return columns, {n: model[n].unit for n in columns if n not in FIELDS}
