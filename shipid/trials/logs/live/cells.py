"""Cells of a table as it is written that are no plain numbers: a clock in several columns, and angles with letters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from shipid.trials.logs.clocks.headers import find_clock
from shipid.trials.logs.clocks.parts import of_parts, with_thousandths
from shipid.trials.logs.tables.lettered import read_lettered


@dataclass(frozen=True)
class ClockColumns:
    """Where the clock of a table stands, and how its cells are put together.

    Attributes
    ----------
    headers : tuple of str
        The columns it is read from; none where no column is a clock for certain.
    others : tuple of str
        Columns that are dates or times as well.
    written : dict of str to pandas.Series
        The first rows, by the headers of the clock that they make.
    cells : callable
        Puts the cells of a row together, in the order of `headers`.
    """

    headers: tuple[str, ...]
    others: tuple[str, ...]
    written: dict[str, pd.Series]
    cells: Callable[[Sequence[str]], list[str]]


def clock_columns_of(table: Mapping[str, pd.Series]) -> ClockColumns:
    """Find the clock of a table in its first rows, as in the whole table.

    Parameters
    ----------
    table : Mapping of str to pandas.Series
        The first rows by header, numbers with a decimal point.

    Returns
    -------
    ClockColumns
    """
    numbers = {header: column.map(plain_number).astype(float) for header, column in table.items()}
    plain = {header: column for header, column in numbers.items() if column.notna().all()}
    found, others = find_clock(table)
    parts = of_parts(plain)
    if parts is not None and (not found or found[-1] in parts[2]):
        name, column, used = parts

        def joined(cells: Sequence[str]) -> list[str]:
            made = of_parts({h: pd.Series([plain_number(cell)], dtype=float) for h, cell in zip(used, cells)})
            return ["" if made is None else str(made[1].iloc[0])]

        rest = {header: column for header, column in table.items() if header not in used}
        return ClockColumns(used, find_clock({name: column, **rest})[1], {name: column}, joined)
    written = {header: table[header] for header in found}
    fraction = with_thousandths(table[found[-1]], plain) if found else None
    if fraction is None:
        return ClockColumns(found, others, written, list)
    beside = fraction[1]

    def with_fraction(cells: Sequence[str]) -> list[str]:
        *first, time, part = cells
        made = with_thousandths(pd.Series([time], dtype=object), {beside: pd.Series([plain_number(part)], dtype=float)})
        return [*first, "" if made is None else str(made[0].iloc[0])]

    return ClockColumns((*found, beside), others, written | {found[-1]: fraction[0]}, with_fraction)


def plain_number(cell: str) -> float:
    """Return the number in a cell with a decimal point; NaN where it is none.

    Parameters
    ----------
    cell : str
        The cell.
    """
    try:
        return float(cell)
    except ValueError:
        return float("nan")


class LetteredCells:
    """A column of angles with letters for their sides, or with degrees and minutes.

    What a letter says may depend on the others of the column: ``S`` is south, or starboard beside ``P``. A cell is read in the
    light of those before it.

    Attributes
    ----------
    said : str
        How the cells are read; empty where none was.
    """

    def __init__(self) -> None:
        self.said = ""
        self._seen: dict[str, str] = {}

    def read(self, cell: str) -> float:
        """Return the angle in a cell in degrees; NaN where it is none, or its letter leaves the side open.

        Parameters
        ----------
        cell : str
            As printed.
        """
        letters = "".join(sign for sign in cell.upper() if sign.isalpha())
        found = read_lettered(pd.Series([*(c for w, c in self._seen.items() if w != letters), cell], dtype="str"))
        if found is None and len(self._seen) > 1:
            return float("nan")
        if letters and len(letters) <= 4:
            self._seen.setdefault(letters, cell)
        if found is None:
            return float("nan")
        values, self.said = found
        return float(values[-1])

    def fits(self, value: float) -> bool:
        """Return whether a plain number can stand in the column: beside letters only zero has none.

        Parameters
        ----------
        value : float
            The number.
        """
        return not self.said or not any(self._seen) or value == 0 or bool(np.isnan(value))
