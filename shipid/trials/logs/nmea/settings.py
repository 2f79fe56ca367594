"""The table ``[nmea]`` of a trial format file: what the sentences of a log leave open.

Everything is optional; ``--format nmea`` alone stands for an empty table::

    [nmea]
    stamp = "iso"              # the logger's stamp: auto, iso, epoch, hh:mm:ss, seconds, milliseconds, none (not used:
                               # the UTC of the sentences counts), or a strptime layout: "%m/%d/%Y,%H:%M:%S.%f"
    date = 2026-05-04          # where neither stamp nor sentence says it
    interval = "0.2 s"         # one clock for all signals, interpolated; by default each signal keeps its own
    gap = "3 s"                # nothing is interpolated onto that clock across more; five intervals of the sentence by default
    speed = "ground"           # or water, the default: u and v over ground, for a log without a speed through the water
    leave_out = ["depth"]      # signals that are not wanted

    [nmea.rudder]              # angle = sign * (scale * RSA + offset)
    use = "port"               # starboard, port or mean
    scale = "0.35 deg"         # a unit of RSA
    offset = "1.2 deg"
    sign = -1                  # positive RSA turns this ship to port

    [nmea.order]               # the same for ROR

    [nmea.heading]
    reference = "magnetic"     # or true, the default: which is preferred where both are there
    variation = "-2.1 deg"     # east is positive; added to a magnetic heading
    correction = "0.7 deg"     # added to any heading: the gyro's error

    [nmea.rate]
    unit = "deg/s"             # deg/min, unless the sensor breaks the standard
    sign = -1

    [nmea.antenna]             # from midship: the positions of the trial are of midship
    x = "31.5 m"               # forward
    y = "-2.0 m"               # to starboard

    [nmea.sources]             # which source is taken: sentence, or talker and sentence
    psi = "HEHDT"
    position = "GPGGA#2"       # the second of two receivers with one talker
    r = "127251#27"            # NMEA 2000: PGN and source
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from math import pi
from pathlib import Path

from shipid.declaration import units
from shipid.declaration.tables import Table
from shipid.foundation.errors import UnitError, nearest
from shipid.trials.errors import FormatFileError
from shipid.trials.logs.format import TrialFormat, common_entries, parse_format, read_format_table, sign_of
from shipid.trials.logs.nmea.sentences.lines import stamp_reader

#: What a log may hold, by the names of `NmeaFormat.sources` and `NmeaFormat.leave_out`, and the sentences and PGNs that
#: carry it.
SIGNALS: dict[str, tuple[str, ...]] = {
    "psi": ("THS", "HDT", "HDG", "HDM", "VHW", "127250", "127257"),
    "r": ("ROT", "127251"),
    "delta": ("RSA", "127245"),
    "delta_order": ("ROR", "127245"),
    "u": ("VBW", "VHW", "128259"),
    "course": ("VTG", "RMC", "VBW", "129026"),
    "position": ("GGA", "RMC", "GLL", "129025", "129029"),
    "wind": ("MWV", "130306"),
    "depth": ("DPT",),
    "phi": ("127257",),
    "n_engine": ("127488",),
}

_TOP = ("title", "source", "ship", "encoding", "comment", "windows", "nmea", "trial")
_NMEA = (
    "stamp", "date", "interval", "gap", "speed", "leave_out",
    "rudder", "order", "heading", "rate", "antenna", "sources",
)  # fmt: skip
_ADDRESS = re.compile(r"[A-Z0-9]{3,8}(#[A-Za-z0-9_.-]{1,16})?")
_RUDDER = ("use", "scale", "offset", "sign")


@dataclass(frozen=True)
class Calibration:
    """From the number in RSA or ROR to the rudder angle: ``sign * (scale * number + offset)``.

    Attributes
    ----------
    use : str or None
        ``starboard``, ``port`` or ``mean``; None takes the one that is there, starboard first.
    scale : float
        Angle a unit [rad].
    offset : float
        Angle at zero [rad].
    sign : int
        -1 where positive numbers turn the ship to port.
    stated : bool
        Whether the format file gives the scale.
    """

    use: str | None = None
    scale: float = pi / 180
    offset: float = 0.0
    sign: int = 1
    stated: bool = False


@dataclass(frozen=True)
class NmeaFormat(TrialFormat):
    """A trial format with a table ``[nmea]``, read and checked.

    Attributes
    ----------
    rudder, order : Calibration
        Of RSA and of ROR.
    stamp : str
        Layout of the logger's stamp.
    date : date or None
        Of the first line.
    step : float or None
        Interval of the one clock for all signals [s]; None is each signal's own clock.
    gap : float or None
        Longest interval to interpolate across onto that clock [s]; None is five intervals of the sentence.
    speed : str
        What u and v are: through the ``water``, or over ``ground``.
    leave_out : tuple of str
        Signals that are not wanted.
    reference : str
        Preferred heading: ``true`` or ``magnetic``.
    variation : float or None
        Magnetic variation [rad], east positive.
    correction : float
        Added to the heading [rad].
    rate_unit : str
        Unit of ROT.
    rate_sign : int
        -1 where positive ROT turns to port.
    antenna : tuple of float or None
        Forward and to starboard of midship [m]; None is not known.
    sources : Mapping of str to str
        Sentence, or talker and sentence, by signal.
    """

    rudder: Calibration = field(default_factory=Calibration)
    order: Calibration = field(default_factory=Calibration)
    stamp: str = "auto"
    date: date | None = None
    step: float | None = None
    gap: float | None = None
    speed: str = "water"
    leave_out: tuple[str, ...] = ()
    reference: str = "true"
    variation: float | None = None
    correction: float = 0.0
    rate_unit: str = "deg/min"
    rate_sign: int = 1
    antenna: tuple[float, float] | None = None
    sources: Mapping[str, str] = field(default_factory=dict)


def chosen_format(given: str | Path | TrialFormat | None) -> TrialFormat | None:
    """Return the format a caller names: ``"nmea"``, a format file with or without ``[nmea]``, a format, or None.

    Parameters
    ----------
    given : str, Path, TrialFormat or None
        As `shipid.read_trial` takes it.

    Returns
    -------
    TrialFormat or None
        An `NmeaFormat` for an NMEA log.

    Raises
    ------
    FormatFileError, MissingFileError
        As `shipid.trials.logs.format.read_format` does.
    """
    if given is None or isinstance(given, TrialFormat):
        return given
    if isinstance(given, str) and given.lower() == "nmea":
        return NmeaFormat("nmea", {})
    table, name = read_format_table(given), Path(given).stem
    return _nmea_format(table, name) if "nmea" in table else parse_format(table, name)


def _nmea_format(file: Table, name: str) -> NmeaFormat:
    """Return the format that the table of a file with ``[nmea]`` states."""
    file.check_keys(_TOP)
    table = file.table("nmea")
    table.check_keys(_NMEA)
    heading, rate, antenna = table.table("heading"), table.table("rate"), table.table("antenna")
    heading.check_keys(("reference", "variation", "correction"))
    rate.check_keys(("unit", "sign"))
    antenna.check_keys(("x", "y"))
    day = table.content.get("date")
    if day is not None and type(day) is not date:
        raise table.fail(f"'date' is {day!r}. Write a date without quotes, as in date = 2026-05-04.")
    return NmeaFormat(
        name,
        {},
        **common_entries(file),
        rudder=_calibration(table.table("rudder")),
        order=_calibration(table.table("order")),
        stamp=_stamp(table),
        date=day,
        step=table.quantity("interval", "s", positive=True),
        gap=table.quantity("gap", "s", positive=True),
        speed=table.choice("speed", ("water", "ground")) or "water",
        leave_out=_unwanted(table),
        reference=heading.choice("reference", ("true", "magnetic")) or "true",
        variation=heading.quantity("variation", "rad"),
        correction=heading.quantity("correction", "rad") or 0.0,
        rate_unit=_rate_unit(rate),
        rate_sign=sign_of(rate),
        antenna=(antenna.quantity("x", "m") or 0.0, antenna.quantity("y", "m") or 0.0) if antenna.content else None,
        sources=_sources(table.table("sources")),
    )


def _calibration(table: Table) -> Calibration:
    table.check_keys(_RUDDER)
    return Calibration(
        table.choice("use", ("starboard", "port", "mean")),
        table.quantity("scale", "rad", positive=True) or Calibration.scale,
        table.quantity("offset", "rad") or 0.0,
        sign_of(table),
        "scale" in table,
    )


def _stamp(table: Table) -> str:
    layout = str(table.value("stamp", str, "auto"))
    try:
        stamp_reader(layout)
    except ValueError as error:
        raise table.fail(
            f"'stamp' is '{layout}', and {error}. Write auto, iso, epoch, hh:mm:ss, seconds, milliseconds, "
            "none, or a strptime layout."
        ) from None
    return layout


def _rate_unit(table: Table) -> str:
    unit = str(table.value("unit", str, "deg/min"))
    try:
        units.factor(unit, "rad/s", f"{table.where}: 'unit'")
    except UnitError as error:
        raise FormatFileError(str(error)) from None
    return unit


def _unwanted(table: Table) -> tuple[str, ...]:
    names = table.value("leave_out", list, [])
    if not all(isinstance(name, str) for name in names):
        raise table.fail(f"'leave_out' is {names!r}, and has to be a list of names.")
    for name in names:
        if name not in SIGNALS:
            raise table.fail(f"'leave_out' names '{name}', which is no signal. {nearest(name, SIGNALS)}")
    return tuple(names)


def _sources(table: Table) -> dict[str, str]:
    table.check_keys(SIGNALS)
    sources = {name: str(table.value(name, str)) for name in table}
    for name, address in sources.items():
        if _ADDRESS.fullmatch(address) is None or not address.partition("#")[0].endswith(SIGNALS[name]):
            talker = "GP" if name in ("position", "course") else "HE"
            example = SIGNALS[name][0] if SIGNALS[name][0].isdigit() else talker + SIGNALS[name][0]
            raise table.fail(
                f"'{name}' is '{address}'. Write one of {', '.join(SIGNALS[name])}, with the talker before it or without, "
                f"as in '{example}'; behind a # the stream of one of several devices or the source of a PGN, as in "
                f"'{example}#2'."
            )
    return sources
