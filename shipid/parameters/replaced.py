"""A ship with some of its values replaced: what a user states goes before what the set holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from shipid.declaration.component import declared_quantities
from shipid.declaration.model import Model
from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import given_unit
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.parameters.correlation import Joint
from shipid.parameters.draft import KNOWN_PARTICULARS
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value
from shipid.parts.steering_machine import SteeringMachine
from shipid.parts.wind import Wind

#: Components that commands join to a ship: their coefficients may be stated as well.
_JOINED = (SteeringMachine, Wind)
_ROLES = {"given": "an input; state it with --input", "state": "a state", "output": "a sensor", "guard": "a guard"}


def with_values(
    ship: ParameterSet, values: Mapping[str, str | float], models: Sequence[Model] = (), source: str = "stated"
) -> ParameterSet:
    """Return a ship with some values replaced.

    Parameters
    ----------
    ship : ParameterSet
        The ship.
    values : mapping of str to str or float
        With units, or in SI: coefficients of the models, particulars such as ``L`` or ``speed``, and coefficients of steering machine
        and wind.
    models : sequence of Model
        Models whose coefficients may be stated.
    source : str
        Where the values come from.

    Returns
    -------
    ParameterSet
        A value that was replaced has no standard deviation. A published coefficient takes the place of the one it defines.

    Raises
    ------
    UnknownNameError
        If nothing has such a name.
    UsageError
        If it is the name of an input or a state, which are no values of a ship.
    UnitError
        If a value has no unit where it needs one, or one that does not fit.
    """
    sections = {name: dict(held) for name, held in ship.sections.items()}
    joint = dict(ship.joint)
    taken: dict[str, list[str]] = {}
    for name, text in values.items():
        unit, meaning, holders = _declared(name, models)
        number = float(text) if isinstance(text, (int, float)) else to_si(text, unit, f"'{name}' ({meaning})")
        value = Value(name, number, unit, source)
        if not holders:
            # A particular is every model's: nothing else may go before it.
            for held in sections.values():
                held.pop(name, None)
            sections.setdefault(PARTICULARS, {})[name] = value
        for model in holders:
            gone = [name]
            if model[name].quantity.kind == "derived":
                partner = model.partner(name, taken.setdefault(model.name, []))
                taken[model.name] += [partner] if partner is not None else []
                gone += [partner] if partner is not None else []
            for section in model.known_as:
                for lost in gone:
                    sections.get(section, {}).pop(lost, None)
                if section in joint:
                    joint[section] = _without(joint[section], gone)
            sections.setdefault(model.name, {})[name] = value
    return replace(ship, sections=sections, joint=joint)


def _declared(name: str, models: Sequence[Model]) -> tuple[str, str, list[Model]]:
    """Unit and meaning of a value, and the models whose coefficient it is; none where it is a particular of the ship."""
    having = [m for m in models if name in m.entries]
    holders = [m for m in having if m[name].quantity.kind in ("parameter", "derived")]
    if holders:
        return holders[0][name].given_unit, holders[0][name].quantity.meaning, holders
    for known in KNOWN_PARTICULARS:
        if known.name == name:
            return known.unit, known.meaning, []
    quantities = {n: q for part in _JOINED for n, q in declared_quantities(part).items()}
    for model in having:
        quantities[name] = model[name].quantity
    known_kinds = {n: q for n, q in quantities.items() if q.kind in ("parameter", "constant")}
    if name in known_kinds:
        return given_unit(name, known_kinds[name].unit), known_kinds[name].meaning, []
    if name in quantities:
        raise UsageError(f"'{name}' is {_ROLES.get(quantities[name].kind, 'no value')}, and is no value of a ship.")
    names = [n for m in models for n in (*m.parameters, *m.constants)]
    raise UnknownNameError("value of a ship called", name, [*names, *known_kinds, *(k.name for k in KNOWN_PARTICULARS)])


def _without(joint: Joint, names: Sequence[str]) -> Joint:
    """The correlation of the other coefficients."""
    kept = [i for i, n in enumerate(joint.names) if n not in names]
    return replace(
        joint,
        names=tuple(joint.names[i] for i in kept),
        correlation=tuple(tuple(joint.correlation[i][j] for j in kept) for i in kept),
    )
