"""Numbers as they are handed over: printed, with two digits of the standard deviation and NaN in words; or plain, beside their units."""

from __future__ import annotations

from collections.abc import Mapping
from math import floor, isfinite, log10

from shipid.foundation.aliases import Plain

#: What is printed for NaN, infinity and None.
NO_NUMBER = "no number"
_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_DIGITS = 4
#: A larger size is printed as no number, a size below the inverse as 0.
_LARGEST = 1e290
_MOST_DIGITS = 7
#: In a sentence a number below this is written out.
_WRITTEN_OUT = 1e7

#: How the name of an attribute ends that is not SI or says its unit for another reason; the longer ending goes first.
_ENDINGS = {"_rad_s": "rad/s", "_deg_s": "deg/s", "_m_s": "m/s", "_deg": "deg", "_m": "m", "_s": "s"}


def number(value: float | None, digits: int = _DIGITS) -> str:
    """Return a number with a given number of significant digits; `NO_NUMBER` for NaN, infinity and None.

    Parameters
    ----------
    value : float or None
        The number.
    digits : int
        Significant digits.
    """
    if value is None or not _is_number(value):
        return NO_NUMBER
    if abs(value) < 1 / _LARGEST:
        return "0"
    # The size is that of the rounded number: 0.99999 has the digits of 1.
    size = float(f"{abs(value):.{digits - 1}e}")
    power = _power(size)
    return _join(_fixed(value, power, digits - 1 - floor(log10(size))), power)


def given(value: float | None) -> str:
    """Return a number that a user wrote: at most six significant digits, without trailing zeros.

    Parameters
    ----------
    value : float or None
        The number.
    """
    text = number(value, 6)
    mantissa, times, power = text.partition(" × ")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + times + power


def brief(value: float | None, digits: int = 3) -> str:
    """Return a number as it stands in a sentence: without trailing zeros, large ones written out (140, not 1.4e+02), an ASCII minus sign.

    Parameters
    ----------
    value : float or None
        The number.
    digits : int
        Significant digits.
    """
    if value is None or not _is_number(value):
        return NO_NUMBER
    text = f"{value + 0.0:.{digits}g}"
    if "e" not in text:
        return text
    size = abs(float(text))
    if 1 <= size < _WRITTEN_OUT:
        return f"{float(text):.0f}"
    mantissa, times, power = number(value, digits).replace("−", "-").partition(" × ")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + times + power


def moment(seconds: float | None) -> str:
    """Return a moment of a clock in s: all digits before the point, at most two behind it, so that it can be typed as part of a trial.

    Parameters
    ----------
    seconds : float or None
        The moment; a clock may count from long ago.
    """
    if seconds is None or not _is_number(seconds):
        return NO_NUMBER
    text = f"{round(float(seconds), 2) + 0.0:.2f}"
    return text.rstrip("0").rstrip(".")


def counted(count: int, one: str, several: str | None = None) -> str:
    """Return a number of things with its noun: "1 gap", "3 gaps", "1 row is", "2 rows are".

    Parameters
    ----------
    count : int
        How many.
    one : str
        What one of them is called.
    several : str, optional
        What any other number of them is called; by default with an s.
    """
    return f"{count} {one if count == 1 else several or one + 's'}"


def fixed(value: float | None, decimals: int, *, sign: bool = False) -> str:
    """Return a number with a given number of decimals.

    Parameters
    ----------
    value : float or None
        The number.
    decimals : int
        Decimals.
    sign : bool
        Whether a plus sign is written.
    """
    if value is None or not isfinite(value):
        return NO_NUMBER
    text = f"{value:{'+' if sign else ''}.{decimals}f}"
    if float(text) == 0:
        text = text.lstrip("+-")
    return text.replace("-", "−")


def percent(share: float, decimals: int = 0) -> str:
    """Return a share in percent as it is written everywhere, with a space: ``43 %``.

    Parameters
    ----------
    share : float
        1 is 100 %.
    decimals : int
        Decimals.
    """
    return f"{100 * share:.{decimals}f} %"


def probability(p: float) -> str:
    """Return a probability, and of a very small one only that it is small.

    Parameters
    ----------
    p : float
        The probability.
    """
    return "below 0.0001" if p < 1e-4 else number(p, 2)


def uncertain(value: float | None, std: float | None) -> str:
    """Return ``1.594 ± 0.0060``: the standard deviation with two digits, the value to the same place.

    Parameters
    ----------
    value, std : float or None
        The value and its standard deviation.
    """
    if value is None or not _is_number(value):
        return NO_NUMBER
    if std is None or not _is_number(std) or std < 1 / _LARGEST:
        return number(value)
    power, place = _place(value, std)
    if place is None:
        return f"{number(value, _MOST_DIGITS)} ± {number(std, 2)}"
    both = f"{_fixed(value, power, place)} ± {_fixed(std, power, place)}"
    return f"({both}) × 10{str(power).translate(_SUPERSCRIPT)}" if power else both


def uncertain_text(value: float | None, std: float | None) -> str:
    """Return the same for a terminal, with an ASCII minus sign; a value of its own as a user writes it.

    Parameters
    ----------
    value, std : float or None
        The value and its standard deviation.
    """
    known = std is not None and _is_number(std) and std >= 1 / _LARGEST
    return (uncertain(value, std) if known else given(value)).replace("−", "-")


