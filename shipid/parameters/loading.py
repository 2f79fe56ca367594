"""The loading of a ship: coefficients of any model that change with the draught, or with the displacement.

A model is transformed, and no equation is retyped: each equation of motion reads a coefficient at the loading of the ship, and
the coefficient itself is the one at a reference loading. A coefficient that the declaration keeps to one sign follows a power of
the loading, ``K (T/T_ref)^K_draught``; one that may have either sign changes in a straight line, ``b1 + b1_draught (T/T_ref - 1)``, as
a ship that is unstable laden may be stable in ballast.
"""

from __future__ import annotations

import functools
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from shipid.declaration.component import Component, declared_quantities
from shipid.declaration.joining.unit_check import check_units
from shipid.declaration.model import Entry, Model
from shipid.declaration.quantity import Equation, Quantity, constant, derived, given, parameter
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import UsageError

#: What says the loading, and with a hyphen before it the ending of the name of a model whose coefficients depend on it.
MEASURES = ("draught", "displacement")
#: What the reference of a measure is called.
REFERENCE = "_ref"
#: Bound of the change of a coefficient, in standard deviations of its prior.
_FAR = 10.0


class AtDraught(Component):
    """The loading of a ship, by her mean draught."""

    draught = given("m", "mean draught of the ship")
    draught_ref = constant("m", "mean draught at which the coefficients are stated", latex="T_{ref}")


class AtDisplacement(Component):
    """The loading of a ship, by her displacement."""

    displacement = given("kg", "displacement of the ship")
    displacement_ref = constant("kg", "displacement at which the coefficients are stated", latex=r"\Delta_{ref}")


class CoefficientAtLoading(Component):
    """One coefficient at the loading of the ship; the transformation gives the names of the model to what it reads."""

    loading = given("1", "what says the loading")
    reference = constant("1", "the same at the reference loading")
    at_reference = given("1", "the coefficient at the reference loading")
    # As the draught or as its inverse, within one standard deviation: published regressions of hull derivatives lie in between.
    power = parameter(
        "1", "power of the loading that the coefficient follows", start=0.0, low=-_FAR, high=_FAR, spread=1.0
    )
    change = parameter("1", "change of the coefficient per relative change of the loading", start=0.0, spread=1.0)

    def follows_a_power(self) -> Expression:
        """Return a coefficient that keeps its sign.

        A derivative of the hull is a power of the draught over the length, times a constant (Clarke et al. 1982); the power is free.
        """
        return self.at_reference * np.exp(self.power * np.log(self.loading / self.reference))

    def changes_in_a_line(self) -> Expression:
        """Return a coefficient that may have either sign: the first order of any smooth dependence (this project's own)."""
        return self.at_reference + self.change * (self.loading / self.reference - 1)


_STATED = {"draught": AtDraught, "displacement": AtDisplacement}


@functools.lru_cache(maxsize=64)
def at_loading(model: Model, measure: str = "draught") -> Model:
    """Return a model whose coefficients depend on the loading; the same where it reads one already.

    Parameters
    ----------
    model : Model
        Any model. Coefficients that identification estimates are changed, but for those of the gear
        (`Component.same_at_any_loading`).
    measure : {"draught", "displacement"}
        What says the loading: the input of the model that states it.

    Returns
    -------
    Model
        Called ``MODEL-draught``. Each coefficient keeps its name, and is that at the loading ``draught_ref``; beside ``K`` stands
        ``K_draught``, which says how it changes.

    Raises
    ------
    UsageError
        If the measure is unknown, the model states it by itself, or no coefficient depends on it.
    """
    if measure not in _STATED:
        raise UsageError(f"the loading is stated by {' or '.join(MEASURES)}, not by '{measure}'.")
    if measure_of(model) is not None:
        return model
    stated = _STATED[measure]
    changed = {n: _Changed(model[n], measure) for n in _of_hull(model)}
    taken = [n for c in changed.values() for n in (c.at_loading, c.part.name) if n in model]
    taken += [n for n in declared_quantities(stated) if n in model]
    if taken:
        raise UsageError(
            f"model {model.name} has a quantity '{taken[0]}' of its own: its coefficients cannot depend on the loading."
        )
    if not changed:
        raise UsageError(
            f"model {model.name} has no coefficient that is estimated and depends on the loading of the ship."
        )
    renamed = {n: c.at_loading for n, c in changed.items()}
    entries: dict[str, Entry] = {}
    for name, entry in model.entries.items():
        # What a coefficient follows from in a publication is the coefficient at the reference.
        moved = entry.equation is not None and entry.quantity.kind != "parameter"
        entries[name] = _reading(entry, renamed) if moved else entry
        if name in changed:
            entries[changed[name].part.name] = Entry(changed[name].part, CoefficientAtLoading)
    entries |= {n: Entry(q, stated) for n, q in declared_quantities(stated).items()}
    entries |= {c.at_loading: c.entry for c in changed.values()}
    known_as = (model.name, *model.extended)
    transformed = Model(f"{model.name}-{measure}", entries, (*model.components, stated), known_as)
    check_units(transformed)
    return transformed


