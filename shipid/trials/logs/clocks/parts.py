"""Clocks that stand in several columns of numbers: year, month, day, hour, minute, second; or milliseconds beside a time."""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np
import pandas as pd

from shipid.trials.logs.clocks.headers import short

#: Names of the parts of a moment in small letters, without blanks and signs; how large they get.
_PARTS: dict[str, tuple[tuple[str, ...], float]] = {
    "year": (("year", "yyyy", "yr", "jahr", "ar", "annee", "jaar", "utcyear"), 2100),
    "month": (("month", "mon", "monat", "maned", "mois", "maand", "utcmonth"), 12),
    "day": (("day", "dd", "tag", "dag", "jour", "utcday"), 31),
    "hour": (("hour", "hours", "hh", "hr", "hrs", "stunde", "heure", "uur", "utchour"), 24),
    "minute": (("minute", "minutes", "min", "mins", "mm", "minuut", "minuten", "utcminute"), 59),
    "second": (("second", "seconds", "sec", "secs", "ss", "sekunde", "sekunden", "seconde", "utcsecond"), 60.9999),
}
_THOUSANDTHS = ("ms", "msec", "msecs", "millis", "millisecond", "milliseconds", "millisekunden", "millisec")


def of_parts(table: Mapping[str, pd.Series]) -> tuple[str, pd.Series, tuple[str, ...]] | None:
    """Return a clock that is written in several columns as one column of text.

    Parameters
    ----------
    table : Mapping of str to pandas.Series
        Columns by header, as printed.

    Returns
    -------
    header : str
        A name for the clock, made of the headers.
    column : pandas.Series
        Moments or times of day as text, empty where a part is missing.
    used : tuple of str
        The headers of the parts.

    None where hour, minute and second are not there, or where their numbers are none of a clock.
    """
    found = {part: _column(table, names, most) for part, (names, most) in _PARTS.items()}
    hour, minute, second = found["hour"], found["minute"], found["second"]
    if hour is None or minute is None or second is None or len({hour, minute, second}) < 3:
        return None
    values = {part: pd.to_numeric(table[h], errors="coerce") for part, h in found.items() if h is not None}
    # Seconds that count on, and hours that stand for a duration with a fraction, are a clock by themselves.
    if float(values["second"].max()) > _PARTS["second"][1] or not _whole(values):
        return None
    thousandths = _column(table, _THOUSANDTHS, 999)
    used = [h for h in found.values() if h is not None]
    seconds = values["second"]
    if thousandths is not None and bool((seconds.dropna() % 1 == 0).all()):
        seconds = seconds + pd.to_numeric(table[thousandths], errors="coerce") / 1000
        used.append(thousandths)
    dated = all(part in values for part in ("year", "month", "day"))
    if not dated:
        used = [h for part, h in found.items() if part in ("hour", "minute", "second") and h is not None] + (
            [thousandths] if thousandths in used and thousandths is not None else []
        )
    columns = [*(values[part] for part in ("year", "month", "day") if dated), values["hour"], values["minute"], seconds]
    cells = _texts(np.column_stack([column.to_numpy(dtype=float, na_value=np.nan) for column in columns]))
    return ", ".join(used), pd.Series(cells, index=table[hour].index, dtype=object), tuple(used)


def with_thousandths(column: pd.Series, table: Mapping[str, pd.Series]) -> tuple[pd.Series, str] | None:
    """Return times of whole seconds with the milliseconds that stand in a column beside them, and its header.

    Parameters
    ----------
    column : pandas.Series
        The clock as text.
    table : Mapping of str to pandas.Series
        The columns beside it.

    Returns
    -------
    tuple of pandas.Series and str, or None
        None where there is no such column, or the times say parts of a second themselves.
    """
    header = _column(table, _THOUSANDTHS, 999)
    if header is None or (column.dtype.kind not in "OUT" and not isinstance(column.dtype, pd.StringDtype)):
        return None
    cells = column.astype(object)
    if not bool(cells.dropna().map(lambda cell: isinstance(cell, str) and cell.strip()[-3:-2] == ":").all()):
        return None
    parts = pd.to_numeric(table[header], errors="coerce")
    there = cells.notna().to_numpy() & np.isfinite(parts.to_numpy(dtype=float, na_value=np.nan))
    behind = np.char.mod(".%03d", parts[there].to_numpy(dtype=int)).astype(object)
    cells = cells.copy()
    cells[there] = cells[there].str.strip().to_numpy(dtype=object) + behind
    return cells, header


def _column(table: Mapping[str, pd.Series], names: tuple[str, ...], most: float) -> str | None:
    """The first column of one of some names whose numbers lie between 0 and a largest one."""
    # MM and mm beside each other are month and minute.
    cased = {header.strip() for header in table} >= {"MM", "mm"}
    for header, column in table.items():
        name = header.strip()
        if cased and name in ("MM", "mm") and (name == "MM") != ("month" in names):
            continue
        if (short(header) in names or (cased and name == "MM")) and (column.dtype.kind in "fiu"):
            values = column.to_numpy(dtype=float, na_value=np.nan)
            known = values[np.isfinite(values)]
            if known.size and known.min() >= 0 and known.max() <= most:
                return header
    return None


def _whole(values: Mapping[str, pd.Series]) -> bool:
    """Whether hours and minutes are whole numbers."""
    return all(bool((values[part].dropna() % 1 == 0).all()) for part in ("hour", "minute"))


def _texts(rows: np.ndarray) -> np.ndarray:
    """Moments, of rows of six numbers, or times of day, of three, as text; NaN where a number is missing."""
    forms = (*(("%04.0f-", "%02.0f-", "%02.0f ") if rows.shape[1] > 3 else ()), "%02.0f:", "%02.0f:", "%09.6f")
    whole = np.isfinite(rows).all(axis=1)
    cells = np.full(len(rows), np.nan, dtype=object)
    parts = [np.char.mod(form, column) for form, column in zip(forms, rows[whole].T)]
    cells[whole] = functools.reduce(np.char.add, parts)
    return cells
