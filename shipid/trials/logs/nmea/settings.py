"""What a log cannot say of itself: the table ``[nmea]`` of a trial format file.

Everything is optional; ``--format nmea`` alone stands for an empty table::

    [nmea]
    stamp = "iso"              # the logger's stamp: auto, iso, epoch, hh:mm:ss, seconds, milliseconds, none (not used:
                               # the UTC of the sentences counts), or a strptime layout: "%m/%d/%Y,%H:%M:%S.%f"
    date = 2026-05-04          # where neither stamp nor sentence says it
    interval = "0.2 s"         # of the trial; the median interval of the heading by default
    gap = "3 s"                # nothing is interpolated across more; five intervals of the sentence by default
    speed = "ground"           # or water, the default: whose u and v are wanted where both are there
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

    [nmea.sources]             # whom to believe: sentence, or talker and sentence
    psi = "HEHDT"
    position = "GGA"
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from math import pi
from pathlib import Path
from typing import Any

from shipid.declaration import units
from shipid.foundation.errors import UnitError
from shipid.trials.logs.format import TrialFormat, _Parser, read_format
from shipid.trials.logs.nmea.lines import stamp_reader

#: What a log may hold, by the names of `NmeaFormat.sources` and `NmeaFormat.leave_out`, and the sentences that carry it.
SIGNALS: dict[str, tuple[str, ...]] = {
    "psi": ("THS", "HDT", "HDG", "HDM", "VHW"),
    "r": ("ROT",),
    "delta": ("RSA",),
    "delta_order": ("ROR",),
    "u": ("VBW", "VHW"),
    "course": ("VTG", "RMC"),
    "position": ("GGA", "RMC", "GLL"),
    "wind": ("MWV",),
    "depth": ("DPT",),
}

_TOP = ("title", "source", "ship", "encoding", "comment", "windows", "nmea")
_NMEA = (
    "stamp", "date", "interval", "gap", "speed", "leave_out",
    "rudder", "order", "heading", "rate", "antenna", "sources",
)  # fmt: skip
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
        Sampling interval of the trial [s]; None is the median interval of the heading, 0.1 s at least.
    gap : float or None
        Longest interval to interpolate across [s]; None is five intervals of the sentence.
    speed : str
        ``water`` or ``ground``.
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
    path = Path(given)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError):
        return read_format(path)  # says what is wrong
    return _NmeaParser(path).parse(content) if "nmea" in content else read_format(path)


class _NmeaParser(_Parser):
    """Turns the content of a format file with ``[nmea]`` into an `NmeaFormat`."""

    def parse(self, content: dict[str, Any]) -> NmeaFormat:
        self.check_keys(content, _TOP, "a file with [nmea]")
        table = self.section(content, "nmea")
        self.check_keys(table, _NMEA, "[nmea]")
        parts = {key: self.part(table, key) for key in ("rudder", "order", "heading", "rate", "antenna", "sources")}
        heading, rate, antenna = parts["heading"], parts["rate"], parts["antenna"]
        self.check_keys(heading, ("reference", "variation", "correction"), "[nmea.heading]")
        self.check_keys(rate, ("unit", "sign"), "[nmea.rate]")
        self.check_keys(antenna, ("x", "y"), "[nmea.antenna]")
        day = table.get("date")
        if day is not None and type(day) is not date:
            raise self.fail(f"[nmea] date is {day!r}. Write a date without quotes, as in date = 2026-05-04.")
        where = "[nmea] "
        return NmeaFormat(
            self.path.stem,
            {},
            encoding=self.encoding(self.typed(content, "encoding", str, "", None)),
            comment=self.comment(self.typed(content, "comment", str, "", "#")),
            windows={name: self.window(name, value) for name, value in self.section(content, "windows").items()},
            **{key: self.typed(content, key, str, "", None) for key in ("ship", "source", "title")},
            rudder=self.calibration(parts["rudder"], "[nmea.rudder]"),
            order=self.calibration(parts["order"], "[nmea.order]"),
            stamp=self.stamp(self.typed(table, "stamp", str, where, "auto")),
            date=day,
            step=self.quantity(table["interval"], "s", "nmea.interval") if "interval" in table else None,
            gap=self.quantity(table["gap"], "s", "nmea.gap") if "gap" in table else None,
            speed=self.one_of(table, "speed", ("water", "ground"), where),
            leave_out=self.unwanted(table.get("leave_out", [])),
            reference=self.one_of(heading, "reference", ("true", "magnetic"), "[nmea.heading] "),
            variation=self.signed(heading, "variation", "rad", "nmea.heading.") if "variation" in heading else None,
            correction=self.signed(heading, "correction", "rad", "nmea.heading."),
            rate_unit=self.rate_unit(self.typed(rate, "unit", str, "[nmea.rate] ", "deg/min")),
            rate_sign=self.sign(rate, "[nmea.rate]"),
            antenna=self.place(antenna),
            sources=self.chosen(parts["sources"]),
        )

    def part(self, table: dict[str, Any], key: str) -> dict[str, Any]:
        value = table.get(key, {})
        if not isinstance(value, dict):
            raise self.fail(f"nmea.{key} is {value!r}, and must be a table [nmea.{key}].")
        return value

    def one_of(self, table: dict[str, Any], key: str, choices: tuple[str, ...], where: str) -> str:
        value = str(self.typed(table, key, str, where, choices[0]))
        if value not in choices:
            raise self.fail(f"{where}{key} is '{value}'. Write one of {', '.join(choices)}.")
        return value

    def signed(self, table: dict[str, Any], key: str, wanted: str, where: str) -> float:
        """Read a quantity of either sign; zero where it is not given."""
        value = table.get(key, f"0 {wanted}")
        if not isinstance(value, (str, int, float)) or isinstance(value, bool):
            raise self.fail(f"{where}{key} is {value!r}. Write a value with its unit, as text.")
        try:
            return units.to_si(value, wanted, f"{where}{key}")
        except UnitError as error:
            raise self.fail(str(error)) from None

    def place(self, table: dict[str, Any]) -> tuple[float, float] | None:
        x, y = (self.signed(table, key, "m", "nmea.antenna.") for key in ("x", "y"))
        return (x, y) if table else None

    def sign(self, table: dict[str, Any], where: str) -> int:
        sign = int(self.typed(table, "sign", int, where + " ", 1))
        if sign not in (1, -1):
            raise self.fail(f"{where} sign is {sign}, and must be 1 or -1. A factor is written as scale.")
        return sign

    def calibration(self, table: dict[str, Any], where: str) -> Calibration:
        self.check_keys(table, _RUDDER, where)
        use = self.one_of(table, "use", ("starboard", "port", "mean"), where + " ") if "use" in table else None
        name = where.strip("[]") + "."
        scale = self.quantity(table["scale"], "rad", name + "scale") if "scale" in table else Calibration.scale
        return Calibration(
            use, scale, self.signed(table, "offset", "rad", name), self.sign(table, where), "scale" in table
        )

    def stamp(self, layout: str) -> str:
        try:
            stamp_reader(layout)
        except ValueError as error:
            raise self.fail(
                f"[nmea] stamp is '{layout}', and {error}. Write auto, iso, epoch, hh:mm:ss, seconds, milliseconds, "
                "none, or a strptime layout."
            ) from None
        return layout

    def rate_unit(self, unit: str) -> str:
        try:
            units.factor(unit, "rad/s", "nmea.rate.unit")
        except UnitError as error:
            raise self.fail(str(error)) from None
        return unit

    def unwanted(self, names: Any) -> tuple[str, ...]:
        if not isinstance(names, list) or not all(isinstance(n, str) for n in names):
            raise self.fail(f"[nmea] leave_out is {names!r}, and must be a list of names.")
        self.check_keys(dict.fromkeys(names), SIGNALS, "[nmea] leave_out")
        return tuple(names)

    def chosen(self, table: dict[str, Any]) -> dict[str, str]:
        self.check_keys(table, SIGNALS, "[nmea.sources]")
        for name in table:
            address = self.typed(table, name, str, "[nmea.sources] ", "")
            if address[-3:] not in SIGNALS[name] or len(address) not in (3, 5):
                raise self.fail(
                    f"[nmea.sources] {name} is '{address}'. Write one of {', '.join(SIGNALS[name])}, with the talker "
                    f"before it or without, as in '{'GP' if name in ('position', 'course') else 'HE'}{SIGNALS[name][0]}'."
                )
        return dict(table)
