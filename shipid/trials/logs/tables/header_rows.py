"""Where the samples of a table begin, and which rows above them hold names and units."""

from __future__ import annotations

import datetime
import functools
import re
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from shipid.declaration import units
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UnitError
from shipid.trials import columns
from shipid.trials.errors import HeaderError
from shipid.trials.logs.tables.cell_units import unit_of_cell
from shipid.trials.logs.tables.numerals import is_missing, is_number, tidy

#: What a cell of a sheet can hold; a cell of a text file is text.
Cell: TypeAlias = "str | float | bool | datetime.date | datetime.time | datetime.timedelta | None"
_Sort = Literal["number", "stamp", "empty", "text"]

#: A longer cell is text.
_LONGEST_CELL = 500
_STAMP = re.compile(
    r"(?=.*[0-9].*[:/.T-].*[0-9])[0-9]{1,4}[-/.:][0-9A-Za-z]{1,9}(?:[-/.:][0-9]{1,4})?[-T :,.0-9+Z/]*(?:[AaPp]\.?[Mm]\.?|UTC|GMT)?"
)
#: What stands in a row of units over a clock that is written as text.
_CLOCK_LAYOUT = re.compile(
    r"[%hHmMsSyYdDtTzZfF:/\-. ]+|utc|gmt|local( time)?|iso.*|date( ?/? ?time)?|time", re.IGNORECASE
)
_BRACKETS = re.compile(r"[\[(]\s*(.*?)\s*[\])]")


@dataclass(frozen=True)
class HeaderBlock:
    """The header of a table, and where its samples begin.

    Attributes
    ----------
    first : int
        Index of the row of the first sample.
    width : int
        Number of columns.
    row : int or None
        Index of the row of names; None where no row names the columns.
    names : tuple of str
        One name a column, empty where there is none; with its unit where it stands beside the name.
    units : tuple of str or None
        The units that stand in a row of their own.
    unused : tuple of int
        Indices of rows above the samples that are neither.
    sound : float
        The share of the samples' cells that are numbers, times, or empty.
    """

    first: int
    width: int
    row: int | None
    names: tuple[str, ...]
    units: tuple[str | None, ...]
    unused: tuple[int, ...]
    sound: float


def sort_of(cell: Cell) -> _Sort:
    """Return what a cell holds: a number, a time, nothing, or text.

    Parameters
    ----------
    cell : str, number, date or None
        The cell.
    """
    if cell is None:
        return "empty"
    if isinstance(cell, (datetime.date, datetime.time, datetime.timedelta)):
        return "stamp"
    if not isinstance(cell, str):
        return "text" if isinstance(cell, bool) else "number"
    return "text" if len(cell) > _LONGEST_CELL else _sort_of_text(cell)


@functools.lru_cache(maxsize=1 << 14)
def _sort_of_text(cell: str) -> _Sort:
    """What a cell of text holds, once for every separator that is tried and every row that is written alike."""
    text = tidy(cell)
    if is_missing(text):
        return "empty"
    if is_number(cell):
        return "number"
    if len(cell) < 60 and _STAMP.fullmatch(text):
        return "stamp"
    return "number" if unit_of_cell(cell) is not None else "text"


