"""From a log to the units and axes of a trial: units, and what the format file puts right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.ndimage import median_filter

from shipid.declaration.vocabulary import FIELDS, angle
from shipid.foundation.numbers import brief
from shipid.trials import columns
from shipid.trials.filling import interpolated
from shipid.trials.holding import held_on_change, repeats_below_threshold, repeats_of
from shipid.trials.logs.format import TrialFormat
from shipid.trials.logs.positions import with_positions
from shipid.trials.logs.record import LenientRecord

#: What a ship's motion shows in every row if it is measured there.
_MEASURED = ("x", "y", "psi", "r", "u", "v", "U", "SOG", "COG", "phi")
GLITCH_WINDOW = 10.0
"""Heading glitches of up to half of this [s] can be distinguished from the motion of the ship."""


def without_trailing(record: LenientRecord) -> LenientRecord:
    """Drop the rows at the end of a log that hold no sample, where the format file says so.

    Parameters
    ----------
    record : LenientRecord
        As printed.

    Returns
    -------
    LenientRecord
        A note says how many were dropped.
    """
    if record.format is None or not record.format.drop_trailing:
        return record
    n = len(record)
    sound = np.flatnonzero(np.any([np.isfinite(values) for values in record.values.values()], axis=0))
    keep = int(sound[-1]) + 1 if sound.size else 0
    if keep == n:
        return record
    note = f"{n - keep} empty rows at the end were dropped."
    return replace(record.keep(np.arange(n) < keep), notes=(*record.notes, note))


def in_si(record: LenientRecord, fmt: TrialFormat | None) -> LenientRecord:
    """Convert a log to the units of a trial, with the signs, the factors and the clock of a format file.

    Parameters
    ----------
    record : LenientRecord
        As printed, every unit stated.
    fmt : TrialFormat or None
        What to put right besides units; None converts units only.

    Returns
    -------
    LenientRecord
        In the units inside a trial, latitude and longitude as x and y; `stated` is what the log said.

    Raises
    ------
    ColumnUnitError
        If a unit is unknown or does not fit its column, or a latitude is no place on the earth.
    """
    values: dict[str, np.ndarray] = {}
    notes = list(record.notes)
    for name, printed in record.values.items():
        factor = columns.to_inside(name, record.stated[name], record.where + ": ")
        if fmt is not None and name in fmt.columns:
            factor *= fmt.columns[name].sign * fmt.columns[name].scale
        values[name] = printed * factor
    if fmt is not None and fmt.interval is not None:
        values = {"t": np.arange(len(record)) * fmt.interval} | {k: v for k, v in values.items() if k != "t"}
        notes.append(f"t was rebuilt as n × {fmt.interval:.6g} s: the record's own clock is not used.")
    _hold_on_change(values, notes)
    return with_positions(replace(record, values=values, notes=tuple(notes)))


def _hold_on_change(values: dict[str, np.ndarray], notes: list[str]) -> None:
    """Hold what is written only when it changes, in place; the notes name it."""
    t = values.get("t")
    if t is None or not np.all(np.diff(t) > 0):
        return
    for name in [c for c in values if c in FIELDS and c != "t" and np.isnan(values[c]).any()]:
        printed = unwrapped(values[name]) if FIELDS[name].unit == "rad" else values[name]
        found = held_on_change(t, printed)
        if found is not None:
            filled = int(np.isfinite(found).sum() - np.isfinite(printed).sum())
            values[name] = found
            notes.append(
                f"{name} is written only when it changes: its value holds until the next, in {filled} of {t.size} rows."
            )
    order = values.get("delta_order")
    if order is None:
        return
    # Written in a row of the others it has the stamp of that row, and not one of its own.
    there = np.flatnonzero(np.isfinite(order))
    others = [np.isfinite(values[c]) for c in values if c in FIELDS and c not in ("t", "delta_order")]
    beside = np.any(others, axis=0)[there] if others else np.zeros(there.size, dtype=bool)
    if 2 <= there.size < 0.3 * t.size and np.mean(np.diff(order[there]) != 0) > 0.9 and beside.mean() > 0.8:
        last = np.searchsorted(there, np.arange(t.size), side="right") - 1
        values["delta_order"] = np.where(last >= 0, order[there[last.clip(0)]], np.nan)
        notes.append(
            f"delta_order is written only when it changes, in {there.size} of {t.size} rows: it holds until the next."
        )


def without_repeats(record: LenientRecord) -> LenientRecord:
    """Count the values that a slow sensor repeats in a faster record as missing: they are old, and say nothing new.

    Parameters
    ----------
    record : LenientRecord
        As `in_si` returns it.

    Returns
    -------
    LenientRecord
        The notes name the channels.
    """
    values, notes = dict(record.values), []
    for name in [c for c in _MEASURED if c in values]:
        printed = unwrapped(values[name]) if FIELDS[name].unit == "rad" else values[name]
        repeats, why = repeats_of(printed), "repeats the last value of a slower sensor"
        if repeats is None:
            repeats, why = (
                repeats_below_threshold(printed),
                "is written again only when it has moved by more than a threshold",
            )
        if repeats is not None:
            values[name] = np.where(repeats, np.nan, values[name])
            notes.append(f"{name} {why}: {int(repeats.sum())} of {len(repeats)} samples count as missing.")
    return replace(record, values=values, notes=(*record.notes, *notes)) if notes else record


def put_right(record: LenientRecord, fmt: TrialFormat) -> LenientRecord:
    """Put right what a format file names: heading glitches and frames. The notes say each, and the signs and factors.

    Parameters
    ----------
    record : LenientRecord
        As `in_si` returns it.
    fmt : TrialFormat
        The format.

    Returns
    -------
    LenientRecord
        The heading is unwrapped; it is left alone where the clock does not rise.
    """
    values, notes = dict(record.values), list(record.notes)
    for name, column in fmt.columns.items():
        if column.sign == -1:
            notes.append(f"the sign of {name} was changed: the record counts it positive the other way.")
        if column.scale != 1.0:
            notes.append(f"{name} was multiplied by {brief(column.scale, 6)}.")
        if column.note:
            notes.append(f"{name}: {column.note}")
        if column.frame == "from":
            values[name] = np.mod(values[name] + np.pi, 2 * np.pi)
            notes.append(f"{name} was turned by 180 deg: the record says where the wind comes from.")
    if "psi" in values and bool(np.all(np.diff(values["t"]) > 0)):
        t, psi = values["t"], values["psi"]
        there = np.isfinite(psi)
        r = interpolated(t, values["r"]) if fmt.glitch_threshold is not None else None
        if r is None or fmt.glitch_threshold is None:
            values["psi"] = unwrapped(psi)
        else:
            there &= np.isfinite(r)
            mended, bad = mended_heading(t[there], psi[there], r[there], fmt.glitch_threshold)
            values["psi"] = psi.copy()
            values["psi"][there] = mended
            values["psi"] = unwrapped(values["psi"])
            if bad:
                notes.append(
                    f"{bad} heading samples disagreed with r by more than {angle(fmt.glitch_threshold, 6)} and were "
                    "replaced by integrating r between good neighbours."
                )
    if any(column.frame == "earth" for column in fmt.columns.values()):
        psi = interpolated(values["t"], values["psi"])
        c, s = np.cos(psi), np.sin(psi)
        north, east = values["u"], values["v"]
        values["u"], values["v"] = north * c + east * s, east * c - north * s
        notes.append("u and v were rotated from the earth's axes to the ship's with psi.")
    return replace(record, values=values, notes=tuple(notes))


def unwrapped(angle: np.ndarray) -> np.ndarray:
    """Return an angle without the jumps of a full turn, over the samples that are there.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        In rad; NaN where a sample is missing.

    Returns
    -------
    ndarray, shape (n,)
    """
    result, there = angle.copy(), np.isfinite(angle)
    result[there] = np.unwrap(angle[there])
    return result


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
    turned = cumulative_trapezoid(r, t, initial=0.0)
    rest = np.exp(1j * (psi - turned))
    size = max(5, round(GLITCH_WINDOW / float(np.median(np.diff(t))))) | 1
    # Mirrored at the ends: repeating the first or the last sample would make a glitch there its own neighbour.
    middle = np.angle(
        median_filter(rest.real, size, mode="mirror") + 1j * median_filter(rest.imag, size, mode="mirror")
    )
    off = np.abs(np.angle(rest * np.exp(-1j * middle))) > threshold
    good = ~off
    slow = np.unwrap(np.angle(rest[good]))
    # Keep the turn the log began in: 370 deg stays 370 deg.
    slow += psi[good][0] - turned[good][0] - slow[0]
    return np.interp(t, t[good], slow) + turned, int(off.sum())
