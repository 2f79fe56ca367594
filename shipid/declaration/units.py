"""Units: every value comes in with a unit and is SI inside.

pint does the arithmetic. One rule is added, because pint counts an angle as a pure number: where a
declaration names an angle, a value has to name it too. ``n3 = 0.4 s^2`` for a coefficient declared in
``s^2/rad^2`` is refused; ``0.4 s^2/deg^2`` is 1313 s^2/rad^2.
"""

from __future__ import annotations

import functools
import re

from shipid.foundation.aliases import PintUnit
from shipid.foundation.errors import TypedUnitError, UnitError
from shipid.foundation.printable import printable

_NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
#: A power of ten as shipid prints it: ``2.7 × 10⁻⁶``.
_PRINTED = re.compile(r"^(\s*[-+]?[\d.]+)\s*×\s*10(⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)")
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
#: The longest text that is looked at as a unit.
_LONGEST = 60
# What no unit holds: a number of four digits; a power that is no plain number of two digits, or has a power itself; a number
# to a power; a second power of a product.
_OUTSIZED = re.compile(
    r"(?<![.0-9])[0-9]{4}"
    r"|\*\*(?!\s*(?:\(\s*[-+]?[0-9]{1,2}(?:\.[0-9]*|/[0-9]+)?\s*\)|[-+]?[0-9]{1,2}(?:\.[0-9]*)?(?![0-9.eE]))\s*(?!\*\*)(?:[^*\s]|\*(?!\*)|$))"
    r"|[0-9]\s*\*\*"
    r"|\)\s*\*\*.*\)\s*\*\*"
)
_SUPERSCRIPT_RUN = re.compile(r"[⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")


class Typed(str):
    """A value that was typed as an argument of a command: what is wrong with it is wrong with the call, not with a file."""

    __slots__ = ()


@functools.cache
def registry() -> PintUnit:
    """Return the one pint registry of the toolbox (built on first use: it costs 0.1-0.3 s)."""
    import pint

    # Pint could keep its definitions parsed, but as pickled objects, which run code when they are read.
    ureg: PintUnit = pint.UnitRegistry(cache_folder=None)
    # A shaft is counted, not turned through an angle: pint's revolution is 2 pi rad, and 2 rps would be 12.57 1/s.
    ureg.define("revolution = [] = rev")
    ureg.define("shaft_revolutions_per_second = revolution / second = rps")
    ureg.define("shaft_revolutions_per_minute = revolution / minute = rpm = revolutions_per_minute")
    # At sea nm is a nautical mile: pint's nanometre would make every range zero.
    ureg.define("@alias nautical_mile = nm = NM")
    # The mil of navies and of NATO; pint's is a tenth of it.
    ureg.define("mil = 2 * pi / 6400 * radian = _ = angular_mil = nato_mil")
    return ureg


def _check_size(text: str) -> None:
    """Refuse what no unit is before it is computed: ``deg^9^9^9`` would take for ever."""
    if len(text) > _LONGEST or _OUTSIZED.search(_tidy(text)):
        shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
        raise UnitError(
            f"'{shown}' is not a unit: it is longer than {_LONGEST} characters, or has numbers or powers that no unit has. "
            "Write it as deg/s, kn, 1/s, s^2/deg^2, or 1 for a number."
        )


def _tidy(text: str) -> str:
    text = _SUPERSCRIPT_RUN.sub(lambda m: "**" + m.group().translate(_SUPERSCRIPTS), text.strip())
    return text.replace("°", "deg").replace("·", "*").replace("^", "**")


@functools.cache
def unit(text: str) -> PintUnit:
    """Parse a unit such as ``"deg/s"``, ``"1/s"``, ``"kn"`` or ``"1"``.

    Parameters
    ----------
    text : str
        The unit; ``"1"``, ``"-"`` and ``""`` mean dimensionless.

    Returns
    -------
    pint.Unit

    Raises
    ------
    UnitError
        If the text is not a unit.
    """
    _check_size(text)
    tidy = _tidy(text)
    if tidy in ("", "1", "-"):
        return registry().Unit("")
    if printable(tidy) != tidy:  # to pint's tokenizer a text ends at a NUL
        raise UnitError(f"'{text}' is not a unit: it holds characters that cannot be printed.")
    try:
        parsed = registry().parse_expression(tidy)
    except Exception:  # pint raises half a dozen kinds for text that is no unit, tokenizer errors among them
        raise UnitError(f"'{text}' is not a unit. Write it as deg/s, kn, 1/s, s^2/deg^2, or 1 for a number.") from None
    if isinstance(parsed, (int, float)) and parsed == 1:
        return registry().Unit("")
    if isinstance(parsed, (int, float)) or parsed.magnitude != 1:
        raise UnitError(f"'{text}' is not a unit: it contains a number.")
    result = parsed.units
    try:
        offset = registry().Quantity(0, result).to_base_units().magnitude != 0
    except Exception:  # powers that overflow, and units that pint cannot take to base units
        raise UnitError(f"'{text}' is not a unit that can be converted to SI.") from None
    if offset:
        raise UnitError(f"'{text}' has an offset; shipid takes no such unit.")
    return result


def pretty(text: str) -> str:
    """Return a unit the way it is printed: ``s^2/deg^2`` becomes ``s²/deg²``, and 1 stays 1.

    Parameters
    ----------
    text : str
        The unit.
    """
    shown = _tidy(text)
    if shown in ("", "1", "-"):
        return "1"
    # Blanks beside an operator or a bracket go; one between two units stays, as in m/(rad s).
    shown = re.sub(r"\s*(\*\*|[*/()])\s*", r"\1", shown)
    shown = re.sub(r"\*\*(?:\((-?[\d.]+)\)|(-?[\d.]+))", lambda m: _raise(m.group(1) or m.group(2)), shown)
    return shown.replace("*", "·")


