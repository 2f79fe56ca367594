"""Text tables: the numbers are parsed by pandas' C engine; a row or field that it cannot parse is named by its line."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from shipid.trials.errors import RaggedRowError, TextInColumnError, TrialError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.naming import by_format, by_header
from shipid.trials.logs.record import LenientRecord
from shipid.trials.logs.text_layout import NUMBER, TextLayout, fields, lay_out, lines_of, no_samples


def read_text(file: Path, fmt: TrialFormat | None) -> tuple[LenientRecord, tuple[str, ...]]:
    """Read a text file.

    Parameters
    ----------
    file : Path
        The file.
    fmt : TrialFormat or None
        What is known about it.

    Returns
    -------
    record : LenientRecord
        Its columns.
    comments : tuple of str
        The comment lines at its head.

    Raises
    ------
    EmptyFileError, HeaderError, SeparatorError, RaggedRowError
        If it holds no samples, no header, columns that cannot be told apart, or a row that is too long.
    UnknownColumnError, NoUnitError
        If it lacks what the format file names.
    """
    layout = lay_out(file, fmt)
    where = f"'{file}'"
    faults: list[TrialError] = []
    if fmt is None:
        headers = {header: k for k, header in enumerate(layout.headers)}
        found, stated, faults = by_header(headers, {}, f"{where}, line {layout.skip}")
    else:
        found, stated = by_format(fmt, layout.headers, layout.width, where, {})
    table, fault = parse(file, layout, list(found.values()))
    if fault is not None:
        faults.append(fault)
    unused: dict[int, np.ndarray] = {}
    if fmt is not None and fmt.interval is not None:
        others = table.drop(columns=list(found.values()))
        unused = {k: pd.to_numeric(others[k], errors="coerce").to_numpy(dtype=float) for k in others}
    record = LenientRecord(
        file.stem,
        {name: table[index].to_numpy() for name, index in found.items()},
        stated,
        where,
        notes=layout.notes,
        faults=tuple(faults),
        unused=unused,
        line=partial(line_of, file, layout),
        words={} if fault is None else {name: fault.cells[k] for name, k in found.items() if k in fault.cells},
    )
    return record, layout.comments


def parse(path: Path, layout: TextLayout, wanted: Sequence[int]) -> tuple[pd.DataFrame, TextInColumnError | None]:
    """Parse the samples of a text file.

    Parameters
    ----------
    path : Path
        The file.
    layout : TextLayout
        How it is laid out.
    wanted : sequence of int
        Indices of the columns that have to be numbers.

    Returns
    -------
    table : pandas.DataFrame
        The columns, named by their index in the file; those wanted are float64, NaN where a field is empty or no number.
    fault : TextInColumnError or None
        The first field of a wanted column that is no number.

    Raises
    ------
    RaggedRowError, EmptyFileError
        If a row has too many fields, or there are no samples.
    """
    fault = None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table = _table(path, layout, dict.fromkeys(wanted, "float64"))
    except pd.errors.EmptyDataError:
        raise no_samples(path) from None
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        fault = _first_text(path, layout, wanted)
        if fault is None:
            raise RaggedRowError(
                f"'{path}' could not be parsed: {' '.join(str(error).split())}. Check its rows, or state a format file."
            ) from None
        table = _table(path, layout, "str")
        printed = table
        if layout.decimal == ",":
            table = table.apply(lambda column: column.str.replace(",", "."))
        table = table.apply(pd.to_numeric, errors="coerce")
        fault = TextInColumnError(str(fault), {k: cells for k in wanted if (cells := texts_in(printed[k], table[k]))})
    if table.empty:
        raise no_samples(path)
    return table, fault


def texts_in(printed: pd.Series, numbers: pd.Series) -> dict[int, str]:
    """Return by row the text of the cells that hold neither a number nor nothing.

    Parameters
    ----------
    printed, numbers : pandas.Series
        A column as it is written, and as numbers.
    """
    rows = np.flatnonzero((numbers.isna() & printed.notna() & (printed.astype(str).str.strip() != "")).to_numpy())
    return {int(row): str(printed.iloc[row]).strip() for row in rows}


def _table(path: Path, layout: TextLayout, dtype: str | dict[int, str]) -> pd.DataFrame:
    # No usecols: told which columns to use, pandas drops what a row has too much of without a word.
    return pd.read_csv(
        path,
        sep=layout.separator,
        skiprows=layout.skip,
        header=None,
        names=list(range(layout.width)),
        index_col=False,
        dtype=dtype,
        decimal=layout.decimal,
        comment=layout.comment,
        encoding=layout.encoding,
        encoding_errors="replace",
        engine="c",
        low_memory=False,
    )


def _samples(path: Path, layout: TextLayout) -> Iterator[tuple[int, str]]:
    """Yield line number (from 1) and text of every sample line: only walked to explain what is wrong."""
    for number, line in enumerate(lines_of(path, layout.encoding), start=1):
        if number > layout.skip and line.strip() and not line.lstrip().startswith(layout.comment):
            yield number, line


def line_of(path: Path, layout: TextLayout, row: int) -> int:
    """Return the line number in the file (from 1) of a sample (from 0).

    Parameters
    ----------
    path : Path
        The file.
    layout : TextLayout
        How it is laid out.
    row : int
        The sample.
    """
    return next(itertools.islice((number for number, _ in _samples(path, layout)), row, None), row)


def _first_text(path: Path, layout: TextLayout, wanted: Sequence[int]) -> TextInColumnError | None:
    """Walk the file to the first field that is text; a row that is too long is refused."""
    fault = None
    for number, line in _samples(path, layout):
        row = fields(line.split(layout.comment)[0], layout.separator)
        if len(row) > layout.width:
            raise RaggedRowError(
                f"'{path}', line {number}: the row has {len(row)} fields, the first sample {layout.width}. "
                "Complete or remove the row; a text field must not contain the separator."
            )
        for index in wanted if fault is None else ():
            value = row[index] if index < len(row) else ""
            if not NUMBER.match(value) or (layout.decimal == "." and "," in value):
                name = layout.headers[index] if index < len(layout.headers) else f"number {index}"
                decimal = " A decimal comma is stated in a format file: decimal = 'comma'." if "," in value else ""
                fault = TextInColumnError(
                    f"'{path}', line {number}, column '{name}': '{value[:40]}' is not a number. "
                    "Replace it by the number, or remove the row; an empty field means that nothing was measured."
                    f"{decimal}"
                )
                break
    return fault
