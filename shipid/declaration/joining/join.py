"""Joining components into a model by name; the error of a mismatch names both places."""

from __future__ import annotations

from dataclasses import replace
from inspect import getattr_static

from shipid.declaration import units
from shipid.declaration.component import SAMPLING_INTERVAL, Component, declared_equations, declared_quantities
from shipid.declaration.joining.unit_check import check_units
from shipid.declaration.model import Entry, Model
from shipid.declaration.quantity import Equation, Quantity
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, UnitError, nearest


def join(name: str, *parts: type[Component] | Model) -> Model:
    """Join components into a model.

    What one component declares as `given` is what another states under the same name. What stays unconnected is an
    input of the model. Constants of the same name are one particular of the ship, and what two components inherit
    unchanged from a common one is stated once. Every equation is run once over quantities with units before the model
    is returned.

    Parameters
    ----------
    name : str
        Name of the model.
    *parts : type[Component] or Model
        The components, or models to extend.

    Returns
    -------
    Model

    Raises
    ------
    DeclarationError
        If a name is stated twice, an equation is missing, derived quantities define each other in a circle, a dead time delays
        what is no input, or an output measures what is not there.
    UnitError
        If a unit is not SI, two components disagree about one, or an equation's terms do not match.
    """
    if not name.strip():
        raise DeclarationError("a model needs a name: join('own ship', ...).")
    stated: dict[str, Entry] = {}
    given: dict[str, list[Entry]] = {}
    order: list[str] = []
    components: list[type[Component]] = []
    extended: list[str] = []
    for part in parts:
        for entry in _entries(part):
            _check_declared_unit(entry)
            # The noise of a state may be a density; a filter reads it.
            noise = ("noise",) if entry.quantity.kind == "output" else ()
            for attribute in ("start", "low", "high", "spread", "nominal", "default", *noise):
                entry.number(attribute)
            if entry.name not in order:
                order.append(entry.name)
            if entry.quantity.kind == "given":
                given.setdefault(entry.name, []).append(entry)
            else:
                stated[entry.name] = _state_once(stated.get(entry.name), entry)
        components += part.components if isinstance(part, Model) else (part,)
        extended += (part.name, *part.extended) if isinstance(part, Model) else ()
    if not stated:
        raise DeclarationError(f"model {name} joins no component that states anything.")

    for wanted, readers in given.items():
        _check_connection(name, wanted, readers, stated.get(wanted))
    for entry in stated.values():
        _check_delay(name, entry, stated, given)
    entries = {n: stated.get(n) or _input(given[n]) for n in order}
    for entry in stated.values():
        _check_measured(name, entry, entries)
    model = Model(name, entries, tuple(components), tuple(dict.fromkeys(n for n in extended if n != name)))
    check_units(model)
    return model


def _entries(part: Expression) -> list[Entry]:
    if isinstance(part, Model):
        return list(part.entries.values())
    if isinstance(part, type) and issubclass(part, Component):
        return [
            Entry(quantity, part, declared_equations(part).get(n)) for n, quantity in declared_quantities(part).items()
        ]
    raise DeclarationError(f"join takes component classes and models, and got {part!r}.")


def _where(entry: Entry) -> str:
    place = f", {entry.equation.place}" if entry.equation else ""
    return f"{entry.owner.__name__} ({entry.quantity.kind}{place})"


def _check_declared_unit(entry: Entry) -> None:
    try:
        coherent = units.is_coherent_si(entry.unit)
    except UnitError as error:
        raise UnitError(f"'{entry.name}' of {entry.owner.__name__}: {error}") from None
    if not coherent:
        raise UnitError(
            f"'{entry.name}' of {entry.owner.__name__} is declared in {units.pretty(entry.unit)}, which is not a coherent "
            f"SI unit. Declare it in {units.pretty(units.coherent(entry.unit))}: values may come in any unit that fits."
        )


def _state_once(first: Entry | None, second: Entry) -> Entry:
    if first is None:
        return second
    if _inherit_the_same(first, second):
        return first
    both_constant = first.quantity.kind == second.quantity.kind == "constant"
    if not both_constant:
        raise DeclarationError(
            f"'{second.name}' is stated twice: by {_where(first)} and by {_where(second)}. Declare it as given(...) in the "
            "component that only reads it, or leave one of them out."
        )
    if not units.same_dimension(first.unit, second.unit):
        raise UnitError(
            f"the constant '{second.name}' is in {units.pretty(first.unit)} in {first.owner.__name__} and in "
            f"{units.pretty(second.unit)} in {second.owner.__name__}."
        )
    return first if first.quantity.default is not None else replace(first, quantity=second.quantity)


