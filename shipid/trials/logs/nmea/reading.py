"""Read an NMEA log: from the file to raw columns."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np

from shipid.foundation.numbers import brief, counted, moment
from shipid.trials import checks
from shipid.trials.errors import LooksLikeDegreesError
from shipid.trials.filling import interpolated
from shipid.trials.logs.nmea.channels import is_magnetic, nothing_read, read_signals
from shipid.trials.logs.nmea.clock import read_clock
from shipid.trials.logs.nmea.errors import CalibrationError, NoOverlapError
from shipid.trials.logs.nmea.log import NmeaLog
from shipid.trials.logs.nmea.opening import read_log
from shipid.trials.logs.nmea.resampling import Channel, Signal, resample, united
from shipid.trials.logs.nmea.settings import NmeaFormat
from shipid.trials.logs.nmea.streams import separated
from shipid.trials.logs.record import LenientRecord
from shipid.trials.source import Source

_UNITS = {
    "t": "s", "psi": "deg", "r": "deg/s", "delta": "deg", "delta_order": "deg", "u": "m/s", "v": "m/s", "SOG": "m/s",
    "COG": "rad",     "x": "m", "y": "m", "wind_speed": "m/s", "wind_direction": "rad", "wind_speed_relative": "m/s",
    "wind_direction_relative": "rad", "depth": "m",
    "phi": "deg", "n_engine": "rps",
}  # fmt: skip


def read_nmea(file: Path, fmt: NmeaFormat, part: str | None = None) -> tuple[LenientRecord, tuple[str, ...]]:
    """Read an NMEA 0183 log as raw columns with their units.

    Parameters
    ----------
    file : Path
        The log: one sentence a line, with or without the logger's stamp before it.
    fmt : NmeaFormat
        What the sentences leave open.
    part : str, optional
        The file in a zip archive.

    Returns
    -------
    record : LenientRecord
        The columns, each at its own stamps or on one clock, with notes on where each comes from and what was left out.
    comments : tuple of str
        The comment lines at the head of the file.

    Raises
    ------
    NoOverlapError
        If the format file asks for one clock, and heading and rudder are nowhere known together.
    NmeaError
        One class a cause (`shipid.trials.logs.nmea.errors`).
    EmptyFileError, ClockError
        If there are no sentences, or the clock jumps back.
    """
    log = read_log(file, fmt, part)
    if not log.records:
        raise nothing_read(log)
    clock = read_clock(log, fmt)
    apart = separated(log, clock.times)
    if apart.records.keys() != log.records.keys():
        # Two devices that each speak once are not one that speaks twice, evenly.
        clock = read_clock(apart, fmt)
    log = apart
    signals = read_signals(log, clock.times, fmt)
    standard = "NMEA 2000" if all(origin.kind.isdigit() for origin in log.records) else "NMEA 0183"
    notes = [f"{standard}.", *clock.notes]
    left_out: list[str] = []
    if fmt.step is not None:
        signals, left_out = _resampled(signals, fmt.step, fmt.gap, log.where)
        notes[0] = f"{standard}, resampled to {brief(fmt.step, 4)} s by linear interpolation."
    t, columns, rule = united(_channels(signals, fmt))
    columns = {"t": t} | columns
    # Sentences count in degrees, and so does what is said of these columns.
    columns |= {name: np.degrees(columns[name]) for name in columns if _UNITS[name].startswith("deg")}
    notes += rule + [note for signal in signals.values() for note in signal.notes]
    notes += _derived(columns, fmt, signals)
    notes += [*left_out, *log.notes, *_never_valid(log, columns)]
    if log.others:
        seen = ", ".join(f"{address} ({n})" for address, n in log.others.most_common(10))
        rest = len(log.others) - 10
        notes.append(f"Sentences that are not read: {seen}" + (f" and {rest} others." if rest > 0 else "."))
    stated = {name: _UNITS[name] for name in columns}
    faults = _rate_fault(signals, log.where)
    source = Source(origin=signals["position"].origin if "position" in signals else None)
    record = LenientRecord(file.stem, columns, stated, log.where, source, notes=tuple(notes), faults=faults)
    return record, log.head


def _never_valid(log: NmeaLog, columns: dict[str, np.ndarray]) -> list[str]:
    """Say which sentences never carry a valid value, where the trial lacks what they stand for."""
    notes = []
    for origin, records in log.records.items():
        lacking = {"RSA": "delta", "ROR": "delta_order", "HDT": "psi", "THS": "psi", "HDG": "psi", "HDM": "psi"}.get(
            origin.kind
        )
        if lacking is not None and lacking not in columns and np.isnan(records.values).all():
            count = counted(len(records.order), f"sentence {origin.name} is", f"sentences {origin.name} are")
            notes.append(
                f"WARNING: {lacking} is missing: {count} there, all of them empty or marked as not valid (status V)."
            )
    return notes


def _resampled(
    signals: dict[str, Signal], step: float, gap: float | None, where: str
) -> tuple[dict[str, Signal], list[str]]:
    """Signals on one clock of multiples of `step`, and what was left out for it."""
    leading = [name for name in signals if name in ("psi", "delta", "delta_order")][:2]
    leading = leading or [max(signals, key=lambda name: len(signals[name].t))]
    t, found, left_out = resample(signals, leading, step, gap)
    if len(t) < 2:
        ends = "; ".join(f"{n} from {moment(signals[n].t[0])} to {moment(signals[n].t[-1])} s" for n in leading)
        raise NoOverlapError(
            f"{where}: {' and '.join(leading)} are nowhere known together ({ends}). Leave out interval in [nmea] of the format "
            "file, so that each signal keeps its own clock; or a longer gap lets sparse sentences be interpolated."
        )
    return {name: replace(signals[name], t=t, values=values) for name, values in found.items()}, left_out


def _channels(signals: dict[str, Signal], fmt: NmeaFormat) -> dict[str, Channel]:
    """Return the trial's columns, each at the times of its own signal."""
    plain = ("psi", "r", "delta", "delta_order", "depth", "phi", "n_engine")
    result = {name: (signals[name].t, signals[name].values[:, 0]) for name in plain if name in signals}
    antenna = fmt.antenna if "psi" in signals else None
    if "position" in signals:
        t, (x, y) = signals["position"].t, signals["position"].values.T
        if antenna is not None and any(antenna):
            psi = _at(signals["psi"], t)
            x = x - antenna[0] * np.cos(psi) + antenna[1] * np.sin(psi)
            y = y - antenna[0] * np.sin(psi) - antenna[1] * np.cos(psi)
        result |= {"x": (t, x), "y": (t, y)}
    if "speeds" in signals:
        speeds = signals["speeds"]
        result |= {name: (speeds.t, values) for name, values in zip(("u", "v"), speeds.values.T)}
    over_ground = signals.get("course", signals.get("bottom track"))
    if over_ground is not None:
        t, (speed, course) = over_ground.t, over_ground.values.T
        north, east = speed * np.cos(course), speed * np.sin(course)
        if over_ground.name == "course" and antenna is not None and any(antenna):
            # The antenna goes round midship.
            psi, r = _at(signals["psi"], t), _turning(t, signals)
            north = north + r * (antenna[0] * np.sin(psi) + antenna[1] * np.cos(psi))
            east = east + r * (antenna[1] * np.sin(psi) - antenna[0] * np.cos(psi))
        result["SOG"] = t, np.hypot(north, east)
        result["COG"] = t, np.mod(np.arctan2(east, north), 2 * pi)
        psi_known = "psi" in signals and not is_magnetic(signals["psi"])
        if fmt.speed == "ground" and "speeds" not in signals and psi_known:
            psi = _at(signals["psi"], t)
            result["u"] = t, north * np.cos(psi) + east * np.sin(psi)
            result["v"] = t, east * np.cos(psi) - north * np.sin(psi)
    for name, tail in (("wind", "_relative"), ("true wind", "")):
        if name in signals:
            t, (speed, along, across) = signals[name].t, signals[name].values.T
            result["wind_speed" + tail] = t, speed
            result["wind_direction" + tail] = t, np.mod(np.arctan2(across, along), 2 * pi)
    return result


