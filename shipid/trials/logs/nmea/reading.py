"""Read an NMEA 0183 log: from the file to raw columns on one clock."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np

from shipid.trials import checks
from shipid.trials.errors import LooksLikeDegreesError
from shipid.trials.logs.nmea.channels import is_magnetic, nothing_read, read_signals
from shipid.trials.logs.nmea.clock import read_clock
from shipid.trials.logs.nmea.errors import CalibrationError, NoOverlapError
from shipid.trials.logs.nmea.opening import read_log
from shipid.trials.logs.nmea.resampling import Signal, resample
from shipid.trials.logs.nmea.settings import NmeaFormat
from shipid.trials.logs.nmea.streams import separated
from shipid.trials.logs.record import LenientRecord

SHORTEST = 0.1
"""Shortest sampling interval that is taken by itself [s]."""

_UNITS = {
    "t": "s", "psi": "deg", "r": "deg/s", "delta": "deg", "delta_order": "deg", "u": "m/s", "v": "m/s", "SOG": "m/s",
    "COG": "rad",     "x": "m", "y": "m", "wind_speed": "m/s", "wind_direction": "rad", "wind_speed_relative": "m/s",
    "wind_direction_relative": "rad", "depth": "m",
    "phi": "deg", "n_engine": "rps",
}  # fmt: skip


def read_nmea(file: Path, fmt: NmeaFormat) -> tuple[LenientRecord, tuple[str, ...]]:
    """Read an NMEA 0183 log as raw columns with their units.

    Parameters
    ----------
    file : Path
        The log: one sentence a line, with or without the logger's stamp before it.
    fmt : NmeaFormat
        What the sentences leave open.

    Returns
    -------
    record : LenientRecord
        The columns on one clock, with notes on where each comes from and what was left out.
    comments : tuple of str
        The comment lines at the head of the file.

    Raises
    ------
    NoOverlapError
        If heading and rudder are nowhere known together.
    NmeaError
        One class a cause (`shipid.trials.logs.nmea.errors`).
    EmptyFileError, ClockError
        If there are no sentences, or the clock jumps back.
    """
    log = read_log(file, fmt)
    if not log.records:
        raise nothing_read(log)
    clock = read_clock(log, fmt)
    log = separated(log, clock.times)
    signals = read_signals(log, clock.times, fmt)
    leading = [name for name in signals if name in ("psi", "delta", "delta_order")][:2]
    leading = leading or [max(signals, key=lambda name: len(signals[name].t))]
    step = fmt.step or max(SHORTEST, round(signals[leading[0]].interval, 2))
    t, found, left_out = resample(signals, leading, step, fmt.gap)
    if not t.size:
        ends = "; ".join(f"{n} from {signals[n].t[0]:.4g} to {signals[n].t[-1]:.4g} s" for n in leading)
        raise NoOverlapError(
            f"{log.where}: heading and rudder are nowhere known together ({ends}). Check that both sensors were logged "
            "at once; a longer gap in [nmea] of a format file lets sparse sentences be interpolated."
        )
    columns = {"t": t} | _columns(t, found, fmt, signals)
    # Sentences count in degrees, and so does what is said of these columns.
    columns |= {name: np.degrees(columns[name]) for name in columns if _UNITS[name].startswith("deg")}
    notes = [f"NMEA 0183, resampled to {step:.4g} s by linear interpolation.", *clock.notes]
    notes += [note for name, signal in signals.items() if name in found for note in signal.notes]
    notes += _derived(columns, found, fmt, signals)
    notes += [*left_out, *log.notes]
    if log.others:
        seen = ", ".join(f"{address} ({n})" for address, n in log.others.most_common(10))
        rest = len(log.others) - 10
        notes.append(f"Sentences that are not read: {seen}" + (f" and {rest} others." if rest > 0 else "."))
    stated = {name: _UNITS[name] for name in columns}
    faults = _rate_fault(signals, log.where)
    return LenientRecord(file.stem, columns, stated, log.where, notes=tuple(notes), faults=faults), log.head


def _columns(
    t: np.ndarray, found: dict[str, np.ndarray], fmt: NmeaFormat, signals: dict[str, Signal]
) -> dict[str, np.ndarray]:
    """Return the trial's columns, of signals that have its clock."""
    psi = found["psi"][:, 0] if "psi" in found else None
    plain = ("psi", "r", "delta", "delta_order", "depth", "phi", "n_engine")
    result: dict[str, np.ndarray] = {name: found[name][:, 0] for name in plain if name in found}
    forward, starboard = fmt.antenna or (0.0, 0.0)
    if "position" in found:
        x, y = found["position"].T
        if psi is not None:
            x = x - forward * np.cos(psi) + starboard * np.sin(psi)
            y = y - forward * np.sin(psi) - starboard * np.cos(psi)
        result |= {"x": x, "y": y}
    if "speeds" in found:
        result |= dict(zip(("u", "v"), found["speeds"].T))
    if "course" in found or "bottom track" in found:
        speed, course = found["course" if "course" in found else "bottom track"].T
        north, east = speed * np.cos(course), speed * np.sin(course)
        if "course" in found and psi is not None and (forward or starboard):
            # The antenna goes round midship.
            r, c, s = _turning(t, found, signals["psi"]), np.cos(psi), np.sin(psi)
            north, east = north + r * (forward * s + starboard * c), east + r * (starboard * s - forward * c)
        result["SOG"] = np.hypot(north, east)
        result["COG"] = np.mod(np.arctan2(east, north), 2 * pi)
        if fmt.speed == "ground" and "speeds" not in found and psi is not None and not is_magnetic(signals["psi"]):
            c, s = np.cos(psi), np.sin(psi)
            result |= {"u": north * c + east * s, "v": east * c - north * s}
    for name, tail in (("wind", "_relative"), ("true wind", "")):
        if name in found:
            speed, along, across = found[name].T
            result["wind_speed" + tail] = speed
            result["wind_direction" + tail] = np.mod(np.arctan2(across, along), 2 * pi)
    return result


