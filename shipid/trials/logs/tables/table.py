"""A table as a file holds it, and the log that is made of it: one way for every kind of file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.result import settled
from shipid.trials import columns as spelling
from shipid.trials.errors import EmptyFileError, HeaderError, TextInColumnError, TrialError
from shipid.trials.logs.clocks.formatted import clock_columns, formatted_clock
from shipid.trials.logs.clocks.headers import NAMES, short
from shipid.trials.logs.clocks.reading import with_clock
from shipid.trials.logs.clocks.stamps import read_stamps
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.naming import by_format, by_header
from shipid.trials.logs.positions import with_degrees
from shipid.trials.logs.record import LenientRecord, same_row
from shipid.trials.logs.tables.lettered import may_be_lettered, read_lettered
from shipid.trials.logs.tables.numerals import MISSING, Decimal, read_numbers, shows_decimals, sign_of_file
from shipid.trials.source import Source

#: No log has as many columns.
MOST_COLUMNS = 10_000


@dataclass(frozen=True, eq=False)
class RawTable:
    """A table as a file holds it, before it is known which column is what.

    Attributes
    ----------
    name : str
        Of the record.
    where : str
        File and sheet, for messages.
    headers : tuple of str
        One a column, empty where a column has none; none at all where the table has no header.
    columns : tuple of pandas.Series
        As printed: numbers, time stamps, text, or a mixture of them.
    units : tuple of str or None
        The unit of each column where it stands beside the table or in a row of its own.
    header : str
        Where the header is, for messages: ``, line 3``.
    row : {"line", "row"}
        What a row is called.
    line : callable
        Gives the number to name for a sample.
    comments : tuple of str
        The comments at the head of the file.
    notes : tuple of str
        What was found out and not stated.
    decimal : str or None
        The decimal sign of numbers that were read from text already.
    printed : callable or None
        Gives a column by its index as text, where numbers were read from it already.
    separator : str or None
        Regular expression of the separator of a text file.
    skip : int or None
        Lines before the first sample of a text file; None where its header is a comment.
    conflicts : mapping of int to (int, str)
        Columns whose cells say another unit than the column or each other: the sample where they do, and what they say.
    """

    name: str
    where: str
    headers: tuple[str, ...]
    columns: tuple[pd.Series, ...]
    units: tuple[str | None, ...]
    header: str = ""
    row: Literal["line", "row"] = "row"
    line: Callable[[int], int] = same_row
    comments: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    decimal: Decimal | None = None
    printed: Callable[[int], pd.Series] | None = field(default=None)
    separator: str | None = None
    skip: int | None = None
    conflicts: Mapping[int, tuple[int, str]] = field(default_factory=dict)

    @property
    def full_headers(self) -> tuple[str, ...]:
        """The headers with the units that stand elsewhere; none where the table has no header."""
        return tuple(
            spelling.header(header, unit) if header and unit and spelling.split_header(header)[1] is None else header
            for header, unit in zip(self.headers, self.units)
        )


def record_of(raw: RawTable, fmt: TrialFormat | None) -> LenientRecord:
    """Make a log of a table.

    Parameters
    ----------
    raw : RawTable
        The table.
    fmt : TrialFormat or None
        What is known about it.

    Returns
    -------
    LenientRecord

    Raises
    ------
    EmptyFileError
        If it has no rows.
    HeaderError
        If the header names a column twice.
    UnknownColumnError, NoUnitError
        If it lacks what the format file names.
    AmbiguousNumberError
        If nothing tells how its numbers are written.
    """
    if not raw.columns or not len(raw.columns[0]):
        raise EmptyFileError(f"{raw.where} holds no samples. Check that the log was written and copied completely.")
    return _unformatted(raw) if fmt is None else _formatted(raw, fmt)


def _unformatted(raw: RawTable) -> LenientRecord:
    headers = raw.full_headers
    indices = {header: k for k, header in enumerate(headers) if header}
    twice = sorted({header for header in headers if header and headers.count(header) > 1})
    if twice:
        raise HeaderError(
            f"{raw.where}{raw.header}: the header names '{twice[0]}' twice. Rename one of the two columns."
        )
    cells = _Cells(raw, list(indices.values()), None)
    table = {header: cells.column(k) for header, k in indices.items()}
    clocked = with_clock(table, raw.where, line=raw.line)
    left_out = [h for h in clocked.columns if h in indices and cells.is_prose(indices[h]) and not _is_known(h)]
    empty = [h for h in clocked.columns if h in indices and h not in left_out and _is_unnamed_hole(h, table[h])]
    kept = {header: column for header, column in clocked.columns.items() if header not in (*left_out, *empty)}
    full, degrees = with_degrees(kept)
    unread = {h: cells.first(indices[h]) for h in left_out if short(h) in NAMES}
    found, stated, faults = by_header(full, {}, raw.where + raw.header, unread)
    notes = [f"Columns of text were left out: {', '.join(map(repr, left_out))}."] if left_out else []
    notes += [f"Columns without a sample were left out: {', '.join(map(repr, empty))}."] if empty else []
    # By header: a name may be that of two columns, of which the first is kept.
    own = {name: next((k for h, k in indices.items() if table[h] is column), None) for name, column in found.items()}
    faults += cells.faults([k for k in own.values() if k is not None])
    return LenientRecord(
        raw.name,
        {name: cells.numbers(column) for name, column in found.items()},
        stated,
        raw.where,
        Source(start=clocked.start),
        notes=(*raw.notes, *cells.notes, *notes, *clocked.notes, *degrees),
        faults=(*faults, *clocked.faults),
        line=raw.line,
        words=cells.words({name: k for name, k in own.items() if k is not None}),
    )


def _formatted(raw: RawTable, fmt: TrialFormat) -> LenientRecord:
    headers, width = raw.full_headers, len(raw.columns)
    found, stated = by_format(fmt, headers, width, raw.where, {})
    clock_at = clock_columns(fmt, found, headers, raw.where)
    cells = _Cells(raw, sorted({*found.values(), *clock_at}), fmt.decimal)
    as_text = "%" in (fmt.clock.layout or "")
    printed = raw.printed if as_text and raw.printed is not None else cells.column
    clock = formatted_clock(fmt, printed, found, stated, headers, raw.where, raw.line)
    values = {name: cells.numbers(cells.column(k)) for name, k in found.items()}
    faulty = [k for name, k in found.items() if name != "t" or clock is None]
    if clock is not None:
        values["t"] = np.asarray(clock.seconds, dtype=float)
    unused: dict[int, np.ndarray] = {}
    if fmt.interval is not None:
        others = [k for k in range(width) if k not in found.values()]
        unused = {
            k: pd.to_numeric(raw.columns[k], errors="coerce").to_numpy(dtype=float, na_value=np.nan) for k in others
        }
    return LenientRecord(
        raw.name,
        values,
        stated,
        raw.where,
        Source(start=clock.start if clock else None),
        notes=(*raw.notes, *cells.notes, *(clock.notes if clock else ())),
        faults=(*(clock.faults if clock else ()), *cells.faults(faulty)),
        unused=unused,
        line=raw.line,
        words=cells.words(found),
    )


def _is_known(header: str) -> bool:
    return spelling.split_header(header)[0] in FIELDS


def _is_unnamed_hole(header: str, column: pd.Series) -> bool:
    """Whether a column holds nothing, and no field is expected of it."""
    name, unit = spelling.split_header(header)
    return name not in FIELDS and unit is None and bool(column.isna().all())


#: Degrees and minutes of a place: 10 30.1965 N is no date.
_PLACE = r"[^:]*\d\s*[NSEW]"


class _Cells:
    """The cells of some columns: as numbers where they are, as text where they may be a clock; and what is neither.

    Parameters
    ----------
    raw : RawTable
        The table.
    wanted : list of int
        Indices of the columns.
    decimal : str or None
        The decimal sign, where it is stated.
    """

    def __init__(self, raw: RawTable, wanted: list[int], decimal: str | None) -> None:
        self.raw = raw
        self.notes: tuple[str, ...] = ()
        self._read: dict[int, pd.Series] = {}
        self._strange: dict[int, np.ndarray] = {}
        texts: dict[int, pd.Series] = {}
        for k in wanted:
            column = raw.columns[k]
            if column.dtype.kind in "fiu" or column.dtype.kind in "mM":
                self._read[k] = column
            elif column.dtype.kind in "bc" or isinstance(column.dtype, pd.PeriodDtype):
                self._read[k], self._strange[k] = _nothing(column), column.notna().to_numpy()
            elif _is_text(column) and _is_clock(column):
                self._read[k] = column
            else:
                texts[k] = column
        self._read_texts(texts, decimal)

    def _read_texts(self, texts: dict[int, pd.Series], decimal: str | None) -> None:
        if not texts:
            return
        written = {k: _only_texts(column) for k, column in texts.items()}
        for k in list(written):
            name = self.raw.headers[k] if k < len(self.raw.headers) else f"number {k}"
            units = (self.raw.units[k] if k < len(self.raw.units) else None, spelling.split_header(name)[1])
            lettered = read_lettered(written[k]) if may_be_lettered(*units) and _is_text(texts[k]) else None
            if lettered is not None:
                values, said = lettered
                self._read[k], self._strange[k] = pd.Series(values, name=texts[k].name), np.zeros(len(values), bool)
                self.notes = (*self.notes, f"Column '{name}': {said}.")
                del written[k], texts[k]
        if not texts:
            return
        named = [
            cells.rename(self.raw.headers[k] if k < len(self.raw.headers) else f"number {k}")
            for k, cells in written.items()
        ]
        sign: Decimal
        if decimal is not None:
            sign = "," if decimal == "," else "."
        else:
            sign = sign_of_file(named, self.raw.decimal, self.raw.where)
        for k, column in texts.items():
            values, strange = read_numbers(written[k], sign)
            others = column.notna() & written[k].isna()
            if others.any():
                plain = others & column.map(
                    lambda cell: isinstance(cell, (int, float, np.number)) and not isinstance(cell, (bool, np.bool_))
                )
                values[plain.to_numpy()] = column[plain].map(_float).to_numpy(dtype=float)
                strange |= (others & ~plain).to_numpy()
            self._read[k], self._strange[k] = pd.Series(values, name=column.name), strange
        if sign == "," and self.raw.decimal is None and decimal is None:
            self.notes = (
                *self.notes,
                "The numbers are written with a decimal comma.",
            )

    def column(self, k: int) -> pd.Series:
        """Return a column: numbers, time stamps, or the text of a clock."""
        return self._read[k].reset_index(drop=True)

    def numbers(self, column: pd.Series) -> np.ndarray:
        """Return a column as numbers, NaN where it holds none."""
        if column.dtype.kind not in "fiu":
            return np.full(len(column), np.nan)
        return settled(column.to_numpy(dtype=float, na_value=np.nan))

    def first(self, k: int) -> str:
        """Return the first cell of a column that holds something, as it is printed."""
        return next((str(cell).strip() for cell in self.raw.columns[k].dropna()), "")

    def is_prose(self, k: int) -> bool:
        """Return whether a column holds cells and none of them is a number."""
        strange = self._strange.get(k)
        column = self._read[k]
        if column.dtype.kind not in "fiu":
            return True
        return strange is not None and bool(strange.any()) and not np.isfinite(self.numbers(column)).any()

    def words(self, used: Mapping[str, int]) -> dict[str, dict[int, str]]:
        """Return by column and row the cells that hold neither a number nor nothing."""
        found = {name: np.flatnonzero(self._strange[k]) for name, k in used.items() if k in self._strange}
        return {
            name: {int(row): str(self.raw.columns[used[name]].iloc[row]).strip() for row in rows}
            for name, rows in found.items()
            if rows.size
        }

    def faults(self, used: list[int]) -> list[TrialError]:
        """Return one fault a column that is used and holds cells that are no numbers: the first, and how many there are."""
        return [fault for k in used if (fault := self._fault(k)) is not None]

    def _fault(self, k: int) -> TrialError | None:
        raw, column = self.raw, self.raw.columns[k]
        header = raw.headers[k] if k < len(raw.headers) else ""
        name = header or f"number {k}"
        if self._read[k].dtype.kind not in "fiu":
            return TextInColumnError(
                f"{raw.where}, column '{name}': it holds dates or times, and is not the clock. Leave it out."
            )
        if k in raw.conflicts:
            at, words = raw.conflicts[k]
            return TextInColumnError(
                f"{raw.where}, {raw.row} {raw.line(at)}, column '{name}': {words}. Write all cells in one unit, that of the header."
            )
        strange = self._strange.get(k)
        if strange is None or not strange.any():
            return None
        first = int(np.flatnonzero(strange)[0])
        cell = str(column.iloc[first])
        more = f" {int(strange.sum()) - 1} more cells of this column are none either." if strange.sum() > 1 else ""
        sign = " A decimal comma is stated in a format file: decimal = 'comma'." if "," in cell else ""
        return TextInColumnError(
            f"{raw.where}, {raw.row} {raw.line(first)}, column '{name}': '{cell[:40]}' is not a number. "
            f"Replace it by the number, or remove the row; an empty field means that nothing was measured.{sign}{more}"
        )


def _only_texts(column: pd.Series) -> pd.Series:
    """The cells that are text; NaN in place of the others."""
    if isinstance(column.dtype, pd.StringDtype):
        return column
    return column.where(column.map(lambda cell: isinstance(cell, str)))


def _float(number: float) -> float:
    try:
        return float(number)
    except OverflowError:  # a whole number of hundreds of digits
        return float("inf")


def _nothing(column: pd.Series) -> pd.Series:
    return pd.Series(np.full(len(column), np.nan), name=column.name)


def _is_text(column: pd.Series) -> bool:
    """Whether every cell that holds something is text."""
    there = column.dropna()
    return bool(len(there)) and bool(there.head(2000).map(lambda cell: isinstance(cell, str)).all())


def _is_clock(column: pd.Series) -> bool:
    """Whether most of the first cells of a column of text are dates or times of day."""
    cells = column.dropna().head(2000).str.strip()
    cells = cells[~cells.str.lower().isin(list(MISSING))].head(50)
    if cells.str.fullmatch(_PLACE).mean() > 0.5:
        return False
    return bool(len(cells)) and float(read_stamps(cells.tolist()).bad.mean()) < 0.5


def decimals_shown(columns: Mapping[int, pd.Series]) -> bool:
    """Return whether numbers that were read have decimals that cannot be thousands in groups of three.

    Parameters
    ----------
    columns : Mapping of int to pandas.Series
        Columns; those that are no numbers are passed over.
    """
    return any(shows_decimals(column.to_numpy(dtype=float)) for column in columns.values() if column.dtype.kind == "f")
