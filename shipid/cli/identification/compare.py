"""``shipid compare``: models ranked by how they predict what they were not fitted to."""

from __future__ import annotations

import click

from shipid.cli.frame.completing import complete_model
from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.options import (
    TrialReader,
    Variadic,
    input_option,
    optional_ship_given,
    reading,
    seed_option,
    set_option,
    ship_option,
    starts_option,
    trials_argument,
    validate_option,
)
from shipid.cli.frame.typed import names_of
from shipid.foundation.exit_codes import ExitCode


@click.command(cls=Variadic)
@trials_argument
@click.option(
    "--models",
    metavar="m1,m2,..",
    help="Candidates: names, or path/to/file.py:Class; by default one model of each usual structure.",
    shell_complete=complete_model,
)
@ship_option()
@reading
@validate_option
@set_option
@input_option
@starts_option
@seed_option("the random starting points")
@delivered(RESULT, REPORT)
def compare(
    trials: tuple[str, ...],
    models: str | None,
    ship: str | None,
    read: TrialReader,
    validate: tuple[str, ...],
    values: dict[str, str],
    inputs: dict[str, str],
    starts: int,
    seed: int,
    delivery: Delivery,
) -> ExitCode:
    """Rank models by their predictions of trials they were not fitted to.

    Each trial is left out in turn, every model is fitted to the others and predicts it; a single trial is cut in two halves.
    Where the trials hold the true wind or an order of the rudder, the candidates have a moment of the wind and a lag. Trials of --validate
    are kept apart: what is predicted of them is printed, and only what their rudder does is used.

    \b
    shipid compare first.csv second.csv --models nomoto,norrbin,de-keizer --ship zeefakkel
    shipid compare trial.csv --models nomoto,my.py:Yaw --ship ship.toml --validate other.csv
    shipid compare trial.csv --models cross-flow,mmg-revolutions --ship kvlcc2 --input n='1.5 rps'
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.identification.compare_models import compare_models
    from shipid.parameters.catalogue import find_model

    candidates = None if models is None else [find_model(m) for m in names_of(models)]
    known = optional_ship_given(ship, values, *(candidates or ()))
    with delivery.progress() as tell:
        ranking = compare_models(
            candidates,
            [read(t) for t in trials],
            ship=known,
            inputs=inputs,
            validate=[read(t) for t in validate],
            starts=starts,
            seed=seed,
            progress=tell,
        )
    return delivery.hand_over(ranking, {REPORT: delivery.report(ranking)})
