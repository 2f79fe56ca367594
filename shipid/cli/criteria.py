"""``shipid criteria``: a model evaluated against IMO MSC.137(76) 5.3."""

from __future__ import annotations

import click

from shipid.cli.shared import json_option, print_json


@click.command()
@click.argument("model")
@click.option("--ship", required=True, metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@click.option("--speed", metavar="V", help="Test speed, as in '15 kn'; the ship's own by default.")
@json_option
def criteria(model: str, ship: str, speed: str | None, as_json: bool) -> None:
    """Evaluate a model against the manoeuvring criteria of IMO MSC.137(76).

    Turning circle, initial turning and overshoots to both sides beside their limits, with bands from the standard deviations
    of the ship's set, and the width of the spiral's loop.
    """
    from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria
    from shipid.parameters.catalogue import find_model, find_ship

    found = manoeuvring_criteria(find_model(model), ship=find_ship(ship), speed=speed)
    if as_json:
        print_json(found.to_dict())
    else:
        click.echo(repr(found))