def _raise(digits: str) -> str:
    if "." in digits:  # there is no raised point
        return f"^{digits}"
    return digits.translate(str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"))


@functools.cache
def angle_exponent(text: str) -> float:
    """Return the power of the angle in a unit: 1 for ``deg/s``, -2 for ``s^2/deg^2``, 0 for ``1/s`` and ``rpm``.

    Parameters
    ----------
    text : str
        The unit.
    """
    return _exponent(text, "radian")


@functools.cache
def counts_revolutions(text: str) -> bool:
    """Return whether a unit counts revolutions, as ``rpm`` does.

    Parameters
    ----------
    text : str
        The unit.
    """
    return _exponent(text, "revolution") != 0


def _exponent(text: str, base: str) -> float:
    root = registry().Quantity(1, unit(text)).to_root_units()
    return float(dict(root.unit_items()).get(base, 0))


@functools.cache
def is_coherent_si(text: str) -> bool:
    """Return whether a unit is made of SI base units and radians alone, so that its values need no factor.

    Parameters
    ----------
    text : str
        The unit.
    """
    return bool(abs(registry().Quantity(1.0, unit(text)).to_base_units().magnitude - 1) < 1e-12)


def coherent(text: str) -> str:
    """Return the unit of SI base units and radians that measures the same: m/s for kn, rps for rpm.

    Parameters
    ----------
    text : str
        The unit.
    """
    found = f"{registry().Quantity(1.0, unit(text)).to_base_units().units:~C}" or "1"
    return "rps" if found == "rev/s" else found


@functools.cache
def same_dimension(first: str, second: str) -> bool:
    """Return whether two units measure the same thing (an angle counts as a number, as in equations it must).

    Parameters
    ----------
    first, second : str
        The units.
    """
    return bool(unit(first).dimensionality == unit(second).dimensionality)


@functools.cache
def factor(given: str, wanted: str, what: str = "the value") -> float:
    """Return the factor that turns a value in one unit into another.

    Parameters
    ----------
    given, wanted : str
        The unit the value has, and the unit it is needed in.
    what : str
        What the value is, for the error message.

    Raises
    ------
    UnitError
        If the units measure different things, `wanted` names an angle and `given` does not, or `wanted` counts revolutions and
        `given` is an angle.
    """
    if not same_dimension(given, wanted):
        raise UnitError(f"{what} needs the unit {pretty(wanted)}, and {pretty(given)} does not fit it.")
    missing = angle_exponent(wanted)
    if missing and angle_exponent(given) != missing:
        raise UnitError(
            f"{what} needs the unit {pretty(wanted)}, and {pretty(given)} does not say which angle it counts in. "
            f"Write the angle, as {pretty(wanted)} or {pretty(wanted).replace('rad', 'deg')}."
        )
    if counts_revolutions(wanted) and angle_exponent(given):
        raise UnitError(
            f"{what} counts revolutions in {pretty(wanted)}, and {pretty(given)} is an angle. Write it in rpm or rps (1 rps is 6.283 rad/s)."
        )
    return float(registry().Quantity(1.0, unit(given)).to(unit(wanted)).magnitude)


def split(text: str) -> tuple[float, str | None]:
    """Return the number and the unit of ``"9 kn"``: ``(9.0, "kn")``; the unit is None where there is only a number.

    Parameters
    ----------
    text : str
        A number, and a unit behind it.

    Raises
    ------
    UnitError
        If the text does not start with a number.
    """
    plain = _PRINTED.sub(lambda m: f"{m[1]}e{m[2].translate(_SUPERSCRIPTS)}", text.replace("−", "-"))
    match = _NUMBER.match(plain)
    if not match:
        raise UnitError(f"'{text}' does not start with a number. Write a value with its unit, as in '9 kn'.")
    return float(match.group(1)), match.group(2) or None


def to_si(value: str | float | tuple[float, str], wanted: str, what: str = "the value") -> float:
    """Return a value with a unit as a number in the wanted (SI) unit.

    Parameters
    ----------
    value : str, tuple or number
        ``"9 kn"`` or ``(9, "kn")``. A bare number is taken only where `wanted` is dimensionless.
    wanted : str
        The unit the toolbox computes in.
    what : str
        What the value is, for the error message.

    Raises
    ------
    UnitError
        If a bare number stands where a unit is needed, or the unit does not fit.
    TypedUnitError
        The same, where the value is `Typed`.
    """
    try:
        return _to_si(value, wanted, what)
    except UnitError as error:
        if isinstance(value, Typed):
            raise TypedUnitError(str(error)) from None
        raise


def _to_si(value: str | float | tuple[float, str], wanted: str, what: str) -> float:
    given: str | None
    if isinstance(value, tuple):
        number, given = float(value[0]), value[1]
    elif isinstance(value, str):
        number, given = split(value)
    else:
        number, given = float(value), None
    if number != number or number in (float("inf"), float("-inf")):
        raise UnitError(f"{what} is {number}, which is not a finite number.")
    if given is None:
        if unit(wanted).dimensionless and not angle_exponent(wanted):
            return number
        needed = pretty(wanted)
        other = {"m/s": "kn"}.get(needed, needed.replace("rad", "deg"))
        choices = list(dict.fromkeys([needed, other]))
        raise UnitError(
            f"{what} is the bare number {number:g}, with no unit, where the unit {needed} is needed. "
            f"Write {' or '.join(f'{number:g} {choice}' for choice in choices)}: shipid does not guess."
        )
    return number * factor(given, wanted, what)
