"""Where a filter starts: the first estimate of each state, and how sure it is."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from shipid.declaration.model import Entry, Model
from shipid.declaration.scale import prime_factor
from shipid.declaration.units import to_si
from shipid.estimation.errors import NoiseLevelError
from shipid.foundation.errors import UnitError, UnknownNameError
from shipid.parameters.parameter_set import ParameterSet

#: Default standard deviation of a first estimate: a share of a parameter, and of what L and U make of any other unit.
PARAMETER_SHARE, STATE_SHARE = 0.5, 0.1
#: A state that starts from a first sample is so many times less sure than that: one part in a hundred of it counts twice.
VAGUER = 10.0


def walking(model: Model) -> tuple[str, ...]:
    """Return the parameters whose declaration says how they walk: those a filter estimates unless told otherwise.

    Parameters
    ----------
    model : Model
        The model.
    """
    return tuple(n for n in model.parameters if model[n].quantity.noise)


def parameter_starts(
    base: Model,
    names: tuple[str, ...],
    ship: ParameterSet,
    known: Mapping[str, float],
    given: Mapping[str, str | float],
    length: float | None,
    speed: float | None,
    spreads: Collection[str] = (),
) -> dict[str, tuple[float, float]]:
    """Return first value and standard deviation of each estimated parameter, SI.

    Parameters
    ----------
    base : Model
        The model in which they are parameters.
    names : tuple of str
        The estimated ones.
    ship : ParameterSet
        Its values and their standard deviations, where it has them.
    known : mapping of str to float
        The ship's values, SI.
    given : mapping of str to str
        First values that replace them, with units.
    length, speed : float or None
        L in m and U in m/s, for starts declared in the prime system.
    spreads : collection of str
        Parameters whose standard deviation the user gives.

    Raises
    ------
    NoiseLevelError
        If nothing says where a parameter starts, or how sure that is.
    """
    result = {}
    for name in names:
        entry = base[name]
        scale = prime_factor(entry.unit, length, speed) if entry.quantity.prime and length and speed else 1.0
        declared = entry.number("start")
        if name in given:
            value = to_si(given[name], entry.unit, f"start of '{name}'")
        elif name in known:
            value = known[name]
        elif declared is not None:
            value = declared * scale
        else:
            raise NoiseLevelError(f"nothing says where the estimate of '{name}' starts: give start={{'{name}': ...}}.")
        spread = entry.number("spread")
        held = ship.find(base, name)
        if held is not None and held.std is not None and name not in given:
            deviation = abs(to_si((held.std, held.unit), entry.unit, f"standard deviation of '{name}'"))
        elif spread is not None:
            deviation = spread * scale
        else:
            deviation = PARAMETER_SHARE * max(abs(value), abs((declared or 0.0) * scale))
        if not deviation and name not in spreads:
            deviation = _room(entry, scale)
        result[name] = (value, deviation)
    return result


def _room(entry: Entry, scale: float) -> float:
    """How unsure a parameter is that starts at zero, of which a share says nothing: its nominal size, or its bounds."""
    nominal, low, high = (entry.number(n) for n in ("nominal", "low", "high"))
    if nominal:
        return abs(nominal) * scale
    if low is None or high is None:
        # It would never move: what is certain to be zero is not estimated.
        raise NoiseLevelError(
            f"the estimate of '{entry.name}' starts at zero, and nothing says how sure that is: give "
            f"initial={{'{entry.name}': ...}}, its first standard deviation."
        )
    return (high - low) / 4 * scale


def state_spreads(model: Model, length: float | None, speed: float | None, sensors: Mapping[str, float]) -> np.ndarray:
    """Return the default standard deviation of each first state, SI, shape (states,).

    Parameters
    ----------
    model : Model
        The model.
    length, speed : float or None
        L in m and U in m/s.
    sensors : mapping of str to float
        Noise of the sensor that shows a state, by state: the first estimate comes from its first sample.
    """
    result = np.empty(len(model.states))
    for i, name in enumerate(model.states):
        spread, nominal = model[name].number("spread"), model[name].number("nominal")
        vaguer = 1.0
        if spread is None:
            # The sample the estimate starts from is taken in as well: a start hardly vaguer than that would count it twice.
            vaguer = VAGUER
            try:
                scaled = STATE_SHARE * prime_factor(model[name].unit, length, speed) if length and speed else None
            except UnitError:
                scaled = None
            spread = scaled if scaled is not None else abs(nominal) if nominal else 1.0
        result[i] = np.hypot(spread, vaguer * sensors.get(name, 0.0))
    return result


def read_deviations(model: Model, given: Mapping[str, str | float], estimated: Mapping[str, str]) -> dict[str, float]:
    """Read standard deviations of first estimates given by the user, SI, by state or parameter.

    Parameters
    ----------
    model : Model
        The model.
    given : mapping of str to str
        By state or estimated parameter, with units.
    estimated : mapping of str to str
        The state of each estimated parameter.

    Raises
    ------
    UnknownNameError
        If a name is no state and no estimated parameter.
    NoiseLevelError
        If one is zero or negative.
    """
    result = {}
    for name, value in given.items():
        if name not in model.states and name not in estimated:
            raise UnknownNameError(f"state of model {model.name} called", name, [*model.states, *estimated])
        level = to_si(value, model[name].unit, f"first standard deviation of '{name}'")
        if not level > 0:
            raise NoiseLevelError(
                f"the first standard deviation of '{name}' is {value}; it is greater than zero. What is known exactly "
                "belongs among the ship's values."
            )
        result[name] = level
    return result


def bounds_of(
    base: Model, model: Model, estimated: Mapping[str, str], length: float | None, speed: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of the states, SI, shapes (states,): an estimated parameter keeps those it was declared with.

    Parameters
    ----------
    base, model : Model
        Without and with the estimated parameters as states.
    estimated : mapping of str to str
        The state of each estimated parameter; a logarithm needs no bounds.
    length, speed : float or None
        L in m and U in m/s, for bounds declared in the prime system.
    """
    low, high = np.full(len(model.states), -np.inf), np.full(len(model.states), np.inf)
    for name, state in estimated.items():
        if state != name:
            continue
        entry, i = base[name], model.states.index(state)
        scale = prime_factor(entry.unit, length, speed) if entry.quantity.prime and length and speed else 1.0
        least, most = entry.number("low"), entry.number("high")
        low[i] = -np.inf if least is None else least * scale
        high[i] = np.inf if most is None else most * scale
    return low, high
