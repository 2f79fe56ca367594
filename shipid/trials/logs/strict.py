"""From a log to a trial: what is noted is refused, the rest converted, put right and checked."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.numbers import counted, moment
from shipid.trials import checks, columns
from shipid.trials.filling import usual_interval
from shipid.trials.logs.conversion import in_si, put_right, unwrapped, without_repeats, without_trailing
from shipid.trials.logs.drafting.names import open_columns, unread_columns
from shipid.trials.logs.following import with_following
from shipid.trials.logs.missing import with_missing
from shipid.trials.logs.record import LenientRecord
from shipid.trials.source import Source


@dataclass(frozen=True, eq=False)
class SoundTable:
    """What a trial is made of.

    Attributes
    ----------
    table : pandas.DataFrame
        Column ``t`` and further columns, in the units inside a trial; NaN where a sample is missing.
    source : Source
        Where it came from, and what was done to it.
    units : dict of str to str
        Units of the columns that are not in the vocabulary.
    """

    table: pd.DataFrame
    source: Source
    units: dict[str, str]


def sound_table(record: LenientRecord) -> SoundTable:
    """Make the table of a trial of a log.

    Parameters
    ----------
    record : LenientRecord
        The log, as printed.

    Returns
    -------
    SoundTable

    Raises
    ------
    TrialError
        If something is noted about the log, or the record is not sound (`shipid.trials.checks`).
    """
    record.refuse()
    where, line, fmt = record.where, record.line, record.format
    record = without_trailing(record)
    checks.check_length(len(record), where)
    record = with_missing(record)
    line = record.line
    checks.check_length(len(record), where)
    record = in_si(record, fmt)
    checks.check_stamped(record.values, where, line)
    checks.check_clock(record.values["t"], where, line)
    checks.check_angles(record.values, record.stated, where)
    record = without_repeats(record)
    if fmt is not None:
        record = put_right(record, fmt)
    values = dict(record.values)
    if fmt is None and "psi" in values:
        values["psi"] = unwrapped(values["psi"])
    followed = with_following(values)
    values = followed.values
    extra = {name: columns.inside_unit(name, record.stated[name]) for name in values if name not in FIELDS}
    order = ["t", *(c for c in FIELDS if c in values and c != "t"), *extra]
    table = pd.DataFrame({c: np.ascontiguousarray(values[c], dtype=float) for c in order})
    notes = (*record.source.notes, *record.notes, *followed.notes, *_remarks(table))
    return SoundTable(table, replace(record.source, notes=notes), extra)


def _remarks(table: pd.DataFrame) -> list[str]:
    """Return what a reader should know and no check refuses."""
    notes = []
    t = table["t"].to_numpy()
    channels = [table[c].to_numpy() for c in table.columns if c != "t"]
    found = checks.gaps(t, min((usual_interval(t, c) for c in channels), default=usual_interval(t)))
    if found.size:
        k = int(found[np.argmax(np.diff(t)[found])])
        notes.append(
            f"The clock has {counted(found.size, 'gap')}, the longest from {moment(t[k])} to {moment(t[k + 1])} s."
        )
    if {"delta", "r"} <= set(table) and checks.turns_to_port(t, table["delta"].to_numpy(), table["r"].to_numpy()):
        notes.append(
            "WARNING: positive rudder turns this ship to port. shipid counts delta and r positive to starboard: "
            "state sign = -1 for the column that is not, in a format file."
        )
    return notes + _unread(table)


def _unread(table: pd.DataFrame) -> list[str]:
    """What columns look like fields of the vocabulary that the log does not hold under their names."""
    headers = [str(header) for header in table.columns]
    lacking, unclear = unread_columns(headers, table.columns), open_columns(headers, table.columns)
    if not lacking and not unclear:
        return []
    told = (
        [f"{' and '.join(lacking.values())} look{'s' if len(lacking) == 1 else ''} like {' and '.join(lacking)}"]
        if lacking
        else []
    )
    told += [f"{header} can be {' or '.join(fields)}" for header, fields in unclear.items()]
    one = len(lacking) + len(unclear) == 1
    it, these, what = ("it", "this name", "the column") if one else ("them", "these names", "the columns")
    return [
        f"WARNING: {', '.join(told)}, and no model that comes with shipid reads {it} under {these}. Unless a model of your own does, rename "
        f"{what}, or write a format file: shipid format FILE drafts it."
    ]
