"""Text tables: the numbers are parsed by pandas' C engine; a row or field that it cannot parse is named by its line."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from shipid.trials.errors import RaggedRowError, TextInColumnError
from shipid.trials.logs.clocks.formatted import clock_columns, formatted_clock
from shipid.trials.logs.clocks.reading import with_clock
from shipid.trials.logs.clocks.stamps import is_stamp
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.naming import by_format, by_header
from shipid.trials.logs.record import LenientRecord
from shipid.trials.logs.text_layout import NUMBER, TextLayout, fields, lay_out, lines_of, no_samples
from shipid.trials.source import Source


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
    where, line = f"'{file}'", partial(line_of, file, layout)
    texts = _clock_texts(file, layout)
    if fmt is not None:
        return _formatted(file, fmt, layout, texts), layout.comments
    named = {header: k for k, header in enumerate(layout.headers) if header}
    table, fault = parse(file, layout, [k for k in named.values() if k not in texts], texts)
    clocked = with_clock({header: table[k] for header, k in named.items()}, where, line=line)
    found, stated, faults = by_header(clocked.columns, {}, f"{where}, line {layout.skip}")
    record = LenientRecord(
        file.stem,
        {name: column.to_numpy(dtype=float) for name, column in found.items()},
        stated,
        where,
        Source(start=clocked.start),
        notes=(*layout.notes, *clocked.notes),
        faults=(*faults, *clocked.faults, *([fault] if fault is not None else [])),
        line=line,
    )
    return record, layout.comments


def _formatted(file: Path, fmt: TrialFormat, layout: TextLayout, texts: Sequence[int]) -> LenientRecord:
    """Read the columns that a format file names."""
    where, line = f"'{file}'", partial(line_of, file, layout)
    found, stated = by_format(fmt, layout.headers, layout.width, where, {})
    texts = [
        k for k in clock_columns(fmt, found, layout.headers, where) if k in texts or "%" in (fmt.clock.layout or "")
    ]
    table, fault = parse(file, layout, [k for k in found.values() if k not in texts], texts)
    clock = formatted_clock(fmt, table.__getitem__, found, stated, layout.headers, where, line)
    values = {name: table[k] if name != "t" or clock is None else clock.seconds for name, k in found.items()}
    unused: dict[int, np.ndarray] = {}
    if fmt.interval is not None:
        others = table.drop(columns=list(found.values()))
        unused = {k: pd.to_numeric(others[k], errors="coerce").to_numpy(dtype=float) for k in others}
    return LenientRecord(
        file.stem,
        {name: np.asarray(column, dtype=float) for name, column in values.items()},
        stated,
        where,
        Source(start=clock.start if clock else None),
        notes=(*layout.notes, *(clock.notes if clock else ())),
        faults=(*(clock.faults if clock else ()), *([fault] if fault is not None else [])),
        unused=unused,
        line=line,
    )


def _clock_texts(file: Path, layout: TextLayout) -> list[int]:
    """The columns of which one of the first cells is a date or a time of day."""
    rows = [fields(text, layout.separator) for _, text in itertools.islice(_samples(file, layout), 20)]
    return [k for k in range(layout.width) if any(k < len(row) and row[k] and is_stamp(row[k]) for row in rows)]


def parse(
    path: Path, layout: TextLayout, wanted: Sequence[int], texts: Sequence[int] = ()
) -> tuple[pd.DataFrame, TextInColumnError | None]:
    """Parse the samples of a text file.

    Parameters
    ----------
    path : Path
        The file.
    layout : TextLayout
        How it is laid out.
    wanted : sequence of int
        Indices of the columns that have to be numbers.
    texts : sequence of int
        Indices of the columns that are text.

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
            table = _table(path, layout, dict.fromkeys(wanted, "float64") | dict.fromkeys(texts, "str"))
    except pd.errors.EmptyDataError:
        raise no_samples(path) from None
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        fault = _first_text(path, layout, wanted)
        if fault is None:
            raise RaggedRowError(
                f"'{path}' could not be parsed: {' '.join(str(error).split())}. Check its rows, or state a format file."
            ) from None
        table = _table(path, layout, "str")
        numbers = table.drop(columns=list(texts))
        if layout.decimal == ",":
            numbers = numbers.apply(lambda column: column.str.replace(",", "."))
        table[numbers.columns] = numbers.apply(pd.to_numeric, errors="coerce")
    if table.empty:
        raise no_samples(path)
    return table, fault


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
