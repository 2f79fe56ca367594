"""From the numbers of sentences to signals in SI units: units, signs, variation, calibration, local metres."""

from __future__ import annotations

from math import pi

import numpy as np

from shipid.declaration import units
from shipid.trials.logs.nmea.errors import CalibrationError, NoHeadingError, NoRudderError
from shipid.trials.logs.nmea.geodesy import to_local
from shipid.trials.logs.nmea.log import NmeaLog
from shipid.trials.logs.nmea.resampling import Signal
from shipid.trials.logs.nmea.settings import Calibration, NmeaFormat
from shipid.trials.logs.nmea.sources import SignalSource, Wanted, check_sources, choose

KNOT = 1852 / 3600
"""In m/s."""
_DEG = pi / 180
_USUAL_RUDDER = 45.0
_QUALITIES = {1: "GPS", 2: "differential", 3: "precise", 4: "RTK", 5: "float RTK"}

_TRUE: list[Wanted] = [("THS", ("heading",)), ("HDT", ("heading",))]
_MAGNETIC: list[Wanted] = [("HDG", ("heading",)), ("HDM", ("heading",))]
_LAST: list[Wanted] = [("VHW", ("heading",))]
_BOTTOM_TRACK: Wanted = ("VBW", ("u_ground", "v_ground"))


