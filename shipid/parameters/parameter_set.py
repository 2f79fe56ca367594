"""Parameter sets: what is known of a ship, each number with its unit and where it comes from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from shipid.declaration.component import slug
from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import pretty, split, to_si
from shipid.declaration.vocabulary import display_unit, given_unit
from shipid.foundation.errors import DeclarationError, ParameterSetError, UnitError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result, ResultEntry, table
from shipid.parameters.correlation import Joint
from shipid.parts.steering_machine import GEAR, check_gear

if TYPE_CHECKING:
    import pandas as pd

PARTICULARS = "particulars"

#: Lengths of ships and of models of ships in m.
_SHORTEST, _LONGEST = 0.1, 2000.0


@dataclass(frozen=True, repr=False)
class Value(ResultEntry):
    """One number of a parameter set, or a table of it against speed.

    Attributes
    ----------
    name : str
        The quantity.
    value : float or tuple of float
        In `unit`.
    unit : str
        The unit of the source, not necessarily SI.
    source : str
        Where it comes from; "assumed" where it is assumed.
    std : float or None
        Standard deviation in `unit`, where known.
    speed : tuple of float
        Speeds of the table in `speed_unit`; empty for a single value.
    speed_unit : str
        Unit of `speed`.
    note : str
        What a reader has to know; empty where there is nothing.
    """

    name: str
    value: float | tuple[float, ...]
    unit: str
    source: str
    std: float | None = None
    speed: tuple[float, ...] = ()
    speed_unit: str = "m/s"
    note: str = ""

    def at(self, speed: float | None, wanted: str, where: str) -> float:
        """Return the value in a wanted unit, linear between the entries of a table.

        Parameters
        ----------
        speed : float or None
            In m/s; needed for a table against speed.
        wanted : str
            The unit of the result.
        where : str
            Whose value it is, for messages.

        Raises
        ------
        UnitError
            If the unit does not fit.
        ParameterSetError
            If a table is asked for without a speed, or outside its range.
        """
        what, wanted = f"'{self.name}' in {where}", given_unit(self.name, wanted)
        if isinstance(self.value, (int, float)):
            return to_si((self.value, self.unit), wanted, what)
        import numpy as np

        speeds = [to_si((s, self.speed_unit), "m/s", f"speed of {what}") for s in self.speed]
        if speed is None:
            raise ParameterSetError(f"{what} depends on the speed: say at which, as in --speed '5 m/s'.")
        if not speeds[0] <= speed <= speeds[-1]:
            raise ParameterSetError(
                f"{what} is known from {speeds[0]:g} to {speeds[-1]:g} m/s, and {brief(speed, 4)} m/s is outside. Ask for a speed inside, or take "
                "another ship, or none where the coefficients are to be identified."
            )
        return to_si((float(np.interp(speed, speeds, self.value)), self.unit), wanted, what)


@dataclass(frozen=True, repr=False)
class ParameterSet(Result):
    """What is known of one ship.

    Attributes
    ----------
    name, title, notes : str
        The short name, one line, and what a user has to know.
    sections : mapping of str to mapping of str to Value
        ``particulars``, and one section for each model or component, under its command-line name.
    joint : mapping of str to Joint
        By model: what an identification says of its coefficients together.
    """

    name: str
    title: str = ""
    notes: str = ""
    sections: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    joint: Mapping[str, Joint] = field(default_factory=dict)

    def __post_init__(self) -> None:
        frozen = {s: MappingProxyType(dict(v)) for s, v in self.sections.items()}
        object.__setattr__(self, "sections", MappingProxyType(frozen))
        object.__setattr__(self, "joint", MappingProxyType(dict(self.joint)))

    def __hash__(self) -> int:
        return hash((self.name, self.title, tuple(self.sections)))

    def __reduce__(self) -> tuple[type[ParameterSet], tuple[object, ...]]:
        sections = {s: dict(v) for s, v in self.sections.items()}
        return ParameterSet, (self.name, self.title, self.notes, sections, dict(self.joint))

    def text(self) -> str:
        """Return the result in lines of text."""
        inside = "; ".join(f"{s}: {', '.join(v)}" for s, v in self.sections.items())
        return f"ship {self.name}, {self.title}: {inside}"

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models and components the set has a section for."""
        return tuple(s for s in self.sections if s != PARTICULARS)

    def find(self, model: Model, name: str) -> Value | None:
        """Return what the set says of a quantity of a model, or None.

        Parameters
        ----------
        model : Model
            The model; its own section goes before those of the models it extends, these before those of its components, and these
            before the particulars.
        name : str
            The quantity.
        """
        for section in (*model.known_as, PARTICULARS):
            value = self.sections.get(section, {}).get(name)
            if value is not None:
                return value
        return None

    def particular(self, name: str, unit: str) -> float | None:
        """Return a particular such as ``L``, or None.

        Parameters
        ----------
        name : str
            The particular.
        unit : str
            The unit of the result.

        Raises
        ------
        ParameterSetError
            If it is a length that no ship or model of a ship has: times and distances are measured in it.
        """
        value = self.sections.get(PARTICULARS, {}).get(name)
        if value is None:
            return None
        if name == "L" and not _SHORTEST <= (length := value.at(None, "m", f"ship {self.name}")) <= _LONGEST:
            raise ParameterSetError(
                f"the length L of ship {self.name} is {length:g} m; it must lie between {_SHORTEST:g} m, a small model, and {_LONGEST:g} m."
            )
        if name in GEAR:
            check_gear(name, value.at(None, GEAR[name][1], f"ship {self.name}"), self.name)
        return value.at(None, unit, f"ship {self.name}")

    def values(self, model: Model, speed: float | None = None) -> dict[str, float]:
        """Return SI numbers of the parameters and constants of a model that the set determines.

        A parameter the set does not hold is worked out from the published coefficients it declares with
        ``@p.instead``; a constant falls back on its declared default.

        Parameters
        ----------
        model : Model
            The model to find values for.
        speed : float, optional
            Forward speed in m/s, for what is tabulated against speed.

        Raises
        ------
        UnitError
            If a unit does not fit.
        ParameterSetError
            If a table does not cover the speed, or the length is that of no ship.
        """
        self.particular("L", "m")
        return resolve(model, _Lookup(self, model, speed))

    def to_frame(self) -> pd.DataFrame:
        """Return what is known of the ship as a pandas table: section, quantity, value in the unit of its source, source."""
        columns = ("value", "std", "unit", "source")
        rows = (
            {"section": section, "name": v.name, **{n: getattr(v, n) for n in columns}}
            for section, values in self.sections.items()
            for v in values.values()
        )
        return table(rows, ["section", "name"], columns)


