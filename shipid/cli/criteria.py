"""``shipid criteria``: a model evaluated against IMO MSC.137(76) 5.3."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.options import model_argument, ship_option, speed_option
from shipid.foundation.exit_codes import ExitCode


@click.command()
@model_argument
@ship_option(required=True)
@speed_option("Test speed")
@delivered(RESULT, REPORT)
def criteria(model: str, ship: str, speed: str | None, delivery: Delivery) -> ExitCode:
    """Evaluate a model against the manoeuvring criteria of IMO MSC.137(76).

    Turning circle, initial turning and overshoots to both sides beside their limits, with bands from the standard deviations
    of the ship's set, and the width of the spiral's loop.
    """
    from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria
    from shipid.parameters.catalogue import find_model, find_ship

    found = manoeuvring_criteria(find_model(model), ship=find_ship(ship), speed=speed)
    return delivery.hand_over(found, {REPORT: delivery.report(found)})
