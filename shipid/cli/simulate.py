"""``shipid simulate``: a manoeuvre of a declared ship, written as a trial."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import click

from shipid.cli.delivery import output_file, overwrite_option
from shipid.cli.messages import say, warn
from shipid.cli.options import (
    LEVELS,
    model_argument,
    sampling_option,
    seed_option,
    ship_option,
    speed_option,
    values_option,
)
from shipid.cli.quantities import NumberWithUnit

if TYPE_CHECKING:
    from shipid.trials.trial import Trial


@click.command()
@model_argument
@ship_option(required=True)
@click.option("--manoeuvre", required=True, metavar="M", help="zigzag:20/20, turn:35, spiral:25, course:60, ...")
@speed_option("Speed before the manoeuvre")
@click.option(
    "--noise", default="none", show_default=True, help=f"Of the sensors: none, standard, or a list, {LEVELS}."
)
@seed_option("the noise and the random telegraph")
@click.option("--duration", type=NumberWithUnit("s"), help="As in '600 s'; long enough for the manoeuvre by default.")
@sampling_option
@click.option(
    "--heading", type=NumberWithUnit("deg"), default="0 deg", show_default=True, help="Heading of the approach."
)
@click.option("--current", metavar="C", help="As in '3 kn to 30 deg' (or 'from').")
@click.option("--wind", metavar="W", help="As in '10 m/s from 270 deg' (or 'to'); needs a ship with wind coefficients.")
@values_option
@click.option("-o", "--output", metavar="FILE", help="CSV file to write; stdout by default.")
@overwrite_option
def simulate(
    model: str,
    ship: str,
    manoeuvre: str,
    speed: str | None,
    noise: str,
    seed: int,
    duration: str | None,
    sampling: str | None,
    heading: str,
    current: str | None,
    wind: str | None,
    values: dict[str, str],
    output: str | None,
    overwrite: bool,
) -> None:
    """Simulate a manoeuvre and write it as a trial.

    \b
    zigzag:20/20        rudder and heading angle; zigzag:-20/20 begins to port
    turn:35             turning circle through 540 degrees, with pull-out
    spiral:25           direct spiral          reversed-spiral:0.6  up to r L/U = 0.6
    course:60/15        course change with at most 15 degrees of rudder
    telegraph:10        random telegraph
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.foundation.notices import Notice
    from shipid.parameters.catalogue import find_model, find_ship
    from shipid.trials.logs.writing import write_trial
    from shipid.trials.manoeuvres.simulate import simulate as run_simulation

    place = None if output is None else output_file(output, overwrite)
    trial = run_simulation(
        find_model(model),
        find_ship(ship),
        manoeuvre,
        speed=speed,
        noise=noise,
        seed=seed,
        duration=duration,
        sampling=sampling,
        heading=heading,
        current=flow_of(current, "current"),
        wind=flow_of(wind, "wind"),
        values=values,
    )
    for note in trial.source.notes:
        if isinstance(note, Notice):
            warn(note)
    if place is None:
        _print(trial)
        return
    try:
        write_trial(trial, place, overwrite=overwrite, comment=trial.source.comment)
    except OSError:
        _print(trial)
        raise
    say(f"{place}: {len(trial)} samples. {trial.source.comment}")


def _print(trial: Trial) -> None:
    click.echo(f"# {trial.source.comment}")
    click.echo(trial.to_frame().to_csv(index=False, lineterminator="\n", float_format="%.10g"), nl=False)


def flow_of(text: str | None, what: str) -> tuple[float, float] | None:
    """Return what ``"3 kn to 30 deg"`` says: speed and direction it flows TO, SI; None for none.

    Parameters
    ----------
    text : str or None
        As above, or ``"10 m/s from 270 deg"``.
    what : str
        What flows, for the message.

    Raises
    ------
    UsageError
        If the text has another form.
    """
    import math

    from shipid.declaration.units import to_si
    from shipid.foundation.errors import UsageError

    if text is None:
        return None
    match = re.match(r"^\s*(.+?)\s+(to|from)\s+(.+?)\s*$", text)
    if not match:
        raise UsageError(
            f"the {what} '{text}' does not say where it flows: write '3 kn to 30 deg' or '10 m/s from 270 deg'."
        )
    direction = to_si(match.group(3), "rad", f"direction of the {what}")
    turned = math.pi if match.group(2) == "from" else 0.0
    return to_si(match.group(1), "m/s", f"speed of the {what}"), direction + turned
