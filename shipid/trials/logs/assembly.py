"""From raw columns to a trial: convert, put right, check, and note what was done."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
import pandas as pd
from scipy.ndimage import median_filter

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UnknownNameError
from shipid.trials import checks, columns
from shipid.trials.errors import HeaderError, TextInColumnError, UnknownColumnError
from shipid.trials.logs.format import TrialFormat
from shipid.trials.source import Source

T = TypeVar("T")

GLITCH_WINDOW = 10.0
"""Heading glitches up to half of this long [s] are told from the ship's motion."""


def _row(k: int) -> int:
    return k


@dataclass
class Raw:
    """A record as it was found: values by name inside the trial, and what is known about each.

    Attributes
    ----------
    values : dict of str to ndarray
        As printed, by name inside the trial.
    stated : dict of str to str
        The unit each column was said to have.
    where : str
        File or table, for messages.
    line : callable
        Gives the row number to name for a sample.
    """

    values: dict[str, np.ndarray]
    stated: dict[str, str]
    where: str
    line: Callable[[int], int] = _row
    notes: list[str] = field(default_factory=list)


def assemble_frame(
    frame: pd.DataFrame, *, name: str, units: Mapping[str, str], source: Source | None
) -> dict[str, Any]:
    """Return what a trial is made of, from a table in memory (see `Trial.from_frame`).

    Parameters
    ----------
    frame, name, units, source
        As for `Trial.from_frame`.
    """
    where = f"table '{name}'"
    values, stated = named_columns({str(c): frame[c] for c in frame.columns}, units, where)
    raw = Raw({key: _floats(key, series, where) for key, series in values.items()}, stated, where)
    return assemble(raw, name, source or Source(), None)


def _floats(name: str, series: pd.Series, where: str) -> np.ndarray:
    if pd.api.types.is_datetime64_any_dtype(series.dtype):
        raise TextInColumnError(
            f"{where}, column '{name}': it holds dates, not numbers. Write seconds since the start of the record."
        )
    numbers = pd.to_numeric(series, errors="coerce")
    text = numbers.isna() & series.notna()
    if text.any():
        k = int(np.flatnonzero(text)[0])
        raise TextInColumnError(
            f"{where}, row {k}, column '{name}': '{str(series.iloc[k])[:40]}' is not a number. "
            "Replace it by the number, or remove the row."
        )
    return numbers.to_numpy(dtype=float, na_value=np.nan)


def named_columns(found: Mapping[str, T], units: Mapping[str, str], where: str) -> tuple[dict[str, T], dict[str, str]]:
    """Read names and units from headers.

    Parameters
    ----------
    found : Mapping
        Columns by header; headers without a name are skipped.
    units : Mapping of str to str
        Units by name or header, for headers that say none.
    where : str
        File or table, for messages.

    Returns
    -------
    values, stated : dict
        The columns and their units, by name.

    Raises
    ------
    NoUnitError, UnknownColumnError, HeaderError
        If a column has no unit, there is no ``t``, or a name occurs twice.
    """
    values: dict[str, T] = {}
    stated: dict[str, str] = {}
    for header, column in found.items():
        name, unit = columns.split_header(header)
        if not name:
            continue
        if name in values:
            raise HeaderError(f"{where}: the header names '{name}' twice. Rename one of the two columns.")
        unit = unit or units.get(name) or units.get(header)
        if not unit:
            raise columns.no_unit(name, where + ", ")
        values[name], stated[name] = column, unit
    for name in units:
        if name not in values and name not in found:
            raise UnknownNameError("column", name, values)
    if "t" not in values:
        close = [n for n in values if n.lower() in ("time", "tvec", "seconds", "elapsed", "timestamp", "t_s")]
        rename = f"Rename '{close[0]}' to 't [s]'" if close else "Name the time column 't [s]'"
        raise UnknownColumnError(
            f"{where}: there is no time column 't' among {', '.join(values)}. {rename}, or map the columns in a "
            "format file."
        )
    return values, stated


def assemble(raw: Raw, name: str, source: Source, fmt: TrialFormat | None) -> dict[str, Any]:
    """Convert a raw record, put right what the format file says, and check it.

    Parameters
    ----------
    raw : Raw
        The record as found.
    name : str
        Name of the trial.
    source : Source
        Where it came from; the notes are added to its own.
    fmt : TrialFormat or None
        What to convert and repair besides units.

    Returns
    -------
    dict
        The fields of a `Trial`.

    Raises
    ------
    TrialError
        If the record is not sound (`shipid.trials.checks`).
    """
    where, line = raw.where, raw.line
    if fmt is not None and fmt.drop_trailing:
        _drop_trailing(raw)
    checks.check_length(len(next(iter(raw.values.values()))), where)
    checks.check_finite(raw.values, where, line)
    inside: dict[str, np.ndarray] = {}
    extra: dict[str, str] = {}
    for column, values in raw.values.items():
        factor = columns.to_inside(column, raw.stated[column], where + ": ")
        if fmt is not None and column in fmt.columns:
            factor *= fmt.columns[column].sign * fmt.columns[column].scale
        inside[column] = values * factor
        if column not in FIELDS:
            extra[column] = columns.inside_unit(column, raw.stated[column])
    if fmt is not None and fmt.interval is not None:
        inside = {"t": np.arange(len(values)) * fmt.interval, **{k: v for k, v in inside.items() if k != "t"}}
        raw.notes.append(f"t was rebuilt as n × {fmt.interval:.6g} s: the record's own clock is not used.")
    checks.check_clock(inside["t"], where, line)
    checks.check_angles(inside, raw.stated, where)
    if fmt is not None:
        _convert(inside, fmt, raw.notes)
    elif "psi" in inside:
        inside["psi"] = np.unwrap(inside["psi"])
    _remark(inside, raw.notes)
    order = ["t", *(c for c in FIELDS if c in inside and c != "t"), *extra]
    table = pd.DataFrame({c: np.ascontiguousarray(inside[c], dtype=float) for c in order})
    source = replace(source, notes=(*source.notes, *raw.notes))
    return {"name": name, "table": table, "source": source, "ship": fmt.ship if fmt else None, "units": extra}


