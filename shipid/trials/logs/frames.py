"""Tables of pandas in memory as logs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from shipid.foundation.errors import UnknownNameError
from shipid.trials.columns import header as join_header
from shipid.trials.columns import split_header
from shipid.trials.errors import HeaderError, TextInColumnError, TrialError
from shipid.trials.logs.clocks.headers import NAMES, short
from shipid.trials.logs.clocks.reading import with_clock
from shipid.trials.logs.naming import by_header
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
    found, twice = _by_header(frame, units, where)
    clocked = with_clock(_with_index(found, frame.index), where)
    series, stated, faults = by_header(clocked.columns, {}, where)
    faults = [*twice, *faults, *clocked.faults]
    values = _numbers(series, where, faults)
    source = source or Source()
    source = replace(source, start=clocked.start or source.start)
    return LenientRecord(
        name, values, stated, where, source, notes=clocked.notes, faults=tuple(faults), words=_words(faults)
    )


def _by_header(
    frame: pd.DataFrame, units: Mapping[str, str], where: str
) -> tuple[dict[str, pd.Series], list[TrialError]]:
    """The columns of a table, with the units that are stated beside their headers; and those that stand twice."""
    columns: dict[str, pd.Series] = {}
    faults: list[TrialError] = []
    headers = [f"{label[0]} [{label[1]}]" if _is_pair(label) else str(label) for label in frame.columns]
    names = [split_header(header)[0] for header in headers]
    for unknown in (u for u in units if u not in names and u not in headers):
        raise UnknownNameError("column", unknown, names)
    for k, (header, name) in enumerate(zip(headers, names)):
        unit = units.get(header) or units.get(name)
        full = join_header(name, unit) if unit and split_header(header)[1] is None else header
        if full in columns:
            faults.append(HeaderError(f"{where}: two columns are named '{header}'. Rename or drop one of them."))
            continue
        columns[full] = frame.iloc[:, k]
    return columns, faults


def _words(faults: list[TrialError]) -> dict[str, Mapping[int, str]]:
    """Return by column and row the cells that hold text."""
    texts = [fault.cells for fault in faults if isinstance(fault, TextInColumnError)]
    return {str(name): cells for found in texts for name, cells in found.items()}


def _is_pair(label: object) -> bool:
    """Whether a label of two levels is a name and its unit."""
    return isinstance(label, tuple) and len(label) == 2 and all(isinstance(part, str) and part for part in label)


def _with_index(columns: dict[str, pd.Series], index: pd.Index) -> dict[str, pd.Series]:
    """Take the index as the clock of a table, where it holds dates, times or durations, or is named as a clock."""
    if isinstance(index, pd.PeriodIndex):
        index = index.to_timestamp()
    clock = isinstance(index, (pd.DatetimeIndex, pd.TimedeltaIndex)) or short(str(index.name)) in NAMES
    if not clock or isinstance(index, pd.MultiIndex):
        return columns
    header = str(index.name) if index.name is not None else "time"
    values = pd.Series(index)
    if header in columns or split_header(header)[0] in [split_header(name)[0] for name in columns]:
        return columns
    return {header: values, **{name: column.reset_index(drop=True) for name, column in columns.items()}}


def _numbers(series: Mapping[str, pd.Series], where: str, faults: list[TrialError]) -> dict[str, np.ndarray]:
    """Return columns as numbers, NaN where there is none; what is none is added to the faults."""
    result = {}
    for name, column in series.items():
        if column.dtype.kind in "mMc" or isinstance(column.dtype, pd.PeriodDtype):
            what = "complex numbers" if column.dtype.kind == "c" else "dates or times, and is not the clock"
            faults.append(TextInColumnError(f"{where}, column '{name}': it holds {what}. Leave it out."))
            result[name] = np.full(len(column), np.nan)
            continue
        numbers = pd.to_numeric(column.astype(object) if column.dtype.kind == "O" else column, errors="coerce")
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
