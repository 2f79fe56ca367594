"""``shipid plan``: which manoeuvres to sail within a time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.flows import current_option, wind_option
from shipid.cli.frame.options import (
    LEVELS,
    estimate_option,
    input_option,
    model_given,
    model_option,
    sampling_option,
    seed_option,
    ship_given,
    ship_option,
    speed_option,
    values_option,
)
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.cli.frame.typed import names_of
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.planning.selection import Criterion


@click.command()
@model_option
@ship_option(required=True)
@click.option(
    "--time", required=True, type=NumberWithUnit("s"), help="Time available, as in 20min, approaches included."
)
@speed_option("Speed of the trials", ", or several to choose from, '9 kn,6 kn'", several=True)
@estimate_option()
@click.option(
    "--noise",
    default="standard",
    show_default=True,
    help=f"Of the sensors: standard, or a list of what is measured, {LEVELS}.",
)
@click.option(
    "--criterion", default="D", show_default=True, metavar="D|A", help="Determinant, or mean relative variance."
)
@click.option("--worst-case", is_flag=True, help="Plan for the worst draw of the coefficients, not for their average.")
@click.option(
    "--repertoire",
    metavar="a,b,..",
    help="Kinds or manoeuvres: zigzag,telegraph,turn,course by default; turn:20; spiral.",
)
@sampling_option
@click.option(
    "--correlation",
    type=NumberWithUnit("s"),
    help="Autocorrelation time of the noise in waves, as in '4 s'; white by default.",
)
@click.option(
    "--between", type=NumberWithUnit("s"), help="Steady approach between two manoeuvres; five L/U by default."
)
@click.option(
    "--heading",
    type=NumberWithUnit("deg"),
    default="0 deg",
    show_default=True,
    help="Heading of the first approach, for the sea room in current and wind.",
)
@current_option("; for timetable and sea room")
@wind_option("; for timetable and sea room")
@click.option("--draws", default=8, type=click.IntRange(0), show_default=True, help="Draws of the coefficients.")
@values_option
@input_option
@seed_option("draws and random telegraphs")
@delivered(RESULT, REPORT)
def plan(
    model: str,
    ship: str,
    time: str,
    speed: str | None,
    estimate: list[str] | None,
    noise: str,
    criterion: Criterion,
    worst_case: bool,
    repertoire: str | None,
    sampling: str | None,
    correlation: str | None,
    between: str | None,
    heading: str,
    current: str | None,
    wind: str | None,
    draws: int,
    values: dict[str, str],
    inputs: dict[str, str],
    seed: int,
    delivery: Delivery,
) -> ExitCode:
    """Plan which manoeuvres shrink the confidence intervals most within a time.

    The timetable holds every rudder order with its time or its condition, and the sea room. Each manoeuvre is one of
    ``shipid simulate --manoeuvre``; the plan stands beside 10/10 and 20/20 zig-zags in the same time.
    Standard deviations are Cramer-Rao bounds, which hold for a ship that the model describes exactly. The manoeuvres are
    chosen for calm water; what waves do to the measurements is --noise and --correlation.

    \b
    shipid plan --model norrbin --ship zeefakkel --time 20min
    shipid plan --model de-keizer --ship ship.toml --time '1 h' --repertoire zigzag,turn:20 --noise 'psi=0.2 deg'
    shipid plan --model de-keizer --ship ship.toml --time 30min --heading '40 deg' --current '2 kn to 90 deg'
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.planning.plan_trials import plan_trials

    found = model_given(model, inputs)
    known = ship_given(ship, values, found)
    with delivery.progress() as tell:
        result = plan_trials(
            found,
            known,
            time,
            speed=speed,
            estimate=estimate,
            noise=noise,
            criterion=criterion,
            worst_case=worst_case,
            repertoire=None if repertoire is None else names_of(repertoire),
            sampling=sampling,
            correlation=correlation,
            between=between,
            heading=heading,
            current=current,
            wind=wind,
            draws=draws,
            seed=seed,
            progress=tell,
        )
    return delivery.hand_over(result, {REPORT: delivery.report(result)})
