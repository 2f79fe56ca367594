"""Tables of pandas as logs: in memory, and in Parquet files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.trials.errors import TextInColumnError, TrialError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.naming import by_format, by_header
from shipid.trials.logs.record import LenientRecord
from shipid.trials.source import Source


def record_of_frame(frame: pd.DataFrame, name: str, units: Mapping[str, str], source: Source | None) -> LenientRecord:
    """Return a table in memory as a log.

    Parameters
    ----------
    frame, name, units, source
        As for `shipid.Trial.from_frame`.

    Returns
    -------
    LenientRecord
    """
    where = f"table '{name}'"
    series, stated, faults = by_header({str(c): frame[c] for c in frame.columns}, units, where)
    values = _numbers(series, where, faults)
    return LenientRecord(name, values, stated, where, source or Source(), faults=tuple(faults), words=_words(faults))


def read_parquet(file: Path, fmt: TrialFormat | None) -> tuple[LenientRecord, tuple[str, ...]]:
    """Read a Parquet file.

    Parameters
    ----------
    file : Path
        The file; units stand in the headers, or in the metadata of the columns.
    fmt : TrialFormat or None
        What its columns are.

    Returns
    -------
    record : LenientRecord
        The columns.
    comments : tuple of str
        The comment lines of the file.

    Raises
    ------
    MissingExtraError
        If pyarrow is not installed.
    TrialError
        If it is not a Parquet file, or lacks what the format file names.
    """
    try:
        import pyarrow.parquet
    except ImportError:
        raise MissingExtraError(
            f"the Parquet file '{file}'", "pyarrow", "parquet", "Or convert the file to CSV."
        ) from None
    try:
        arrow = pyarrow.parquet.read_table(file)
    except (pyarrow.ArrowInvalid, OSError) as error:
        raise TrialError(
            f"'{file}' is not a readable Parquet file: {error}. Check that it was copied completely."
        ) from None
    frame = arrow.to_pandas()
    units = _arrow_units(arrow.schema, frame)
    where = f"'{file}'"
    series = {str(c): frame[c] for c in frame.columns}
    faults: list[TrialError] = []
    if fmt is None:
        named, stated, faults = by_header(series, units, where)
    else:
        headers = tuple(series)
        found, stated = by_format(fmt, headers, len(headers), where, units)
        named = {name: series[headers[index]] for name, index in found.items()}
    faults += [
        TextInColumnError(f"{where}, column '{name}': it holds {column.dtype}, not numbers. Write it as float64.")
        for name, column in named.items()
        if not pd.api.types.is_numeric_dtype(column.dtype)
    ]
    values = _numbers(named, where, faults)
    comment = (arrow.schema.metadata or {}).get(b"comment", b"").decode("utf-8", "replace")
    record = LenientRecord(file.stem, values, stated, where, faults=tuple(faults), words=_words(faults))
    return record, tuple(comment.splitlines())


def _words(faults: list[TrialError]) -> dict[str, Mapping[int, str]]:
    """Return by column and row the cells that hold text."""
    texts = [fault.cells for fault in faults if isinstance(fault, TextInColumnError)]
    return {str(name): cells for found in texts for name, cells in found.items()}


def _arrow_units(schema: Plain, frame: pd.DataFrame) -> dict[str, str]:
    """Units that a Parquet file states beside its headers: in the fields' metadata, or in pandas' attrs."""
    units = {}
    attrs = frame.attrs.get("units", {})
    for arrow_field in schema:
        metadata = arrow_field.metadata or {}
        stated = metadata.get(b"unit") or metadata.get(b"units")
        unit = stated.decode("utf-8", "replace") if stated else attrs.get(arrow_field.name)
        if unit:
            units[arrow_field.name] = unit
    return units


def _numbers(series: Mapping[str, pd.Series], where: str, faults: list[TrialError]) -> dict[str, np.ndarray]:
    """Return columns as numbers, NaN where there is none; what is none is added to the faults."""
    result = {}
    for name, column in series.items():
        if column.dtype.kind in "mM":
            raise TextInColumnError(
                f"{where}, column '{name}': it holds dates or times of day, not numbers. Write seconds since the start of "
                "the record."
            )
        numbers = pd.to_numeric(column, errors="coerce")
        text = numbers.isna() & column.notna()
        if text.any():
            k = int(np.flatnonzero(text)[0])
            faults.append(
                TextInColumnError(
                    f"{where}, row {k}, column '{name}': '{str(column.iloc[k])[:40]}' is not a number. "
                    "Replace it by the number, or remove the row.",
                    {name: {int(row): str(column.iloc[row]) for row in np.flatnonzero(text)}},
                )
            )
        result[name] = numbers.to_numpy(dtype=float, na_value=np.nan)
    return result