def _at(signal: Signal, t: np.ndarray) -> np.ndarray:
    """A signal between its samples; NaN in its holes."""
    return interpolated(signal.t, signal.values[:, 0], t)


def _turning(t: np.ndarray, signals: dict[str, Signal]) -> np.ndarray:
    """Rate of turn [rad/s]; the slope of the heading where there is no ROT."""
    if "r" in signals:
        return _at(signals["r"], t)
    psi = signals["psi"]
    return interpolated(psi.t, np.gradient(psi.values[:, 0], psi.t), t)


def _derived(columns: dict[str, np.ndarray], fmt: NmeaFormat, signals: dict[str, Signal]) -> list[str]:
    """Say what was computed of several signals, and what is missing for it."""
    notes = []
    if "u" in columns and "speeds" not in signals:
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
    elif fmt.antenna is not None and {"position", "course"} & set(signals):
        notes.append(
            f"x, y, SOG, COG are of midship: the antenna stands {fmt.antenna[0]:g} m forward and {fmt.antenna[1]:g} m to starboard "
            "of it."
        )
    elif "position" in signals:
        notes.append("x, y are of the antenna; state [nmea.antenna] for those of midship.")
    if {"delta", "psi"} <= set(columns) and "r" not in columns:  # with ROT, every trial is checked
        rudder, psi = signals["delta"], signals["psi"]
        slope = np.gradient(psi.values[:, 0], psi.t)
        if checks.turns_to_port(psi.t, _at(rudder, psi.t), slope):
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
