"""Parameter sets as TOML files: read with every entry checked, written whole or not at all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import tomli_w

from shipid.declaration.tables import Table, is_finite, read_table
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ParameterSetError, nearest
from shipid.foundation.replacing import write_text
from shipid.parameters.correlation import IDENTIFIED, joint_table, read_joint
from shipid.parameters.parameter_set import ParameterSet, Value

#: Entries of a value, and of the file beside its tables.
VALUE_KEYS = ("value", "unit", "source", "std", "speed", "speed_unit", "note")
HEAD_KEYS = ("name", "title", "notes", "schema")


def read_parameter_set(path: str | Path) -> ParameterSet:
    """Read a parameter set from a TOML file.

    Parameters
    ----------
    path : str or Path
        The file. Top level: ``name``, ``title``, ``notes``; tables: ``particulars`` and one for each model or
        component, each quantity as ``{value, unit, source}`` with optional ``std``, ``note``, or a table against
        speed, ``{speed = [..], speed_unit, value = [..], unit, source}``.

    Returns
    -------
    ParameterSet

    Raises
    ------
    ParameterSetError
        If the file cannot be read, or a number has no unit or no source; the message names file, table and entry.
    """
    return parse_parameter_set(read_table(Path(path), "parameter set", ParameterSetError), Path(path).stem)


def parse_parameter_set(table: Table, name: str) -> ParameterSet:
    """Return a parameter set from a table of a TOML file.

    Parameters
    ----------
    table : Table
        The parsed table.
    name : str
        Of a set that says no name.

    Returns
    -------
    ParameterSet

    Raises
    ------
    ParameterSetError
        As `read_parameter_set`.
    """
    head = {k: table.value(k, str) for k in HEAD_KEYS if k in table and k != "schema"}
    sections: dict[str, dict[str, Value]] = {}
    for section in table:
        if section in (*HEAD_KEYS, IDENTIFIED):
            continue
        if not isinstance(table.content[section], Mapping):
            raise table.fail(f"'{section}' stands outside a table. {nearest(section, HEAD_KEYS)}")
        inside = table.table(section)
        sections[section] = {n: _value(inside, n) for n in inside}
    joint = read_joint(table.where, table.content.get(IDENTIFIED, {}))
    return ParameterSet(head.get("name", name), head.get("title", ""), head.get("notes", ""), sections, joint)


def _value(section: Table, name: str) -> Value:
    raw = section.content[name]
    where = f"{section.where} {name}"
    if isinstance(raw, str):
        raise ParameterSetError(f"{where} is text; write {{ value = 1.2, unit = '...', source = '...' }}.")
    if not isinstance(raw, Mapping):
        raise ParameterSetError(
            f"{where} is the bare number {raw} with no unit and no source; write "
            f"{{ value = {raw}, unit = '...', source = '...' }}."
        )
    for key in raw:
        if key not in VALUE_KEYS:
            raise ParameterSetError(f"{where} has an entry '{key}' it does not know. {nearest(key, VALUE_KEYS)}")
    for key in ("value", "unit", "source"):
        if key not in raw:
            raise ParameterSetError(f"{where} has no {key}.")
    if not str(raw["source"]).strip():
        raise ParameterSetError(f"{where} has an empty source. Say where it comes from; 'assumed' is a source.")
    table = isinstance(raw["value"], list)
    numbers = raw["value"] if table else [raw["value"]]
    if not numbers or not all(is_finite(n) for n in numbers):
        raise ParameterSetError(f"{where} is {raw['value']!r}, which is not a finite number.")
    std = raw.get("std")
    if std is not None and not (is_finite(std) and std >= 0):
        raise ParameterSetError(f"{where} has the standard deviation {std!r}, which is not a number of zero or more.")
    speed = tuple(raw.get("speed", ()))
    if not all(is_finite(v) for v in speed):
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
        speed_unit=str(raw.get("speed_unit", "m/s")),
        note=str(raw.get("note", "")),
    )


def write_parameter_set(parameters: ParameterSet, path: str | Path) -> None:
    """Write a parameter set as TOML, in the form `read_parameter_set` reads.

    Parameters
    ----------
    parameters : ParameterSet
        What to write.
    path : str or Path
        The file; it is replaced in one step.

    Raises
    ------
    ParameterSetError
        If a model is called as an entry of the file.
    """
    write_text(Path(path), tomli_w.dumps(parameter_table(parameters)))


def parameter_table(parameters: ParameterSet) -> dict[str, Plain]:
    """Return a parameter set as the table that TOML writes.

    Parameters
    ----------
    parameters : ParameterSet
        What to write.

    Returns
    -------
    dict of str to Plain
        What `parse_parameter_set` reads.

    Raises
    ------
    ParameterSetError
        If a section is called as an entry of the file.
    """
    for section in parameters.sections:
        if section in (*HEAD_KEYS, IDENTIFIED):
            raise ParameterSetError(
                f"a model called '{section}' has no place in a parameter set, which has an entry of that name. Call it otherwise."
            )
    head = {"name": parameters.name, "title": parameters.title, "notes": parameters.notes}
    table: dict[str, Plain] = {k: v for k, v in head.items() if v or k == "name"}
    for section, values in parameters.sections.items():
        table[section] = {v.name: _entry(v) for v in values.values()}
    return table | joint_table(parameters.joint)


def _entry(value: Value) -> dict[str, Plain]:
    speeds = {"speed": list(value.speed), "speed_unit": value.speed_unit} if value.speed else {}
    return {
        "value": list(value.value) if isinstance(value.value, tuple) else value.value,
        "unit": value.unit,
        **({} if value.std is None else {"std": value.std}),
        **speeds,
        "source": value.source,
        **({"note": value.note} if value.note else {}),
    }
