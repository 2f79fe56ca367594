"""Units that stand behind the numbers, in the cells: ``12.3 deg``, ``12.3°``, ``0.5 deg/s``, as spreadsheets and displays write them."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from shipid.declaration import units
from shipid.foundation.errors import UnitError
from shipid.trials import columns as spelling
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.tables.numerals import MISSING, Decimal, certain_sign
from shipid.trials.logs.tables.table import RawTable

_NUMBER = r"[-+\u2212]?(?:[0-9][0-9.,]*|[.,][0-9]+)(?:[eEdD][-+]?[0-9]{1,4})?"
#: A number or a mark of a missing one, and behind it what begins with no digit.
_CELL = re.compile(
    rf"(?P<number>{_NUMBER}|(?i:nan|n/a|--?-?))\s*[\[(]?\s*(?P<unit>(?![eEdD][-+]?[0-9])[^\W\d_][^\[\]()]{{0,29}}|[°º%][^\[\]()]{{0,29}})\s*[\])]?"
)
#: What follows a number and is no unit: letters of the side, true and magnetic, halves of the day.
_OTHERS = frozenset(
    ("n", "s", "e", "w", "o", "p", "t", "b", "r", "l", "sb", "ps", "bb", "stb", "stbd", "port", "pt", "am", "pm", "a", "z")
)  # fmt: skip


@functools.cache
def _is_unit(text: str) -> bool:
    words = text.replace("°", " ").replace("º", " ").split()
    # A small s is the second, a small m the metre.
    if any(word == "M" or (word != "s" and word.lower().rstrip(".") in _OTHERS) for word in words):
        return False
    try:
        units.unit(spelling.spelt(text))
    except UnitError:
        return False
    return True


def unit_of_cell(cell: str) -> str | None:
    """Return the unit behind the number of a cell; None where it is no number with a unit.

    Parameters
    ----------
    cell : str
        The cell: ``12.3 deg``.
    """
    apart = number_and_unit(cell)
    return apart[1] if apart else None


def number_and_unit(cell: str) -> tuple[str, str] | None:
    """Return the number of a cell, as it is written, and the unit behind it; None where it is no number with a unit.

    Parameters
    ----------
    cell : str
        The cell: ``12.3 deg``.
    """
    match = _CELL.fullmatch(cell.strip().strip("\"'").strip()) if len(cell) < 100 else None
    said = match["unit"].strip() if match else ""
    return (match["number"], said) if match and said and _is_unit(said) else None


def same_unit(one: str, other: str) -> bool:
    """Return whether two texts are one unit, however they are spelt.

    Parameters
    ----------
    one, other : str
        As a logger writes them: ``°``, ``deg``.
    """
    try:
        return bool(units.unit(spelling.spelt(one)) == units.unit(spelling.spelt(other)))
    except UnitError:
        return False


def stated_units(fmt: TrialFormat | None) -> dict[str | int, str]:
    """Return the units that a format file states, by header or index.

    Parameters
    ----------
    fmt : TrialFormat or None
        The format.
    """
    columns = fmt.columns.values() if fmt else ()
    places = ((c.column if c.column is not None else c.index, c.unit) for c in columns)
    return {place: unit for place, unit in places if place is not None and unit}


def with_cell_units(raw: RawTable, stated: Mapping[str | int, str]) -> RawTable:
    """Take the unit of a column from its cells, where each of them says the same one and neither header nor format another.

    Parameters
    ----------
    raw : RawTable
        As the file holds it.
    stated : mapping of str or int to str
        The units that a format file states, by header or index.

    Returns
    -------
    RawTable
        A note says which columns were read so. Other columns stay as they are; those whose cells say several units, or another one than the
        column's, are named in its `conflicts`.
    """
    columns, beside, notes = list(raw.columns), list(raw.units), list(raw.notes)
    beside += [None] * (len(columns) - len(beside))
    decimal: Decimal | None = raw.decimal
    conflicts: dict[int, tuple[int, str]] = {}
    for k, column in enumerate(columns):
        if not (column.dtype.kind == "O" or isinstance(column.dtype, pd.StringDtype)):
            continue
        header = raw.headers[k] if k < len(raw.headers) else ""
        said = stated.get(k) or stated.get(header) or beside[k] or spelling.split_header(header)[1]
        name = spelling.split_header(header)[0] or f"number {k}"
        try:
            found = _split(column, said)
        except _ConflictError as conflict:
            # A column that nothing uses is no fault.
            at = int(np.flatnonzero(column.index == conflict.at)[0])
            beside[k] = beside[k] or said or conflict.first
            conflicts[k] = at, f"the cell says the unit {conflict.unit}, {conflict.other}"
            continue
        if found is None:
            continue
        columns[k], unit = found
        if said is None:
            beside[k] = unit
        notes.append(f"Column '{name}': each cell says the unit {unit}.")
        decimal = decimal or next((sign for cell in columns[k].dropna() if (sign := certain_sign(cell))), None)
    return replace(
        raw, columns=tuple(columns), units=tuple(beside), notes=tuple(notes), decimal=decimal, conflicts=conflicts
    )


class _ConflictError(Exception):
    """A cell says another unit than its column or another cell."""

    def __init__(self, at: int, unit: str, other: str, first: str) -> None:
        super().__init__(unit)
        self.at, self.unit, self.other, self.first = at, unit, other, first


def _split(column: pd.Series, said: str | None) -> tuple[pd.Series, str] | None:
    """The cells without their unit, and the unit; None where they say none, several, or another one than is said."""
    texts = column.dropna()
    first = next((cell for cell in texts if isinstance(cell, str) and cell.strip().lower() not in MISSING), None)
    if first is None or (unit_of_cell(first) is None and (said is None or not _is_plain(first))):
        return None
    if not texts.map(lambda cell: isinstance(cell, str)).all():
        return None
    cells = texts.astype("str").str.strip().str.strip("\"'").str.strip()
    parts = cells.str.extract(f"^{_CELL.pattern}$")
    there = ~cells.str.lower().isin(list(MISSING)).to_numpy(dtype=bool)
    seen = parts["unit"].str.strip()
    bare = there & seen.isna().to_numpy()
    # A bare number beside others with a unit has that of the column, where something says it.
    if bare.any() and (said is None or not cells[bare].map(_is_plain).all()):
        return None
    found = seen.dropna().unique().tolist()
    if not found or not all(map(_is_unit, found)):
        return None
    other = next((u for u in found if not same_unit(u, said or found[0])), None)
    if other is not None:
        what = f"and the column {said}" if said else f"and cells above it {found[0]}"
        raise _ConflictError(seen.index[seen == other][0], other, what, found[0])
    numbers = column.astype(object).copy()
    numbers[texts.index] = np.where(seen.notna(), parts["number"], cells)
    return numbers.astype("str").where(numbers.notna()), found[0]


def _is_plain(cell: str) -> bool:
    return re.fullmatch(_NUMBER, cell.strip()) is not None
