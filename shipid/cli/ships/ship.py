"""``shipid ship``: what is known of a ship and where it comes from, or the draft of a new one."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import click

from shipid.cli.frame.completing import complete_ship
from shipid.cli.frame.delivery import Delivery, json_option, output_or_stdout, overwrite_option
from shipid.cli.frame.messages import say
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.numbers import uncertain_text

if TYPE_CHECKING:
    from shipid.foundation.aliases import Plain
    from shipid.parameters.correlation import Joint
    from shipid.parameters.parameter_set import ParameterSet, Value

F = TypeVar("F", bound=Callable[..., object])

#: Option: the particular it states, and its help.
_OPTIONS = {
    "length": ("L", "Length between perpendiculars, '45 m'."),
    "beam": ("B", "Beam, '8.5 m'."),
    "draught": ("T", "Draught, '2.5 m'."),
    "speed": ("speed", "Speed before a manoeuvre, '10 kn'."),
    "rudder": ("delta_max", "Largest rudder angle, '35 deg'."),
    "rudder_rate": ("delta_rate", "Rate of the steering gear, '2.5 deg/s'."),
}


def _particulars(function: F) -> F:
    """Give the command an option for each particular."""
    for name, (_, words) in reversed(_OPTIONS.items()):
        function = click.option(f"--{name.replace('_', '-')}", name, metavar="V", help=f"With --new: {words}")(function)
    return function


@click.command()
@click.argument("ship", required=False, metavar="[SHIP]", shell_complete=complete_ship)
@click.option("--new", metavar="NAME", help="Draft a ship file of this name instead.")
@_particulars
@click.option("--source", metavar="TEXT", help="With --new: where these values come from.")
@click.option("--title", default="", metavar="TEXT", help="With --new: one line about the ship.")
@click.option("--coefficients", "model", metavar="MODEL", help="With --new: list the coefficients of a model, too.")
@click.option("-o", "--output", metavar="FILE", help="With --new: file to write; stdout by default.")
@overwrite_option
@json_option
def ship(
    ship: str | None,
    new: str | None,
    source: str | None,
    title: str,
    model: str | None,
    output: str | None,
    overwrite: bool,
    as_json: bool,
    **stated: str | None,
) -> ExitCode:
    """Show what is known of a ship and where it comes from, or draft the file of a new one.

    SHIP is a name (see shipid models) or the path of a ship file. A draft lists every particular that commands ask for; one
    whose source is empty is refused by every command until the source is filled in.

    \b
    shipid ship zeefakkel
    shipid ship --new tender --length '24 m' --speed '12 kn' --source 'general arrangement, rev. B' -o tender.toml
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.declaration.units import Typed
    from shipid.foundation.errors import UsageError
    from shipid.foundation.replacing import write_text
    from shipid.parameters.catalogue import find_model, find_ship
    from shipid.parameters.draft import draft_parameter_set

    delivery = Delivery(as_json)
    given = [f"--{name.replace('_', '-')}" for name, value in stated.items() if value is not None]
    given += [
        f"--{name}"
        for name, value in (("source", source), ("title", title), ("coefficients", model), ("output", output))
        if value
    ]
    if (ship is None) == (new is None):
        raise UsageError("give a SHIP to show, or --new NAME to draft one, and not both.")
    if ship is not None:
        if given:
            raise UsageError(f"{', '.join(given)}: only with --new NAME, which drafts a ship file.")
        found = find_ship(ship)
        return delivery.hand_over_parts(ship_data(found), ship_text(found))
    if source is not None and not source.strip():
        raise UsageError("--source is empty. Say where the values come from; 'assumed' is a source.")
    path = output_or_stdout(output, overwrite)
    values = {_OPTIONS[name][0]: Typed(value) for name, value in stated.items() if value is not None}
    known = find_model(model) if model else None
    text = draft_parameter_set(str(new), values, source=source or "", title=title, model=known)
    if path is not None:
        write_text(path, text)
        say(f"written: {path}." + ("" if source or not values else " Its sources are empty: fill them in."))
    if as_json or path is None:
        return delivery.hand_over_parts({"ship": new, "text": text}, text.rstrip("\n"))
    return ExitCode.DONE


def _assumed(found: ParameterSet) -> list[str]:
    return [
        f"{section}: {name}"
        for section, values in found.sections.items()
        for name, v in values.items()
        if _is_assumed(v)
    ]


def _is_assumed(value: Value) -> bool:
    return "assum" in value.source.lower()


def _unstated(found: ParameterSet) -> list[str]:
    """Particulars that commands ask for and the set does not hold."""
    from shipid.parameters.draft import KNOWN_PARTICULARS

    there = found.sections.get("particulars", {})
    return [known.name for known in KNOWN_PARTICULARS if known.name not in there]


def ship_data(found: ParameterSet) -> dict[str, Plain]:
    """Return what is known of a ship as plain values.

    Parameters
    ----------
    found : ParameterSet
        The ship.
    """
    from shipid.parameters.hull.estimates import hull_estimates
    from shipid.parameters.parameter_file import parameter_table

    told = {"assumed": _assumed(found), "not_stated": _unstated(found)}
    return parameter_table(found) | told | {"hull_regression": hull_estimates(found).to_dict()}


def ship_text(found: ParameterSet) -> str:
    """Return what is known of a ship in lines of text.

    Parameters
    ----------
    found : ParameterSet
        The ship.
    """
    from shipid.declaration.units import pretty
    from shipid.parameters.draft import KNOWN_PARTICULARS
    from shipid.parameters.hull.estimates import hull_estimates

    meanings = {known.name: known.meaning for known in KNOWN_PARTICULARS}
    lines = [f"{found.name}: {found.title}" if found.title else found.name]
    lines += [found.notes, ""] if found.notes else [""]
    for section, values in found.sections.items():
        lines.append(section)
        names = max(map(len, values), default=0)
        shown = {name: _shown(value, pretty(value.unit)) for name, value in values.items()}
        width = max(map(len, shown.values()), default=0)
        for name, value in values.items():
            meaning = f" ({meanings[name]})" if section == "particulars" and name in meanings else ""
            note = f"; {value.note}" if value.note else ""
            lines.append(f"  {name:<{names}}  {shown[name]:<{width}}  {value.source}{note}{meaning}")
            lines += [f"  {'':<{names}}  {_table(value)}"] if value.speed else []
    lines += [f"found at: [{section}] {_range(known)}" for section, known in found.joint.items()]
    lines += hull_estimates(found).lines()
    assumed, unstated = _assumed(found), _unstated(found)
    lines.append(f"assumed: {', '.join(assumed) if assumed else 'nothing'}")
    lines += [f"not stated: {', '.join(unstated)}"] if unstated else []
    return "\n".join(lines)


def _range(known: Joint) -> str:
    from shipid.parameters.validity import range_words

    return ", ".join(range_words(known).values()) or "speeds and rudder angles that are not stated"


def _shown(value: Value, unit: str) -> str:
    tail = "" if unit == "1" else f" {unit}"
    if isinstance(value.value, tuple):
        return f"{min(value.value):g} to {max(value.value):g}{tail}"
    return uncertain_text(value.value, value.std) + tail


def _table(value: Value) -> str:
    assert isinstance(value.value, tuple)
    return ", ".join(f"{v:g} at {s:g}" for v, s in zip(value.value, value.speed)) + f" {value.speed_unit}"
