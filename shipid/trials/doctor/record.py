"""A record as the doctor sees it: read leniently, with everything kept that `read_trial` refuses."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.trials import columns
from shipid.trials.errors import ColumnUnitError, TextInColumnError, TrialError, UnknownColumnError
from shipid.trials.logs import reading, text
from shipid.trials.logs.format import TrialFormat
from shipid.trials.trial import Trial

_ALIASES: dict[str, tuple[str, ...]] = {
    "t": ("time", "tvec", "seconds", "elapsed", "timestamp", "t_s", "sec"),
    "x": ("n", "north", "northing", "x0", "x_position_mid", "x_pos", "pos_x"),
    "y": ("e", "east", "easting", "y0", "y_position_mid", "y_pos", "pos_y"),
    "psi": ("heading", "hdg", "psi_hat", "yaw", "hdt", "compass"),
    "r": ("rot", "yaw_rate", "yawrate", "r_angvelo", "rate_of_turn", "gyro"),
    "u": ("u_velo", "surge", "vx", "dx0/dt"),
    "v": ("vm_velo", "sway", "vy", "dy0/dt"),
    "U": ("speed", "sog", "stw"),
    "delta": ("rudder", "delta_rudder", "azi", "azimuth", "rudder_angle", "rsa"),
    "delta_order": ("rudder_order", "order"),
    "n": ("rpm", "n_prop", "rev", "revolutions"),
    "phi": ("roll", "heel"),
    "p": ("roll_rate", "rollrate"),
}


@dataclass
class Record:
    """A table in SI units as logged: NaN, repeated stamps and wraps included.

    Attributes
    ----------
    name : str
        Name of the trial.
    values : dict of str to ndarray
        By name inside a trial, with ``t``; SI, in the sign of the log.
    stated : dict of str to str
        The unit each column was said to have.
    extra : dict of str to str
        Units inside of columns that are not in the vocabulary.
    no_unit : list of str
        Columns that say no unit, for which the usual one was assumed.
    text_error : str or None
        What stands in a column of numbers and is none.
    """

    name: str
    values: dict[str, np.ndarray]
    stated: dict[str, str]
    extra: dict[str, str] = field(default_factory=dict)
    no_unit: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    path: str | None = None
    text_error: str | None = None
    ship: str | None = None
    comment: str = ""
    simulated: bool = False


def from_trial(trial: Trial) -> Record:
    """Return a trial as a record.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    return Record(
        trial.name,
        {c: trial[c].astype(float) for c in trial.table.columns},
        {c: trial.unit(c) for c in trial.table.columns},
        dict(trial.units),
        path=trial.source.path,
        ship=trial.ship,
        comment=trial.source.comment,
        simulated=trial.source.simulated,
    )


def read_record(path: str | Path, fmt: TrialFormat | None, *, treated: bool) -> Record:
    """Read a file leniently.

    Parameters
    ----------
    path : str or Path
        The file; ``FILE@A:B`` reads a window of it.
    fmt : TrialFormat or None
        What its columns are.
    treated : bool
        Whether to apply the signs, factors, frames and the clock of the format file; otherwise only its units count.

    Returns
    -------
    Record

    Raises
    ------
    TrialError
        If it cannot be read at all; the message names the line.
    """
    file, tail = reading._split(path)
    span = reading._span(tail, fmt, file)
    reading._check_file(file)
    if file.suffix.lower() in (".parquet", ".pq"):
        raw, comments = reading._read_parquet(file, fmt)
        record = Record(file.stem, dict(raw.values), dict(raw.stated))
    else:
        record, comments = _from_text(file, fmt)
    record.path, record.comment = str(file), "\n".join(comments)
    record.simulated = "simulated" in (comments[0].lower() if comments else "")
    record.ship = fmt.ship if fmt else None
    _to_si(record, fmt if treated else None)
    if span is not None:
        t = record.values["t"]
        start, end = (-np.inf if span[0] is None else span[0]), (np.inf if span[1] is None else span[1])
        keep = (t >= start - 1e-9) & (t <= end + 1e-9)
        record.values = {name: values[keep] for name, values in record.values.items()}
        record.name = f"{record.name}@{tail}"
    return record


def _from_text(file: Path, fmt: TrialFormat | None) -> tuple[Record, tuple[str, ...]]:
    try:
        layout = text.lay_out(file, fmt)
    except TrialError as error:
        raise _with_line(error, file) from None
    where = f"'{file}'"
    no_unit: list[str] = []
    notes = list(layout.notes)
    if fmt is None:
        found, stated = _named(layout.headers, where, no_unit, notes)
    else:
        found, stated = reading._mapped(fmt, layout.headers, layout.width, where)
    clock = "t" not in found
    wanted = sorted({*found.values(), *(range(layout.width) if clock else ())})
    problem = None
    try:
        table = text.parse(file, layout, wanted)
    except TextInColumnError as error:
        table, problem = _coerced(file, layout), str(error)
    values = {name: table[index].to_numpy(dtype=float) for name, index in found.items()}
    if clock:
        _own_clock(table, set(found.values()), values, stated, notes, fmt)
    return Record(file.stem, values, stated, no_unit=no_unit, notes=notes, text_error=problem), layout.comments


def _with_line(error: TrialError, file: Path) -> TrialError:
    """Name the line that stopped the reading, where the message does not yet."""
    if re.search(r"line \d", str(error)):
        return error
    with file.open("rb") as stream:
        number = next((k for k, line in enumerate(stream, 1) if line.strip() and not line.startswith(b"#")), 1)
    return type(error)(f"{error} It was line {number} that stopped the doctor.")


