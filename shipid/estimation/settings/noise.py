"""Noise levels in physical units: of sensors, and of what drives the states.

A level in the unit of the quantity itself is the standard deviation of one sample. A level per root second (``"0.01
deg/s/s^0.5"`` on a rate of turn) is the density of white noise that drives a state: over an interval T it adds the variance
``level**2 T``. An input counts the other way round: its white noise has the intensity ``level * s^0.5``, and a sample of it
the variance ``level**2 / T``.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale, prime_exponents
from shipid.declaration.units import to_si, unit
from shipid.estimation.errors import NoiseLevelError, NotMeasurableError
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.errors import UnitError, UnknownNameError
from shipid.generation.linearisation import COORDINATES
from shipid.parts.sensors import LARGEST_LEVEL, SMALLEST_LEVEL

#: Default density of the noise that drives a state, in the prime system: about the error of a model of low order.
MODEL_NOISE = 0.005


@dataclass(frozen=True)
class NoiseSource:
    """White noise that enters a model.

    Attributes
    ----------
    name : str
        The state or the input it enters.
    level : float
        SI: of one sample, or a density.
    place : {"state", "input"}
        What it is added to.
    density : bool
        Whether the level is per root second (for an input: times root second).
    assumed : bool
        Whether it is the toolbox's default.
    """

    name: str
    level: float
    place: Literal["state", "input"]
    density: bool
    assumed: bool = False


#: The smallest noise of process that is taken, SI: its square is still a number.
_SMALLEST = 1e-100


def sensor_levels(model: Model, measured: Mapping[str, Amount | None]) -> dict[str, float]:
    """Return the standard deviation of one sample of each sensor, SI.

    Parameters
    ----------
    model : Model
        The model.
    measured : mapping of str to str or None
        States, derived quantities or outputs, each with a level such as ``"0.2 deg"``; None takes the level that a declared
        output states.

    Raises
    ------
    NotMeasurableError
        If the model does not have the quantity, or it is no such quantity.
    NoiseLevelError
        If a level is missing, zero, negative, or none of a sensor.
    UnitError
        If its unit does not fit.
    """
    if not measured:
        raise NotMeasurableError("a filter needs at least one measured quantity, as in measured={'psi': '0.2 deg'}.")
    levels = {}
    for name, value in measured.items():
        known = [*model.states, *model.derived, *model.outputs]
        if name not in known:
            role = f" It is {model[name].quantity.kind} there." if name in model else ""
            error = UnknownNameError(f"quantity of model {model.name} to measure called", name, known)
            raise NotMeasurableError(f"{error}{role}")
        given = model[name].quantity.noise if value is None else value
        if given is None:
            raise NoiseLevelError(
                f"the sensor of '{name}' has no noise level. Give the standard deviation of one sample, as in "
                f"{name}={_example(model[name].given_unit)}."
            )
        levels[name] = _positive(given, (model[name].given_unit,), f"noise of the sensor of '{name}'", SMALLEST_LEVEL)[
            0
        ]
        if levels[name] > LARGEST_LEVEL:
            raise NoiseLevelError(
                f"the noise of the sensor of '{name}' is {given}, larger than any sensor's. Leave the sensor out, or give the standard "
                "deviation of one sample."
            )
    return levels


def _example(own: str) -> str:
    return f"'0.2 {own.replace('rad', 'deg')}'" if own != "1" else "'0.01'"


def _positive(value: Amount, units: Sequence[str], what: str, least: float = _SMALLEST) -> tuple[float, int]:
    """Read a positive level in one of several units; return it in SI, and which unit it was."""
    refused: UnitError | None = None
    for i, wanted in enumerate(units):
        try:
            level = to_si(value, wanted, what)
        except UnitError as error:
            refused = refused or error
            continue
        if not level > 0:
            raise NoiseLevelError(
                f"the {what} is {value}; a noise level must be greater than zero. For a quantity that is known exactly, "
                "leave the noise out."
            )
        if level < least:
            raise NoiseLevelError(
                f"the {what} is {value}, smaller than anything that is measured or computed. Give the standard deviation of "
                "one sample of a real sensor, or the noise of a real disturbance."
            )
        return level, i
    assert refused is not None
    if len(units) == 1:
        raise refused
    choices = " or ".join(f"{u.replace('**', '^')} ({w})" for u, w in zip(units, ("for one sample", "a density")))
    raise type(refused)(f"{refused} A noise level here is in {choices}.")


def declared_noise(base: Model, model: Model, estimated: Collection[str]) -> dict[str, Amount]:
    """Return the noise that a model declares on its states and inputs, and on the parameters that are estimated.

    Parameters
    ----------
    base, model : Model
        Without and with the estimated parameters as states.
    estimated : collection of str
        The estimated parameters.
    """
    entries = [e for e in model.entries.values() if e.quantity.kind in ("state", "given")]
    return {e.name: e.quantity.noise for e in (*entries, *(base[n] for n in estimated)) if e.quantity.noise}


def process_sources(
    model: Model,
    noise: Mapping[str, Amount],
    estimated: Mapping[str, str],
    sizes: Mapping[str, float],
    scale: Scale,
    model_noise: bool = True,
    lost: Mapping[str, float] | None = None,
) -> tuple[NoiseSource, ...]:
    """Return what drives the states: the levels given, and the default for moving states that have none.

    Parameters
    ----------
    model : Model
        With the estimated parameters as states.
    noise : mapping of str to str
        By state, input or estimated parameter.
    estimated : mapping of str to str
        The state that stands for each estimated parameter.
    sizes : mapping of str to float
        Value of each parameter that is estimated by its logarithm: its noise is taken as a share of it.
    scale : Scale
        L and U, for the default.
    model_noise : bool
        Whether states that have a rate, and are no parameter and no position or heading, get the default.
    lost : mapping of str to float, optional
        Standard deviation of inputs while they are missing, SI: a noise of its own where the input has none.

    Raises
    ------
    UnknownNameError
        If a name is no state, input or estimated parameter.
    NoiseLevelError
        If a level is zero or negative.
    UnitError
        If its unit fits neither a sample nor a density.
    """
    found: list[NoiseSource] = []
    for name, value in noise.items():
        state = estimated.get(name, name)
        if state in model.states:
            share = sizes.get(name)
            own = model[name].unit if share is not None else model[state].unit
            level, dense = _positive(value, (own, times(own, "1/s^0.5")), f"noise of '{name}'")
            found.append(NoiseSource(state, level / abs(share or 1.0), "state", bool(dense)))
        elif name in model.inputs:
            own = model[name].unit
            level, dense = _positive(value, (own, times(own, "s^0.5")), f"noise of '{name}'")
            found.append(NoiseSource(name, level, "input", bool(dense)))
        else:
            raise UnknownNameError(
                f"state, input or estimated parameter of model {model.name} to put noise on called",
                name,
                [*model.states, *model.inputs, *estimated],
            )
    if model_noise and scale.known:
        driven = {s.name for s in found} | set(estimated.values()) | set(COORDINATES)
        for name in model.states:
            if name not in driven and _walks(model, name):
                density = times(model[name].unit, "1/s^0.5")
                found.append(NoiseSource(name, MODEL_NOISE * scale.factor(density), "state", True, True))
    driven = {s.name for s in found}
    found += [NoiseSource(n, v, "input", False) for n, v in (lost or {}).items() if n not in driven]
    return tuple(found)


def _walks(model: Model, name: str) -> bool:
    """Whether a state has a rate, and a unit that L and U scale."""
    equation = model[name].equation
    try:
        prime_exponents(model[name].unit)
    except UnitError:
        return False
    return equation is not None and equation.kind == "rate"


def times(first: str, second: str) -> str:
    """Return the product of two units, as it is written.

    Parameters
    ----------
    first, second : str
        The units.
    """
    return f"{unit(first) * unit(second):~C}"