def spread(value: float, std: float) -> str:
    """Return ``± 0.0024``, in the decimals in which it would stand behind the value: for a column beside that of the value.

    Parameters
    ----------
    value, std : float
        The value and a standard deviation.
    """
    head, _, tail = uncertain(value, std).partition(" ± ")
    return f"± {tail if tail and not head.startswith('(') else number(std, 2)}"


def interval(ends: tuple[float, float] | None, std: float | None) -> str:
    """Return ``1.582 to 1.606``, to the second digit of the standard deviation.

    Parameters
    ----------
    ends : tuple of float or None
        Both ends.
    std : float or None
        The standard deviation.
    """
    if ends is None or std is None or not all(_is_number(e) for e in (*ends, std)) or std < 1 / _LARGEST:
        return "none"
    power, place = _place(0.5 * (ends[0] + ends[1]), std)
    if place is None:
        return " to ".join(number(e, _MOST_DIGITS) for e in ends)
    low, high = (_fixed(e, power, place) for e in ends)
    return f"({low} to {high}) × 10{str(power).translate(_SUPERSCRIPT)}" if power else f"{low} to {high}"


def estimate(value: float | None, ends: tuple[float, float] | None, factor: float = 1.0) -> tuple[str, str]:
    """Return a value and its 95 % interval, both to the second digit of the standard deviation that the interval stands for.

    Parameters
    ----------
    value : float or None
        The value.
    ends : tuple of float or None
        Both ends; the interval is empty where they are not known, and the value has three digits.
    factor : float
        Of the unit shown.
    """
    if value is None or ends is None or not all(_is_number(e) for e in (value, *ends)) or ends[0] == ends[1]:
        return number(None if value is None else value * factor, 3), ""
    low, high = sorted(end * factor for end in ends)
    std = (high - low) / 4
    power, place = _place(value * factor, std)
    shown = (
        number(value * factor, _MOST_DIGITS) if place is None else _join(_fixed(value * factor, power, place), power)
    )
    return shown, interval((low, high), std)


def _is_number(value: float) -> bool:
    return isfinite(value) and abs(value) <= _LARGEST


def _power(size: float) -> int:
    exponent = floor(log10(size)) if size > 0 else 0
    return 0 if -3 <= exponent < 5 else exponent


def _place(value: float, std: float) -> tuple[int, int | None]:
    """Power of ten to take out and the last decimal place; no place where the value would get too many digits."""
    power = _power(max(abs(value), std))
    place = last_place(std)
    if value and floor(log10(abs(value))) + place >= _MOST_DIGITS:
        return power, None
    return power, place


def last_place(std: float) -> int:
    """Return the decimal place of the second digit of a standard deviation; below zero for one of 100 and more.

    Parameters
    ----------
    std : float
        Greater than zero.
    """
    return 1 - floor(log10(float(f"{std:.1e}")))


def _fixed(value: float, power: int, place: int) -> str:
    scaled = round(value, place) / 10.0**power
    return fixed(scaled, max(0, place + power))


def _join(mantissa: str, power: int) -> str:
    return f"{mantissa} × 10{str(power).translate(_SUPERSCRIPT)}" if power else mantissa


def quantity(value: Plain, unit: str, **more: Plain) -> dict[str, Plain]:
    """Return a value beside its unit: ``{"value": 12.0, "unit": "s"}``.

    Parameters
    ----------
    value : float, list of float or None
        The number; None where it is not known.
    unit : str
        Its unit.
    **more : float, list of float or None
        What belongs to it, in the same unit: ``std``.
    """
    return {"value": value, "unit": unit, **more}


def with_units(values: Mapping[str, Plain], **units: str) -> dict[str, Plain]:
    """Return plain values with the unit beside the number instead of in its name.

    Parameters
    ----------
    values : mapping of str to plain values
        ``settling_s`` becomes ``settling`` with the unit s; a name that ends in no unit stays.
    **units : str
        Units of names that do not say them.
    """
    found: dict[str, Plain] = {}
    for name, value in values.items():
        base, unit = _split(name)
        unit = units.get(name, unit)
        found[base] = value if unit is None else quantity(value, unit)
    return found


def columns_of(values: Mapping[str, Plain]) -> dict[str, Plain]:
    """Return a row of a table: a number beside its unit becomes a column ``name [unit]``.

    Parameters
    ----------
    values : mapping of str to plain values
        As `with_units` returns them.
    """
    return {
        (f"{n} [{v['unit']}]" if _is_quantity(v) else n): v["value"] if _is_quantity(v) else v
        for n, v in values.items()
    }


def unit_of_name(name: str) -> str | None:
    """Return the unit in which the name of an attribute ends, such as deg for ``error_deg``; None where it says none.

    Parameters
    ----------
    name : str
        Name of the attribute.
    """
    return _split(name)[1]


def _split(name: str) -> tuple[str, str | None]:
    for ending, unit in _ENDINGS.items():
        if name.endswith(ending):
            return name.removesuffix(ending), unit
    return name, None


def _is_quantity(value: Plain) -> bool:
    return isinstance(value, Mapping) and set(value) == {"value", "unit"}
