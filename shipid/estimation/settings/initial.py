"""Where a filter starts: the first estimate of each state, and its standard deviation."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Entry, Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import to_si
from shipid.estimation.errors import NoiseLevelError
from shipid.estimation.settings.instruments import Amount
from shipid.foundation.errors import UnitError, UnknownNameError, UsageError
from shipid.parameters.parameter_set import ParameterSet

#: Default standard deviation of a first estimate: a share of a parameter, and of the scale by L and U of any other quantity.
PARAMETER_SHARE, STATE_SHARE = 0.5, 0.1
#: A state that starts from a first sample has so many times its standard deviation: the sample counts twice by 1 %.
WIDER = 10.0


def drifting(model: Model) -> tuple[str, ...]:
    """Return the parameters that are declared with noise: those a filter estimates unless the user names others.

    Parameters
    ----------
    model : Model
        The model.
    """
    return tuple(n for n in model.parameters if model[n].quantity.noise)


@dataclass(frozen=True)
class FirstEstimates:
    """What is known of states and parameters before the first sample, SI.

    Attributes
    ----------
    states : mapping of str to float
        First estimates of states that the user gave.
    parameters : mapping of str to tuple of float
        First value and standard deviation of each estimated parameter.
    deviations : mapping of str to float
        Standard deviations that the user gave, by state or estimated parameter.
    """

    states: Mapping[str, float]
    parameters: Mapping[str, tuple[float, float]]
    deviations: Mapping[str, float]


def read_states(model: Model, given: Mapping[str, Amount], parameters: Collection[str]) -> dict[str, float]:
    """Return first estimates of states, SI.

    Parameters
    ----------
    model : Model
        The model.
    given : mapping of str to str
        By state, with units.
    parameters : collection of str
        Estimated parameters, for the message.

    Raises
    ------
    UnknownNameError
        If a name is no state.
    """
    for name in given:
        if name not in model.states:
            known = [*model.states, *parameters]
            raise UnknownNameError(f"state of model {model.name} to start called", name, known)
    return {n: to_si(v, model[n].given_unit, f"start of '{n}'") for n, v in given.items()}


def parameter_starts(
    base: Model,
    names: tuple[str, ...],
    ship: ParameterSet,
    known: Mapping[str, float],
    given: Mapping[str, Amount],
    scale: Scale,
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
    scale : Scale
        L and U, for starts declared in the prime system.
    spreads : collection of str
        Parameters whose standard deviation the user gives.

    Raises
    ------
    NoiseLevelError
        If neither start nor standard deviation of a parameter follow from what is given.
    UnknownNameError
        If a name is no parameter of the model.
    """
    result = {}
    for name in names:
        if name not in base.parameters + base.constants:
            raise UnknownNameError(f"parameter in model {base.name} called", name, base.parameters + base.constants)
        entry = base[name]
        declared, factor = scale.start_of(entry), scale.factor_of(entry)
        if name in given:
            value = to_si(given[name], entry.given_unit, f"start of '{name}'")
        elif name in known:
            value = known[name]
        elif declared is not None:
            value = declared
        else:
            raise NoiseLevelError(f"the estimate of '{name}' has no first value: give start={{'{name}': ...}}.")
        spread = entry.number("spread")
        held = ship.find(base, name)
        if held is not None and held.std is not None and name not in given:
            deviation = abs(to_si((held.std, held.unit), entry.unit, f"standard deviation of '{name}'"))
        elif spread is not None and np.isfinite(factor):
            deviation = spread * factor
        else:
            deviation = PARAMETER_SHARE * max(abs(value), abs(declared or 0.0))
        if not deviation and name not in spreads:
            deviation = _usual_size(entry, scale)
        result[name] = (value, deviation)
    return result


