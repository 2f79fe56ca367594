"""What each sentence carries: the fields that are numbers and valid, as the standard counts them.

pynmeagps splits and types the fields; here their status is obeyed. A field that is empty or whose status says that it is
not valid is NaN. Nothing is converted yet: knots stay knots, and ROT stays in degrees a minute.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import date, datetime, time
from typing import TYPE_CHECKING

from shipid.foundation.errors import MissingExtraError

if TYPE_CHECKING:
    from pynmeagps import NMEAMessage

NAN = float("nan")
_EPOCH_DAY = date(1970, 1, 1).toordinal()

#: The positioning system's mode indicators that are fixes: autonomous, differential, precise, RTK, float RTK.
_FIX = ("", "A", "D", "P", "R", "F")
#: GGA's qualities that are fixes: GPS, differential, precise, RTK, float RTK. 6 is dead reckoning, 7 manual, 8 a simulator.
_QUALITY = (1, 2, 3, 4, 5)
#: Knots a unit of MWV's speed: knots, km/h, m/s, statute miles per hour.
_WIND_UNITS = {"N": 1.0, "K": 1 / 1.852, "M": 3600 / 1852, "S": 1609.344 / 1852}


def parser() -> Callable[[str], NMEAMessage | None]:
    """Return the function that splits and types a sentence.

    Raises
    ------
    MissingExtraError
        If pynmeagps is not installed.
    """
    try:
        from pynmeagps import NMEAReader
        from pynmeagps.exceptions import NMEAMessageError, NMEAParseError, NMEATypeError
    except ImportError:
        raise MissingExtraError("an NMEA log", "pynmeagps", "nmea") from None

    def parse(text: str) -> NMEAMessage | None:
        try:
            return NMEAReader.parse(text + "*00", validate=0)
        except (NMEAMessageError, NMEAParseError, NMEATypeError):
            return None

    return parse


def _number(value: object) -> float:
    if not isinstance(value, (int, float)):
        return NAN
    return float(value) if abs(value) < 1e9 else NAN  # NaN compares false


def _get(message: NMEAMessage, name: str, valid: bool = True) -> float:
    return _number(getattr(message, name, None)) if valid else NAN


def _utc(message: NMEAMessage, valid: bool = True) -> float:
    value = getattr(message, "time", None)
    if not valid or not isinstance(value, time):
        return NAN
    return value.hour * 3600 + value.minute * 60 + value.second + value.microsecond * 1e-6


def _day(message: NMEAMessage) -> float:
    value = getattr(message, "date", None)
    if isinstance(value, datetime):
        value = value.date()
    return value.toordinal() - _EPOCH_DAY if isinstance(value, date) else NAN


def _signed(message: NMEAMessage, value: str, side: str, unsure: float) -> float:
    """A number with its letter E or W; `unsure` where it is not given."""
    number, letter = _number(getattr(message, value, None)), getattr(message, side, "")
    if number != number or letter not in ("E", "W"):
        return unsure
    return abs(number) if letter == "E" else -abs(number)


def _place(message: NMEAMessage, valid: bool) -> tuple[float, float]:
    """Latitude and longitude [deg]; NaN without the letters that say which hemisphere."""
    valid = valid and getattr(message, "NS", "") in ("N", "S") and getattr(message, "EW", "") in ("E", "W")
    lat, lon = _get(message, "lat", valid), _get(message, "lon", valid)
    return (lat, lon) if abs(lat) <= 90 and abs(lon) <= 180 else (NAN, NAN)


def _rsa(m: NMEAMessage) -> tuple[float, ...]:
    return _get(m, "stbdangle", m.stbdstatus == "A"), _get(m, "portangle", getattr(m, "portstatus", "") == "A")


def _ror(m: NMEAMessage) -> tuple[float, ...]:
    return (
        _get(m, "stbdrudderorder", m.stbdrudderstatus == "A"),
        _get(m, "portrudderorder", getattr(m, "portrudderstatus", "") == "A"),
    )


def _heading(value: float) -> float:
    return value if -360 <= value <= 360 else NAN


def _hdt(m: NMEAMessage) -> tuple[float, ...]:
    return (_heading(_get(m, "headingT", getattr(m, "headingTu", "T") == "T")),)


def _ths(m: NMEAMessage) -> tuple[float, ...]:
    return (_heading(_get(m, "headt", getattr(m, "mi", "") in ("A", "E"))),)


def _hdg(m: NMEAMessage) -> tuple[float, ...]:
    deviation = _signed(m, "deviation", "deviationEW", 0.0)
    return _heading(_get(m, "headingM")) + deviation, _signed(m, "variation", "variationEW", NAN)


def _hdm(m: NMEAMessage) -> tuple[float, ...]:
    return (_heading(_get(m, "headingM", getattr(m, "headingMag", "M") == "M")),)


def _rot(m: NMEAMessage) -> tuple[float, ...]:
    return (_get(m, "rot", getattr(m, "valid", "A") == "A"),)


def _vhw(m: NMEAMessage) -> tuple[float, ...]:
    knots = _get(m, "spdN")
    if knots != knots:
        knots = _get(m, "spdK") / 1.852
    return _heading(_get(m, "hdgT")), knots


def _vbw(m: NMEAMessage) -> tuple[float, ...]:
    water, ground = getattr(m, "waterspdstatus", "") == "A", getattr(m, "groundspdstatus", "") == "A"
    return (
        _get(m, "longwaterspd", water),
        _get(m, "transwaterspd", water),
        _get(m, "longgroundspd", ground),
        _get(m, "transgroundspd", ground),
    )


def _vtg(m: NMEAMessage) -> tuple[float, ...]:
    valid = getattr(m, "posMode", "") in _FIX
    knots = _get(m, "sogn", valid)
    if knots != knots:
        knots = _get(m, "sogk", valid) / 1.852
    return knots, _get(m, "cogt", valid)


def _rmc(m: NMEAMessage) -> tuple[float, ...]:
    valid = m.status == "A" and getattr(m, "posMode", "") in _FIX
    variation = _signed(m, "mv", "mvEW", NAN)
    return (
        *_place(m, valid),
        _get(m, "spd", valid),
        _get(m, "cog", valid),
        variation,
        _utc(m, valid),
        _day(m) if valid else NAN,
    )


def _gga(m: NMEAMessage) -> tuple[float, ...]:
    valid = m.quality in _QUALITY
    return *_place(m, valid), _utc(m, valid), _get(m, "quality", valid)


def _gll(m: NMEAMessage) -> tuple[float, ...]:
    valid = getattr(m, "status", "A") == "A" and getattr(m, "posMode", "") in _FIX
    return *_place(m, valid), _utc(m, valid)


def _zda(m: NMEAMessage) -> tuple[float, ...]:
    try:
        day = float(date(m.year, m.month, m.day).toordinal() - _EPOCH_DAY)
    except (AttributeError, TypeError, ValueError):
        day = NAN
    return _utc(m), day


def _mwv(m: NMEAMessage) -> tuple[float, ...]:
    valid = getattr(m, "status", "") == "A" and m.speedu in _WIND_UNITS
    knots = _get(m, "speed", valid) * _WIND_UNITS.get(m.speedu, NAN)
    angle = _get(m, "angle", valid)
    return (
        (angle, knots, NAN, NAN)
        if m.reference == "R"
        else (NAN, NAN, angle, knots)
        if m.reference == "T"
        else (NAN,) * 4
    )


def _dpt(m: NMEAMessage) -> tuple[float, ...]:
    return (_get(m, "depth"),)


#: Sentence: the fields it carries here, and the function that takes them from a parsed message.
CARRIED: dict[str, tuple[tuple[str, ...], Callable[[NMEAMessage], tuple[float, ...]]]] = {
    "RSA": (("starboard", "port"), _rsa),
    "ROR": (("starboard", "port"), _ror),
    "HDT": (("heading",), _hdt),
    "THS": (("heading",), _ths),
    "HDG": (("heading", "variation"), _hdg),
    "HDM": (("heading",), _hdm),
    "ROT": (("rate",), _rot),
    "VHW": (("heading", "u"), _vhw),
    "VBW": (("u", "v", "u_ground", "v_ground"), _vbw),
    "VTG": (("sog", "cog"), _vtg),
    "RMC": (("lat", "lon", "sog", "cog", "variation", "utc", "day"), _rmc),
    "GGA": (("lat", "lon", "utc", "quality"), _gga),
    "GLL": (("lat", "lon", "utc"), _gll),
    "ZDA": (("utc", "day"), _zda),
    "MWV": (("angle", "speed", "true_angle", "true_speed"), _mwv),
    "DPT": (("depth",), _dpt),
}
