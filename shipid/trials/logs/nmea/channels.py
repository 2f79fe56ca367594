"""From the numbers of sentences to signals in SI units: units, signs, variation, calibration, local metres."""

from __future__ import annotations

from math import pi

import numpy as np

from shipid.declaration import units
from shipid.foundation.numbers import brief
from shipid.trials.logs.geodesy import to_local
from shipid.trials.logs.nmea.comparison import described
from shipid.trials.logs.nmea.errors import CalibrationError, NoRudderError, NoSignalError
from shipid.trials.logs.nmea.log import NmeaLog
from shipid.trials.logs.nmea.resampling import Signal
from shipid.trials.logs.nmea.settings import Calibration, NmeaFormat
from shipid.trials.logs.nmea.sources import SignalSource, Wanted, check_sources, choose

KNOT = 1852 / 3600
"""In m/s."""
_DEG = pi / 180
_USUAL_RUDDER = 45.0
#: A rudder that moves less than this [deg] stands still, one that moves more is alive; twins further apart are not the same.
_STILL, _MOVES, _APART = 0.5, 5.0, 2.0
#: A rudder of twins that is valid in less than this part of the sentences of the other is not taken.
_FALLS_SILENT = 0.9
_QUALITIES = {1: "GPS", 2: "differential", 3: "precise", 4: "RTK", 5: "float RTK"}

_TRUE: list[Wanted] = [("THS", ("heading",)), ("HDT", ("heading",)), ("127250", ("heading",))]
_MAGNETIC: list[Wanted] = [("HDG", ("heading",)), ("HDM", ("heading",)), ("127250", ("magnetic",))]
_LAST: list[Wanted] = [("VHW", ("heading",))]
# Nothing says which north the yaw of an attitude counts from, and receivers put their course there.
_ASKED: list[Wanted] = [("127257", ("yaw",))]
_COURSE: list[Wanted] = [(kind, ("sog", "cog")) for kind in ("VTG", "RMC", "129026")]
_PLACE: list[Wanted] = [(kind, ("lat", "lon")) for kind in ("GGA", "RMC", "GLL", "129025", "129029")]
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
        What is there of ``psi``, ``r``, ``delta``, ``delta_order``, ``speeds`` (u, v), ``course`` or ``bottom track`` (speed
        and course over ground, of a receiver or of a log), ``position`` (x, y of the antenna), ``wind`` and ``true wind``
        (speed and components), ``depth``, ``phi``, ``n_engine`` [1/s].

    Raises
    ------
    NoSignalError
        If there is none of them.
    NoRudderError
        If the format file asks for a rudder that is not there.
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
    found += [
        _rate(log, times, fmt),
        _along_the_ship(log, times, fmt),
        _over_ground(log, times, fmt, heading),
        _position(log, times, fmt),
    ]
    found += _winds(log, times, fmt, heading)
    for name, source, factor, note in (
        ("depth", ("DPT", ("depth",)), 1.0, "below the transducer, in m"),
        ("phi", ("127257", ("roll",)), _DEG, "the roll of an attitude"),
        ("n_engine", ("127488", ("rpm",)), 1 / 60, "of the engine; a gear may stand between it and the propeller"),
    ):
        if (plain := choose(log, times, fmt, name, [[source]])) is not None:
            found.append(Signal(name, plain.t, plain.values * factor, (f"{name}: {described(plain)}; {note}.",)))
    signals = {signal.name: signal for signal in found if signal is not None}
    if not signals:
        raise nothing_read(log)
    return signals


def nothing_read(log: NmeaLog) -> NoSignalError:
    """Return the error of a log that holds nothing a trial can hold.

    Parameters
    ----------
    log : NmeaLog
        The log.

    Returns
    -------
    NoSignalError
    """
    return NoSignalError(
        f"{log.where} holds nothing that is read with two valid values: heading, rate of turn, rudder, speed, position, "
        f"course, wind or depth. Seen were {log.seen()}. Check what the logger keeps."
    )