def read_signals(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> dict[str, Signal]:
    """Read every signal a log holds.

    Parameters
    ----------
    log : NmeaLog
        The log.
    times : ndarray, shape (n,)
        Time of every sentence [s].
    fmt : NmeaFormat
        Sources, calibrations and what else the sentences leave open.

    Returns
    -------
    dict of str to Signal
        ``psi`` and at least one of ``delta`` and ``delta_order``; further ``r``, ``speeds`` (u, v), ``course`` or
        ``bottom track`` (speed and course over ground, of a receiver or of a log), ``position`` (x, y of the antenna), ``wind`` and ``true wind``
        (speed and components), ``depth``.

    Raises
    ------
    NoHeadingError, NoRudderError
        If the log lacks what makes a trial.
    CalibrationError
        If the rudder cannot be in degrees.
    NoSuchSourceError
        If the format file names a source that is not there.
    """
    check_sources(log, fmt.sources)
    heading = _heading(log, times, fmt)
    found: list[Signal | None] = [heading]
    found += [_rudder(log, times, fmt, "delta", "RSA", fmt.rudder)]
    found += [_rudder(log, times, fmt, "delta_order", "ROR", fmt.order)]
    if found[1] is None and found[2] is None:
        raise NoRudderError(
            f"{log.where} holds no rudder angle: no RSA and no ROR with two valid values. Seen were {log.seen()}. Log the "
            "rudder angle sensor (RSA) too; without the rudder there is nothing to identify or to measure."
        )
    found += [
        _rate(log, times, fmt),
        _along_the_ship(log, times, fmt),
        _over_ground(log, times, fmt, heading),
        _position(log, times, fmt),
    ]
    found += _winds(log, times, fmt, heading)
    if (depth := choose(log, times, fmt, "depth", [[("DPT", ("depth",))]])) is not None:
        found.append(
            Signal("depth", depth.t, depth.values, (f"depth: {depth.describe()}; below the transducer, in m.",))
        )
    return {signal.name: signal for signal in found if signal is not None}


def _heading(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal:
    tiers = [_TRUE, _MAGNETIC, _LAST] if fmt.reference == "true" else [_MAGNETIC, _TRUE, _LAST]
    found = choose(log, times, fmt, "psi", tiers)
    if found is None:
        raise NoHeadingError(
            f"{log.where} holds no heading: none of THS, HDT, HDG, HDM and VHW has two valid values. Seen were "
            f"{log.seen()}. Log the gyro compass too; a course over ground is not a heading."
        )
    psi = np.unwrap(found.values[:, 0] * _DEG)
    note, more = f"psi: {found.describe()}; degrees", []
    if found.kind in ("HDG", "HDM"):
        added, origin = _variation(log, fmt, found)
        if added is None:
            more.append(
                "WARNING: psi is the magnetic heading, because nothing states the variation: positions, courses and wind "
                "are true. State variation in [nmea.heading]."
            )
        else:
            psi = psi + added
            note += f" magnetic; the variation was added: {origin}"
    if fmt.correction:
        psi = psi + fmt.correction
        note += f"; {fmt.correction / _DEG:+.4g} deg were added (correction)"
    return Signal("psi", found.t, psi[:, None], (note + ".", *more))


def _variation(log: NmeaLog, fmt: NmeaFormat, found: SignalSource) -> tuple[float | None, str]:
    if fmt.variation is not None:
        return fmt.variation, f"{fmt.variation / _DEG:+.4g} deg, of the format file"
    keys = [k for k in log.records if k == (found.kind, found.talker) and k[0] == "HDG"]
    keys += [k for k in log.records if k[0] == "RMC"]
    for kind, talker in keys:
        said = log.records[kind, talker].values[:, {"HDG": 1, "RMC": 4}[kind]]
        if np.isfinite(said).any():
            value = float(np.nanmedian(said))
            return value * _DEG, f"{value:+.4g} deg, of {talker}{kind}"
    return None, ""


def _rudder(
    log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, name: str, kind: str, calibration: Calibration
) -> Signal | None:
    sides: dict[str, tuple[str, ...]] = {"starboard": ("starboard",), "port": ("port",), "mean": ("starboard", "port")}
    for use in (calibration.use,) if calibration.use else ("starboard", "port"):
        found = choose(log, times, fmt, name, [[(kind, sides[use])]])
        if found is not None:
            break
    if found is None:
        if calibration.use and any(k == kind for k, _ in log.records) and name not in fmt.leave_out:
            raise NoRudderError(
                f"{log.where}: the format file asks for {calibration.use} of {kind}, and no {kind} has two valid values "
                "there. Correct use in the format file."
            )
        return None
    number = found.values.mean(axis=1)
    note = f"{name}: {found.describe()}; {use}"
    table = "[nmea.rudder]" if name == "delta" else "[nmea.order]"
    more = []
    if not calibration.stated:
        k = int(np.argmax(np.abs(number)))
        most = float(abs(number[k]))
        if most > 90:
            raise CalibrationError(
                f"{log.where}, line {found.lines[k]}: {kind} goes to {number[k]:.4g}, so it is not in degrees (the standard "
                f"leaves its unit open). State scale and offset in {table} of a format file, as in scale = '0.1 deg'."
            )
        note += ", read as degrees (the standard leaves the unit open; no calibration is stated)"
        if most > _USUAL_RUDDER:
            more.append(
                f"WARNING: {kind} goes to {number[k]:.4g}, which is much for degrees of rudder. Compare with the stops, and "
                f"state scale in {table} of a format file."
            )
    angle = calibration.sign * (calibration.scale * number + calibration.offset)
    if calibration.stated and (most := float(np.abs(angle).max())) > 90 * _DEG:
        raise CalibrationError(
            f"{log.where}: by the calibration in {table} of the format file the rudder goes to {most / _DEG:.4g} deg. Correct "
            f"the scale: the largest {kind} is {np.abs(number).max():.4g}."
        )
    if calibration != Calibration(use=calibration.use):
        turned = "-" if calibration.sign < 0 else ""
        note += (
            f", calibrated: {turned}({calibration.scale / _DEG:.6g} deg × {kind} {calibration.offset / _DEG:+.4g} deg)"
        )
    return Signal(name, found.t, angle[:, None], (note + ".", *more))


def _rate(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    found = choose(log, times, fmt, "r", [[("ROT", ("rate",))]])
    if found is None:
        return None
    r = found.values * (fmt.rate_sign * units.factor(fmt.rate_unit, "rad/s"))
    note = f"r: {found.describe()}; {fmt.rate_unit}" + (", sign changed" if fmt.rate_sign < 0 else "")
    return Signal("r", found.t, r, (note + ".",))


def _along_the_ship(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    """Speeds along the ship and across of a log: through the water, over ground only where the format file asks for it."""
    tiers: list[list[Wanted]] = [[("VBW", ("u", "v"))], [("VBW", ("u",)), ("VHW", ("u",))]]
    if fmt.speed == "ground":
        tiers = [[_BOTTOM_TRACK], [("VBW", ("u_ground",))]]
    found = choose(log, times, fmt, "u", tiers)
    if found is None:
        return None
    axes = ", ".join(("u", "v")[: len(found.fields)])
    over = (
        "over ground, as the format file asks for; a current is in it" if fmt.speed == "ground" else "through the water"
    )
    return Signal("speeds", found.t, found.values * KNOT, (f"{axes}: {found.describe()}; {over}, knots.",))


def _over_ground(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, psi: Signal) -> Signal | None:
    """Speed and course over ground: of a receiver, else of a log that tracks the bottom."""
    found = choose(log, times, fmt, "course", [[("VTG", ("sog", "cog")), ("RMC", ("sog", "cog"))], [_BOTTOM_TRACK]])
    if found is None:
        return None
    note = f"SOG, COG: {found.describe()}; over ground, knots"
    if found.kind != "VBW":
        speed, course = found.values.T * ((KNOT,), (_DEG,))
        return Signal("course", found.t, np.column_stack((speed, np.unwrap(course))), (note + ".",))
    inside = (found.t >= psi.t[0]) & (found.t <= psi.t[-1])
    if inside.sum() < 2:
        return None
    t, (forward, starboard) = found.t[inside], found.values[inside].T * KNOT
    course = np.unwrap(np.interp(t, psi.t, psi.values[:, 0]) + np.arctan2(starboard, forward))
    note += f" along the ship and across, turned by psi{' (magnetic)' if is_magnetic(psi) else ''}."
    return Signal("bottom track", t, np.column_stack((np.hypot(forward, starboard), course)), (note,))


def is_magnetic(psi: Signal) -> bool:
    """Return whether a heading is magnetic, with a variation that nothing states.

    Parameters
    ----------
    psi : Signal
        The heading.
    """
    return any(note.startswith("WARNING: psi is the magnetic heading") for note in psi.notes)


def _position(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    place = ("lat", "lon")
    found = choose(log, times, fmt, "position", [[("GGA", place), ("RMC", place), ("GLL", place)]])
    if found is None:
        return None
    lat, lon = (found.values * _DEG).T
    north, east = to_local(lat, lon, (float(lat[0]), float(lon[0])))
    note = (
        f"x, y: {found.describe()}; metres in the plane that touches the WGS84 ellipsoid at the first fix, latitude "
        f"{lat[0] / _DEG:.7f}, longitude {lon[0] / _DEG:.7f}"
    )
    more = []
    if found.kind == "GGA":
        quality = log.records["GGA", found.talker].values[:, 3]
        kinds, counts = np.unique(quality[np.isfinite(quality)], return_counts=True)
        if len(kinds) > 1:
            said = ", ".join(f"{_QUALITIES[int(k)]} {n}" for k, n in zip(kinds, counts))
            more.append(f"The quality of the fixes changes ({said}): the positions may step.")
    return Signal("position", found.t, np.column_stack((north, east)), (note + ".", *more))


def _winds(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, psi: Signal) -> list[Signal | None]:
    signals: list[Signal | None] = []
    for name, fields in (("wind", ("angle", "speed")), ("true wind", ("true_angle", "true_speed"))):
        found = choose(log, times, fmt, "wind", [[("MWV", fields)]])
        if found is None:
            continue
        blows_to, speed = found.values[:, 0] * _DEG + pi, found.values[:, 1] * KNOT
        if name == "true wind":
            # The angle of a true wind, too, counts from the bow.
            blows_to = blows_to + np.interp(found.t, psi.t, psi.values[:, 0])
        columns = "wind_speed, wind_direction" + ("_relative" if name == "wind" else "")
        columns = columns.replace("speed,", "speed_relative,") if name == "wind" else columns
        note = f"{columns}: {found.describe()}; the direction was turned by 180 deg, to where the wind blows"
        note += ", and by psi: MWV counts from the bow." if name == "true wind" else "."
        vector = np.column_stack((speed, speed * np.cos(blows_to), speed * np.sin(blows_to)))
        signals.append(Signal(name, found.t, vector, (note,)))
    return signals