def _named(
    headers: tuple[str, ...], where: str, no_unit: list[str], notes: list[str]
) -> tuple[dict[str, int], dict[str, str]]:
    """Find columns by header, forgiving names and missing units."""
    known = {alias: name for name, aliases in _ALIASES.items() for alias in aliases}
    split = [columns.split_header(h) for h in headers]
    plain = {name for name, _ in split}
    found: dict[str, int] = {}
    stated: dict[str, str] = {}
    guessed = []
    for index, (header, unit) in enumerate(split):
        name = header
        if name not in FIELDS or (name == "n" and "N" in plain):
            alias = known.get(name.lower())
            name = alias if alias and alias not in plain else name
        if not name or name in found:
            continue
        if name != header:
            guessed.append(f"{name} is '{header}'")
        if not unit and name not in FIELDS:
            continue
        found[name], stated[name] = index, unit or columns.example_unit(name)
        if not unit:
            no_unit.append(name)
    if guessed:
        notes.append(f"Columns guessed from their headers: {', '.join(guessed)}.")
    if "t" not in found:
        raise UnknownColumnError(
            f"{where}: none of the columns {', '.join(h for h in headers if h) or 'of the header'} (line 1) is a clock. "
            "Name the time column 't [s]', or map the columns in a format file."
        )
    return found, stated


def _coerced(file: Path, layout: text.Layout) -> pd.DataFrame:
    """Parse the file with NaN for whatever is no number."""
    table = pd.read_csv(
        file,
        sep=layout.separator,
        skiprows=layout.skip,
        header=None,
        names=list(range(layout.width)),
        index_col=False,
        dtype=str,
        comment=layout.comment,
        encoding=layout.encoding,
        encoding_errors="replace",
    )
    if layout.decimal == ",":
        table = table.apply(lambda c: c.str.replace(",", "."))
    return table.apply(pd.to_numeric, errors="coerce")


def _own_clock(
    table: pd.DataFrame,
    used: set[int],
    values: dict[str, np.ndarray],
    stated: dict[str, str],
    notes: list[str],
    fmt: TrialFormat | None,
) -> None:
    """Find the clock the log itself prints, where the format file replaces it by an interval."""
    interval = fmt.interval if fmt is not None and fmt.interval is not None else 1.0
    n = len(table)
    stated["t"] = "s"
    for index in table.columns:
        if index in used:
            continue
        t = table[index].to_numpy(dtype=float)
        sound = t[np.isfinite(t)]
        runs_on = len(sound) > 9 and np.all(np.diff(sound) >= 0) and sound[-1] > sound[0]
        if runs_on and 0.9 < (sound[-1] - sound[0]) / (interval * (len(sound) - 1)) < 1.1:
            notes.append(f"The log's own clock is column {index}, which the format file replaces.")
            values["t"] = t
            return
    values["t"] = np.arange(n) * interval


def _to_si(record: Record, fmt: TrialFormat | None) -> None:
    """Convert to SI; with a format file, put right what it says."""
    for name in list(record.values):
        unit = record.stated[name]
        try:
            factor = columns.to_inside(name, unit)
        except ColumnUnitError:
            if name in FIELDS:
                record.no_unit.append(name)
                record.stated[name] = columns.example_unit(name)
                factor = columns.to_inside(name, record.stated[name])
            else:
                del record.values[name]
                continue
        if name not in FIELDS:
            record.extra[name] = columns.inside_unit(name, unit)
        if fmt is not None and name in fmt.columns:
            factor *= fmt.columns[name].sign * fmt.columns[name].scale
        record.values[name] = record.values[name] * factor
    if fmt is None:
        return
    if fmt.drop_trailing:
        sound = np.flatnonzero(np.all([np.isfinite(v) for v in record.values.values()], axis=0))
        keep = int(sound[-1]) + 1 if sound.size else 0
        record.values = {name: v[:keep] for name, v in record.values.items()}
    if fmt.interval is not None:
        record.values["t"] = np.arange(len(record.values["t"])) * fmt.interval
    _treat_heading(record.values, fmt)


def _treat_heading(values: dict[str, np.ndarray], fmt: TrialFormat) -> None:
    from shipid.trials.logs.assembly import mended_heading

    sound = all(np.isfinite(v).all() for v in values.values()) and bool(np.all(np.diff(values["t"]) > 0))
    if "psi" in values and sound:
        if fmt.glitch_threshold is None:
            values["psi"] = np.unwrap(values["psi"])
        else:
            values["psi"], _ = mended_heading(values["t"], values["psi"], values["r"], fmt.glitch_threshold)
    if any(c.frame == "earth" for c in fmt.columns.values()):
        c, s = np.cos(values["psi"]), np.sin(values["psi"])
        values["u"], values["v"] = values["u"] * c + values["v"] * s, values["v"] * c - values["u"] * s


def has_repairs(fmt: TrialFormat | None) -> bool:
    """Whether a format file puts anything right besides units.

    Parameters
    ----------
    fmt : TrialFormat or None
        The format file.
    """
    if fmt is None:
        return False
    changed: Any = [c.sign != 1 or c.scale != 1.0 or c.frame == "earth" for c in fmt.columns.values()]
    return any(changed) or fmt.interval is not None or fmt.glitch_threshold is not None or fmt.drop_trailing