def _heading(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    tiers = [_TRUE, _MAGNETIC, _LAST] if fmt.reference == "true" else [_MAGNETIC, _TRUE, _LAST]
    if fmt.sources.get("psi", "").startswith("127257"):
        tiers = [_ASKED]
    found = choose(log, times, fmt, "psi", tiers)
    if found is None:
        return None
    psi = np.unwrap(found.values[:, 0] * _DEG)
    note, more = f"psi: {described(found)}; degrees", []
    if found.origin.kind in ("HDG", "HDM") or found.fields == ("magnetic",):
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
    origins = [found.origin] if found.origin.kind in ("HDG", "127250") else []
    origins += [origin for origin in log.records if origin.kind in ("RMC", "127258")]
    for origin in origins:
        said = log.records[origin].column("variation")
        if np.isfinite(said).any():
            value = float(np.nanmedian(said))
            return value * _DEG, f"{value:+.4g} deg, of {origin.name}"
    return None, ""


def _rudder(
    log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, name: str, kind: str, calibration: Calibration
) -> Signal | None:
    found, use, more = _side(log, times, fmt, name, kind, calibration)
    table = "[nmea.rudder]" if name == "delta" else "[nmea.order]"
    if found is None and not calibration.use:
        use, found = "", choose(log, times, fmt, name, [[("127245", ("position" if name == "delta" else "order",))]])
    if found is None:
        if calibration.use and any(origin.kind == kind for origin in log.records) and name not in fmt.leave_out:
            raise NoRudderError(
                f"{log.where}: the format file asks for {calibration.use} of {kind}, and no {kind} has two valid values "
                "there. Correct use in the format file."
            )
        return None
    kind = found.origin.kind
    number = found.values.mean(axis=1)
    note = f"{name}: {described(found)}" + (f"; {use}" if use else "")
    if not calibration.stated and kind != "127245":
        k = int(np.argmax(np.abs(number)))
        most = float(abs(number[k]))
        if most > 90:
            raise CalibrationError(
                f"{log.where}, line {found.lines[k]}: {kind} goes to {brief(number[k], 4)}, so it is not in degrees (the standard "
                f"leaves its unit open). State scale and offset in {table} of a format file, as in scale = '0.1 deg'."
            )
        note += ", read as degrees (the standard leaves the unit open; no calibration is stated)"
        if most > _USUAL_RUDDER:
            more.append(
                f"WARNING: {kind} goes to {brief(number[k], 4)}, which is much for degrees of rudder. Compare with the stops, and "
                f"state scale in {table} of a format file."
            )
    angle = calibration.sign * (calibration.scale * number + calibration.offset)
    if calibration.stated and (most := float(np.abs(angle).max())) > 90 * _DEG:
        raise CalibrationError(
            f"{log.where}: by the calibration in {table} of the format file the rudder goes to {brief(most / _DEG, 4)} deg. Correct "
            f"the scale: the largest {kind} is {brief(np.abs(number).max(), 4)}."
        )
    if calibration != Calibration(use=calibration.use):
        turned = "-" if calibration.sign < 0 else ""
        note += f", calibrated: {turned}({brief(calibration.scale / _DEG, 6)} deg × {kind} {calibration.offset / _DEG:+.4g} deg)"
    return Signal(name, found.t, angle[:, None], (note + ".", *more))


def _side(
    log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, name: str, kind: str, calibration: Calibration
) -> tuple[SignalSource | None, str, list[str]]:
    """The rudder of twins that is taken, which one it is, and what the reader should know of the other."""
    sides: dict[str, tuple[str, ...]] = {"starboard": ("starboard",), "port": ("port",), "mean": ("starboard", "port")}
    found = {use: choose(log, times, fmt, name, [[(kind, sides[use])]]) for use in sides}
    if calibration.use or found["starboard"] is None or found["port"] is None:
        use = calibration.use or ("port" if found["starboard"] is None else "starboard")
        return found[use], use, []
    starboard, port = found["starboard"], found["port"]
    degrees = calibration.scale / _DEG
    table = "[nmea.rudder]" if name == "delta" else "[nmea.order]"
    many, few = ("starboard", "port") if len(starboard.t) >= len(port.t) else ("port", "starboard")
    counts = {"starboard": len(starboard.t), "port": len(port.t)}
    if counts[few] < _FALLS_SILENT * counts[many]:
        note = (
            f"WARNING: the {few} rudder of {kind} is valid {counts[few]} times and the {many} one {counts[many]} times: {name} is "
            f"that of the {many} rudder, as use = '{many}' in {table} of a format file says it. Check the {few} sensor."
        )
        return found[many], many, [note]
    moves = {use: float(np.ptp(side.values)) * degrees for use, side in (("starboard", starboard), ("port", port))}
    still, alive = sorted(moves, key=lambda use: moves[use])
    if moves[still] < _STILL and moves[alive] > _MOVES:
        at = float(np.median((starboard if still == "starboard" else port).values)) * degrees
        note = (
            f"WARNING: the {still} rudder of {kind} stands still at {brief(at)} deg while the {alive} one moves over {brief(moves[alive])} "
            f"deg: {name} is that of the {alive} rudder, as use = '{alive}' in {table} of a format file says it. Check the "
            f"{still} sensor."
        )
        return found[alive], alive, [note]
    apart = float(np.mean(np.abs(starboard.values[:, 0] - np.interp(starboard.t, port.t, port.values[:, 0])))) * degrees
    more = f"{name}: the port rudder is logged too, and differs by {brief(apart, 2)} deg on average; use = 'port' in {table} takes it."
    return starboard, "starboard", [("WARNING: " if apart > _APART else "") + more]


def _rate(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    found = choose(log, times, fmt, "r", [[("ROT", ("rate",)), ("127251", ("rate",))]])
    if found is None:
        return None
    unit = fmt.rate_unit if found.origin.kind == "ROT" else "deg/min"
    r = found.values * (fmt.rate_sign * units.factor(unit, "rad/s"))
    note = (
        f"r: {described(found)}"
        + (f"; {unit}" if found.origin.kind == "ROT" else "")
        + (", sign changed" if fmt.rate_sign < 0 else "")
    )
    return Signal("r", found.t, r, (note + ".",))


def _along_the_ship(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    """Speeds along the ship and across of a log: through the water, over ground only where the format file asks for it."""
    tiers: list[list[Wanted]] = [[("VBW", ("u", "v"))], [("VBW", ("u",)), ("VHW", ("u",)), ("128259", ("u",))]]
    if fmt.speed == "ground":
        tiers = [[_BOTTOM_TRACK], [("VBW", ("u_ground",))]]
    found = choose(log, times, fmt, "u", tiers)
    if found is None:
        return None
    axes = ", ".join(("u", "v")[: len(found.fields)])
    over = (
        "over ground, as the format file asks for; a current is in it" if fmt.speed == "ground" else "through the water"
    )
    return Signal("speeds", found.t, found.values * KNOT, (f"{axes}: {described(found)}; {over}, knots.",))


def _over_ground(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, psi: Signal | None) -> Signal | None:
    """Speed and course over ground: of a receiver, else of a log that tracks the bottom."""
    found = choose(log, times, fmt, "course", [_COURSE, [_BOTTOM_TRACK]])
    if found is None:
        return None
    note = f"SOG, COG: {described(found)}; over ground, knots"
    if found.origin.kind != "VBW":
        speed, course = found.values.T * ((KNOT,), (_DEG,))
        return Signal("course", found.t, np.column_stack((speed, np.unwrap(course))), (note + ".",))
    if psi is None:
        return None
    inside = (found.t >= psi.t[0]) & (found.t <= psi.t[-1])
    if inside.sum() < 2:
        return None
    t, (forward, starboard) = found.t[inside], found.values[inside].T * KNOT
    course = np.unwrap(np.interp(t, psi.t, psi.values[:, 0]) + np.arctan2(starboard, forward))
    note += f" along the ship and across, turned by psi{' (magnetic)' if is_magnetic(psi) else ''}."
    return Signal("bottom track", t, np.column_stack((np.hypot(forward, starboard), course)), (note,))


def is_magnetic(psi: Signal | None) -> bool:
    """Return whether a heading is magnetic, with a variation that nothing states.

    Parameters
    ----------
    psi : Signal or None
        The heading.
    """
    return psi is not None and any(note.startswith("WARNING: psi is the magnetic heading") for note in psi.notes)


def _position(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat) -> Signal | None:
    found = choose(log, times, fmt, "position", [_PLACE])
    if found is None:
        return None
    lat, lon = (found.values * _DEG).T
    origin = float(lat[0]), float(lon[0])
    north, east = to_local(lat, lon, origin)
    note = (
        f"x, y: {described(found)}; metres in the plane that touches the WGS84 ellipsoid at the first fix, latitude "
        f"{lat[0] / _DEG:.7f}, longitude {lon[0] / _DEG:.7f}"
    )
    more = []
    if found.origin.kind in ("GGA", "129029"):
        quality = log.records[found.origin].column("quality")
        kinds, counts = np.unique(quality[np.isfinite(quality)], return_counts=True)
        if len(kinds) > 1:
            said = ", ".join(f"{_QUALITIES[int(k)]} {n}" for k, n in zip(kinds, counts))
            more.append(f"The quality of the fixes changes ({said}): the positions may step.")
    return Signal("position", found.t, np.column_stack((north, east)), (note + ".", *more), origin)


def _winds(log: NmeaLog, times: np.ndarray, fmt: NmeaFormat, psi: Signal | None) -> list[Signal | None]:
    signals: list[Signal | None] = []
    relative = choose(log, times, fmt, "wind", [[(kind, ("angle", "speed")) for kind in ("MWV", "130306")]])
    if relative is not None:
        signals.append(_wind("wind", relative, None))
    north = choose(log, times, fmt, "wind", [[("130306", ("north_angle", "north_speed"))]])
    bow = choose(log, times, fmt, "wind", [[(kind, ("true_angle", "true_speed")) for kind in ("MWV", "130306")]])
    if north is not None:
        signals.append(_wind("true wind", north, None))
    elif bow is not None and psi is not None:
        signals.append(_wind("true wind", bow, psi))
    return signals


def _wind(name: str, found: SignalSource, psi: Signal | None) -> Signal:
    """A wind as speed and components of the direction it blows to; one that counts from the bow is turned by psi."""
    blows_to, speed = found.values[:, 0] * _DEG + pi, found.values[:, 1] * KNOT
    if psi is not None:
        blows_to = blows_to + np.interp(found.t, psi.t, psi.values[:, 0])
    relative = "_relative" if name == "wind" else ""
    note = f"wind_speed{relative}, wind_direction{relative}: {described(found)}; the direction was turned by 180 deg, to where "
    note += "the wind blows" + (f", and by psi: {found.origin.kind} counts from the bow." if psi is not None else ".")
    vector = np.column_stack((speed, speed * np.cos(blows_to), speed * np.sin(blows_to)))
    return Signal(name, found.t, vector, (note,))
