"""Sheets of Excel workbooks, by openpyxl: the values as they were saved; nothing is computed, no macro is run."""

from __future__ import annotations

import datetime
import io
import itertools
import zipfile
from collections.abc import Collection, Iterator, Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.trials.errors import DamagedFileError, EmptyFileError, FileSizeError, HeaderError, TrialError
from shipid.trials.logs.tables.choosing import Candidate, chosen
from shipid.trials.logs.tables.header_rows import Cell, HeaderBlock, blank, find_heading
from shipid.trials.logs.tables.opening import LARGEST
from shipid.trials.logs.tables.table import MOST_COLUMNS, RawTable

#: Rows that are looked at to find a header; cells that a sheet may have; sheets of a workbook.
_HEAD, _MOST_CELLS, _MOST_SHEETS = 200, 8_000_000, 200


def read_excel(data: bytes, file: Path, sheet: str | None, columns: Collection[str]) -> RawTable:
    """Read a sheet of a workbook.

    Parameters
    ----------
    data : bytes
        The workbook.
    file : Path
        The file, for messages.
    sheet : str or None
        The sheet that is wanted; the only one that looks like a trial by default.
    columns : collection of str
        Headers that a format file names.

    Returns
    -------
    RawTable

    Raises
    ------
    MissingExtraError
        If openpyxl is not installed.
    ChoiceError
        If the sheet is not there, or has to be named.
    EmptyFileError
        If no sheet holds a table of numbers under a header.
    DamagedFileError
        If the workbook cannot be read.
    FileSizeError
        If it expands to more than is read.
    """
    try:
        import openpyxl
    except ImportError:
        raise MissingExtraError(f"the workbook '{file}'", "openpyxl", "excel", "Or save the sheet as CSV.") from None
    _check_size(data, file)
    try:
        book = openpyxl.load_workbook(io.BytesIO(data), read_only=True, data_only=True, keep_links=False)
        sheets = [s for s in book.worksheets if hasattr(s, "iter_rows")][:_MOST_SHEETS]
        candidates = [found for s in sheets if (found := _candidate(s, file, columns)) is not None]
        if not candidates:
            names = ", ".join(f"'{s.title}'" for s in sheets[:20])
            raise EmptyFileError(
                f"'{file}' has no sheet with a table of numbers under a header: {names}. Write a row of names with units, "
                "such as 't [s]' and 'psi [deg]', and one row for every sample."
            )
        return chosen(candidates, sheet, columns, "sheet", f"'{file}'")
    except TrialError:
        raise
    except Exception:  # a damaged workbook fails in as many ways as there are parts in it
        raise DamagedFileError(
            f"'{file}' is a damaged Excel workbook. Check that it was copied completely, or save it anew."
        ) from None


def _check_size(data: bytes, file: Path) -> None:
    """Judge a workbook by what it expands to, before it is parsed."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        size = sum(member.file_size for member in archive.infolist())
    if size > LARGEST:
        raise FileSizeError(
            f"'{file}' expands to {size // 1_000_000} MB, and at most {LARGEST // 1_000_000} MB are read. Save the sheet with the "
            "trial in a workbook of its own."
        )


def _candidate(sheet: Plain, file: Path, columns: Collection[str]) -> Candidate | None:
    """A sheet that holds numbers under a header."""
    where = f"'{file}', sheet '{sheet.title}'"
    numbered = list(itertools.islice(_rows(sheet, where), _HEAD))
    rows = _of_one_width([cells for _, cells in numbered])
    heading = find_heading(rows, columns, where)
    if heading is None or heading.row is None or heading.sound <= 0.5:
        return None
    at = [number for number, _ in numbered]
    hidden = getattr(sheet, "sheet_state", "visible") != "visible"
    return Candidate(sheet.title, heading.names, partial(_read, sheet, file, heading, at), hidden)


def _rows(sheet: Plain, where: str) -> Iterator[tuple[int, list[Cell]]]:
    """Yield number (from 1) and cells of every row that holds something; the size that a sheet claims is not believed."""
    sheet.reset_dimensions()
    count = 0
    for number, row in enumerate(sheet.iter_rows(values_only=True), start=1):
        count += len(row) + 1
        if count > _MOST_CELLS or len(row) > MOST_COLUMNS:
            raise FileSizeError(
                f"{where} has more than {_MOST_CELLS} cells, or more than {MOST_COLUMNS} columns. Delete what lies outside the "
                "table, or save the table as CSV."
            )
        cells = list(row)
        while cells and (cells[-1] is None or cells[-1] == ""):
            cells.pop()
        if cells and not blank(cells):
            yield number, cells


def _of_one_width(rows: Sequence[list[Cell]]) -> list[list[Cell]]:
    width = max(map(len, rows), default=0)
    return [[*row, *[None] * (width - len(row))] for row in rows]


def _read(sheet: Plain, file: Path, heading: HeaderBlock, at: Sequence[int], notes: tuple[str, ...]) -> RawTable:
    """Read the whole of a sheet."""
    where = f"'{file}', sheet '{sheet.title}'"
    if heading.row is None:
        raise HeaderError(f"{where} has no row of names.")
    numbers: list[int] = []
    rows: list[list[Cell]] = []
    for number, cells in _rows(sheet, where):
        if number >= at[heading.first]:
            numbers.append(number)
            rows.append(cells)
    rows = _of_one_width(rows)
    width = max(heading.width, len(rows[0]))
    names = [*(name for name in heading.names), *[""] * (width - len(heading.names))][:width]
    units = [*heading.units, *[None] * (width - len(heading.units))][:width]
    columns = [column_of(cells) for cells in zip(*rows)]
    columns += [column_of([None] * len(rows))] * (width - len(columns))
    kept = [k for k in range(width) if names[k] or columns[k].notna().any()]
    if heading.unused:
        shown = ", ".join(str(at[k]) for k in heading.unused[:5]) + (", ..." if len(heading.unused) > 5 else "")
        notes = (*notes, f"Above the samples, not used: row {shown} of the sheet.")
    return RawTable(
        name=file.stem,
        where=where,
        headers=tuple(names[k] for k in kept),
        columns=tuple(columns[k] for k in kept),
        units=tuple(units[k] for k in kept),
        header=f", row {at[heading.row]}",
        line=numbers.__getitem__,
        notes=notes,
    )


def column_of(cells: Sequence[Cell]) -> pd.Series:
    """Return the cells of a column: numbers, time stamps, or what they are.

    Parameters
    ----------
    cells : sequence of cells
        As openpyxl reads them; a time of day becomes text.

    Returns
    -------
    pandas.Series
    """
    there = [cell for cell in cells if cell is not None]
    if all(isinstance(cell, (int, float)) and not isinstance(cell, bool) for cell in there):
        return pd.Series([None if cell is None else float(cell) for cell in cells], dtype=float)  # type: ignore[arg-type]
    if all(isinstance(cell, (datetime.datetime, datetime.date)) for cell in there):
        return pd.Series(pd.to_datetime(pd.Series(list(cells), dtype=object), errors="coerce"))
    if all(isinstance(cell, datetime.timedelta) for cell in there):
        return pd.Series(pd.to_timedelta(pd.Series(list(cells), dtype=object), errors="coerce"))
    return pd.Series([cell.isoformat() if isinstance(cell, datetime.time) else cell for cell in cells], dtype=object)
