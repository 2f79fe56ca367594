"""Parameter sets: what is known of a ship, each number with its unit and where it comes from."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from shipid.declaration.component import Scope, slug
from shipid.declaration.model import Model
from shipid.declaration.units import pretty, split, to_si
from shipid.foundation.errors import DeclarationError, ParameterSetError, UnitError, nearest
from shipid.parameters.correlation import IDENTIFIED, Joint, joint_lines, read_joint

_VALUE_KEYS = {"value", "unit", "source", "std", "speed", "speed_unit", "note"}
_HEAD_KEYS = {"name", "title", "notes", "schema"}
PARTICULARS = "particulars"


@dataclass(frozen=True)
class Value:
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
        """Return the value in `wanted` units at a speed in m/s, linear between the entries of a table.

        Raises
        ------
        UnitError
            If the unit does not fit.
        ParameterSetError
            If a table is asked for without a speed, or outside its range.
        """
        what = f"'{self.name}' in {where}"
        if isinstance(self.value, (int, float)):
            return to_si((self.value, self.unit), wanted, what)
        import numpy as np

        speeds = [to_si((s, self.speed_unit), "m/s", f"speed of {what}") for s in self.speed]
        if speed is None:
            raise ParameterSetError(f"{what} depends on the speed: say at which, as in --speed '5 m/s'.")
        if not speeds[0] <= speed <= speeds[-1]:
            raise ParameterSetError(
                f"{what} is known from {speeds[0]:g} to {speeds[-1]:g} m/s, and {speed:.4g} m/s is outside."
            )
        return to_si((float(np.interp(speed, speeds, self.value)), self.unit), wanted, what)


@dataclass(frozen=True)
class ParameterSet:
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

    def __reduce__(self) -> Any:
        sections = {s: dict(v) for s, v in self.sections.items()}
        return ParameterSet, (self.name, self.title, self.notes, sections, dict(self.joint))

    def __repr__(self) -> str:
        inside = "; ".join(f"{s}: {', '.join(v)}" for s, v in self.sections.items())
        return f"<ParameterSet {self.name!r} {self.title!r}: {inside}>"

    @property
    def models(self) -> tuple[str, ...]:
        """Names of the models and components the set has a section for."""
        return tuple(s for s in self.sections if s != PARTICULARS)

    def find(self, model: Model, name: str) -> Value | None:
        """Return what the set says of a quantity of a model, or None."""
        for section in (model.name, *(slug(c) for c in model.components), PARTICULARS):
            value = self.sections.get(section, {}).get(name)
            if value is not None:
                return value
        return None

    def particular(self, name: str, unit: str) -> float | None:
        """Return a particular such as ``L`` in SI, or None."""
        value = self.sections.get(PARTICULARS, {}).get(name)
        return None if value is None else value.at(None, unit, f"ship {self.name}")

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
            If a table does not cover the speed.
        """
        return resolve(model, _Lookup(self, model, speed))


class _Lookup(dict[str, float]):
    """The set's own numbers for the quantities of a model, read when asked for."""

    def __init__(self, parameters: ParameterSet, model: Model, speed: float | None) -> None:
        super().__init__()
        for name, entry in model.entries.items():
            found = parameters.find(model, name) if entry.quantity.kind != "given" else None
            if found is not None:
                self[name] = found.at(speed, entry.unit, f"ship {parameters.name}")


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

    equation = model[name].equation
    if equation is None:
        raise _AbsentError(name)
    return float(equation.function(Scope(model[name].owner, lookup)))


def read_parameter_set(path: str | Path) -> ParameterSet:
    """Read a parameter set from a TOML file.

    Parameters
    ----------
    path : str or Path
        The file. Top level: ``name``, ``title``, ``notes``; tables: ``particulars`` and one for each model or
        component, each quantity as ``{value, unit, source}`` with optional ``std``, ``note``, or a table against
        speed, ``{speed = [..], speed_unit, value = [..], unit, source}``.

    Raises
    ------
    ParameterSetError
        If the file cannot be read, or a number has no unit or no source; the message names file, table and entry.
    """
    path = Path(path)
    try:
        raw = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ParameterSetError(f"the parameter set {path} cannot be read: {error.strerror}.") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ParameterSetError(f"the parameter set {path} is not valid TOML: {error}.") from None
    return parse_parameter_set(raw, path)


def parse_parameter_set(raw: dict[str, Any], path: Path) -> ParameterSet:
    """Return a parameter set from what TOML made of it; the path is for messages, and names a set without a name.

    Raises
    ------
    ParameterSetError
        As `read_parameter_set`.
    """
    joint = read_joint(path, raw.pop(IDENTIFIED, {}))
    head = {k: raw.pop(k) for k in list(raw) if k in _HEAD_KEYS}
    for key, text in head.items():
        if key != "schema" and not isinstance(text, str):
            raise ParameterSetError(f"{path}: '{key}' is {text!r}, and has to be text in quotes.")
    sections: dict[str, dict[str, Value]] = {}
    for section, content in raw.items():
        if not isinstance(content, dict):
            raise ParameterSetError(f"{path}: '{section}' stands outside a table. {nearest(section, _HEAD_KEYS)}")
        sections[section] = {n: _value(path, section, n, v) for n, v in content.items()}
    name = head.get("name", path.stem)
    return ParameterSet(name, head.get("title", ""), head.get("notes", ""), sections, joint)


