"""``shipid criteria``: a model evaluated against IMO MSC.137(76) 5.3."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.options import (
    input_option,
    model_argument,
    model_given,
    set_option,
    ship_given,
    ship_option,
    speed_option,
)
from shipid.foundation.exit_codes import ExitCode


@click.command()
@model_argument
@ship_option(required=True)
@speed_option("Test speed")
@set_option
@input_option
@delivered(RESULT, REPORT)
def criteria(
    model: str, ship: str, speed: str | None, values: dict[str, str], inputs: dict[str, str], delivery: Delivery
) -> ExitCode:
    """Evaluate a model against the manoeuvring criteria of IMO MSC.137(76).

    Turning circle, initial turning and overshoots to both sides beside their limits, with bands from the standard deviations
    of the ship's set, and the width of the spiral's loop. The criteria hold in deep, calm water (MSC.137(76), 5.2), so the
    command takes no wind, current or waves: shipid simulate and shipid plan do.

    \b
    shipid criteria de-keizer --ship soesterberg
    shipid criteria norrbin --ship ship.toml --speed '15 kn' --set delta_rate='5 deg/s'
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria

    found = model_given(model, inputs)
    evaluated = manoeuvring_criteria(found, ship=ship_given(ship, values, found), speed=speed)
    return delivery.hand_over(evaluated, {REPORT: delivery.report(evaluated)})
