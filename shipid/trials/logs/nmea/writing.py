"""Write a trial as an NMEA 0183 log: what a logger on the bridge would have kept of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from math import pi
from pathlib import Path

import numpy as np

from shipid.foundation.errors import UnknownNameError
from shipid.trials.logs.geodesy import to_geographic
from shipid.trials.logs.nmea.channels import KNOT
from shipid.trials.logs.nmea.sentences.lines import checksum
from shipid.trials.logs.writing import text_file
from shipid.trials.source import origin_in
from shipid.trials.trial import Trial

#: Sentences a second, by address: gyro and rudder indicator are fast, a log and a receiver are not.
RATES: dict[str, float] = {
    "HEHDT": 5.0, "HEROT": 5.0, "IIRSA": 5.0, "IIROR": 5.0, "VDVBW": 1.0, "GPGGA": 1.0, "GPVTG": 1.0, "GPZDA": 1.0,
    "WIMWV": 1.0,
}  # fmt: skip
START = datetime(2026, 5, 4, 9, 0, tzinfo=UTC)
#: Of a trial that says nothing of its own.
ORIGIN = (63.45 * pi / 180, 10.42 * pi / 180)

_NEEDS = {
    "HDT": ("psi",), "THS": ("psi",), "ROT": ("r",), "RSA": ("delta",), "ROR": ("delta_order",), "VBW": ("u",),
    "VHW": ("u",), "GGA": ("x", "y"), "GLL": ("x", "y"), "RMC": ("x", "y"), "VTG": ("SOG", "COG"), "ZDA": (),
    "MWV": ("wind_speed_relative", "wind_direction_relative"), "DPT": ("depth",),
}  # fmt: skip


#: What a sentence says besides, where the trial has it.
_OPTIONAL = ("v", "SOG", "COG")


def sentence(address: str, *fields: str) -> str:
    """Return a sentence with its checksum: ``$HEHDT,123.4,T*2D``.

    Parameters
    ----------
    address : str
        Talker and sentence.
    *fields : str
        As the standard prints them.
    """
    text = ",".join((address, *fields))
    return f"${text}*{checksum(text)}"


def _minutes(angle: float, width: int, letters: str) -> tuple[str, str]:
    """Degrees and minutes to five decimals (2 cm), and the hemisphere."""
    units = round(abs(angle) * 180 / pi * 60 * 1e5)
    degrees, rest = divmod(units, 6_000_000)
    return f"{degrees:0{width}d}{rest // 100000:02d}.{rest % 100000:05d}", letters[0] if angle >= 0 else letters[1]


def _fields(kind: str, v: dict[str, float], moment: datetime) -> tuple[str, ...]:
    """What a sentence says of an instant."""
    utc = f"{moment:%H%M%S}.{moment.microsecond // 10000:02d}"
    place = (*_minutes(v["lat"], 2, "NS"), *_minutes(v["lon"], 3, "EW")) if "lat" in v else ()
    match kind:
        case "HDT":
            return f"{round(v['psi'] * 180 / pi, 1) % 360:.1f}", "T"
        case "THS":
            return f"{round(v['psi'] * 180 / pi, 1) % 360:.1f}", "A"
        case "ROT":
            return f"{v['r'] * 180 / pi * 60:z.1f}", "A"
        case "RSA":
            return f"{v['delta'] * 180 / pi:z.1f}", "A", "", "V"
        case "ROR":
            return f"{v['delta_order'] * 180 / pi:z.1f}", "A", "", "V", "B"
        case "VBW":
            return f"{v['u'] / KNOT:z.2f}", f"{v['v'] / KNOT:z.2f}" if "v" in v else "", "A", "", "", "V"
        case "VHW":
            return "", "T", "", "M", f"{v['u'] / KNOT:z.2f}", "N", f"{v['u'] * 3.6:z.2f}", "K"
        case "GGA":
            return utc, *place, "1", "10", "0.9", "5.0", "M", "40.0", "M", "", ""
        case "GLL":
            return *place, utc, "A", "A"
        case "RMC" | "VTG":
            knots, course = v.get("SOG", 0.0) / KNOT, round(float(np.degrees(v.get("COG", 0.0))), 1) % 360
            if kind == "VTG":
                return f"{course:.1f}", "T", "", "M", f"{knots:.2f}", "N", f"{knots * 1.852:.2f}", "K", "A"
            return utc, "A", *place, f"{knots:.2f}", f"{course:.1f}", f"{moment:%d%m%y}", "", "", "A"
        case "ZDA":
            return utc, f"{moment:%d}", f"{moment:%m}", f"{moment:%Y}", "00", "00"
        case "MWV":
            angle = (v["wind_direction_relative"] - pi) * 180 / pi
            return f"{round(angle, 1) % 360:.1f}", "R", f"{v['wind_speed_relative'] / KNOT:.1f}", "N", "A"
        case "DPT":
            return f"{v['depth']:.1f}", "0.0"
    raise AssertionError(kind)


#: What a logger puts before a sentence, by the name of its layout.
STAMPS: dict[str, Callable[[datetime], str]] = {
    "iso": lambda m: f"{m:%Y-%m-%dT%H:%M:%S}.{m.microsecond // 1000:03d}Z ",
    "epoch": lambda m: f"{m.timestamp():.3f} ",
    "hh:mm:ss": lambda m: f"{m:%H:%M:%S}.{m.microsecond // 1000:03d} ",
    "tag": lambda m: _tag(f"s:LOG1,c:{round(m.timestamp() * 1000)}"),
    "none": lambda m: "",
}


def _tag(block: str) -> str:
    return f"\\{block}*{checksum(block)}\\"


def nmea_lines(
    trial: Trial,
    rates: Mapping[str, float] | None = None,
    *,
    stamp: str = "iso",
    start: datetime = START,
    origin: tuple[float, float] | None = None,
) -> Iterator[str]:
    """Return the lines of a log of a trial, in the order of time.

    Values between samples are interpolated; each sentence prints as many decimals as instruments do (headings, rudder
    angles and rates 0.1, speeds 0.01 kn, positions 0.00001 minutes).

    Parameters
    ----------
    trial : Trial
        What was sailed. Where it holds no ``SOG`` and ``COG``, those of ``u``, ``v`` and ``psi`` are written: without a
        current.
    rates : Mapping of str to float, optional
        Sentences a second by address (`RATES`); those the trial has no columns for are left out.
    stamp : str
        One of `STAMPS`.
    start : datetime
        UTC at t = 0.
    origin : tuple of float, optional
        Latitude and longitude [rad] of x = y = 0; by default that of the trial, and `ORIGIN` where it states none.

    Yields
    ------
    str
        Without the end of the line.

    Raises
    ------
    UnknownNameError
        If there is no such sentence or stamp.
    """
    rates = RATES if rates is None else rates
    for address in rates:
        if address[2:] not in _NEEDS:
            raise UnknownNameError("sentence that is written called", address[2:], _NEEDS)
    if stamp not in STAMPS:
        raise UnknownNameError("stamp called", stamp, STAMPS)
    origin = origin or trial.source.origin or ORIGIN
    table = _with_course({name: trial[name] for name in trial.table.columns})
    t = table["t"]
    events: list[tuple[float, str, dict[str, float]]] = []
    for slot, (address, rate) in enumerate(rates.items()):
        names = _NEEDS[address[2:]]
        if not set(names) <= set(table):
            continue
        # Instruments do not wait for each other: each has its place within the interval.
        phase = 0.0 if slot == 0 else 0.013 * slot
        at = np.arange(t[0] + phase, t[-1] + 1e-9, 1 / rate)
        values = {name: np.interp(at, t, table[name]) for name in {*names, *_OPTIONAL} if name in table}
        if "COG" in values:
            north, east = (np.interp(at, t, turn(table["COG"])) for turn in (np.cos, np.sin))
            values["COG"] = np.arctan2(east, north)
        if "x" in names:
            values["lat"], values["lon"] = to_geographic(values["x"], values["y"], origin)
        rows = zip(*values.values()) if values else ((),) * len(at)
        events += [(s, address, dict(zip(values, row))) for s, row in zip(at, rows)]
    for seconds, address, values_then in sorted(events, key=lambda event: event[0]):
        moment = start + timedelta(seconds=float(seconds))
        yield STAMPS[stamp](moment) + sentence(address, *_fields(address[2:], values_then, moment))


def _with_course(table: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Add speed and course over ground, without a current, where a trial holds the motion through the water alone."""
    if "SOG" in table or not {"u", "psi"} <= set(table):
        return table
    u, v, psi = table["u"], table.get("v", np.zeros_like(table["u"])), table["psi"]
    return table | {"SOG": np.hypot(u, v), "COG": np.mod(psi + np.arctan2(v, u), 2 * pi)}


def write_nmea(
    trial: Trial,
    path: str | Path,
    rates: Mapping[str, float] | None = None,
    *,
    stamp: str = "iso",
    start: datetime = START,
    origin: tuple[float, float] | None = None,
    comment: str | None = None,
    overwrite: bool = False,
) -> Path:
    """Write a trial as an NMEA 0183 log, whole or not at all.

    Parameters
    ----------
    trial : Trial
        What was sailed.
    path : str or Path
        The file.
    rates, stamp, start, origin
        As in `nmea_lines`.
    comment : str, optional
        Lines to put first, each behind a ``#``; by default those of the trial. A first line with the word "simulated"
        marks a simulation.
    overwrite : bool
        Whether a file of that name may be replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    OverwriteError
        If the file exists and `overwrite` is not set.
    MissingFileError
        If the folder cannot be written to.
    """
    if origin is not None:
        said = "\n".join(line for line in trial.source.comment.splitlines() if origin_in(line) is None)
        trial = replace(trial, source=replace(trial.source, origin=origin, comment=said))
    with text_file(trial, path, overwrite, comment) as file:
        file.writelines(line + "\r\n" for line in nmea_lines(trial, rates, stamp=stamp, start=start, origin=origin))
    return Path(path)