def _value(path: Path, section: str, name: str, raw: Any) -> Value:
    where = f"{path}, [{section}] {name}"
    if isinstance(raw, str):
        raise ParameterSetError(f"{where} is text; write {{ value = 1.2, unit = '...', source = '...' }}.")
    if not isinstance(raw, dict):
        raise ParameterSetError(
            f"{where} is the bare number {raw} with no unit and no source; write "
            f"{{ value = {raw}, unit = '...', source = '...' }}."
        )
    for key in raw:
        if key not in _VALUE_KEYS:
            raise ParameterSetError(f"{where} has an entry '{key}' it does not know. {nearest(key, _VALUE_KEYS)}")
    for key in ("value", "unit", "source"):
        if key not in raw:
            raise ParameterSetError(f"{where} has no {key}.")
    if not str(raw["source"]).strip():
        raise ParameterSetError(f"{where} has an empty source. Say where it comes from; 'assumed' is a source.")
    table = isinstance(raw["value"], list)
    numbers = raw["value"] if table else [raw["value"]]
    if not numbers or not all(_is_finite(n) for n in numbers):
        raise ParameterSetError(f"{where} is {raw['value']}, which is not a finite number.")
    std = raw.get("std")
    if std is not None and not (_is_finite(std) and std >= 0):
        raise ParameterSetError(f"{where} has the standard deviation {std!r}, which is not a number of zero or more.")
    speed = tuple(raw.get("speed", ()))
    if not all(_is_finite(v) for v in speed):
        raise ParameterSetError(f"{where} has a speed that is not a finite number: {list(speed)}.")
    if table and (len(speed) != len(numbers) or list(speed) != sorted(set(speed))):
        raise ParameterSetError(f"{where} needs one speed for each of its {len(numbers)} values, rising.")
    value: float | tuple[float, ...] = tuple(float(n) for n in numbers) if table else float(raw["value"])
    return Value(
        name,
        value,
        str(raw["unit"]),
        str(raw["source"]),
        std=None if std is None else float(std),
        speed=speed,
        speed_unit=raw.get("speed_unit", "m/s"),
        note=raw.get("note", ""),
    )


def _is_finite(number: Any) -> bool:
    return isinstance(number, (int, float)) and not isinstance(number, bool) and abs(number) < float("inf")


def write_parameter_set(parameters: ParameterSet, path: str | Path) -> None:
    """Write a parameter set as TOML, in the form `read_parameter_set` reads.

    Parameters
    ----------
    parameters : ParameterSet
        What to write.
    path : str or Path
        The file; it is replaced in one step.
    """
    import os

    path = Path(path)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    temporary.write_text("\n".join(parameter_lines(parameters)) + "\n", encoding="utf-8")
    temporary.replace(path)


def parameter_lines(parameters: ParameterSet, prefix: str = "") -> list[str]:
    """Return a parameter set as lines of TOML; the prefix stands before the name of each table, with its dot."""
    import json

    def text(value: str) -> str:
        return json.dumps(value, ensure_ascii=False)

    lines = [f"name = {text(parameters.name)}"]
    lines += [f"{k} = {text(v)}" for k, v in (("title", parameters.title), ("notes", parameters.notes)) if v]
    for section, values in parameters.sections.items():
        lines += ["", f"[{prefix}{section if section.replace('-', '').isalnum() else text(section)}]"]
        for v in values.values():
            numbers = list(v.value) if isinstance(v.value, tuple) else v.value
            parts = [f"value = {numbers}", f"unit = {text(v.unit)}"]
            if v.std is not None:
                parts.append(f"std = {v.std}")
            if v.speed:
                parts += [f"speed = {list(v.speed)}", f"speed_unit = {text(v.speed_unit)}"]
            parts.append(f"source = {text(v.source)}")
            if v.note:
                parts.append(f"note = {text(v.note)}")
            lines.append(f"{v.name} = {{ {', '.join(parts)} }}")
    return lines + joint_lines(parameters.joint, prefix)


def parse_value(model: Model, assignment: str) -> tuple[str, float]:
    """Read ``"n3=0.4 s^2/deg^2"`` for a model: the name and its SI number.

    Raises
    ------
    UnitError
        If the value has no unit, or one that does not fit; the message shows both units.
    UnknownNameError
        If the model has no such quantity.
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
    return name, to_si(text, entry.unit, f"'{name}' ({entry.quantity.meaning})")


def missing_values(model: Model, values: Mapping[str, float], ship: str) -> ParameterSetError | None:
    """Return the error that names what a model still lacks, or None when it lacks nothing."""
    lacking = [n for n in model.parameters + model.constants if n not in values]
    if not lacking:
        return None
    named = ", ".join(f"{n} [{pretty(model[n].unit)}]" for n in lacking)
    return ParameterSetError(
        f"model {model.name} needs {named}, which {ship} does not hold. Give them, as in --fix "
        f"'{lacking[0]}=1.0 {pretty(model[lacking[0]].unit)}', or take a ship that has a [{model.name}] table."
    )
