"""Read logs and trials: tables of every kind of file, with units in the header or described by a format file, and NMEA."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from shipid.foundation.errors import MissingFileError, UsageError, nearest
from shipid.foundation.numbers import moment
from shipid.trials import columns
from shipid.trials.conditions import Conditions
from shipid.trials.errors import EmptyFileError, TrialError, WindowError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.nmea.opening import is_nmea, why_no_nmea
from shipid.trials.logs.nmea.reading import read_nmea
from shipid.trials.logs.nmea.settings import NmeaFormat, chosen_format
from shipid.trials.logs.record import LenientRecord, Span, inside
from shipid.trials.logs.strict import sound_table
from shipid.trials.logs.tables.reading import read_table
from shipid.trials.logs.tables.table import record_of
from shipid.trials.source import origin_in
from shipid.trials.trial import Trial


def read_trial(
    path: str | Path,
    format: str | Path | TrialFormat | None = None,
    window: str | Span | None = None,
) -> Trial:
    """Read a trial record; SI inside.

    Parameters
    ----------
    path : str or Path
        A text file (CSV and relatives), an Excel workbook, a MATLAB, HDF5 or Parquet file; ``FILE@A:B`` reads a window of it in
        seconds of its own clock, ``FILE@name`` a window the format file names, ``FILE#SHEET`` one of several sheets, structs or
        groups, ``FILE.zip#LOG`` one of several files of an archive.
    format : str, Path or TrialFormat, optional
        A trial format file (`shipid.trials.logs.format`), for records whose headers do not speak for themselves;
        ``"nmea"`` for an NMEA 0183 log, or a format file with ``[nmea]`` (`shipid.trials.logs.nmea.settings`).
    window : str or tuple, optional
        ``(start, end)`` in seconds, ``"start:end"``, or a name from the format file.

    Returns
    -------
    Trial

    Raises
    ------
    WindowError
        If the window is not one of the record.
    TrialError
        One class a cause (`shipid.trials.errors`); the message names file, row and column and says what to do.
    """
    if window is not None and split_window(path)[2] is not None:
        raise WindowError(f"'{path}' names a window and so does the argument window. Give one of the two.")
    record = read_record(path, format, window)
    record.refuse()
    span = record.window
    if span is not None and not np.isfinite(record.values.get("t", np.zeros(1))).all():
        # Rows without a time outside the window do not matter.
        record = _cut(record, span)
    sound = sound_table(record)
    trial = Trial(record.name, sound.table, sound.source, record.ship, sound.units)
    return trial if span is None else trial.window(*span)


#: Trials as a caller may give them: one or several, in memory or as files.
Trials: TypeAlias = "Trial | str | Path | Sequence[Trial | str | Path]"


def trials_of(given: Trials) -> list[Trial]:
    """Return trials that a caller gives as they are, or by their files.

    Parameters
    ----------
    given : Trial, str, Path or sequence of them
        One trial or several; a file is read as by `read_trial`.

    Raises
    ------
    UsageError
        If it is something else.
    TrialError
        Of a file that cannot be read.
    """
    several = [given] if isinstance(given, (Trial, str, Path)) else given
    if not isinstance(several, (list, tuple)):
        table = " A table of pandas becomes one by shipid.Trial.from_frame." if hasattr(given, "columns") else ""
        raise UsageError(
            f"a trial is a shipid.Trial or the path of a log, or a list of them; this is a {type(given).__name__}.{table}"
        )
    found = []
    for one in several:
        if not isinstance(one, (Trial, str, Path)):
            raise UsageError(f"a trial is a shipid.Trial or the path of a log; this is a {type(one).__name__}.")
        found.append(one if isinstance(one, Trial) else read_trial(one))
    return found


def read_record(
    path: str | Path,
    format: str | Path | TrialFormat | None = None,
    window: str | Span | None = None,
) -> LenientRecord:
    """Read a log as it was written: nothing is converted or left out, and what is wrong is noted.

    Parameters
    ----------
    path, format, window
        As for `read_trial`.

    Returns
    -------
    LenientRecord
        The whole log; its `window` is the stretch that is wanted.

    Raises
    ------
    MissingFileError
        If there is no such file.
    TrialError
        If it cannot be read at all; the message names the line.
    """
    fmt = chosen_format(format)
    file, part, tail = split_window(path)
    wanted = window if tail is None else tail
    span = _span(wanted, fmt, file)
    _check_file(file)
    if fmt is None and is_nmea(file, part):
        fmt = NmeaFormat("nmea", {})
    if isinstance(fmt, NmeaFormat):
        record, comments = read_nmea(file, fmt, part)
    else:
        try:
            table = read_table(file, fmt, part)
        except TrialError:
            fault = why_no_nmea(file, part) if fmt is None else None
            if fault is not None:
                raise fault from None
            raise
        record, comments = record_of(table, fmt), table.comments
    source = replace(
        record.source,
        path=str(file),
        sha256=_sha256(file),
        format=fmt.name if fmt else None,
        simulated="simulated" in (comments[0].lower() if comments else ""),
        comment="\n".join(comments),
        # Positions that count from a fix do so whatever a comment says of the trial they were written from.
        origin=record.source.origin or origin_in("\n".join(comments)),
    )
    asked = wanted if span is None or isinstance(wanted, str) else ":".join("" if b is None else f"{b:g}" for b in span)
    title = record.name if asked is None else f"{record.name}@{asked}"
    if fmt is not None:
        # What is stated of the window counts more than what is stated of its log, and that more than what is stated of all.
        names = [file.name, file.stem, *([wanted] if isinstance(wanted, str) else []), title]
        stated = [fmt.of_one[name] for name in dict.fromkeys(names) if name in fmt.of_one]
        source = replace(source, conditions=functools.reduce(Conditions.with_those, stated, fmt.conditions))
        record = replace(record, notes=(*record.notes, *_of_no_log(fmt, names, file)))
    ship = fmt.ship if fmt else None
    return replace(record, source=source, format=fmt, ship=ship, window=span, title=title)


def split_window(path: str | Path) -> tuple[Path, str | None, str | None]:
    """Split ``FILE#SHEET@WINDOW``; a file whose own name has a '#' or an '@' is taken whole when it is there.

    Parameters
    ----------
    path : str or Path
        As a user writes it.

    Returns
    -------
    file : Path
        The file.
    part : str or None
        What stands behind the '#': a sheet, struct or group.
    window : str or None
        What stands behind the '@'.
    """
    whole = Path(path)
    if whole.exists():
        return whole, None, None
    stem, at, tail = str(path).rpartition("@")
    if at and Path(stem).exists():
        return Path(stem), None, tail
    for text, window in ((stem, tail), (str(path), None)):
        file, sharp, _ = text.rpartition("#")
        while sharp and not Path(file).exists():  # a file of an archive may name its sheet in turn
            file, sharp, _ = file.rpartition("#")
        if sharp:
            return Path(file), text[len(file) + 1 :], window
    # None is there: a name like a@b.csv is more likely a file that is missing than a window of one.
    return (Path(stem), None, tail) if at and "@" in whole.name and ":" in tail else (whole, None, None)


def _span(window: str | Span | None, fmt: TrialFormat | None, file: Path) -> Span | None:
    if window is None:
        return None
    if not isinstance(window, str):
        start, end = window
        return start, end
    if fmt is not None and window in fmt.windows:
        named = fmt.windows[window]
        return named.start, named.end
    first, colon, second = window.partition(":")
    try:
        if not colon:
            raise ValueError
        return (float(first) if first.strip() else None, float(second) if second.strip() else None)
    except ValueError:
        names = "The format file names no windows. " if fmt else "Named windows need a format file. "
        if fmt is not None and fmt.windows:
            names = nearest(window, fmt.windows)
        raise WindowError(
            f"'{window}' is not a window of '{file}'. Write start:end in seconds, as in '{file.name}@100:250'. "
            f"{names}".strip()
        ) from None


def _of_no_log(fmt: TrialFormat, names: Sequence[str], file: Path) -> tuple[str, ...]:
    """Say which names under ``[trials]`` are those of no log, a warning where this log has no entry of its own."""
    others = [name for name in fmt.of_one if name not in names]
    if not others:
        return ()
    logs = {name for path in file.parent.iterdir() if path.is_file() for name in (path.name, path.stem)}

    def is_there(name: str) -> bool:
        log, _, tail = name.rpartition("@")
        return name in logs or name in fmt.windows or (log in logs and (tail in fmt.windows or ":" in tail))

    lost = [name for name in others if not is_there(name)]
    if not lost:
        return ()
    close = nearest(lost[0], {file.stem, file.name, *fmt.windows, *logs}).strip()
    told = (
        f"{'' if len(others) < len(fmt.of_one) else 'WARNING: '}the format file '{fmt.name}' states conditions of "
        f"{', '.join(map(repr, lost[:5]))}{', ...' if len(lost) > 5 else ''}, and neither this log nor one beside it nor a window is "
        f"called that: they count for nothing here."
    )
    return (f"{told} {close}" if close.startswith("Did") else told,)


def _check_file(file: Path) -> None:
    if not file.exists():
        siblings = [p.name for p in file.parent.iterdir() if p.is_file()] if file.parent.is_dir() else []
        close = nearest(file.name, siblings) if siblings else ""
        close = close if close.startswith("Did") else ""
        raise MissingFileError(f"there is no file '{file}'. {close}Check the path.")
    if file.is_dir():
        raise MissingFileError(
            f"'{file}' is a folder. Name a trial in it, or several where a command takes them, as in FOLDER/*.csv."
        )
    try:
        with file.open("rb") as stream:
            if not stream.read(1):
                raise EmptyFileError(
                    f"'{file}' is empty (0 bytes). Check that the log was written and copied completely."
                )
    except OSError as error:
        raise MissingFileError(f"'{file}' cannot be opened: {error.strerror}. Check its permissions.") from None


def _sha256(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _cut(record: LenientRecord, span: Span) -> LenientRecord:
    """Cut a log to a window before it is checked: from the first sample inside it to the last."""
    try:
        t = record.values["t"] * columns.to_inside("t", record.stated["t"])
    except TrialError:
        return record  # the conversion to SI says it better
    within = np.flatnonzero(inside(t, span))
    if not within.size:
        start, end = ("" if one is None else moment(one) for one in span)
        known = t[np.isfinite(t)]
        runs = f" The record runs from {moment(known.min())} to {moment(known.max())} s." if known.size else ""
        raise WindowError(f"the window {start}:{end} s holds no sample of {record.where}.{runs} Choose one inside it.")
    rows = np.arange(len(record))
    return record.keep((rows >= within[0]) & (rows <= within[-1]))
