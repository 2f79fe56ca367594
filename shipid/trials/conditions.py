"""The conditions of a trial: what a log does not hold and its record has to state (MSC/Circ.1053): ship, loading, place, weather, who."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from shipid.declaration.tables import Table
from shipid.declaration.units import factor, pretty
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import given
from shipid.foundation.result import Result, table

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Condition:
    """One condition that a record states.

    Attributes
    ----------
    name : str
        Its key in a table ``[trial]``.
    group : {"ship", "loading", "surroundings", "trial"}
        Where a record of the trial lists it.
    label : str
        What a table calls it.
    unit, display : str
        Unit inside and unit shown; empty for a text.
    """

    name: str
    group: str
    label: str
    unit: str = ""
    display: str = ""


_ENTRIES = (
    Condition("ship", "ship", "Ship"),
    Condition("imo_number", "ship", "IMO number"),
    Condition("yard", "ship", "Builder and hull number"),
    Condition("length", "ship", "Length between perpendiculars", "m", "m"),
    Condition("breadth", "ship", "Breadth", "m", "m"),
    Condition("rudder", "ship", "Rudder: kind, number"),
    Condition("rudder_area", "ship", "Rudder area", "m^2", "m^2"),
    Condition("largest_rudder", "ship", "Largest rudder angle", "rad", "deg"),
    Condition("propeller", "ship", "Propeller: kind, number"),
    Condition("engine", "ship", "Engine and its output at the trial"),
    Condition("condition", "loading", "Loading condition"),
    Condition("draught_forward", "loading", "Draught forward", "m", "m"),
    Condition("draught_aft", "loading", "Draught aft", "m", "m"),
    Condition("displacement", "loading", "Displacement", "kg", "t"),
    Condition("place", "surroundings", "Place"),
    Condition("depth", "surroundings", "Water depth", "m", "m"),
    Condition("wind_speed", "surroundings", "Wind speed", "m/s", "m/s"),
    Condition("wind_from", "surroundings", "Wind from", "rad", "deg"),
    Condition("sea_state", "surroundings", "Sea state"),
    Condition("wave_height", "surroundings", "Significant wave height", "m", "m"),
    Condition("waves_from", "surroundings", "Waves from", "rad", "deg"),
    Condition("current_speed", "surroundings", "Current speed", "m/s", "kn"),
    Condition("current_to", "surroundings", "Current to", "rad", "deg"),
    Condition("date", "trial", "Date and time"),
    Condition("who", "trial", "Carried out by"),
    Condition("instruments", "trial", "Instruments"),
    Condition("remarks", "trial", "Remarks"),
)

#: By name.
ENTRIES: Mapping[str, Condition] = MappingProxyType({e.name: e for e in _ENTRIES})
#: Share by which numbers of one loading may differ: fuel that is burnt, draughts that are read to a few centimetres.
_SAME_LOADING = 0.03
#: Those that cannot be zero or negative.
_POSITIVE = (
    "length",
    "breadth",
    "rudder_area",
    "largest_rudder",
    "draught_forward",
    "draught_aft",
    "displacement",
    "depth",
)


@dataclass(frozen=True, repr=False)
class Conditions(Result):
    """What is stated of a trial; what is not stated is a blank of its record.

    Attributes
    ----------
    values : Mapping of str to str or float
        By the names of `ENTRIES`; numbers SI, directions clockwise from north.
    """

    values: Mapping[str, str | float] = field(default_factory=dict, hash=False)

    def to_frame(self) -> pd.DataFrame:
        """Return what is stated as a pandas table, SI."""
        rows = [
            {"name": n, "value": v, "unit": pretty(ENTRIES[n].unit), "label": ENTRIES[n].label}
            for n, v in self.values.items()
        ]
        return table(rows, "name", ("value", "unit", "label"))

    def number(self, name: str) -> float | None:
        """Return a stated number, SI, or None.

        Parameters
        ----------
        name : str
            The entry.
        """
        value = self.values.get(name)
        return None if value is None else float(value)

    @property
    def loading(self) -> dict[str, float]:
        """What is stated of the loading in one number, SI: ``draught``, the mean of forward and aft as far as they are stated, and ``displacement``."""
        ends = [d for n in ("draught_forward", "draught_aft") if (d := self.number(n)) is not None]
        found = {"draught": sum(ends) / len(ends) if ends else None, "displacement": self.number("displacement")}
        return {n: v for n, v in found.items() if v is not None}

    def with_those(self, of_one: Conditions) -> Conditions:
        """Return conditions with those of one trial in place of what they state as well.

        Parameters
        ----------
        of_one : Conditions
            What is stated of this trial alone.
        """
        return Conditions({**self.values, **of_one.values})

    def shown(self, name: str) -> str | None:
        """Return a stated value with its unit as a reader expects it, or None for a blank.

        Parameters
        ----------
        name : str
            The entry.
        """
        entry, value = ENTRIES[name], self.values.get(name)
        if value is None or isinstance(value, str):
            return value
        return f"{given(value * factor(entry.unit, entry.display))} {pretty(entry.display)}"

    def lines(self, group: str | None = None) -> Iterator[tuple[str, str | None]]:
        """Yield label and value of every entry, None for a blank.

        Parameters
        ----------
        group : str, optional
            Only those of this group.
        """
        for entry in _ENTRIES:
            if group in (None, entry.group):
                yield entry.label, self.shown(entry.name)

    def with_defaults(self, values: Mapping[str, str | float | None]) -> Conditions:
        """Return the conditions with entries that are known from elsewhere; what is stated stays.

        Parameters
        ----------
        values : Mapping of str to str, float or None
            By the names of `ENTRIES`; None is left out.
        """
        return Conditions({**{n: v for n, v in values.items() if v is not None}, **self.values})

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values: texts, and ``{"value", "unit"}`` for numbers; None for a blank."""
        result: dict[str, Plain] = {}
        for entry in _ENTRIES:
            value = self.values.get(entry.name)
            if isinstance(value, (int, float)):
                result[entry.name] = {"value": value * factor(entry.unit, entry.display), "unit": entry.display}
            else:
                result[entry.name] = value
        return result


