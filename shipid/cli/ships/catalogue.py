"""``shipid models`` and ``shipid show``: what there is, and what it says."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.completing import complete_model_or_ship
from shipid.cli.frame.delivery import Delivery, delivered
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.declaration.model import Model
    from shipid.foundation.aliases import Plain
    from shipid.generation.typesetting.typeset import Typeset

#: The kinds of quantities, in the order in which they are shown.
_KINDS = {
    "state": "states",
    "given": "inputs",
    "parameter": "parameters",
    "constant": "constants",
    "derived": "derived",
    "output": "outputs",
    "guard": "not valid where",
}


@click.command()
@delivered()
def models(delivery: Delivery) -> ExitCode:
    """List models and ships, one line each.

    \b
    shipid models
    shipid models --json
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.parameters.catalogue import known_models, known_ships

    found, ships = known_models(), known_ships()
    width = max(map(len, [*found, *ships]))
    lines = [
        "models",
        *(f"  {name:<{width}}  {_about(model)} [{', '.join(model.parameters)}]" for name, model in found.items()),
        "ships",
        *(f"  {name:<{width}}  {ship.title} [{', '.join(ship.models)}]" for name, ship in ships.items()),
    ]
    data = {
        "models": {n: {"about": _about(m), "parameters": list(m.parameters)} for n, m in found.items()},
        "ships": {n: {"about": s.title, "models": list(s.models)} for n, s in ships.items()},
    }
    return delivery.hand_over_parts(data, "\n".join(lines))


def _about(model: Model) -> str:
    first = (model.components[0].__doc__ or "").strip().partition("\n")[0]
    return str(first)


@click.command()
@click.argument("model", metavar="MODEL|SHIP", shell_complete=complete_model_or_ship)
@click.option("--latex", is_flag=True, help="Print the equations as LaTeX.")
@delivered()
def show(model: str, latex: bool, delivery: Delivery) -> ExitCode:
    """Show a model: quantities, units, equations, sources; or a ship: values, units, sources.

    MODEL is a name (see shipid models) or path/to/file.py:Class, and SHIP a name or the path of a ship file.

    \b
    shipid show norrbin
    shipid show norrbin --latex
    shipid show zeefakkel
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.cli.ships.ship import ship_data, ship_text
    from shipid.foundation.errors import UnknownNameError, UsageError
    from shipid.generation.typesetting.typeset import typeset
    from shipid.parameters.catalogue import find_model, find_ship, known_ships

    ships = known_ships()
    if model.endswith(".toml") or model in ships:
        if latex:
            raise UsageError(f"'{model}' is a ship, and has no equations: leave --latex out.")
        known = find_ship(model)
        return delivery.hand_over_parts(ship_data(known), ship_text(known))
    try:
        found = find_model(model)
    except UnknownNameError as error:
        # A misspelt ship is answered by the nearest ship.
        if difflib.get_close_matches(model, ships, n=1):
            raise UnknownNameError("ship", model, ships) from None
        raise error
    equations = typeset(found)
    if latex:
        rows = [e.latex.replace(" = ", " &= ", 1) + f" && \\text{{{e.component}.{e.method}}}" for e in equations]
        click.echo("\\begin{align}\n" + " \\\\\n".join(rows) + "\n\\end{align}")
        return ExitCode.DONE
    return delivery.hand_over_parts(_model_data(found, equations), _model_text(found, equations))


def _model_data(model: Model, equations: list[Typeset]) -> dict[str, Plain]:
    return {
        "model": model.name,
        "quantities": {
            n: {
                "kind": "input" if e.quantity.kind == "given" else e.quantity.kind,
                "unit": e.unit,
                "meaning": e.quantity.meaning,
                "component": e.owner.__name__,
                **{a: e.number(a) for a in ("start", "low", "high", "default") if e.number(a) is not None},
            }
            for n, e in model.entries.items()
        },
        "equations": [
            {"target": e.target, "kind": e.kind, "equation": e.plain, "latex": e.latex, "source": e.source}
            for e in equations
        ],
    }


def _model_text(model: Model, equations: list[Typeset]) -> str:
    from shipid.declaration.component import SAMPLING_INTERVAL
    from shipid.declaration.units import pretty

    lines = [f"{model.name}: {_about(model)}", ""]
    width = max(map(len, model.entries))
    for kind, title in _KINDS.items():
        names = [n for n in model.entries if model[n].quantity.kind == kind and n != SAMPLING_INTERVAL]
        lines += [title] if names else []
        lines += [f"  {n:<{width}}  {pretty(model[n].unit):<9}  {model[n].quantity.meaning}" for n in names]
    lines.append("equations")
    for e in equations:
        label = "  (where a parameter set publishes it)" if e.kind == "instead" else ""
        lines += [f"  {e.plain}{label}", f"      {e.component}: {e.source.partition(chr(10))[0]}"]
    return "\n".join(lines)
