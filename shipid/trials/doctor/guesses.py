"""What the doctor takes a log for where it does not say: names of columns, units, the clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from shipid.declaration.vocabulary import FIELDS
from shipid.trials import columns
from shipid.trials.errors import ClockError, ColumnUnitError, NoUnitError, UnknownColumnError
from shipid.trials.logs.conversion import in_si, put_right
from shipid.trials.logs.drafting.names import meaning_of
from shipid.trials.logs.missing import marked_samples
from shipid.trials.logs.record import LenientRecord, inside
from shipid.trials.trial import Trial

#: What loggers call the columns of the vocabulary, in small letters.
_ALIASES: dict[str, tuple[str, ...]] = {
    "t": ("time", "tvec", "seconds", "elapsed", "timestamp", "t_s", "sec"),
    "x": ("n", "north", "northing", "x0", "x_position_mid", "x_pos", "pos_x"),
    "y": ("e", "east", "easting", "y0", "y_position_mid", "y_pos", "pos_y"),
    "psi": ("heading", "hdg", "psi_hat", "yaw", "hdt", "compass"),
    "r": ("rot", "yaw_rate", "yawrate", "r_angvelo", "rate_of_turn", "gyro"),
    "u": ("u_velo", "surge", "vx", "dx0/dt"),
    "v": ("vm_velo", "sway", "vy", "dy0/dt"),
    "U": ("speed", "stw"),
    "SOG": ("sog", "speed_over_ground"),
    "COG": ("cog", "course_over_ground"),
    "delta": ("rudder", "delta_rudder", "azi", "azimuth", "rudder_angle", "rsa"),
    "delta_order": ("rudder_order", "order"),
    "n": ("rpm", "n_prop", "rev", "revolutions"),
    "phi": ("roll", "heel"),
    "p": ("roll_rate", "rollrate"),
}


@dataclass(frozen=True, eq=False)
class GuessedRecord:
    """A log in SI units, with the names and units that were guessed.

    Attributes
    ----------
    record : LenientRecord
        In the units inside a trial; NaN, repeated stamps and wraps included. `stated` holds a unit for every column.
    assumed : Mapping of str to str or None
        Columns for which the usual unit was assumed, and the unit they say, which does not fit; None where they say none.
    marks : Mapping of str to Mapping of int to float
        By column and row the numbers, as printed, that stand for a missing sample; NaN in the record.
    names : Mapping of str to str
        Headers by the name that was guessed from them.
    unread : Mapping of str to str or None
        Columns of no field that were left out, and the unit they say, which is none; None where they say nothing.
    """

    record: LenientRecord
    assumed: Mapping[str, str | None] = field(default_factory=dict)
    marks: Mapping[str, Mapping[int, float]] = field(default_factory=dict)
    names: Mapping[str, str] = field(default_factory=dict)
    unread: Mapping[str, str | None] = field(default_factory=dict)


def from_trial(trial: Trial) -> GuessedRecord:
    """Return a trial as a log, of which nothing has to be guessed.

    Parameters
    ----------
    trial : Trial
        The trial.

    Returns
    -------
    GuessedRecord
    """
    names = trial.table.columns
    return GuessedRecord(
        LenientRecord(
            trial.name,
            {name: trial[name].astype(float) for name in names},
            {name: trial.unit(name) for name in names},
            f"trial '{trial.name}'",
            trial.source,
            ship=trial.ship,
            title=trial.name,
        )
    )


def guessed(record: LenientRecord, *, treated: bool) -> GuessedRecord:
    """Return a log in SI units, with guesses for what it does not say.

    Parameters
    ----------
    record : LenientRecord
        As printed.
    treated : bool
        Whether to apply the signs, factors, frames and the clock of the format file; otherwise only its units count.

    Returns
    -------
    GuessedRecord
        Its window, where one is wanted.

    Raises
    ------
    UnknownColumnError
        If no column can be the clock.
    NoUnitError
        If the only column that can be says no unit.
    ClockError
        If its stamps cannot be read.
    """
    fmt = record.format
    names: dict[str, str] = {}
    printed = record
    if fmt is None:
        record, names = _with_names(record)
    else:
        record = _with_clock(record)
    if "t" not in record.values:
        clocks = UnknownColumnError | NoUnitError | ClockError
        raise next(fault for fault in record.faults if isinstance(fault, clocks))
    record, assumed = _with_units(record)
    read = {*record.values, *names.values()}
    unread = {c: printed.stated.get(c) for c in printed.values if c not in read and not _fits(c, printed.stated)}
    notes, faults = record.notes, record.faults
    if record.window is not None and (fmt is None or fmt.interval is None):
        # Whether a number stands for a missing sample is judged by the samples of the window.
        clock = record.values["t"] * columns.to_inside("t", record.stated["t"])
        record = replace(record.keep(inside(clock, record.window)), window=None)
    record, marks = _without_marks(record)
    record = in_si(record, fmt if treated else None)
    if treated and fmt is not None and len(record):
        record = put_right(record, fmt)
    if record.window is not None:
        within = inside(record.values["t"], record.window)
        place = dict(zip(np.flatnonzero(within).tolist(), range(len(record))))
        record = record.keep(within)
        marks = {c: {place[k]: v for k, v in cells.items() if k in place} for c, cells in marks.items()}
    # What is done about a log stands in the findings, not in the notes.
    return GuessedRecord(replace(record, notes=notes, faults=faults), assumed, marks, names, unread)


def _without_marks(record: LenientRecord) -> tuple[LenientRecord, dict[str, dict[int, float]]]:
    """Count numbers that stand for a missing sample as missing."""
    values, marks = dict(record.values), {}
    for name, printed in record.values.items():
        marked = marked_samples(record, name)
        if marked.any():
            values[name] = np.where(marked, np.nan, printed)
            index = np.flatnonzero(marked)
            marks[name] = dict(zip(index.tolist(), printed[index].tolist()))
    return replace(record, values=values), marks


def _with_names(record: LenientRecord) -> tuple[LenientRecord, dict[str, str]]:
    """Take columns for those of the vocabulary by their usual names; leave out what says neither name nor unit.

    Returns
    -------
    record : LenientRecord
    names : dict of str to str
        Headers by the name that was guessed from them.
    """
    known = {alias: name for name, aliases in _ALIASES.items() for alias in aliases}
    values: dict[str, np.ndarray] = {}
    stated: dict[str, str] = {}
    words = dict(record.words)
    guesses: dict[str, str] = {}
    others: dict[str, list[str]] = {}
    # Of several columns that can be one quantity the first that moves is taken: a sensor that is stuck comes last.
    still = {header for header, column in record.values.items() if len(np.unique(column[np.isfinite(column)])) < 2}
    for header, column in sorted(record.values.items(), key=lambda item: item[0] in still):
        name = header
        if name not in FIELDS or (name == "n" and "N" in record.values):
            alias = known.get(name.lower()) or _usual(header, record.stated)
            name = alias if alias and alias not in record.values else name
            if name in guesses:
                others.setdefault(name, []).append(header + (" (it never changes)" if header in still else ""))
        if name in values or (name not in FIELDS and header not in record.stated):
            continue
        values[name] = column
        if header in record.words:
            words[name] = record.words[header]
        if header in record.stated:
            stated[name] = record.stated[header]
        elif (said := meaning_of(header).unit) and _fits(name, {name: said}):
            stated[name] = said
        if name != header:
            guesses[name] = header
    notes = tuple(
        f"{name} is taken from '{guesses[name]}'; {', '.join(left)} can be it, too. State the right one in a format file."
        for name, left in others.items()
    )
    return replace(record, values=values, stated=stated, words=words, notes=(*record.notes, *notes)), guesses


def _usual(header: str, stated: Mapping[str, str]) -> str | None:
    """The field of the vocabulary that a header in use means without doubt, and whose unit its own does not contradict."""
    meaning = meaning_of(header)
    if meaning.doubtful or not meaning.fields or meaning.fields[0] not in FIELDS:
        return None
    name = meaning.fields[0]
    return name if header not in stated or _fits(name, {name: stated[header]}) else None


def _with_clock(record: LenientRecord) -> LenientRecord:
    """Find the clock the log itself prints, where the format file replaces it by an interval."""
    if "t" in record.values or record.format is None or record.format.interval is None:
        return record
    interval, notes = record.format.interval, record.notes
    t = np.arange(len(record)) * interval
    for index, column in record.unused.items():
        sound = column[np.isfinite(column)]
        runs_on = len(sound) > 9 and np.all(np.diff(sound) >= 0) and sound[-1] > sound[0]
        if runs_on and 0.9 < (sound[-1] - sound[0]) / (interval * (len(sound) - 1)) < 1.1:
            t, notes = column, (*notes, f"The log's own clock is column {index}, which the format file replaces.")
            break
    return replace(record, values={**record.values, "t": t}, stated={**record.stated, "t": "s"}, notes=notes)


def _with_units(record: LenientRecord) -> tuple[LenientRecord, dict[str, str | None]]:
    """Assume the usual unit of a column of the vocabulary that says none that fits; leave out others that do not."""
    values, stated = dict(record.values), dict(record.stated)
    assumed: dict[str, str | None] = {}
    for name in record.values:
        if _fits(name, stated):
            continue
        if name in FIELDS:
            assumed[name] = stated.get(name)
            stated[name] = FIELDS[name].display
        else:
            del values[name]
    return replace(record, values=values, stated=stated), assumed


def _fits(name: str, stated: Mapping[str, str]) -> bool:
    try:
        return name in stated and bool(columns.to_inside(name, stated[name]))
    except ColumnUnitError:
        return False
