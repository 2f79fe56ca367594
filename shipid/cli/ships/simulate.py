"""``shipid simulate``: a manoeuvre of a declared ship, written as a trial."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from shipid.cli.frame.completing import complete_manoeuvre
from shipid.cli.frame.delivery import output_or_stdout, overwrite_option
from shipid.cli.frame.flows import current_option, wind_option
from shipid.cli.frame.messages import say, warn, warned
from shipid.cli.frame.options import (
    LEVELS,
    input_option,
    model_argument,
    model_given,
    sampling_option,
    seed_option,
    ship_option,
    speed_option,
    values_option,
)
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.prediction.sailing.voyage import Voyage
    from shipid.trials.trial import Trial


@click.command()
@model_argument
@ship_option(required=True)
@click.option(
    "--manoeuvre",
    metavar="M",
    help="zigzag:20/20, turn:35, spiral:25, course:60, ...",
    shell_complete=complete_manoeuvre,
)
@click.option(
    "--autopilot", metavar="FILE", help="Sail courses under this schedule.toml of shipid tune, in place of a manoeuvre."
)
@click.option(
    "--course",
    "courses",
    multiple=True,
    metavar="[T:]H",
    help="With --autopilot: a heading to order, '60 deg', or at a time, '300 s:60 deg'; once or more.",
)
@click.option(
    "--route",
    metavar="FILE",
    help="Sail a route, RTZ or CSV, under the track pilot; with the autopilot of --autopilot, or one designed by default.",
)
@speed_option("Speed before the manoeuvre")
@click.option(
    "--noise", default="none", show_default=True, help=f"Of the sensors: none, standard, or a list, {LEVELS}."
)
@seed_option("the noise, which is another one for each manoeuvre and speed, and of the random telegraph")
@click.option(
    "--duration",
    type=NumberWithUnit("s"),
    help="As in '600 s'; long enough for the manoeuvre by default. The stages of a spiral share it.",
)
@sampling_option
@click.option(
    "--heading", type=NumberWithUnit("deg"), default="0 deg", show_default=True, help="Heading of the approach."
)
@current_option()
@wind_option("; needs a ship with wind coefficients")
@click.option(
    "--waves",
    metavar="W",
    help="Yaw by waves that the instruments show, '0.5 deg from 300 deg'; of a model with WaveMoment their height, '2 m from 300 deg'.",
)
@values_option
@input_option
@click.option("-o", "--output", metavar="FILE", help="CSV or Parquet file to write; stdout by default.")
@overwrite_option
def simulate(
    model: str,
    ship: str,
    manoeuvre: str | None,
    autopilot: str | None,
    courses: tuple[str, ...],
    route: str | None,
    speed: str | None,
    noise: str,
    seed: int,
    duration: str | None,
    sampling: str | None,
    heading: str,
    current: str | None,
    wind: str | None,
    waves: str | None,
    values: dict[str, str],
    inputs: dict[str, str],
    output: str | None,
    overwrite: bool,
) -> ExitCode:
    """Simulate a manoeuvre, courses under an autopilot or a route under the track pilot, and write it as a trial.

    \b
    zigzag:20/20        rudder and heading angle; zigzag:-20/20 begins to port
    turn:35             turning circle through 540 degrees, with pull-out
    spiral:25           direct spiral          reversed-spiral:0.6  up to r L/U = 0.6
    course:60/15        course change with at most 15 degrees of rudder
    telegraph:10        random telegraph

    \b
    shipid simulate de-keizer --ship soesterberg --manoeuvre zigzag:20/20 -o trial.csv
    shipid simulate de-keizer --ship soesterberg --manoeuvre turn:35 --current '2 kn to 90 deg' --waves '0.3 deg from 40 deg'
    shipid simulate de-keizer --ship soesterberg --autopilot schedule.toml --course '60 deg' -o voyage.csv
    shipid simulate de-keizer --ship soesterberg --route plan.rtz --current '2 kn to 30 deg' -o voyage.csv
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.foundation.notices import Notice
    from shipid.trials.logs.writing import write_trial

    _check(manoeuvre, autopilot, courses, route)
    place = output_or_stdout(output, overwrite)
    settings = {
        "speed": speed, "noise": noise, "seed": seed, "duration": duration, "sampling": sampling, "heading": heading,
        "current": current, "wind": wind, "waves": waves, "values": values,
        "inputs": inputs,
    }  # fmt: skip
    summary = ""
    if manoeuvre is not None:
        trial = _manoeuvre(model, ship, manoeuvre, settings)
    elif route is not None:
        del settings["heading"]
        voyage = _route(model, ship, autopilot, route, settings)
        trial, summary = voyage.trial, voyage.text()
    else:
        assert autopilot is not None
        trial = _voyage(model, ship, autopilot, courses, settings)
    for note in trial.source.notes:
        if isinstance(note, Notice):
            warn(note)
    if summary:
        say(summary)
    code = ExitCode.DOUBTFUL if any(n.serious for n in warned()) else ExitCode.DONE
    if place is None:
        _print(trial)
        return code
    try:
        write_trial(trial, place, overwrite=overwrite, comment=trial.source.comment)
    except OSError:
        _print(trial)
        raise
    said = trial.source.comment.replace("\n", ". ")
    say(f"{place}: {len(trial)} samples. {said}")
    return code


