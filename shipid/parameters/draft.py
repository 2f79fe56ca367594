"""The draft of a parameter set: what is known of a ship, and a place for what is not; the sources are to be filled in."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass

from shipid.declaration.model import Entry, Model
from shipid.declaration.units import pretty, split, to_si
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief
from shipid.parameters.parameter_set import PARTICULARS


@dataclass(frozen=True)
class Particular:
    """A particular of a ship that commands ask for.

    Attributes
    ----------
    name : str
        In ``[particulars]``.
    unit : str
        SI.
    meaning : str
        What it is.
    example : str
        A value with its unit.
    """

    name: str
    unit: str
    meaning: str
    example: str


#: In the order in which a file lists them.
KNOWN_PARTICULARS = (
    Particular("L", "m", "length between perpendiculars", "45 m"),
    Particular("B", "m", "beam", "8.5 m"),
    Particular("T", "m", "draught", "2.5 m"),
    Particular("speed", "m/s", "speed before a manoeuvre", "10 kn"),
    Particular("delta_max", "rad", "largest rudder angle", "35 deg"),
    Particular("delta_rate", "rad/s", "rate of the steering gear", "2.5 deg/s"),
)


def draft_parameter_set(
    name: str, values: Mapping[str, str], *, source: str = "", title: str = "", model: Model | None = None
) -> str:
    """Return the draft of a parameter set as TOML.

    Parameters
    ----------
    name : str
        Short name of the ship.
    values : Mapping of str to str
        Its particulars with their units, by the names of `KNOWN_PARTICULARS`; the others are listed as comments.
    source : str
        Where the values come from. Where it is empty so are the sources in the draft, and `read_parameter_set` refuses it until
        they are filled in.
    title : str
        One line about the ship.
    model : Model, optional
        A model whose coefficients are listed as comments.

    Returns
    -------
    str

    Raises
    ------
    UsageError
        If the name is empty, or a value is not greater than zero.
    UnitError
        If a value has no unit, or one that does not fit.
    """
    if not name.strip() or not name.isprintable():
        raise UsageError("a ship needs a name of one or more printable characters, as in 'my-ship'.")
    lines = [
        "# Every number has its source: a drawing, a report, a trial. 'assumed' is a source, an empty one is refused.",
        f"name = {json.dumps(name.strip())}",
        f"title = {json.dumps(title)}",
        "",
        f"[{PARTICULARS}]",
    ]
    for known in KNOWN_PARTICULARS:
        text = values.get(known.name)
        if text is None:
            unit = split(known.example)[1]
            lines.append(f"# {_entry(known.name, '...', unit, '')}  # {known.meaning}, as in {known.example}")
            continue
        what = f"'{known.name}' ({known.meaning})"
        if not to_si(text, known.unit, what) > 0:
            raise UsageError(f"{what} is {text}, and has to be greater than zero, as in '{known.example}'.")
        number, unit = split(text)
        lines.append(f"{_entry(known.name, repr(number), unit, source)}  # {known.meaning}")
    if model is not None:
        lines += ["", f"[{model.name}]", *_coefficients(model)]
    return "\n".join(lines) + "\n"


def _entry(name: str, number: str, unit: str | None, source: str) -> str:
    return (
        f"{name} = {{ value = {number}, unit = {json.dumps(unit)}, source = {json.dumps(source, ensure_ascii=False)} }}"
    )


def _coefficients(model: Model) -> list[str]:
    """A comment for each coefficient of a model that is no particular."""
    particulars = {known.name for known in KNOWN_PARTICULARS}
    return [
        f"# {_entry(name, '...', model[name].unit, '')}  # {model[name].quantity.meaning}{_if_absent(model[name])}"
        for name in model.parameters + model.constants
        if name not in particulars
    ]


def _if_absent(entry: Entry) -> str:
    """What is taken where the file leaves a constant out."""
    default = entry.number("default")
    if default is None:
        return ""
    unit = "" if entry.unit == "1" else f" {pretty(entry.unit)}"
    return f"; {brief(default, 6)}{unit} if it is left out"
