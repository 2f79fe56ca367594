"""Parquet files, by pyarrow: judged by what they expand to before they are read."""

from __future__ import annotations

import datetime
import json
from pathlib import Path

import pandas as pd

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.foundation.printable import printable
from shipid.trials.columns import split_header
from shipid.trials.errors import DamagedFileError, EmptyFileError, FileSizeError, TrialError
from shipid.trials.logs.clocks.headers import NAMES, short
from shipid.trials.logs.tables.opening import LARGEST
from shipid.trials.logs.tables.table import MOST_COLUMNS, RawTable

#: Letters of a cell of text.
_LONGEST = 1_000
#: Columns that are left out and named.
_NAMED = 8


def read_parquet(data: bytes, file: Path) -> RawTable:
    """Read a Parquet file.

    Parameters
    ----------
    data : bytes
        The file; units stand in the headers, in the metadata of the columns, or in pandas' attributes.
    file : Path
        The file, for messages.

    Returns
    -------
    RawTable

    Raises
    ------
    MissingExtraError
        If pyarrow is not installed.
    DamagedFileError
        If it is not a Parquet file, or damaged.
    EmptyFileError
        If it has no column of numbers, times or text.
    FileSizeError
        If it expands to more than is read.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingExtraError(
            f"the Parquet file '{file}'", "pyarrow", "parquet", "Or convert the file to CSV."
        ) from None
    try:
        source = pyarrow.BufferReader(data)
        schema = pyarrow.parquet.ParquetFile(source).schema_arrow
        texts, others = _columns(schema, pyarrow.types)
        nested = [
            f"'{printable(f.name)}' ({printable(str(f.type))[:40]})" for f in schema if f.name not in {*texts, *others}
        ]
        # A text that many rows share is kept once.
        opened = pyarrow.parquet.ParquetFile(source, read_dictionary=texts)
        _check_size(opened.metadata, len(texts) + len(others), file)
        arrow = opened.read(columns=[*texts, *others], use_threads=False)
        arrow.validate(full=True)
        long = [name for name in texts if _longest(arrow.column(name)) > _LONGEST]
        arrow = arrow.drop_columns(long)
        frame = arrow.to_pandas()
        units = _units(arrow.schema)
        comment = (arrow.schema.metadata or {}).get(b"comment", b"").decode("utf-8", "replace")
    except TrialError:
        raise
    except Exception as error:  # damage shows in many places of the library
        reason = str(error).split("\n")[0][:100].rstrip(".")
        raise DamagedFileError(
            f"'{file}' is not a readable Parquet file: {reason}. Check that it was copied completely."
        ) from None
    names = [*(str(name) for name in frame.columns)]
    columns = [_plain(frame.iloc[:, k]) for k in range(len(names))]
    if not columns:
        raise EmptyFileError(f"'{file}' holds no column of numbers, times or text.")
    order = _in_order(opened.schema_arrow.names, names)
    clock = _clock_of(frame.index, names)
    headers = [*([] if clock is None else [str(clock.name)]), *(names[k] for k in order)]
    return RawTable(
        name=file.stem,
        where=f"'{file}'",
        headers=tuple(headers),
        columns=(*(() if clock is None else (clock,)), *(columns[k] for k in order)),
        units=tuple(units.get(header) for header in headers),
        comments=tuple(comment.splitlines()),
        notes=(
            *([f"Columns of long texts were left out: {', '.join(map(repr, long))}."] if long else []),
            *(
                [f"Columns that hold no single values were left out: {', '.join(nested[:_NAMED])}{_more(nested)}."]
                if nested
                else []
            ),
        ),
    )


def _columns(schema: Plain, types: Plain) -> tuple[list[str], list[str]]:
    """The columns of text, and those of numbers and times; lists and structs are none."""
    inner = {f.name: f.type.value_type if types.is_dictionary(f.type) else f.type for f in schema}
    texts = [name for name, kind in inner.items() if types.is_string(kind) or types.is_large_string(kind)]
    plain = (types.is_integer, types.is_floating, types.is_boolean, types.is_temporal, types.is_decimal, types.is_null)
    return texts, [f.name for f in schema if any(is_kind(f.type) for is_kind in plain)]


def _more(names: list[str]) -> str:
    return f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""


def _longest(column: Plain) -> int:
    """Letters of the longest text of a column."""
    return max((int(nbytes) for chunk in column.chunks for nbytes in _sizes(chunk)), default=0)


def _sizes(chunk: Plain) -> list[int]:
    import pyarrow.compute

    texts = chunk.dictionary if hasattr(chunk, "dictionary") else chunk
    longest = pyarrow.compute.max(pyarrow.compute.binary_length(texts)).as_py()
    return [] if longest is None else [longest]


def _check_size(metadata: Plain, width: int, file: Path) -> None:
    """Judge a file by its metadata: what its pages expand to, and what its rows take in memory."""
    groups = [metadata.row_group(k) for k in range(metadata.num_row_groups)]
    rows = max(metadata.num_rows, sum(group.num_rows for group in groups))
    pages = sum(group.total_byte_size for group in groups)
    if width > MOST_COLUMNS or max(rows * 8 * width, pages) > LARGEST:
        raise FileSizeError(
            f"'{file}' expands to {rows} rows of {width} columns, and at most {LARGEST // 1_000_000} MB and {MOST_COLUMNS} columns are "
            "read. Cut it into parts, or leave out columns that are not needed."
        )
    if min(rows, pages, *(group.num_rows for group in groups)) < 0:
        raise ValueError("it claims fewer rows than none")


def _plain(column: pd.Series) -> pd.Series:
    """A column as numbers, times or text, without the types of Arrow and of categories."""
    column = column.reset_index(drop=True)
    if isinstance(column.dtype, pd.CategoricalDtype):
        return column.astype(object)
    if column.dtype.kind == "O" or not isinstance(column.dtype.type, type):
        # Decimals, dates and times of day of Arrow come as objects.
        if bool(column.dropna().map(lambda cell: isinstance(cell, (datetime.date, datetime.time))).all()):
            return column.map(lambda cell: cell.isoformat(), na_action="ignore")
        numbers = pd.to_numeric(column, errors="coerce")
        return (
            numbers.astype(float) if bool((numbers.notna() | column.isna()).all()) and column.notna().any() else column
        )
    return column


def _in_order(schema: list[str], names: list[str]) -> list[int]:
    """The columns in the order of the file."""
    place = {name: k for k, name in enumerate(schema)}
    return sorted(range(len(names)), key=lambda k: place.get(names[k], len(place)))


def _clock_of(index: pd.Index, names: list[str]) -> pd.Series | None:
    """The index as a column, where it is the clock: dates, times or durations, or named as one."""
    if isinstance(index, pd.MultiIndex) or (isinstance(index, pd.RangeIndex) and index.name is None):
        return None
    timed = isinstance(index, (pd.DatetimeIndex, pd.TimedeltaIndex))
    if not timed and (index.name is None or short(str(index.name)) not in NAMES):
        return None
    header = str(index.name) if index.name is not None else "time"
    if split_header(header)[0] in [split_header(name)[0] for name in names]:
        return None
    return pd.Series(index.to_numpy() if not timed else index, name=header).reset_index(drop=True)


def _units(schema: Plain) -> dict[str, str]:
    """Units that a Parquet file states beside its headers: in the fields' metadata, or in pandas' attrs."""
    units = {}
    # Out of the file itself: not every version of pandas and Arrow brings the attrs back.
    kept = json.loads((schema.metadata or {}).get(b"PANDAS_ATTRS", b"{}"))
    attrs = kept.get("units") if isinstance(kept, dict) else None
    attrs = attrs if isinstance(attrs, dict) else {}
    for arrow_field in schema:
        metadata = arrow_field.metadata or {}
        stated = metadata.get(b"unit") or metadata.get(b"units")
        unit = stated.decode("utf-8", "replace") if stated else attrs.get(arrow_field.name)
        if unit:
            units[arrow_field.name] = str(unit)
    return units
