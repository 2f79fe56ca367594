"""The vocabulary of the toolbox: every field of a trial once, with its unit, the unit it is shown in, its label and sign.

The names are the field's (ITTC 7.5-04-02-01): positions north and east, heading clockwise from north, rate of turn and
rudder angle positive to starboard. A new signal is one line here.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from shipid.declaration.units import counts_revolutions, factor, pretty, same_dimension
from shipid.foundation.numbers import brief, number, uncertain_text

Number = TypeVar("Number", float, np.ndarray)


@dataclass(frozen=True)
class Field:
    """One field of the vocabulary.

    Attributes
    ----------
    name : str
        The canonical name, as a table spells it.
    unit : str
        The unit inside the toolbox.
    display : str
        The unit a reader expects to see.
    label : str
        What a figure or a table calls it.
    meaning : str
        What it is, with its sign convention.
    missing : str
        What it means where a record does not hold it.
    wraps : bool
        Whether it is an angle that comes back to itself after a turn.
    """

    name: str
    unit: str
    display: str
    label: str
    meaning: str
    missing: str = "not measured"
    wraps: bool = False


_NO_CURRENT = "no current is assumed by models that declare a default of zero"
_REFUSED = "refused by a model that reads it"

_FIELDS = (
    Field("t", "s", "s", "Time", "time, on the record's own clock", "refused: a record has a clock"),
    Field("x", "m", "m", "Position north", "position, north"),
    Field("y", "m", "m", "Position east", "position, east"),
    Field("psi", "rad", "deg", "Heading", "heading, clockwise from north, unwrapped", wraps=True),
    Field("r", "rad/s", "deg/s", "Rate of turn", "rate of turn, positive to starboard"),
    Field("u", "m/s", "m/s", "Forward speed", "forward speed through the water, along the ship"),
    Field("v", "m/s", "m/s", "Sway speed", "sideways speed through the water, positive to starboard"),
    Field("U", "m/s", "m/s", "Speed through the water", "speed through the water, in the direction of motion: hypot(u, v)"),
    Field("SOG", "m/s", "m/s", "Speed over ground", "speed over the ground: a current is in it"),
    Field("COG", "rad", "deg", "Course over ground", "course over the ground, clockwise from north", wraps=True),
    Field("delta", "rad", "deg", "Rudder angle", "rudder angle, positive turns to starboard", _REFUSED),
    Field("delta_order", "rad", "deg", "Rudder order", "ordered rudder angle, positive turns to starboard", _REFUSED),
    Field("n", "rps", "rpm", "Revolutions", "propeller revolutions, per second inside", _REFUSED),
    Field("n_order", "rps", "rpm", "Ordered revolutions", "ordered propeller revolutions, per second inside", _REFUSED),
    Field("phi", "rad", "deg", "Roll angle", "roll angle, positive to starboard"),
    Field("p", "rad/s", "deg/s", "Roll rate", "roll rate, positive to starboard"),
    Field("wind_speed", "m/s", "m/s", "Wind speed", "true wind speed", _REFUSED),
    Field(
        "wind_direction", "rad", "deg", "Wind direction",
        "true wind, the direction it blows TO, clockwise from north", _REFUSED, wraps=True,
    ),
    Field("wind_speed_relative", "m/s", "m/s", "Relative wind speed", "relative wind speed"),
    Field(
        "wind_direction_relative", "rad", "deg", "Relative wind direction",
        "relative wind, the direction it blows TO, from the bow", wraps=True,
    ),
    Field("thrust", "N", "kN", "Thrust", "propeller thrust"),
    Field("torque", "N*m", "kN*m", "Torque", "propeller torque"),
    Field("beta", "rad", "deg", "Drift angle", "drift angle, positive when the flow comes from port: atan2(-v, u)"),
    Field("cruise", "m/s", "m/s", "Speed before the manoeuvre", "speed before the manoeuvre", "mean speed before the first execute"),
    Field("draught", "m", "m", "Mean draught", "mean draught of the ship", _REFUSED),
    Field("displacement", "kg", "t", "Displacement", "displacement of the ship", _REFUSED),
    Field("current_north", "m/s", "m/s", "Current to the north", "current, component TO the north", _NO_CURRENT),
    Field("current_east", "m/s", "m/s", "Current to the east", "current, component TO the east", _NO_CURRENT),
)  # fmt: skip

#: By name.
FIELDS: Mapping[str, Field] = MappingProxyType({f.name: f for f in _FIELDS})

#: How quantities outside the vocabulary are shown, by the unit they have inside.
_SHOWN = {"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2", "rps": "rpm", "rev/s": "rpm"}


def given_unit(name: str, unit: str) -> str:
    """Return the unit in which values of a quantity are taken: a shaft speed counts revolutions, as in records, and is no angle.

    Parameters
    ----------
    name, unit : str
        The quantity, and its declared unit: ``1/s`` alone would take radians.
    """
    counted = FIELDS[name].unit if name in FIELDS else unit
    return counted if counts_revolutions(counted) and same_dimension(counted, unit) else unit


def label(name: str, meaning: str = "") -> str:
    """Return what a figure or a table calls a quantity.

    Parameters
    ----------
    name : str
        Of the field, or of a quantity of a model.
    meaning : str
        The declared meaning of a quantity outside the vocabulary; its first words are the label.
    """
    if name in FIELDS:
        return FIELDS[name].label
    first = meaning.split(",")[0].split(":")[0].strip()
    return first[:1].upper() + first[1:] if first else name


def display_unit(name: str, inside: str) -> str:
    """Return the unit a quantity is shown in.

    Parameters
    ----------
    name : str
        Of the quantity.
    inside : str
        The unit it has inside the toolbox.
    """
    if name in FIELDS:
        return FIELDS[name].display
    return _SHOWN.get(inside, inside)


@functools.cache
def display_factor(name: str, inside: str) -> float:
    """Return the factor from the unit inside to the one a quantity is shown in.

    Parameters
    ----------
    name : str
        Of the quantity.
    inside : str
        The unit it has inside the toolbox.
    """
    return factor(FIELDS[name].unit if name in FIELDS else inside, display_unit(name, inside))


def to_display(value: Number, name: str, inside: str = "") -> Number:
    """Return a number, or an array of them, in the unit a reader expects.

    Parameters
    ----------
    value : float or ndarray
        In the unit inside.
    name : str
        Of the quantity.
    inside : str
        The unit inside, for a quantity outside the vocabulary; for a field it is known.
    """
    return value * display_factor(name, FIELDS[name].unit if name in FIELDS else inside)


def shown(value: float, name: str, inside: str = "", digits: int = 4) -> str:
    """Return a number with its unit as a reader expects it: ``"10.2 deg"``.

    Parameters
    ----------
    value : float
        In the unit inside.
    name : str
        Of the quantity.
    inside : str
        The unit inside, for a quantity outside the vocabulary.
    digits : int
        Significant digits.
    """
    unit = pretty(display_unit(name, inside))
    return brief(float(to_display(value, name, inside)), digits) + ("" if unit == "1" else f" {unit}")


def shown_error(value: float, name: str, inside: str = "") -> str:
    """Return the size of an error with three digits and its unit, as a terminal and a page print it: ``"0.0200 m/s"``.

    Parameters
    ----------
    value : float
        In the unit inside.
    name : str
        Of the quantity.
    inside : str
        The unit inside, for a quantity outside the vocabulary.
    """
    unit = pretty(display_unit(name, inside))
    return number(float(to_display(value, name, inside)), 3) + ("" if unit == "1" else f" {unit}")


def shown_estimate(value: float | None, std: float | None, name: str, inside: str = "") -> str:
    """Return an estimate with its standard deviation and its unit as a reader expects it: ``"10.20 ± 0.12 deg"``.

    Parameters
    ----------
    value, std : float or None
        In the unit inside; a standard deviation that is not known is left out.
    name : str
        Of the quantity.
    inside : str
        The unit inside, for a quantity outside the vocabulary.
    """
    unit = pretty(display_unit(name, inside))
    both = (None if v is None else float(to_display(v, name, inside)) for v in (value, std))
    return uncertain_text(*both) + ("" if unit == "1" else f" {unit}")


def angle(value: float, digits: int = 4) -> str:
    """Return an angle in the unit angles are shown in: ``"10.2 deg"``.

    Parameters
    ----------
    value : float
        In rad.
    digits : int
        Significant digits.
    """
    # What a simulated rudder leaves of an angle is no angle, and a zero has no sign.
    return shown(round(value, 12) + 0.0, "", "rad", digits)


def compass(value: float, decimals: int = 1) -> str:
    """Return a heading, a course or a bearing as three digits and decimals, from 000.0 to 359.9.

    Parameters
    ----------
    value : float
        In rad, any turn of it.
    decimals : int
        Digits behind the point.
    """
    # Rounded first: 359.97 is 000.0, and no 360.0.
    degrees = round(float(np.rad2deg(value)), decimals) % 360
    return f"{degrees:0{4 + decimals if decimals else 3}.{decimals}f}"
