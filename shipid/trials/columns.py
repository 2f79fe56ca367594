"""The columns of a trial: headers such as ``psi [deg]``, the spellings of units that loggers write, the unit inside."""

from __future__ import annotations

import functools
import re

from shipid.declaration import units
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UnitError
from shipid.trials.errors import ColumnUnitError, NoUnitError

# What loggers write and pint does not know, or reads as something else (Nm).
_SPELLINGS = (
    (re.compile(r"\brev\b"), "revolution"),
    (re.compile(r"\b([kM]?)Nm\b"), r"\1N*m"),
    (re.compile(r"\b(RPM|Rpm)\b|(?i:\b(u|umdr\.?|r|omw|omdr?|obr|tr)/min\b|\b[ur]pm\b)|\bmin-1(?!\w)"), "rpm"),
    (re.compile(r"\bNM\b"), "nmi"),
    (re.compile(r"\b[Dd]ecimal [Dd]egrees\b|\bdegrees?_(north|east)\b|\b(DD|dd)\b"), "deg"),
    # Degrees of the compass: pint reads Grad as a thousand million rad, and grad as a hundredth of a right angle, which no ship logs.
    (re.compile(r"(?i:\bdeg(s|r[eé]es?|r[eé]s?)?\b|\bgra(d(er|en|os?|i)?|us?)\b)\.?|º|度"), "deg"),
    (
        re.compile(r"\bKn\b|(?i:\b(kts?|knots?|knoten|knopen|knop|n(œ|oe)uds?|nds|nudos?|nodi|nós)\b)|ノット|节|節"),
        "kn",
    ),  # kN is a force
    (re.compile(r"(?i:(?<=/)(min|minut[eoi]s?|minuten|minutt)\b)|分"), "min"),
    (re.compile(r"(?i:\b(sek|sekund(en?)?|sec|secs|secondes?|seconds?|seconden|segundos?|second[oi])\b)\.?|秒"), "s"),
    (re.compile(r"(?i:\b(m[eè]tres?|metros?|metri)\b)"), "m"),
    (re.compile(r"\b(m|deg|rad) ?s-1(?!\w)"), r"\1/s"),
)
#: A longer header is a name without a unit.
_LONGEST_HEADER = 300
#: Units at the end of a name of the vocabulary, for files whose names hold no brackets: ``psi_deg``, ``u_mps``.
_ENDINGS = {
    "deg": "deg", "rad": "rad", "m": "m", "kn": "kn", "kts": "kn", "knots": "kn", "mps": "m/s", "m_s": "m/s", "degps": "deg/s",
    "dps": "deg/s", "deg_s": "deg/s", "degpmin": "deg/min", "deg_min": "deg/min", "radps": "rad/s", "rad_s": "rad/s", "rpm": "rpm", "rps": "rps",
}  # fmt: skip
#: ``psi/deg`` and ``psi in deg``, as tables of laboratories name a quantity and its unit.
_IN_UNIT = re.compile(r"^(?P<name>\w+)(?:\s*/\s*|\s+in\s+)\(?(?P<unit>[^()\[\]\d][^()\[\]]*?)\)?$")
#: The last brackets hold the unit; a remark in round ones may stand before them: ``Rudder (port +) [deg]``.
_BRACKETED = re.compile(r"^\s*(?P<name>[^\[\]]*?)\s*(?:\[(?P<square>[^\]]*)\]|\((?P<round>[^()]*)\))\s*$")


@functools.cache
def spelt(unit: str) -> str:
    """Return a unit in a spelling that `shipid.declaration.units` reads.

    Parameters
    ----------
    unit : str
        As a logger writes it: ``rev/s``, ``Nm``.
    """
    for pattern, replacement in _SPELLINGS:
        unit = pattern.sub(replacement, unit)
    return unit


def split_header(text: str) -> tuple[str, str | None]:
    """Split a header such as ``psi [deg]``, ``psi[deg]``, ``psi (deg)``, ``psi/deg`` or ``psi_deg`` into name and unit.

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
    match = _BRACKETED.match(text) if len(text) <= _LONGEST_HEADER else None
    if not match or not match["name"]:
        return _by_ending(text) or (text, None)
    unit = match["square"] if match["square"] is not None else match["round"]
    return match["name"].rstrip("/ ").strip(), unit.strip()


def _by_ending(text: str) -> tuple[str, str] | None:
    """Name and unit of ``psi_deg``, ``psi/deg`` or ``psi in deg``: a field of the vocabulary, and behind it a unit that fits it."""
    if text in FIELDS:
        return None
    said = _IN_UNIT.match(text) if len(text) <= _LONGEST_HEADER else None
    if said and said["name"] in FIELDS:
        try:
            units.factor(spelt(said["unit"]), FIELDS[said["name"]].unit)
        except UnitError:
            return None
        return said["name"], said["unit"]
    for ending, unit in _ENDINGS.items():
        name = text.removesuffix(f"_{ending}")
        if name != text and name in FIELDS and name != "t":
            try:
                units.factor(unit, FIELDS[name].unit)
            except UnitError:
                return None
            return name, unit
    return None


def header(name: str, unit: str) -> str:
    """Return the header of a column: ``psi [deg]``.

    Parameters
    ----------
    name, unit : str
        Name and unit.
    """
    return f"{name} [{unit}]"


def inside_unit(name: str, unit: str) -> str:
    """Return the unit a column has inside a trial.

    The vocabulary's unit for a canonical name; for any other name, the coherent SI unit of the one given.

    Parameters
    ----------
    name : str
        The column.
    unit : str
        The unit it is given in.

    Raises
    ------
    ColumnUnitError
        If the unit of a column outside the vocabulary cannot be read.
    """
    if name in FIELDS:
        return FIELDS[name].unit
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


def example_unit(name: str) -> str:
    """Return a unit to show in a message about a column.

    Parameters
    ----------
    name : str
        The column.
    """
    return FIELDS[name].display if name in FIELDS else "unit"


def no_unit(name: str, where: str, field: str | None = None, *, formats: bool = True) -> NoUnitError:
    """Return the error for a column that says no unit.

    Parameters
    ----------
    name : str
        The column.
    where : str
        File and line, at the beginning of the message.
    field : str, optional
        The field of the vocabulary that it is; by default the one of its name.
    formats : bool
        Whether a format file may describe such a file.
    """
    if (field or name) in FIELDS:
        column = FIELDS[field or name]
        choices = [header(name, choice) for choice in dict.fromkeys((column.display, column.unit))]
        remedy = f"Write {' or '.join(repr(c) for c in choices)} in the header"
    else:
        remedy = f"Write '{name} [unit]' in the header, with [1] for a pure number"
    other = ", or state the unit in a format file" if formats else ""
    return NoUnitError(f"{where}column '{name}' says no unit. {remedy}{other}: shipid does not guess.")