def log_scaled(base: Model, starts: Mapping[str, tuple[float, float]], asked: Sequence[str] | None) -> tuple[str, ...]:
    """Return the estimated parameters that are states by their logarithm.

    Parameters
    ----------
    base : Model
        The model in which they are parameters.
    starts : mapping of str to (float, float)
        First value and standard deviation of each estimated one, SI.
    asked : sequence of str, optional
        Those that the user wants so; by default each whose lower bound is zero or more. One that starts at zero has no
        logarithm there, and is a state within its bounds.

    Raises
    ------
    UsageError
        If the first value of one that the user wants so is not greater than zero, or a first value is below its bound of zero.
    """
    positive = tuple(n for n in starts if (low := base[n].number("low")) is not None and low >= 0)
    for name in positive if asked is None else asked:
        value = starts[name][0] if name in starts else 1.0
        if value < 0 or (value == 0 and asked is not None):
            raise UsageError(
                f"the first value of '{name}' is {value:g} {base[name].unit}, and "
                + ("a positive parameter cannot be negative." if asked is None else "zero or less has no logarithm.")
                + f" Give start={{'{name}': ...}}, greater than zero."
            )
    return tuple(asked) if asked is not None else tuple(n for n in positive if starts[n][0] > 0)


def _usual_size(entry: Entry, scale: Scale) -> float:
    """Return the standard deviation of a parameter that starts at zero: its nominal size, or a quarter of its bounds."""
    nominal, (low, high) = entry.number("nominal"), scale.bounds_of(entry)
    size = abs(nominal) * scale.factor_of(entry) if nominal else (high - low) / 4
    if not np.isfinite(size):
        # With a standard deviation of zero the estimate would never change.
        raise NoiseLevelError(
            f"the estimate of '{entry.name}' starts at zero and has no standard deviation: give "
            f"initial={{'{entry.name}': ...}}, its first standard deviation."
        )
    return size


def state_spreads(model: Model, scale: Scale, sensors: Mapping[str, float]) -> np.ndarray:
    """Return the default standard deviation of each first state, SI, shape (states,).

    Parameters
    ----------
    model : Model
        The model.
    scale : Scale
        L and U.
    sensors : mapping of str to float
        Noise of the sensor that shows a state, by state: the first estimate comes from its first sample.
    """
    result = np.empty(len(model.states))
    for i, name in enumerate(model.states):
        spread, nominal = model[name].number("spread"), model[name].number("nominal")
        wider = 1.0
        if spread is None:
            # The first sample is also used in an update: a start hardly wider than its noise would count it twice.
            wider = WIDER
            try:
                spread = STATE_SHARE * scale.factor(model[name].unit) if scale.known else None
            except UnitError:
                spread = None
            spread = spread if spread is not None else abs(nominal) if nominal else 1.0
        result[i] = np.hypot(spread, wider * sensors.get(name, 0.0))
    return result


def read_deviations(model: Model, given: Mapping[str, Amount], estimated: Mapping[str, str]) -> dict[str, float]:
    """Return standard deviations of first estimates given by the user, SI, by state or parameter.

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
        level = to_si(value, model[name].given_unit, f"first standard deviation of '{name}'")
        if not level > 0:
            raise NoiseLevelError(
                f"the first standard deviation of '{name}' is {value}; it must be greater than zero. What is known exactly "
                "belongs among the ship's values."
            )
        result[name] = level
    return result


def state_bounds(
    base: Model, model: Model, estimated: Mapping[str, str], scale: Scale
) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds of the states, SI, shapes (states,): an estimated parameter keeps those it was declared with.

    Parameters
    ----------
    base, model : Model
        Without and with the estimated parameters as states.
    estimated : mapping of str to str
        The state of each estimated parameter; a logarithm needs no bounds.
    scale : Scale
        L and U, for bounds declared in the prime system.
    """
    low, high = np.full(len(model.states), -np.inf), np.full(len(model.states), np.inf)
    for name, state in estimated.items():
        if state == name:
            i = model.states.index(state)
            low[i], high[i] = scale.bounds_of(base[name])
    return low, high