def _inherit_the_same(first: Entry, second: Entry) -> bool:
    """Whether two components inherit one and the same statement: declaration, equation, and helpers it may call."""
    if first.owner is second.owner or first.quantity is not second.quantity:
        return False
    if first.equation is None or second.equation is None:
        return first.equation is second.equation
    if first.equation.function is not second.equation.function:
        return False
    common = next(c for c in first.owner.__mro__ if issubclass(second.owner, c))
    helpers = [n for n in dir(common) if not n.startswith("__") and n not in vars(Component)]
    return all(_same_helper(getattr_static(first.owner, n), getattr_static(second.owner, n)) for n in helpers)


def _same_helper(first: Expression, second: Expression) -> bool:
    # Quantities are connected by name, and equations are compared where their own quantity is.
    return first is second or isinstance(first, Quantity | Equation) or isinstance(second, Quantity | Equation)


def _check_connection(model: str, name: str, readers: list[Entry], source: Entry | None) -> None:
    reference = source or readers[0]
    for reader in readers:
        if not units.same_dimension(reference.unit, reader.unit):
            verb = "states" if source else "reads"
            raise UnitError(
                f"model {model}: {reference.owner.__name__} {verb} '{name}' in {units.pretty(reference.unit)}, and "
                f"{reader.owner.__name__} reads it in {units.pretty(reader.unit)}."
            )
    if name == SAMPLING_INTERVAL and source is not None:
        raise DeclarationError(
            f"model {model}: '{SAMPLING_INTERVAL}' is the sampling interval, and {_where(source)} states it."
        )


def _check_delay(model: str, entry: Entry, stated: dict[str, Entry], given: dict[str, list[Entry]]) -> None:
    """Refuse a dead time of what is no input, unless the component that states it reads the dead time as well."""
    late = entry.quantity.delays
    if late is None:
        return
    if not units.same_dimension(entry.unit, "s"):
        raise UnitError(f"model {model}: the dead time '{entry.name}' is in {units.pretty(entry.unit)}, and not in s.")
    source = stated.get(late)
    if source is None and late not in given:
        raise DeclarationError(f"model {model}: '{entry.name}' delays '{late}', which no component reads.")
    if source is not None and entry.name not in declared_quantities(source.owner):
        raise DeclarationError(
            f"model {model}: '{entry.name}' delays the input '{late}', and {_where(source)} states '{late}' without it: "
            "a dead time is carried where that is a record, and by LateSteeringMachine. Choose the model without it."
        )


def _check_measured(model: str, entry: Entry, entries: dict[str, Entry]) -> None:
    """Refuse an output that measures what the model does not have, or shows it in another unit: a log holds it under one name."""
    measured = entry.quantity.measures
    if measured is None:
        return
    if measured not in entries:
        raise DeclarationError(
            f"model {model}: '{entry.name}' of {entry.owner.__name__} measures '{measured}', which is no quantity of the model. "
            f"{nearest(measured, entries)}".strip()
        )
    if not units.same_dimension(entry.unit, entries[measured].unit):
        raise UnitError(
            f"model {model}: '{entry.name}' of {entry.owner.__name__} is in {units.pretty(entry.unit)}, and measures '{measured}' in "
            f"{units.pretty(entries[measured].unit)}: a log has one column for both. Leave measures=... out; the log then holds a column "
            f"'{entry.name}'."
        )


def _input(readers: list[Entry]) -> Entry:
    with_default = [r for r in readers if r.quantity.default is not None]
    return (with_default or readers)[0]


def replace_component(model: Model, old: type[Component], new: type[Component], name: str | None = None) -> Model:
    """Return a new model in which one component stands in another's place.

    Parameters
    ----------
    model : Model
        The model; it stays as it is.
    old, new : type[Component]
        The component to take out, and the one to put in.
    name : str, optional
        Name of the new model; the old name when not given.

    Returns
    -------
    Model

    Raises
    ------
    DeclarationError
        If `old` is not in the model, or the new one does not fit.
    """
    if old not in model.components:
        raise DeclarationError(f"model {model.name} has no component {old.__name__} to replace.")
    return join(name or model.name, *(new if c is old else c for c in model.components))
