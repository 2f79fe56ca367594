"""Augmenting: parameters that become states with a random walk, positive ones in log scale."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from shipid.declaration.component import Component, Scope
from shipid.declaration.model import Entry, Model
from shipid.declaration.quantity import Equation, Quantity
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, UnknownNameError


def augment(model: Model, names: Iterable[str], log: Iterable[str] | None = None) -> Model:
    """Return a new model in which parameters are states that keep their value.

    The rate of each is zero; the process noise of a filter makes it a random walk. A parameter whose
    lower bound is zero or more becomes the state ``log_NAME``, the natural logarithm of its value over one unit, and the
    parameter itself follows from it, so it cannot change sign.

    Parameters
    ----------
    model : Model
        The model to augment.
    names : iterable of str
        Parameters (or constants) that become states.
    log : iterable of str, optional
        Which of them are scaled by the logarithm; by default those whose lower bound is zero or more.

    Returns
    -------
    Model
        With one more state for each name.

    Raises
    ------
    UnknownNameError
        If a name is no parameter of the model.
    DeclarationError
        If a parameter is augmented twice, or ``log`` names one that may be negative.
    """
    names = tuple(dict.fromkeys(names))
    logs = None if log is None else set(log)
    for extra in sorted((logs or set()) - set(names)):
        raise DeclarationError(f"'{extra}' is to be in log scale but is not among the augmented: {', '.join(names)}.")
    entries = dict(model.entries)
    for name in names:
        if name not in model.parameters + model.constants:
            raise UnknownNameError(f"parameter in model {model.name} called", name, model.parameters + model.constants)
        entry = model[name]
        low = entry.number("low")
        positive = low is not None and low >= 0
        if logs is not None and name in logs and low is not None and low < 0:
            raise DeclarationError(f"'{name}' may be negative (its lower bound is {low:g}), so it has no logarithm.")
        in_log = positive if logs is None else name in logs
        entries.update(_log_state(entry, entries) if in_log else _plain_state(entry))
    return replace(model, entries=entries)


def _stays(self: Scope) -> Expression:
    """Random walk: the expected value does not change."""
    return 0.0


def _plain_state(entry: Entry) -> dict[str, Entry]:
    quantity = replace(entry.quantity, kind="state", estimated=True)
    return {entry.name: Entry(quantity, entry.owner, Equation(quantity, "rate", _stays))}


def _log_state(entry: Entry, entries: dict[str, Entry]) -> dict[str, Entry]:
    log_name = f"log_{entry.name}"
    if log_name in entries:
        raise DeclarationError(f"'{log_name}' is already a quantity of the model.")
    one_unit = Quantity("constant", entry.unit, f"one unit of {entry.name}", default=1.0, name=f"unit_{entry.name}")
    start, symbol = entry.number("start"), entry.quantity.latex or entry.name
    log_state = Quantity(
        "state",
        "1",
        f"logarithm of {entry.quantity.meaning}",
        start=float(np.log(start)) if start else 0.0,
        latex=rf"\ln {symbol}",
        name=log_name,
    )

    def from_log(self: Scope) -> Expression:
        """The parameter from its logarithm, so that it stays positive."""
        return getattr(self, one_unit.name) * np.exp(getattr(self, log_name))

    parameter = replace(entry.quantity, kind="derived")
    walk, value = Equation(log_state, "rate", _stays), Equation(parameter, "equals", from_log)
    members = {log_name: log_state, one_unit.name: one_unit, entry.name: parameter, "stays": walk, "from_log": value}
    owner = type(f"Log_{entry.name}", (Component,), {"__doc__": "The logarithm of a positive parameter.", **members})
    return {
        log_name: Entry(log_state, owner, walk),
        one_unit.name: Entry(one_unit, owner),
        entry.name: Entry(parameter, owner, value),
    }