def _drop_trailing(raw: Raw) -> None:
    """Drop the rows at the end of a record in which a column is empty."""
    sound = np.flatnonzero(np.all([np.isfinite(values) for values in raw.values.values()], axis=0))
    n = len(next(iter(raw.values.values())))
    keep = int(sound[-1]) + 1 if sound.size else 0
    if keep < n:
        raw.values = {name: values[:keep] for name, values in raw.values.items()}
        raw.notes.append(f"{n - keep} empty rows at the end were dropped.")


def _convert(inside: dict[str, np.ndarray], fmt: TrialFormat, notes: list[str]) -> None:
    """Put right what the format file names: signs, factors, glitches, frames. The notes say each."""
    for name, column in fmt.columns.items():
        if column.sign == -1:
            notes.append(f"{name} was turned over: the record counts it positive the other way.")
        if column.scale != 1.0:
            notes.append(f"{name} was multiplied by {column.scale:.6g}.")
        if column.note:
            notes.append(f"{name}: {column.note}")
        if column.frame == "from":
            inside[name] = np.mod(inside[name] + np.pi, 2 * np.pi)
            notes.append(f"{name} was turned by 180 deg: the record says where the wind comes from.")
    if "psi" in inside:
        if fmt.glitch_threshold is None:
            inside["psi"] = np.unwrap(inside["psi"])
        else:
            inside["psi"], bad = mended_heading(inside["t"], inside["psi"], inside["r"], fmt.glitch_threshold)
            if bad:
                shown = np.degrees(fmt.glitch_threshold)
                notes.append(
                    f"{bad} heading samples disagreed with r by more than {shown:g} deg and were replaced by "
                    "integrating r between good neighbours."
                )
    if any(column.frame == "earth" for column in fmt.columns.values()):
        east_of = np.cos(inside["psi"]), np.sin(inside["psi"])
        north, east = inside["u"], inside["v"]
        inside["u"] = north * east_of[0] + east * east_of[1]
        inside["v"] = east * east_of[0] - north * east_of[1]
        notes.append("u and v were rotated from the earth's axes to the ship's with psi.")


def mended_heading(t: np.ndarray, psi: np.ndarray, r: np.ndarray, threshold: float) -> tuple[np.ndarray, int]:
    """Unwrap a heading with the help of the rate of turn, and replace samples that disagree with it.

    What is left of the heading when the integral of r is taken off changes slowly (the bias of the gyro). A
    sample that sticks out of its running median by more than the threshold is a glitch, be it a jump of the
    compass or an interpolation across 0/360; it is replaced by the integral of r, hung between its neighbours.

    Parameters
    ----------
    t, psi, r : ndarray, shape (n,)
        Time [s], heading as logged [rad], rate of turn [rad/s].
    threshold : float
        How far a sample may stick out [rad].

    Returns
    -------
    psi : ndarray, shape (n,)
        Heading, unwrapped.
    count : int
        How many samples were replaced.
    """
    turned = np.concatenate(([0.0], np.cumsum(0.5 * (r[1:] + r[:-1]) * np.diff(t))))
    rest = np.exp(1j * (psi - turned))
    size = max(5, round(GLITCH_WINDOW / float(np.median(np.diff(t))))) | 1
    middle = np.arctan2(median_filter(rest.imag, size, mode="nearest"), median_filter(rest.real, size, mode="nearest"))
    off = np.abs(np.angle(rest * np.exp(-1j * middle))) > threshold
    good = ~off
    slow = np.unwrap(np.angle(rest[good]))
    # Keep the turn the log began in: 370 deg stays 370 deg.
    slow += psi[good][0] - turned[good][0] - slow[0]
    return np.interp(t, t[good], slow) + turned, int(off.sum())


def _remark(inside: Mapping[str, np.ndarray], notes: list[str]) -> None:
    """Note what a reader should know and no check refuses."""
    t = inside["t"]
    found = checks.gaps(t)
    if found.size:
        k = int(found[np.argmax(np.diff(t)[found])])
        notes.append(f"The clock has {found.size} gaps, the longest from {t[k]:g} to {t[k + 1]:g} s.")
    if {"delta", "r"} <= set(inside) and checks.turns_to_port(t, inside["delta"], inside["r"]):
        notes.append(
            "WARNING: positive rudder turns this ship to port. shipid counts delta and r positive to starboard: "
            "state sign = -1 for the column that is not, in a format file."
        )