def _check(
    manoeuvre: str | None,
    autopilot: str | None,
    courses: tuple[str, ...],
    route: str | None,
) -> None:
    from shipid.foundation.errors import UsageError

    if route is not None:
        if manoeuvre is not None or courses:
            raise UsageError("--route is a voyage of its own: leave out --manoeuvre and --course.")
        if click.get_current_context().get_parameter_source("heading") is click.core.ParameterSource.COMMANDLINE:
            raise UsageError("a route begins on its first leg: leave out --heading.")
        return
    if (manoeuvre is None) == (autopilot is None):
        raise UsageError(
            "simulate needs a --manoeuvre, or an --autopilot with a --course, or a --route. See shipid simulate --help."
        )
    if autopilot is not None and not courses:
        raise UsageError("--autopilot needs a --course to sail, as in --course '60 deg', or a --route.")
    if autopilot is None and courses:
        raise UsageError("--course belongs to --autopilot: leave it out of a manoeuvre.")


def _manoeuvre(model: str, ship: str, manoeuvre: str, settings: dict[str, Any]) -> Trial:
    from shipid.parameters.catalogue import find_model, find_ship
    from shipid.trials.manoeuvres.simulate import simulate as run_simulation

    return run_simulation(find_model(model), find_ship(ship), manoeuvre, **settings)


def _voyage(
    model: str,
    ship: str,
    autopilot: str,
    courses: tuple[str, ...],
    settings: dict[str, Any],
) -> Trial:
    from shipid.autopilot.design.read_schedule import check_same_ship, read_schedule
    from shipid.parameters.catalogue import find_ship
    from shipid.prediction.sailing.sail import sail

    orders: list[tuple[str, str]] | str = (
        [_order_of(c) for c in courses] if len(courses) > 1 or ":" in courses[0] else courses[0]
    )
    sailing = model_given(model, settings.pop("inputs"))
    pilot, known = read_schedule(autopilot, sailing), find_ship(ship)
    check_same_ship(autopilot, pilot, known)
    return sail(
        pilot,
        orders,
        model=sailing,
        ship=known,
        **settings,
    )


def _route(
    model: str,
    ship: str,
    autopilot: str | None,
    route: str,
    settings: dict[str, Any],
) -> Voyage:
    from shipid.autopilot.design.design_autopilot import design_autopilot
    from shipid.autopilot.design.read_schedule import check_same_ship, read_schedule
    from shipid.parameters.catalogue import find_ship
    from shipid.prediction.routes.read_route import read_route
    from shipid.prediction.sailing.sail_route import sail_route

    plan = read_route(route)
    sailing, known = model_given(model, settings.pop("inputs")), find_ship(ship)
    if autopilot is None:
        pilot = design_autopilot(sailing, known)
    else:
        pilot = read_schedule(autopilot, sailing)
        check_same_ship(autopilot, pilot, known)
    return sail_route(
        pilot,
        plan,
        model=sailing,
        ship=known,
        **settings,
    )


def _order_of(text: str) -> tuple[str, str]:
    from shipid.foundation.errors import UsageError

    when, mark, heading = text.partition(":")
    if not mark:
        raise UsageError(f"of several courses each has its time, and '{text}' has none: write '300 s:{text}'.")
    return when, heading


def _print(trial: Trial) -> None:
    from shipid.foundation.result import csv_of

    for line in trial.source.comment.splitlines():
        click.echo(f"# {line}")
    click.echo(csv_of(trial.to_frame(), 10), nl=False)
