"""``shipid plan``: which manoeuvres to sail within a time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from shipid.cli.shared import assignments, json_option, names_of, print_json, progress_on_stderr

if TYPE_CHECKING:
    from shipid.planning.selection import Criterion


@click.command()
@click.option("--model", required=True, metavar="MODEL", help="A model's name, or path/to/file.py:Class.")
@click.option("--ship", required=True, metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@click.option("--time", required=True, metavar="T", help="What there is, as in 20min, approaches included.")
@click.option("--speed", metavar="V", help="As in '9 kn', or several to choose from, '9 kn,6 kn'.")
@click.option("--estimate", metavar="a,b,..", help="Coefficients to estimate; the model's own choice by default.")
@click.option(
    "--noise",
    default="standard",
    show_default=True,
    help="standard, or a list of what is measured: 'psi=0.2 deg,u=0.1 m/s'.",
)
@click.option(
    "--criterion", default="D", show_default=True, metavar="D|A", help="Determinant, or mean relative variance."
)
@click.option(
    "--worst-case", is_flag=True, help="The worst draw of the coefficients counts, not the average over them."
)
@click.option(
    "--repertoire",
    metavar="a,b,..",
    help="Kinds or manoeuvres: zigzag,telegraph,turn,course by default; turn:20; spiral.",
)
@click.option("--sampling", metavar="T", help="Sampling interval of the sensors, as in '1 s'.")
@click.option(
    "--correlation", metavar="T", help="Autocorrelation time of the noise in waves, as in '4 s'; white by default."
)
@click.option("--between", metavar="T", help="Steady approach between two manoeuvres; five L/U by default.")
@click.option("--draws", default=8, type=click.IntRange(0), show_default=True, help="Draws of the coefficients.")
@click.option(
    "--set", "--fix", "values", multiple=True, metavar="NAME=VALUE", help="Replace a value of the ship, with its unit."
)
@click.option("--seed", default=0, type=click.IntRange(0), show_default=True, help="Of draws and random telegraphs.")
@json_option
def plan(
    model: str,
    ship: str,
    time: str,
    speed: str | None,
    estimate: str | None,
    noise: str,
    criterion: Criterion,
    worst_case: bool,
    repertoire: str | None,
    sampling: str | None,
    correlation: str | None,
    between: str | None,
    draws: int,
    values: tuple[str, ...],
    seed: int,
    as_json: bool,
) -> None:
    """Plan which manoeuvres shrink the confidence intervals most within a time.

    Each manoeuvre is one of ``shipid simulate --manoeuvre``; the plan stands beside 10/10 and 20/20 zig-zags in the same time.
    Standard deviations are Cramer-Rao bounds, which hold for a ship that is as the model says.
    """
    from shipid.parameters.catalogue import find_model, find_ship
    from shipid.planning.plan_trials import plan_trials

    found, known = find_model(model), find_ship(ship)
    with progress_on_stderr(as_json) as tell:
        result = plan_trials(
            found,
            known,
            time,
            speed=speed,
            estimate=names_of(estimate),
            noise=noise,
            criterion=criterion,
            worst_case=worst_case,
            repertoire=names_of(repertoire),
            values=assignments(values),
            sampling=sampling,
            correlation=correlation,
            between=between,
            draws=draws,
            seed=seed,
            progress=tell,
        )
    if as_json:
        print_json(result.to_dict())
    else:
        click.echo(repr(result))