def conditions_of(table: Table) -> Conditions:
    """Return the conditions that a table ``[trial]`` states.

    Parameters
    ----------
    table : Table
        The table; an empty one states nothing.

    Returns
    -------
    Conditions

    Raises
    ------
    ShipidError
        Of the class of the table: if a key is not known, a number has no unit or is not possible.
    """
    table.check_keys(ENTRIES)
    values: dict[str, str | float] = {}
    for name in table:
        entry = ENTRIES[name]
        if entry.unit:
            number = table.quantity(name, entry.unit, positive=name in _POSITIVE)
            assert number is not None
            values[name] = number
        elif isinstance(table.content[name], str):
            text = str(table.value(name, str)).strip()
            if text:
                values[name] = text
        else:
            # A date is written without quotes in TOML.
            values[name] = str(table.content[name])
    return Conditions(values)


def one_loading(numbers: Sequence[float]) -> bool:
    """Return whether numbers that say a loading are those of one: they agree within 3 %.

    Parameters
    ----------
    numbers : sequence of float
        Draughts or displacements, SI.
    """
    return max(numbers) <= (1 + _SAME_LOADING) * min(numbers)


def different_loadings(stated: Mapping[str, Conditions]) -> str | None:
    """Return what trials state of different loadings, in words, or None where those that state any agree.

    Parameters
    ----------
    stated : mapping of str to Conditions
        By trial.

    Returns
    -------
    str or None
        As in ``"displacement 520 t (ballast-20), 610 t (laden-20)"``. Numbers agree within 3 %, texts where they are the same but
        for case.
    """
    said = []
    for entry in (e for e in _ENTRIES if e.group == "loading"):
        known = {trial: c.values[entry.name] for trial, c in stated.items() if entry.name in c.values}
        numbers = [v for v in known.values() if isinstance(v, float)]
        if numbers and one_loading(numbers):
            continue
        if not numbers and len({str(v).casefold() for v in known.values()}) < 2:
            continue
        trials: dict[str, list[str]] = {}
        for trial in known:
            trials.setdefault(str(stated[trial].shown(entry.name)), []).append(trial)
        each = ", ".join(f"{value} ({', '.join(names)})" for value, names in trials.items())
        said.append(f"{entry.label[0].lower()}{entry.label[1:]} {each}")
    return "; ".join(said) or None
