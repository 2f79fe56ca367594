"""The columns of a trial: canonical names, SI units, meanings, and headers such as ``psi [deg]``.

The vocabulary is the field's (ITTC 7.5-04-02-01): positions north and east, heading clockwise from north,
rate of turn and rudder angle positive to starboard.
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass

from shipid.declaration import units
from shipid.foundation.errors import UnitError
from shipid.trials.errors import ColumnUnitError, NoUnitError


@dataclass(frozen=True)
class Column:
    """One column of the vocabulary.

    Attributes
    ----------
    name : str
        The canonical name, as a table spells it.
    unit : str
        The unit inside a trial.
    display : str
        The unit a reader expects to see.
    meaning : str
        What it is, with its sign convention.
    """

    name: str
    unit: str
    display: str
    meaning: str


COLUMNS: dict[str, Column] = {
    c.name: c
    for c in (
        Column("t", "s", "s", "time, on the record's own clock"),
        Column("x", "m", "m", "position, north"),
        Column("y", "m", "m", "position, east"),
        Column("psi", "rad", "deg", "heading, clockwise from north, unwrapped"),
        Column("r", "rad/s", "deg/s", "rate of turn, positive to starboard"),
        Column("u", "m/s", "m/s", "forward speed, along the ship"),
        Column("v", "m/s", "m/s", "sideways speed, positive to starboard"),
        Column("U", "m/s", "m/s", "speed over all"),
        Column("delta", "rad", "deg", "rudder angle, positive turns to starboard"),
        Column("delta_order", "rad", "deg", "ordered rudder angle, positive turns to starboard"),
        Column("n", "rps", "rpm", "propeller revolutions, per second inside"),
        Column("phi", "rad", "deg", "roll angle, positive to starboard"),
        Column("p", "rad/s", "deg/s", "roll rate, positive to starboard"),
        Column("wind_speed", "m/s", "m/s", "true wind speed"),
        Column("wind_direction", "rad", "deg", "true wind, the direction it blows TO, clockwise from north"),
        Column("wind_speed_relative", "m/s", "m/s", "relative wind speed"),
        Column("wind_direction_relative", "rad", "deg", "relative wind, the direction it blows TO, from the bow"),
        Column("thrust", "N", "kN", "propeller thrust"),
        Column("torque", "N*m", "kN*m", "propeller torque"),
        Column("beta", "rad", "deg", "drift angle, positive when the flow comes from port: atan2(-v, u)"),
    )
}

# What loggers write and pint does not know, or reads as something else (Nm).
_SPELLINGS = (
    (re.compile(r"\brev\b"), "revolution"),
    (re.compile(r"\b([kM]?)Nm\b"), r"\1N*m"),
    (re.compile(r"\b(RPM|Rpm)\b"), "rpm"),
    (re.compile(r"\b(DEG|Deg)\b"), "deg"),
)
_BRACKETED = re.compile(r"^\s*(?P<name>[^\[\]()]*?)\s*(?:\[(?P<square>[^\]]*)\]|\((?P<round>[^)]*)\))\s*$")


@functools.cache
def spelt(unit: str) -> str:
    """Return a unit in a spelling that `shipid.declaration.units` reads: ``rev/s``, ``Nm`` and friends."""
    for pattern, replacement in _SPELLINGS:
        unit = pattern.sub(replacement, unit)
    return unit


def split_header(text: str) -> tuple[str, str | None]:
    """Split a header such as ``psi [deg]``, ``psi[deg]`` or ``psi (deg)`` into name and unit.

    Parameters
    ----------
    text : str
        One field of the header line.

    Returns
    -------
    name : str
        The name, without quotes and blanks.
    unit : str or None
        The unit, or None where the header says none.
    """
    text = text.strip().strip("\"'").strip()
    match = _BRACKETED.match(text)
    if not match or not match["name"]:
        return text, None
    unit = match["square"] if match["square"] is not None else match["round"]
    return match["name"].strip(), unit.strip()


def header(name: str, unit: str) -> str:
    """Return the header of a column: ``psi [deg]``."""
    return f"{name} [{unit}]"


def inside_unit(name: str, unit: str) -> str:
    """Return the unit a column has inside a trial.

    The vocabulary's unit for a canonical name; for any other name, the coherent SI unit of the one given.

    Raises
    ------
    ColumnUnitError
        If the unit of a column outside the vocabulary cannot be read.
    """
    if name in COLUMNS:
        return COLUMNS[name].unit
    try:
        base = units.registry().Quantity(1.0, units.unit(spelt(unit))).to_base_units().units
    except UnitError as error:
        raise ColumnUnitError(f"the unit of column '{name}' cannot be read: {error}") from None
    return f"{base:~C}" or "1"


def to_inside(name: str, unit: str, where: str = "") -> float:
    """Return the factor that turns a column's values into the unit they have inside a trial.

    Parameters
    ----------
    name : str
        The column's name inside the trial.
    unit : str
        The unit of the values.
    where : str
        File or frame, for the error message.

    Raises
    ------
    ColumnUnitError
        If the unit is unknown or measures something else.
    """
    try:
        return units.factor(spelt(unit), inside_unit(name, unit), "it")
    except UnitError as error:
        raise ColumnUnitError(
            f"{where}column '{name}': {error} Correct the header, as in '{header(name, example_unit(name))}', "
            f"or state the unit of '{name}' in a format file."
        ) from None


def display_unit(name: str, inside: str) -> str:
    """Return the unit a column is shown in: the vocabulary's, or for other columns the one inside."""
    return COLUMNS[name].display if name in COLUMNS else inside


def example_unit(name: str) -> str:
    """Return a unit to show in a message about a column."""
    return COLUMNS[name].display if name in COLUMNS else "unit"


def no_unit(name: str, where: str) -> NoUnitError:
    """Return the error for a column that says no unit."""
    if name in COLUMNS:
        column = COLUMNS[name]
        choices = [header(name, choice) for choice in dict.fromkeys((column.display, column.unit))]
        remedy = f"Write {' or '.join(repr(c) for c in choices)} in the header"
    else:
        remedy = f"Write '{name} [unit]' in the header, with [1] for a pure number"
    return NoUnitError(
        f"{where}column '{name}' says no unit. {remedy}, or state the unit in a format file: shipid does not guess."
    )
