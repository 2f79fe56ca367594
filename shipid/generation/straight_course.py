"""A ship on a straight course: its states and inputs, and its linear model there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.numbers import brief
from shipid.generation.linearisation import Linearisation, NoSteadyStateError, find_steady_state, linearise
from shipid.generation.simulator import initial_state, input_rows
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.ship_coefficients import coefficients_at

#: Inputs that are zero on a straight course at heading zero.
AMIDSHIPS = ("delta", "delta_order", "psi_order", "r_order")
#: How far the steady speed of a model may be from the one that was asked for, as a share of it.
_SAME_SPEED = 0.01


def straight_course(model: Model, speeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return states and inputs of a ship that goes straight at each speed, nothing else acting on it.

    Parameters
    ----------
    model : Model
        A ship model, with or without its autopilot.
    speeds : ndarray, shape (n,)
        In m/s.

    Returns
    -------
    x : ndarray, shape (states, n)
    u : ndarray, shape (inputs, n)

    Raises
    ------
    UnstatedInputError
        If the model reads an input that a straight course does not state and that declares no default.
    """
    x = initial_state(model, {"u": speeds})
    u = input_rows(model, {"u": speeds, "cruise": speeds, **dict.fromkeys(AMIDSHIPS, 0.0)}, speeds.size)
    return np.broadcast_to(x.reshape(len(x), -1), (len(x), speeds.size)), u


def linear_ship(
    model: Model,
    ship: ParameterSet,
    speed: float,
    given: Mapping[str, str] | None = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
) -> Linearisation:
    """Linearise a ship on its steady straight course, rudder amidships.

    Parameters
    ----------
    model : Model
        A ship model in continuous time.
    ship : ParameterSet
        The ship; coefficients with a dimension are carried to the speed by powers of L and L/U.
    speed : float
        In m/s.
    given : mapping of str to str, optional
        Other inputs of the model, with their units, such as ``{"n": "80 rpm"}``.
    inputs, outputs : sequence of str, optional
        Which to keep; by default all inputs, and the states as outputs. States that the outputs do not depend on are left
        out: of a rate of turn, the position and the heading.

    Returns
    -------
    Linearisation

    Raises
    ------
    UsageError
        If the speed is not greater than zero.
    UnknownNameError
        If the model has no such input, state or output.
    UnstatedInputError
        If the model reads an input that is not given and declares no default.
    NoSteadyStateError
        If the ship does not go straight at this speed with these inputs.
    ParameterSetError
        If the ship lacks a coefficient.
    DeclarationError
        If the model is sampled.
    """
    if not speed > 0:
        raise UsageError(f"a ship at {speed:g} m/s is on no straight course: give a speed greater than zero.")
    known = {}
    for name, value in (given or {}).items():
        if name not in model.inputs:
            raise UnknownNameError(f"input of model {model.name} called", name, model.inputs)
        known[name] = to_si(value, model[name].given_unit, f"'{name}'")
    at = {"u": speed, "cruise": speed, **dict.fromkeys(AMIDSHIPS, 0.0), **known}
    condition = dict(zip(model.states, initial_state(model, at).tolist()))
    condition |= dict(zip(model.inputs, input_rows(model, at, 1)[:, 0].tolist()))
    condition |= coefficients_at(model, ship, speed).values
    condition |= find_steady_state(model, condition)
    found = condition.get("u", speed)
    if abs(found - speed) > _SAME_SPEED * speed:
        raise NoSteadyStateError(
            f"model {model.name} goes straight at {brief(found, 4)} m/s with these inputs, and not at {brief(speed, 4)} m/s. Ask for that speed, "
            "or give the inputs that hold the other one."
        )
    linear = linearise(model, condition, inputs=inputs, outputs=outputs)
    return linear if outputs is None else _seen(linear)


def _seen(linear: Linearisation) -> Linearisation:
    """The same system without states that no output depends on, so that a gain or a margin is that of the outputs."""
    seen = (linear.C != 0).any(axis=0)
    for _ in linear.states:
        seen = seen | (linear.A[seen] != 0).any(axis=0)
    kept = np.flatnonzero(seen)
    return replace(
        linear,
        A=linear.A[np.ix_(kept, kept)],
        B=linear.B[kept],
        C=linear.C[:, kept],
        states=tuple(linear.states[k] for k in kept),
    )