def measure_of(model: Model) -> str | None:
    """Return what says the loading of a model whose coefficients depend on it, or None.

    Parameters
    ----------
    model : Model
        The model.
    """
    return next((n for n, stated in _STATED.items() if stated in model.components), None)


def load_parts(model: Model) -> dict[str, str]:
    """Return the coefficients that depend on the loading: the name of each, and of its part that says how it changes.

    Parameters
    ----------
    model : Model
        The model.
    """
    measure = measure_of(model)
    return {} if measure is None else {n: p for n in model.parameters if (p := f"{n}_{measure}") in model.parameters}


def value_at_loading(model: Model, name: str) -> str:
    """Return the quantity of a model that is a coefficient of it at the loading of the ship.

    Parameters
    ----------
    model : Model
        A model whose coefficients depend on the loading.
    name : str
        A coefficient.
    """
    loaded = f"{name}_at_{measure_of(model)}"
    return loaded if loaded in model else name


class _Changed:
    """A coefficient that depends on the loading: what is declared beside it."""

    def __init__(self, entry: Entry, measure: str) -> None:
        name, quantity = entry.name, entry.quantity
        low, high = entry.number("low"), entry.number("high")
        keeps_sign = (low is not None and low >= 0) or (high is not None and high <= 0)
        pattern = declared_quantities(CoefficientAtLoading)
        source = "power" if keeps_sign else "change"
        own = CoefficientAtLoading
        equation = own.follows_a_power if keeps_sign else own.changes_in_a_line
        self.at_loading = f"{name}_at_{measure}"
        part = replace(
            pattern[source], name=f"{name}_{measure}", meaning=f"{pattern[source].meaning}: of {name}, by the {measure}"
        )
        if not keeps_sign:
            size = max(abs(entry.number("start") or 0.0), entry.number("spread") or 0.0) or 1.0
            part = replace(part, unit=entry.unit, prime=quantity.prime, spread=size, low=-_FAR * size, high=_FAR * size)
        self.part: Quantity = part
        value: Quantity = replace(
            derived(entry.unit, f"{quantity.meaning}, at the {measure} of the ship"), name=self.at_loading
        )
        reads = {"loading": measure, "reference": measure + REFERENCE, "at_reference": name, source: part.name}
        self.entry = Entry(value, CoefficientAtLoading, Equation(value, "equals", equation), tuple(reads.items()))


def _of_hull(model: Model) -> list[str]:
    """The coefficients that identification estimates and a loading changes."""
    return [
        n
        for n in model.parameters
        if model[n].quantity.estimated and n not in _same(model[n].owner) and model[n].number("start") is not None
    ]


def _same(owner: type[Component]) -> Collection[str]:
    return {n for c in owner.__mro__ for n in vars(c).get("same_at_any_loading", ())}


def _reading(entry: Entry, renamed: dict[str, str]) -> Entry:
    """An entry whose equation reads other quantities in the place of some."""
    own = dict(entry.reads)
    seen = {n: renamed[n] for n in renamed if n not in own} | {n: renamed.get(m, m) for n, m in own.items()}
    return replace(entry, reads=tuple(seen.items()))
