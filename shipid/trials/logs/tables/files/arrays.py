"""Tables in files of named arrays (MATLAB, HDF5): structs and groups whose arrays are equally long."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pandas as pd

from shipid.trials.columns import split_header
from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.tables.choosing import Candidate, chosen
from shipid.trials.logs.tables.table import MOST_COLUMNS, RawTable

#: Entries that name the columns of a matrix, or their units.
_NAMES = ("names", "columns", "labels", "header", "headers", "colnames", "variables", "channels", "name")
_UNITS = ("units", "unit")
_SINCE = re.compile(r"\s*(\w+)\s+since\s+(\S.*?)\s*")


@dataclass(frozen=True, eq=False)
class Array:
    """An array of a file.

    Attributes
    ----------
    values : ndarray
        Numbers, texts, or records with named fields.
    unit : str or None
        Where it is stated beside the array.
    names, units : tuple of str
        Of the columns of a matrix, where they stand beside it.
    """

    values: np.ndarray
    unit: str | None = None
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Unreadable:
    """Something that only the program which wrote it can read.

    Attributes
    ----------
    what : str
        What it is.
    """

    what: str


Node: TypeAlias = "Array | Unreadable | Mapping[str, Node]"


@dataclass
class _Table:
    """Columns that belong together."""

    headers: list[str] = field(default_factory=list)
    columns: list[np.ndarray] = field(default_factory=list)
    units: list[str | None] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def add(self, name: str, values: np.ndarray, unit: str | None) -> None:
        since = _SINCE.fullmatch(unit or "")
        if since is not None:  # as climate and ocean data count time
            unit = since[1]
            self.notes.append(f"'{name}' counts {unit} since {since[2][:40]}.")
        self.headers.append(name)
        self.columns.append(values)
        self.units.append(unit)


def read_arrays(
    root: Mapping[str, Node], file: Path, wanted: str | None, columns: Collection[str], kind: str
) -> RawTable:
    """Read a table out of named arrays.

    Parameters
    ----------
    root : Mapping of str to node
        What the file holds.
    file : Path
        The file, for messages.
    wanted : str or None
        The struct or group that is wanted: ``run2``, ``campaign/run2``.
    columns : collection of str
        Headers that a format file names.
    kind : str
        What a table is called: struct or group.

    Returns
    -------
    RawTable

    Raises
    ------
    ChoiceError
        If the table is not there, or has to be named.
    EmptyFileError
        If there is no table.
    """
    found: dict[str, _Table] = {}
    unreadable: list[str] = []
    _collect(root, "", found, unreadable)
    if not found:
        names = ", ".join(f"'{name}'" for name in list(root)[:20]) or "nothing"
        only = (
            f" It holds {unreadable[0]}: write the columns as plain arrays of numbers in a struct."
            if unreadable
            else ""
        )
        raise EmptyFileError(
            f"'{file}' holds no table: no {kind} with two or more columns of numbers, equally long, in {names}.{only}"
        )
    candidates = [
        Candidate(path or "/", tuple(t.headers), partial(_raw, file, path, t, kind)) for path, t in found.items()
    ]
    return chosen(candidates, wanted.strip("/") or "/" if wanted is not None else None, columns, kind, f"'{file}'")


def _raw(file: Path, path: str, table: _Table, kind: str, notes: tuple[str, ...]) -> RawTable:
    return RawTable(
        name=file.stem,
        where=f"'{file}', {kind} '{path}'" if path else f"'{file}'",
        headers=tuple(table.headers),
        columns=tuple(pd.Series(_native(values)) for values in table.columns),
        units=tuple(table.units),
        notes=(*notes, *table.notes),
    )


def _native(values: np.ndarray) -> np.ndarray:
    """An array that pandas takes: in the byte order of the machine, half precision as single, texts as objects."""
    if values.dtype.kind in "SU":
        return np.array(
            [v.decode("utf-8", "replace") if isinstance(v, bytes) else str(v) for v in values], dtype=object
        )
    if values.dtype.kind == "f":
        return np.ascontiguousarray(values, dtype=np.float64)
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))


def _collect(group: Mapping[str, Node], path: str, found: dict[str, _Table], unreadable: list[str]) -> None:
    """Gather the tables of a group and of those in it."""
    table = _columns_of(group)
    if table is not None:
        found[path] = table
    for name, node in group.items():
        inner = f"{path}/{name}" if path else name
        if isinstance(node, Unreadable):
            unreadable.append(f"'{inner}', {node.what}")
        elif isinstance(node, Mapping):
            if name.lower() not in _UNITS:
                _collect(node, inner, found, unreadable)
        elif (matrix := _matrix_of(node, group)) is not None:
            found[inner] = matrix


def _columns_of(group: Mapping[str, Node]) -> _Table | None:
    """The arrays of a group that are as long as most of them."""
    arrays = {
        name: flat
        for name, node in group.items()
        if isinstance(node, Array) and (flat := _flat(node.values)) is not None
    }
    lengths = Counter(len(values) for name, values in arrays.items() if values.dtype.kind in "fiu" and len(values) > 1)
    if not lengths:
        return None
    length, count = max(lengths.items(), key=lambda item: (item[1], item[0]))
    if count < 2:
        return None
    units = _units_of(group)
    table = _Table()
    for name, values in arrays.items():
        if len(values) == length and name.lower() not in (*_NAMES, *_UNITS):
            node = group[name]
            stated = node.unit if isinstance(node, Array) else None
            table.add(name, values, stated or units.get(name))
    others = [
        name
        for name, values in arrays.items()
        if len(values) != length and values.dtype.kind in "fiu" and len(values) > 1
    ]
    if others:
        shown = ", ".join(f"'{name}'" for name in others[:5]) + (", ..." if len(others) > 5 else "")
        table.notes.append(f"Not as long as the other columns, and left out: {shown}.")
    return table if len(table.columns) <= MOST_COLUMNS else None


def _flat(values: np.ndarray) -> np.ndarray | None:
    """A column: an array with one dimension that is longer than one; None for anything else."""
    if values.dtype.names is not None or values.dtype.kind not in "fiubSUMm":
        return None
    flat = values.reshape(-1) if values.size == max(values.shape, default=0) else None
    return flat if flat is not None and flat.ndim == 1 else None


def _matrix_of(node: Array, group: Mapping[str, Node]) -> _Table | None:
    """The table in a matrix whose columns are named beside it, or in an array of records."""
    values = node.values
    if values.dtype.names is not None and values.ndim == 1 and len(values) > 1:
        table = _Table()
        for k, name in enumerate(values.dtype.names):
            column = values[name]
            if column.ndim == 1 and column.dtype.kind in "fiubSUMm":
                table.add(name, column, node.units[k] if k < len(node.units) else None)
        return table if len(table.columns) > 1 else None
    if values.ndim != 2 or values.dtype.kind not in "fiu" or min(values.shape) < 2:
        return None
    names = node.names or _texts(group, _NAMES)
    # As many columns as names, whichever way round it lies; without names the shorter side is that of the columns.
    if (names and len(names) == values.shape[0] != values.shape[1]) or (
        not names and values.shape[0] < values.shape[1]
    ):
        values = values.T
    if values.shape[1] > MOST_COLUMNS or (names and len(names) != values.shape[1]):
        return None
    units = node.units or _texts(group, _UNITS)
    table = _Table()
    for k in range(values.shape[1]):
        table.add(names[k] if names else "", values[:, k], units[k] if len(units) == values.shape[1] else None)
    return table


def _texts(group: Mapping[str, Node], keys: Collection[str]) -> tuple[str, ...]:
    """The texts under one of some names in a group."""
    for name, node in group.items():
        if name.lower() in keys and isinstance(node, Array) and node.values.dtype.kind in "SUO":
            cells = node.values.reshape(-1)
            return tuple(c.decode("utf-8", "replace") if isinstance(c, bytes) else str(c) for c in cells)
    return ()


def _units_of(group: Mapping[str, Node]) -> dict[str, str]:
    """Units by name of a column: in a group of units, as a list in the order of the columns, or as ``psi_unit``."""
    units: dict[str, str] = {}
    plain = [
        n
        for n, node in group.items()
        if isinstance(node, Array) and node.values.dtype.kind in "fiu" and node.values.size > 1
    ]
    for name, node in group.items():
        text = _text(node)
        stem = next((name[: -len(end)] for end in ("_units", "_unit") if name.lower().endswith(end)), None)
        if stem is not None and text is not None:
            units[stem] = text
        elif name.lower() in _UNITS and isinstance(node, Mapping):
            units |= {inner: unit for inner, leaf in node.items() if (unit := _text(leaf)) is not None}
        elif name.lower() in _UNITS:
            listed = _texts(group, (name.lower(),))
            units |= dict(zip(plain, listed)) if len(listed) == len(plain) else {}
    return {name: unit for name, unit in units.items() if split_header(name)[1] is None}


def _text(node: Node) -> str | None:
    if isinstance(node, Array) and node.values.dtype.kind in "SUO" and node.values.size == 1:
        cell = node.values.reshape(-1)[0]
        return cell.decode("utf-8", "replace") if isinstance(cell, bytes) else str(cell)
    return None