def _turning(t: np.ndarray, found: dict[str, np.ndarray], psi: Signal) -> np.ndarray:
    """Rate of turn [rad/s]; the slope of the heading where there is no ROT."""
    return found["r"][:, 0] if "r" in found else np.interp(t, psi.t, np.gradient(psi.values[:, 0], psi.t))


def _derived(
    columns: dict[str, np.ndarray], found: dict[str, np.ndarray], fmt: NmeaFormat, signals: dict[str, Signal]
) -> list[str]:
    """Say what was computed of several signals, and what is missing for it."""
    notes = []
    if "u" in columns and "speeds" not in found:
        notes.append(
            "u, v: of SOG, COG and psi, over ground, as the format file asks for (speed = 'ground'); a current is in them."
        )
    elif "u" not in columns and fmt.speed == "ground":
        notes.append(
            "WARNING: the format file asks for u over ground, and nothing gives it: it takes VBW with a speed over ground, "
            "or VTG or RMC beside a true heading."
        )
    elif "u" not in columns and "SOG" in columns:
        notes.append(
            "SOG is a speed over ground, and no sentence gives the speed through the water, u. State speed = 'ground' in "
            "[nmea] of a format file to have u and v of SOG, COG and psi; a current is then in them."
        )
    if fmt.antenna is not None and "psi" not in columns:
        notes.append("WARNING: x, y, SOG, COG are of the antenna: without a heading they cannot be brought to midship.")
    elif fmt.antenna is not None and {"position", "course"} & set(found):
        notes.append(
            f"x, y, SOG, COG are of midship: the antenna stands {fmt.antenna[0]:g} m forward and {fmt.antenna[1]:g} m to starboard "
            "of it."
        )
    elif "position" in found:
        notes.append("x, y are of the antenna; state [nmea.antenna] for those of midship.")
    if {"delta", "psi"} <= set(columns) and "r" not in columns:  # with ROT, every trial is checked
        slope = np.gradient(columns["psi"], columns["t"]) if len(columns["t"]) > 1 else columns["t"]
        if checks.turns_to_port(columns["t"], np.radians(columns["delta"]), np.radians(slope)):
            notes.append(
                "WARNING: positive RSA turns this ship to port: state sign = -1 in [nmea.rudder] of a format file."
            )
    return notes


def _rate_fault(signals: dict[str, Signal], where: str) -> tuple[CalibrationError, ...]:
    """Return the fault of a ROT that is not in the unit it is said to be in, by comparison with the heading."""
    if not {"psi", "r"} <= set(signals):
        return ()
    psi, rate = signals["psi"], signals["r"]
    inside = (psi.t >= rate.t[0]) & (psi.t <= rate.t[-1])
    if inside.sum() < checks.FEWEST_SAMPLES:
        return ()
    t = psi.t[inside]
    columns = {"t": t, "psi": psi.values[inside, 0], "r": np.interp(t, rate.t, rate.values[:, 0])}
    try:
        checks.check_angles(columns, {"psi": "deg", "r": "deg/s"}, where)
    except LooksLikeDegreesError as error:
        return (
            CalibrationError(
                f"{where}: ROT does not fit the heading: {error.finding}. State unit = 'deg/s' (or what the sensor sends) in "
                "[nmea.rate] of a format file, or leave_out = ['r'] in [nmea]."
            ),
        )
    return ()
