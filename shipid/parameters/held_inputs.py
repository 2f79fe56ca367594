"""Inputs of a model that are held at a value: a propeller that turns at one rate, a depth of water, a tug that pulls."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping

from shipid.declaration.component import Component
from shipid.declaration.joining.join import join
from shipid.declaration.model import Model
from shipid.declaration.quantity import Equation, Quantity, constant, derived
from shipid.declaration.units import to_si
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import UsageError

#: Ends the name of the constant that holds an input.
_HELD = "_held"
#: Inputs that a command states itself: held, they would take the helm from it.
_STEERED = ("delta", "delta_order", "psi_order", "r_order")


def hold_inputs(model: Model, values: Mapping[str, str | float]) -> Model:
    """Return a model whose inputs of some names are held at a value, wherever it is run.

    Parameters
    ----------
    model : Model
        A ship model.
    values : mapping of str to str or float
        By input, with a unit or in SI.

    Returns
    -------
    Model
        Of the same name; the model itself where nothing is held.

    Raises
    ------
    UsageError
        If the model reads no such input, or it is the rudder or an order.
    UnitError
        If a value has no unit where it needs one, or one that does not fit.
    """
    if not values:
        return model
    held = []
    for name, text in values.items():
        if name in _STEERED:
            raise UsageError(f"'{name}' is what the command orders: it is not held.")
        if name in (*model.constants, *model.parameters):
            raise UsageError(f"'{name}' is a value of the ship in model {model.name}, not an input: --set states it.")
        if name not in model.inputs:
            raise UsageError(f"model {model.name} reads no input '{name}'; it reads {', '.join(model.inputs)}.")
        entry = model[name]
        number = to_si(text, entry.given_unit, f"input '{name}'") if isinstance(text, str) else float(text)
        held.append((name, entry.unit, entry.quantity.meaning, entry.quantity.wraps, number))
    return join(model.name, model, _component(tuple(held)))


def held_inputs(model: Model) -> dict[str, str]:
    """Return the constants that hold inputs of a model, by input.

    Parameters
    ----------
    model : Model
        A model, of `hold_inputs` or any other.
    """
    names = (n.removesuffix(_HELD) for n in model.constants if n.endswith(_HELD))
    return {n: n + _HELD for n in names if n in model.derived}


@functools.lru_cache(maxsize=64)
def _component(held: tuple[tuple[str, str, str, bool, float], ...]) -> type[Component]:
    """The component; one for each set of values, so that what is generated from it is kept."""
    members: dict[str, object] = {"__doc__": "Inputs that are held.", "__module__": __name__}
    for name, unit, meaning, wraps, value in held:
        quantity: Quantity = derived(unit, meaning, wraps=wraps)
        members[name + _HELD] = constant(unit, f"{meaning}, held", default=value)
        members[name] = quantity
        members[f"hold_{name}"] = Equation(quantity, "equals", _holding(name))
    return type("HeldInputs", (Component,), members)


@functools.lru_cache(maxsize=256)
def _holding(name: str) -> Callable[[Component], Expression]:
    def hold(self: Component) -> Expression:
        """The value that was stated."""
        return getattr(self, name + _HELD)

    return hold
