"""What each sentence carries: the fields that are numbers and valid, as the standard counts them.

A field that is empty, or whose status says that it is not valid, is NaN. Nothing is converted yet: knots stay knots, and
ROT stays in degrees a minute. The order of the fields is that of IEC 61162-1.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import date
from functools import lru_cache

NAN = float("nan")
_EPOCH_DAY = date(1970, 1, 1).toordinal()

#: The fields of a sentence as text; the address stands first.
Fields = list[str]

#: The positioning system's mode indicators that are fixes: autonomous, differential, precise, RTK, float RTK.
_FIX = ("", "A", "D", "P", "R", "F")
#: GGA's qualities that are fixes: GPS, differential, precise, RTK, float RTK. 6 is dead reckoning, 7 manual, 8 a simulator.
_QUALITY = ("1", "2", "3", "4", "5")
#: Knots a unit of MWV's speed: knots, km/h, m/s, statute miles per hour.
_WIND_UNITS = {"N": 1.0, "K": 1 / 1.852, "M": 3600 / 1852, "S": 1609.344 / 1852}

#: A speed of nines alone, 99 knots and more: no ship's.
_NINES = re.compile(r"-?99+(?:\.9*)?")


def _text(f: Fields, k: int, absent: str = "") -> str:
    return f[k] if k < len(f) else absent


def _number(f: Fields, k: int, valid: bool = True) -> float:
    """Field k as a number; NaN where it is empty or not valid. A text that is no number is a ValueError."""
    text = _text(f, k)
    if not text:
        return NAN
    if "_" in text:
        raise ValueError(text)
    value = float(text)
    return value if valid and abs(value) < 1e9 else NAN  # NaN compares false


def _speed(f: Fields, k: int, valid: bool = True) -> float:
    """Field k as a speed; NaN also where it is nines alone, as 99.99 or -999.9, which logs send for one that they have not."""
    return NAN if _NINES.fullmatch(_text(f, k)) else _number(f, k, valid)


def _utc(f: Fields, k: int, valid: bool = True) -> float:
    """Seconds of the day of ``hhmmss.ss``."""
    text = _text(f, k)
    if not valid or not text:
        return NAN
    if not (text[:6].isdigit() and len(text) >= 6):
        raise ValueError(text)
    hour, minute, second = int(text[:2]), int(text[2:4]), float(text[4:])
    return hour * 3600 + minute * 60 + second if hour < 24 and minute < 60 and second < 61 else NAN


@lru_cache(maxsize=256)
def _day_number(year: int, month: int, day: int) -> float:
    try:
        return float(date(year, month, day).toordinal() - _EPOCH_DAY)
    except (ValueError, OverflowError):  # numbers of any length
        return NAN


def _day(f: Fields, k: int) -> float:
    """Days since 1970 of ``ddmmyy``; the positioning system began in 1980."""
    text = _text(f, k)
    if not (text.isdigit() and len(text) == 6):
        return NAN
    year = int(text[4:])
    return _day_number(year + (1900 if year >= 80 else 2000), int(text[2:4]), int(text[:2]))


def _angle(f: Fields, k: int, letters: str, degrees: int) -> float:
    """Degrees of ``dddmm.mmmm`` with its letter; NaN without the letter that says which hemisphere."""
    text, side = _text(f, k), _text(f, k + 1)
    if not text or side not in letters or not side:
        return NAN
    if not text[: degrees + 2].isdigit():
        raise ValueError(text)
    minutes = float(text[degrees:])
    value = int(text[:degrees]) + minutes / 60 if minutes < 60 else NAN
    return value if side == letters[0] else -value


def _place(f: Fields, k: int, valid: bool) -> tuple[float, float]:
    """Latitude and longitude [deg], four fields from k on."""
    lat, lon = _angle(f, k, "NS", 2), _angle(f, k + 2, "EW", 3)
    return (lat, lon) if valid and abs(lat) <= 90 and abs(lon) <= 180 else (NAN, NAN)


def _signed(f: Fields, k: int, unsure: float) -> float:
    """A number with its letter E or W; `unsure` where it is not given."""
    number, letter = _number(f, k), _text(f, k + 1)
    if number != number or letter not in ("E", "W"):
        return unsure
    return abs(number) if letter == "E" else -abs(number)


def _heading(value: float) -> float:
    return value if -360 <= value <= 360 else NAN


def _both_rudders(f: Fields) -> tuple[float, ...]:
    return _number(f, 1, _text(f, 2) == "A"), _number(f, 3, _text(f, 4) == "A")


def _hdt(f: Fields) -> tuple[float, ...]:
    return (_heading(_number(f, 1, _text(f, 2, "T") == "T")),)


def _ths(f: Fields) -> tuple[float, ...]:
    return (_heading(_number(f, 1, _text(f, 2) in ("A", "E"))),)


def _hdg(f: Fields) -> tuple[float, ...]:
    return _heading(_number(f, 1)) + _signed(f, 2, 0.0), _signed(f, 4, NAN)


def _hdm(f: Fields) -> tuple[float, ...]:
    return (_heading(_number(f, 1, _text(f, 2, "M") == "M")),)


def _rot(f: Fields) -> tuple[float, ...]:
    return (_number(f, 1, _text(f, 2, "A") == "A"),)


def _vhw(f: Fields) -> tuple[float, ...]:
    knots = _speed(f, 5)
    return _heading(_number(f, 1)), knots if knots == knots else _speed(f, 7) / 1.852


def _vbw(f: Fields) -> tuple[float, ...]:
    water, ground = _text(f, 3) == "A", _text(f, 6) == "A"
    return _speed(f, 1, water), _speed(f, 2, water), _speed(f, 4, ground), _speed(f, 5, ground)


def _vtg(f: Fields) -> tuple[float, ...]:
    valid = _text(f, 9) in _FIX and _text(f, 2, "T") == "T"
    knots = _speed(f, 5, valid)
    return knots if knots == knots else _speed(f, 7, valid) / 1.852, _number(f, 1, valid)


def _rmc(f: Fields) -> tuple[float, ...]:
    valid = _text(f, 2) == "A" and _text(f, 12) in _FIX
    speed, course, day = _speed(f, 7, valid), _number(f, 8, valid), _day(f, 9) if valid else NAN
    return *_place(f, 3, valid), speed, course, _signed(f, 10, NAN), _utc(f, 1, valid), day


def _gga(f: Fields) -> tuple[float, ...]:
    valid = _text(f, 6) in _QUALITY
    return *_place(f, 2, valid), _utc(f, 1, valid), _number(f, 6, valid)


def _gll(f: Fields) -> tuple[float, ...]:
    valid = _text(f, 6, "A") == "A" and _text(f, 7) in _FIX
    return *_place(f, 1, valid), _utc(f, 5, valid)


def _zda(f: Fields) -> tuple[float, ...]:
    day, month, year = (_text(f, k) for k in (2, 3, 4))
    said = day.isdigit() and month.isdigit() and year.isdigit() and len(year) == 4
    return _utc(f, 1), _day_number(int(year), int(month), int(day)) if said else NAN


def _mwv(f: Fields) -> tuple[float, ...]:
    unit = _text(f, 4)
    valid = _text(f, 5) == "A" and unit in _WIND_UNITS
    wind = _number(f, 1, valid), _number(f, 3, valid) * _WIND_UNITS.get(unit, NAN)
    return {"R": (*wind, NAN, NAN), "T": (NAN, NAN, *wind)}.get(_text(f, 2), (NAN,) * 4)


def _dpt(f: Fields) -> tuple[float, ...]:
    return (_number(f, 1),)


#: Sentence: the fields it carries here, and the function that takes them from its text; a field that is no number, where one
#: has to stand, is a ValueError.
CARRIED: dict[str, tuple[tuple[str, ...], Callable[[Fields], tuple[float, ...]]]] = {
    "RSA": (("starboard", "port"), _both_rudders),
    "ROR": (("starboard", "port"), _both_rudders),
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