def find_heading(rows: Sequence[Sequence[Cell]], wanted: Collection[str], where: str) -> HeaderBlock | None:
    """Find the first sample of a table, and the rows of names and units above it.

    Parameters
    ----------
    rows : sequence of sequences of cells
        The first rows of a file, without those that are blank.
    wanted : collection of str
        Headers that a format file names.
    where : str
        File, for messages.

    Returns
    -------
    HeaderBlock or None
        None where there is no sample: no row of numbers of the width that most rows have.

    Raises
    ------
    HeaderError
        If a column has two units.
    """
    sorts = [[sort_of(cell) for cell in row] for row in rows]
    lengths = Counter(len(row) for row in sorts[len(sorts) // 2 :] if "number" in row)
    if not lengths:
        lengths = Counter(len(row) for row in sorts if "number" in row)
    if not lengths:
        return None
    width = lengths.most_common(1)[0][0]
    full = [k for k, row in enumerate(sorts) if len(row) == width]
    body = [sorts[k] for k in full[len(full) // 2 :]]
    numeric = [k for k, column in enumerate(zip(*body)) if _is_numeric(column)]
    first = next((k for k in full if _is_sample(sorts[k], numeric, 0)), None)
    if first is None:
        return None
    # A bad cell makes no header of a sample; "Draught, 5.7, 6.1" above the names makes no sample.
    while first and len(sorts[first - 1]) == width and _is_sample(sorts[first - 1], numeric, width):
        first -= 1
    samples = [row for row in sorts[first:] if len(row) == width]
    counted = Counter(sort for row in samples for sort in row if sort != "empty")
    sound = 1 - counted["text"] / max(counted.total(), 1)
    sound *= len(samples) / len(sorts[first:])
    texts = [["" if cell is None else str(cell).strip() for cell in row] for row in rows[:first]]
    # A remark beside a table of a workbook makes every row as wide, and the header no longer.
    used = sum(any(sort != "empty" for sort in column) for column in zip(*body))
    likely = [k for k, row in enumerate(texts) if sum(map(bool, row)) >= max(2, used / 2) and "text" in sorts[k]]
    of_units = next((k for k in reversed(likely) if _is_row_of_units(texts[k])), None) if len(likely) > 1 else None
    named = [k for k in likely if k != of_units]
    if not named:
        return HeaderBlock(first, width, None, (), (), tuple(range(first)), sound)
    # Of rows that look alike names stand above their units; what stands below, as of devices, is told twice or more.
    above = len(rows) if of_units is None else of_units
    row = max(named, key=lambda k: (_score(texts[k], wanted), k < above, _all_differ(texts[k]), k))
    stated: tuple[str | None, ...] = (None,) * width
    if of_units is not None:
        stated = tuple(_unit(cell) for cell in _padded(texts[of_units], width))
        _check_agreement(texts[row], stated, where)
    unused = tuple(k for k in range(first) if k not in (row, of_units))
    return HeaderBlock(first, width, row, tuple(texts[row]), stated, unused, sound)


def is_sample_row(row: Sequence[Cell]) -> bool:
    """Return whether a row holds more numbers and times than text.

    Parameters
    ----------
    row : sequence of cells
        The row.
    """
    sorts = [sort_of(cell) for cell in row]
    return sorts.count("number") + sorts.count("stamp") > sorts.count("text")


def _padded(row: Sequence[str], width: int) -> list[str]:
    return [*row[:width], *[""] * (width - len(row))]


def _is_numeric(column: Sequence[_Sort]) -> bool:
    """Whether most cells of a column that hold something are numbers or times."""
    there = [sort for sort in column if sort != "empty"]
    return sum(sort in ("number", "stamp") for sort in there) * 2 > len(there)


def _is_sample(row: Sequence[_Sort], numeric: Sequence[int], most_bad: int) -> bool:
    """Whether a row holds numbers and times in the columns that do: more of them than of text."""
    inside = [row[k] for k in numeric]
    good, bad = sum(sort in ("number", "stamp") for sort in inside), inside.count("text")
    return good > bad and bad <= most_bad


def _score(row: Sequence[str], wanted: Collection[str]) -> int:
    """How much a row looks like the names of a log's columns."""
    score = 0
    for cell in row:
        name, unit = columns.split_header(cell)
        score += 4 * (cell in wanted or name in wanted) + 2 * (name in FIELDS) + (unit is not None)
    return score


def _all_differ(row: Sequence[str]) -> bool:
    there = [cell for cell in row if cell]
    return len(set(there)) == len(there)


def _unit(cell: str) -> str | None:
    """The unit in a cell of a row of units; None for an empty cell and for the layout of a clock."""
    match = _BRACKETS.fullmatch(cell)
    text = match[1] if match else cell
    if not text or (_CLOCK_LAYOUT.fullmatch(text) and len(text) > 3):
        return None
    return "1" if text in ("-", "--") else text


def _is_row_of_units(row: Sequence[str]) -> bool:
    there = [cell for cell in row if cell]
    known = sum(1 for cell in there if _BRACKETS.fullmatch(cell) or _is_unit(cell))
    names = sum(
        1 for cell in there if columns.split_header(cell)[0] in FIELDS and columns.split_header(cell)[0] not in _ALSO
    )
    return known > 0.7 * len(there) and not names * 2 > len(there)


#: Names of the vocabulary that are units as well.
_ALSO = ("t", "u", "n", "h", "r", "p", "v", "N")


def _is_unit(cell: str) -> bool:
    unit = _unit(cell)
    if unit is None:
        return True
    try:
        units.unit(columns.spelt(unit))
    except UnitError:
        return False
    return True


def _check_agreement(names: Sequence[str], stated: Sequence[str | None], where: str) -> None:
    for header, unit in zip(names, stated):
        name, beside = columns.split_header(header)
        if beside and unit and columns.spelt(beside) != columns.spelt(unit):
            raise HeaderError(
                f"{where}: column '{name}' says the unit {beside} beside its name and {unit} in the row of units. Correct one."
            )


def blank(row: Sequence[Cell]) -> bool:
    """Return whether a row holds nothing.

    Parameters
    ----------
    row : sequence of cells
        The row.
    """
    return all(cell is None or (isinstance(cell, str) and not cell.strip()) for cell in row)
