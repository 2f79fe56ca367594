"""Missing samples of a log: marks and impossible numbers become NaN, and what is left out is counted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.numbers import counted
from shipid.trials import columns
from shipid.trials.errors import EmptyFileError, TrialError
from shipid.trials.logs.record import LenientRecord
from shipid.trials.missing_marks import marks_of_missing


def with_missing(record: LenientRecord) -> LenientRecord:
    """Return a log in which every missing sample is NaN.

    Rows without a single number are left out, and so are columns; the notes count them, and the missing samples of each column.

    Parameters
    ----------
    record : LenientRecord
        As printed.

    Returns
    -------
    LenientRecord

    Raises
    ------
    EmptyFileError
        If no column but the clock holds a sample.
    """
    notes = list(record.notes)
    values = {}
    for name, printed in record.values.items():
        marked = marked_samples(record, name)
        values[name] = np.where(marked, np.nan, printed)
        if marked.any():
            shown = ", ".join(f"{value:g}" for value in np.unique(printed[marked])[:3])
            first = record.line(int(np.flatnonzero(marked)[0]))
            notes.append(
                f"{name}: {counted(int(marked.sum()), 'sample is', 'samples are')} {shown}, which stands for a missing one, the first in row {first}."
            )
    rows = np.any([np.isfinite(column) for column in values.values()], axis=0)
    ticking = record.format is not None and record.format.interval is not None
    if (
        not rows.all() and rows.any() and not ticking
    ):  # where rows come at a fixed interval, an empty one is a tick of the clock
        notes.append(
            f"{counted(int((~rows).sum()), 'row')} without any number {'was' if (~rows).sum() == 1 else 'were'} left out of {len(rows)}."
        )
        record = replace(record, values=values).keep(rows)
        values = dict(record.values)
    empty = [name for name, column in values.items() if name != "t" and not np.isfinite(column).any()]
    for name in empty:
        notes.append(f"{name} holds no sample and was left out.")
        del values[name]
    if empty and not set(values) - {"t"}:
        raise EmptyFileError(
            f"{record.where} holds no sample in any column but the clock. Check that the sensors were on."
        )
    for name, column in values.items():
        if name != "t" and (count := int(np.isnan(column).sum())):
            notes.append(f"{name}: {count} of {len(column)} samples are missing.")
    return replace(record, values=values, notes=tuple(notes))


def marked_samples(record: LenientRecord, name: str) -> np.ndarray:
    """Return which samples of a column are marks of a missing one, or no number a sensor can show.

    Parameters
    ----------
    record : LenientRecord
        As printed.
    name : str
        The column.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    return marks_of_missing(record.values[name], _full_circle(record, name))


def _full_circle(record: LenientRecord, name: str) -> float | None:
    if name not in FIELDS or not FIELDS[name].wraps or name not in record.stated:
        return None
    try:
        return 2 * np.pi / columns.to_inside(name, record.stated[name])
    except TrialError:
        return None  # the conversion to SI says it better
