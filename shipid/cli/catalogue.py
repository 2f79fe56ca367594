"""``shipid models`` and ``shipid show``: what there is, and what it says."""

from __future__ import annotations

from typing import Any

import click

from shipid.cli.shared import json_option, print_json


@click.command()
@json_option
def models(as_json: bool) -> None:
    """List models and ships, one line each."""
    from shipid.parameters.catalogue import known_models, known_ships

    found, ships = known_models(), known_ships()
    if as_json:
        print_json(
            {
                "models": {n: {"about": _about(m), "parameters": list(m.parameters)} for n, m in found.items()},
                "ships": {n: {"about": s.title, "models": list(s.models)} for n, s in ships.items()},
            }
        )
        return
    width = max(map(len, [*found, *ships]))
    click.echo("models")
    for name, model in found.items():
        click.echo(f"  {name:<{width}}  {_about(model)} [{', '.join(model.parameters)}]")
    click.echo("ships")
    for name, ship in ships.items():
        click.echo(f"  {name:<{width}}  {ship.title} [{', '.join(ship.models)}]")


def _about(model: Any) -> str:
    first = (model.components[0].__doc__ or "").strip().partition("\n")[0]
    return str(first)


@click.command()
@click.argument("model")
@json_option
@click.option("--latex", is_flag=True, help="Print the equations as LaTeX.")
def show(model: str, as_json: bool, latex: bool) -> None:
    """Show a model: quantities, units, equations, sources.

    MODEL is a name (see shipid models) or path/to/file.py:Class.
    """
    from shipid.declaration.component import SAMPLING_INTERVAL
    from shipid.declaration.units import pretty
    from shipid.generation.typesetting.typeset import typeset
    from shipid.parameters.catalogue import find_model

    found = find_model(model)
    equations = typeset(found)
    if latex:
        rows = [e.latex.replace(" = ", " &= ", 1) + f" && \\text{{{e.component}.{e.method}}}" for e in equations]
        click.echo("\\begin{align}\n" + " \\\\\n".join(rows) + "\n\\end{align}")
        return
    if as_json:
        print_json(
            {
                "model": found.name,
                "quantities": {
                    n: {
                        "kind": "input" if e.quantity.kind == "given" else e.quantity.kind,
                        "unit": e.unit,
                        "meaning": e.quantity.meaning,
                        "component": e.owner.__name__,
                        **{a: e.number(a) for a in ("start", "low", "high", "default") if e.number(a) is not None},
                    }
                    for n, e in found.entries.items()
                },
                "equations": [
                    {"target": e.target, "kind": e.kind, "equation": e.plain, "latex": e.latex, "source": e.source}
                    for e in equations
                ],
            }
        )
        return
    click.echo(f"{found.name}: {_about(found)}\n")
    width = max(map(len, found.entries))
    for kind, title in (
        ("state", "states"),
        ("given", "inputs"),
        ("parameter", "parameters"),
        ("constant", "constants"),
        ("derived", "derived"),
        ("output", "outputs"),
    ):
        names = [n for n in found.entries if found[n].quantity.kind == kind and n != SAMPLING_INTERVAL]
        if names:
            click.echo(title)
        for n in names:
            click.echo(f"  {n:<{width}}  {pretty(found[n].unit):<9}  {found[n].quantity.meaning}")
    click.echo("equations")
    for e in equations:
        label = "  (where a parameter set publishes it)" if e.kind == "instead" else ""
        click.echo(f"  {e.plain}{label}\n      {e.component}: {e.source.partition(chr(10))[0]}")