#: What a ship is called of which nothing is known: none was given.
NOBODY = "unnamed"
_GIVE_SHIP = "give one, as in --ship soesterberg, or ship='soesterberg' in Python (shipid models lists them)"

#: A message that asks for values shows so many of them.
_EXAMPLES = 3
#: Stands for a number that only the user knows: one that is printed would be taken for a fact of the ship.
_STATED_BY_USER = "VALUE"


class _Lookup(dict[str, float]):
    """The set's own numbers for the quantities of a model, read when asked for."""

    def __init__(self, parameters: ParameterSet, model: Model, speed: float | None) -> None:
        super().__init__()
        for name, entry in model.entries.items():
            found = parameters.find(model, name) if entry.quantity.kind != "given" else None
            if found is not None:
                self[name] = found.at(speed, entry.unit, f"ship {parameters.name}")
                if name in GEAR:
                    check_gear(name, self[name], parameters.name)


def resolve(model: Model, known: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters and constants of a model that known numbers determine.

    Parameters
    ----------
    model : Model
        The model.
    known : mapping of str to float
        SI numbers of parameters, constants and published (derived) coefficients.

    Returns
    -------
    dict of str to float
        Only what is determined.
    """
    import numpy as np

    result: dict[str, float] = {}
    for name in model.parameters + model.constants:
        entry = model[name]
        default = entry.number("default")
        if name in known:
            result[name] = known[name]
        elif entry.equation is not None:
            try:
                with np.errstate(all="ignore"):
                    value = float(_instead(model, name, known, ()))
            except (_AbsentError, ZeroDivisionError):
                continue
            if np.isfinite(value):
                result[name] = value
        elif default is not None:
            result[name] = default
    return result


class _AbsentError(Exception):
    """A coefficient that the known numbers do not determine."""


def _instead(model: Model, name: str, known: Mapping[str, float], path: tuple[str, ...]) -> float:
    """Work a parameter out of published coefficients, following other parameters that are worked out the same way."""
    if name in path:
        raise _AbsentError(name)

    def lookup(wanted: str) -> float:
        if wanted in known:
            return known[wanted]
        entry = model[wanted]
        if entry.quantity.kind == "parameter" and entry.equation is not None:
            return _instead(model, wanted, known, (*path, name))
        raise _AbsentError(wanted)

    if model[name].equation is None:
        raise _AbsentError(name)
    return float(model[name].value(lookup))


def parse_value(model: Model, assignment: str) -> tuple[str, float]:
    """Return the name and the SI number of a text such as ``"n3=0.4 s^2/deg^2"``.

    Parameters
    ----------
    model : Model
        The model that declares the quantity.
    assignment : str
        The text.

    Raises
    ------
    UnitError
        If the value has no unit, or one that does not fit; the message shows both units.
    UnknownNameError
        If the model has no such quantity.
    DeclarationError
        If it is a state or an output, which take no value.
    """
    name, sign, text = assignment.partition("=")
    name, text = name.strip(), text.strip()
    if not sign or not text:
        raise UnitError(f"'{assignment}' does not say NAME=VALUE UNIT, as in n3='0.4 s^2/deg^2'.")
    entry = model[name]
    if entry.quantity.kind in ("state", "output"):
        raise DeclarationError(
            f"'{name}' is a {entry.quantity.kind} of model {model.name}, and cannot be given a value."
        )
    split(text)
    return name, to_si(text, entry.given_unit, f"'{name}' ({entry.quantity.meaning})")


def lacks_speed(ship: ParameterSet, option: str) -> ParameterSetError:
    """Return the error that says that nothing states at which speed a ship sails.

    Parameters
    ----------
    ship : ParameterSet
        The ship.
    option : str
        How the speed is given on the command line, as in ``--speed '9 kn'``.
    """
    if ship.name == NOBODY:
        return ParameterSetError(f"neither a ship nor a speed is given: {_GIVE_SHIP}, or a speed, as in {option}.")
    return ParameterSetError(f"ship {ship.name} has no speed of its own: give one, as in {option}.")


def lacks_length(ship: ParameterSet, why: str) -> ParameterSetError:
    """Return the error that says that nothing states how long a ship is.

    Parameters
    ----------
    ship : ParameterSet
        The ship.
    why : str
        What the length is needed for, as in ``which sets the pace of a manoeuvre``.
    """
    if ship.name == NOBODY:
        return ParameterSetError(f"no ship is given, and so no length L, {why}: {_GIVE_SHIP}.")
    return ParameterSetError(f"ship {ship.name} has no length L greater than zero, {why}.")


def missing_values(model: Model, values: Mapping[str, float], ship: str) -> ParameterSetError | None:
    """Return the error that names what a model still lacks, or None when it lacks nothing.

    Parameters
    ----------
    model : Model
        The model.
    values : mapping of str to float
        What is known, SI.
    ship : str
        Whose values they are, for the message.
    """
    lacking = [n for n in model.parameters + model.constants if n not in values]
    if not lacking:
        return None
    named = ", ".join(f"{n} [{pretty(model[n].unit)}]" for n in lacking)
    examples = [_example(model, n, values) for n in lacking[:_EXAMPLES]]
    begins = any(f"={_STATED_BY_USER}" not in example for example in examples)
    remark = " (where a search begins: an order of size, not a value of this ship)" if begins else ""
    it = "it" if len(lacking) == 1 else "them"
    tables = dict.fromkeys("particulars" if n in model.constants else slug(model[n].owner) for n in lacking)
    held = f"which {ship} does not hold. State {it}"
    if ship == f"ship {NOBODY}":
        held = f"and no ship is given: {_GIVE_SHIP}. Or state {it}"
    return ParameterSetError(
        f"model {model.name} needs {named}, {held}, as in {' '.join(examples)}{remark}, or write {it} "
        f"into the ship's file, in {', '.join(f'[{table}]' for table in tables)}."
    )


def _example(model: Model, name: str, values: Mapping[str, float]) -> str:
    """How a value is stated, with its unit: where a search for it begins, where that is known."""
    # With two speeds: a coefficient that is scaled by the length alone comes out the same.
    start, other = (Scale(values.get("L"), speed).start_of(model[name]) for speed in (1.0, 2.0))
    value = _STATED_BY_USER if start is None or start != other else f"{start:.3g}"
    unit = display_unit(name, model[name].unit) if value == _STATED_BY_USER else model[name].unit
    return f"--set '{name}={value}{'' if unit == '1' else f' {pretty(unit)}'}'"
