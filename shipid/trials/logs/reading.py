"""Read trial files: text with units in the header, text described by a format file, Parquet, NMEA 0183 logs."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from shipid.foundation.errors import MissingFileError, nearest
from shipid.trials import columns
from shipid.trials.errors import (
    ColumnUnitError,
    EmptyFileError,
    MissingExtraError,
    TextInColumnError,
    TrialError,
    UnknownColumnError,
    WindowError,
)
from shipid.trials.logs import text
from shipid.trials.logs.assembly import Raw, assemble, named_columns
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.nmea.reading import read_nmea
from shipid.trials.logs.nmea.settings import NmeaFormat, chosen_format
from shipid.trials.source import Source
from shipid.trials.trial import Trial

Span = tuple[float | None, float | None]


def read_trial(
    path: str | Path,
    format: str | Path | TrialFormat | None = None,
    window: str | Span | None = None,
) -> Trial:
    """Read a trial record; SI inside.

    Parameters
    ----------
    path : str or Path
        A text file (CSV and relatives) or a Parquet file; ``FILE@A:B`` reads a window of it in seconds of its own
        clock, ``FILE@name`` a window the format file names.
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
    TrialError
        One class a cause (`shipid.trials.errors`); the message names file, row and column and says what to do.
    """
    fmt = chosen_format(format)
    file, tail = _split(path)
    if tail is not None and window is not None:
        raise WindowError(f"'{path}' names a window and so does the argument window. Give one of the two.")
    span = _span(window if tail is None else tail, fmt, file)
    _check_file(file)
    if isinstance(fmt, NmeaFormat):
        raw, comments = read_nmea(file, fmt)
    elif file.suffix.lower() in (".parquet", ".pq"):
        raw, comments = _read_parquet(file, fmt)
    else:
        raw, comments = _read_text(file, fmt)
    comment = "\n".join(comments)
    source = Source(
        path=str(file),
        sha256=_sha256(file),
        format=fmt.name if fmt else None,
        simulated="simulated" in (comments[0].lower() if comments else ""),
        comment=comment,
    )
    cut = span is not None and _has_holes(raw) and (fmt is None or fmt.interval is None)
    if span is not None and cut:
        # Outside the window the record may be as broken as it likes.
        _cut(raw, span, file)
    trial = Trial(**assemble(raw, file.stem, source, fmt))
    return trial if span is None else trial.window(*span)


def _split(path: str | Path) -> tuple[Path, str | None]:
    """Split ``FILE@WINDOW``; a file whose own name has an '@' is taken whole when it is there."""
    whole = Path(path)
    if whole.exists() or "@" not in whole.name:
        return whole, None
    stem, _, tail = str(path).rpartition("@")
    # Neither is there: a name like a@b.csv is more likely a file that is missing than a window of one.
    return (Path(stem), tail) if Path(stem).exists() or ":" in tail else (whole, None)


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


def _check_file(file: Path) -> None:
    if not file.exists():
        siblings = [p.name for p in file.parent.iterdir() if p.is_file()] if file.parent.is_dir() else []
        close = nearest(file.name, siblings) if siblings else ""
        close = close if close.startswith("Did") else ""
        raise MissingFileError(f"there is no file '{file}'. {close}Check the path.")
    if file.is_dir():
        raise MissingFileError(f"'{file}' is a folder. Name one trial file in it.")
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


def _read_text(file: Path, fmt: TrialFormat | None) -> tuple[Raw, tuple[str, ...]]:
    layout = text.lay_out(file, fmt)
    where = f"'{file}'"
    if fmt is None:
        found, stated = named_columns({header: k for k, header in enumerate(layout.headers)}, {}, where)
    else:
        found, stated = _mapped(fmt, layout.headers, layout.width, where)
    table = text.parse(file, layout, list(found.values()))
    values = {name: table[index].to_numpy() for name, index in found.items()}
    raw = Raw(values, stated, where, partial(text.line_of, file, layout), list(layout.notes))
    return raw, layout.comments


def _mapped(
    fmt: TrialFormat, headers: tuple[str, ...], width: int, where: str
) -> tuple[dict[str, int], dict[str, str]]:
    """Find the columns a format file names: their indices and units."""
    by_header = {header: k for k, header in enumerate(headers)}
    bare = {columns.split_header(header)[0]: k for k, header in enumerate(headers)}
    found, stated = {}, {}
    for name, column in fmt.columns.items():
        if column.column is not None:
            index = by_header.get(column.column, bare.get(column.column))
            if index is None:
                raise UnknownColumnError(
                    f"{where} has no column '{column.column}', which the format file '{fmt.name}' names for {name}. "
                    f"{nearest(column.column, bare)}".rstrip()
                )
        else:
            assert column.index is not None
            index = column.index
            if index >= width:
                raise UnknownColumnError(
                    f"{where} has {width} columns, counted from 0, and the format file '{fmt.name}' wants number "
                    f"{index} for {name}. Correct the index, or the separator."
                )
        unit = column.unit or (columns.split_header(headers[index])[1] if index < len(headers) == width else None)
        if not unit:
            raise columns.no_unit(name, f"{where}, format file '{fmt.name}': ")
        found[name], stated[name] = index, unit
    return found, stated


def _read_parquet(file: Path, fmt: TrialFormat | None) -> tuple[Raw, tuple[str, ...]]:
    try:
        import pyarrow.parquet
    except ImportError:
        raise MissingExtraError(
            f"'{file}' is a Parquet file, and pyarrow is not installed. Install shipid[parquet], or convert it to CSV."
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
    if fmt is None:
        values, stated = named_columns(series, units, where)
    else:
        headers = tuple(series)
        found, stated = _mapped(_with_units(fmt, units), headers, len(headers), where)
        values = {name: series[headers[index]] for name, index in found.items()}
    numbers: dict[str, np.ndarray] = {}
    for name, column in values.items():
        if not pd.api.types.is_numeric_dtype(column.dtype):
            raise TextInColumnError(
                f"{where}, column '{name}': it holds {column.dtype}, not numbers. Write it as float64; "
                "time in seconds from the start of the record."
            )
        numbers[name] = column.to_numpy(dtype=float, na_value=np.nan)
    comment = (arrow.schema.metadata or {}).get(b"comment", b"").decode("utf-8", "replace")
    return Raw(numbers, stated, where), tuple(comment.splitlines())


def _arrow_units(schema: Any, frame: pd.DataFrame) -> dict[str, str]:
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


def _with_units(fmt: TrialFormat, units: dict[str, str]) -> TrialFormat:
    """Let the file's metadata state the units that the format file leaves open."""
    complete = {
        name: replace(column, unit=column.unit or units.get(column.column or ""))
        for name, column in fmt.columns.items()
    }
    return replace(fmt, columns=complete)


def _has_holes(raw: Raw) -> bool:
    return not all(np.isfinite(values).all() for values in raw.values.values())


def _cut(raw: Raw, span: Span, file: Path) -> None:
    """Cut a raw record to a window before it is checked."""
    try:
        t = raw.values["t"] * columns.to_inside("t", raw.stated["t"])
    except ColumnUnitError:
        return  # assemble() says it better
    start, end = (-np.inf if span[0] is None else span[0]), (np.inf if span[1] is None else span[1])
    slack = 1e-9 * max(1.0, *(abs(bound) for bound in (start, end) if np.isfinite(bound)), 1.0)
    keep = np.flatnonzero((t >= start - slack) & (t <= end + slack))
    if not keep.size:
        known = t[np.isfinite(t)]
        runs = f" The record runs from {known.min():g} to {known.max():g} s." if known.size else ""
        raise WindowError(f"the window {start:g}:{end:g} s holds no sample of '{file}'.{runs} Choose one inside it.")
    first, last = keep[0], keep[-1] + 1
    raw.values = {name: values[first:last] for name, values in raw.values.items()}
    raw.line = _shifted(raw.line, int(first))


def _shifted(line: Callable[[int], int], first: int) -> Callable[[int], int]:
    return lambda row: line(row + first)
