"""Rows of a table that are no samples: its header once more, at the head of each page, and what stands below the last sample."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pandas as pd

from shipid.foundation.numbers import counted
from shipid.trials.logs.clocks.headers import NAMES, short
from shipid.trials.logs.clocks.stamps import read_stamps
from shipid.trials.logs.tables.numerals import MISSING
from shipid.trials.logs.tables.table import RawTable

#: So many rows below the last sample are a summary or remarks, and not a log that was broken off.
_MOST_BELOW = 30
#: Fewer samples above them do not show what a sample looks like.
_FEWEST = 10
_WORD = re.compile(r"[^\W\d_]{2,}")


def samples_only(raw: RawTable) -> RawTable:
    """Leave out repeated headers, and the rows at the end that have a word in place of a time.

    Parameters
    ----------
    raw : RawTable
        As the file holds it.

    Returns
    -------
    RawTable
        A note says how many rows were left out.
    """
    repeated = _headers_again(raw)
    below = _below(raw, repeated)
    keep = ~repeated
    keep[below:] = False
    if keep.all():
        return raw
    notes = []
    if repeated.any():
        notes.append(
            f"{counted(int(repeated.sum()), f'{raw.row} repeats', f'{raw.row}s repeat')} the header, the first is {raw.row} "
            f"{raw.line(int(np.flatnonzero(repeated)[0]))}: no samples, and left out."
        )
    if below < len(keep):
        words = [str(cell).strip() for cell in raw.columns[_clock_of(raw)].iloc[below:].dropna()]
        shown = ", ".join(f"'{word[:30]}'" for word in words[:3]) + (", ..." if len(words) > 3 else "")
        notes.append(
            f"{counted(len(keep) - below, f'{raw.row} at the end has', f'{raw.row}s at the end have')} a word in place of a time ({shown}; "
            f"{raw.row} {raw.line(below)} is the first): no samples, and left out."
        )
    rows = np.flatnonzero(keep)
    line, printed = raw.line, raw.printed
    return replace(
        raw,
        columns=tuple(column[keep].reset_index(drop=True) for column in raw.columns),
        line=lambda row: line(int(rows[row])),
        printed=None if printed is None else lambda k: printed(k)[keep].reset_index(drop=True),
        notes=(*raw.notes, *notes),
    )


def _is_text(column: pd.Series) -> bool:
    return column.dtype.kind == "O" or isinstance(column.dtype, pd.StringDtype)


def _headers_again(raw: RawTable) -> np.ndarray:
    """Rows that hold nothing but the headers, or the units below them."""
    n = len(raw.columns[0])
    same, filled = np.zeros(n, dtype=int), np.zeros(n, dtype=int)
    if not raw.headers or not any(map(_is_text, raw.columns)):
        return np.zeros(n, dtype=bool)
    for k, column in enumerate(raw.columns):
        there = np.array(column.notna())
        if _is_text(column) and k < len(raw.headers):
            texts = column.map(lambda cell: cell.strip() if isinstance(cell, str) else cell)
            words = {raw.headers[k].strip(), raw.full_headers[k].strip(), (raw.units[k] or "").strip()} - {""}
            same += texts.isin(list(words)).to_numpy()
            there &= (texts != "").to_numpy(dtype=bool, na_value=True)
        filled += there
    return np.asarray((same == filled) & (same >= min(2, len(raw.columns))))


def _clock_of(raw: RawTable) -> int:
    """The column that is the clock by its name; else the first."""
    return next((k for k, header in enumerate(raw.headers) if short(header) in NAMES), 0)


def _below(raw: RawTable, repeated: np.ndarray) -> int:
    """The first of the rows below the last sample; the number of rows where there are none."""
    column = raw.columns[_clock_of(raw)]
    n = len(column)
    if not _is_text(column) or n < _FEWEST + 1:
        return n
    start = max(n - _MOST_BELOW - 1, 0)
    tail = column.iloc[start:].reset_index(drop=True)
    cells = tail.map(lambda cell: cell.strip() if isinstance(cell, str) else "" if pd.isna(cell) else "0")
    numbers = pd.to_numeric(cells.astype(object).str.replace(",", ".", regex=False), errors="coerce").notna().to_numpy()
    empty = cells.str.lower().isin([*MISSING, ""]).to_numpy() | repeated[start:]
    words = ~numbers & ~empty & np.array([_WORD.search(cell) is not None for cell in cells])
    if not words.any():
        return n
    words[words] = read_stamps(cells[words].tolist()).bad
    samples = np.flatnonzero(~words & ~empty)
    last = int(samples[-1]) if samples.size else -1
    behind = np.flatnonzero(words[last + 1 :])
    if last < 0 or not behind.size or start + last + 1 < _FEWEST:
        return n
    return start + last + 1 + int(behind[0])
