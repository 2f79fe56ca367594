"""``shipid compare``: models ranked by how they predict what they were not fitted to."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import Delivery, delivered
from shipid.cli.frame.options import (
    TrialReader,
    Variadic,
    names_of,
    reading,
    seed_option,
    ship_option,
    starts_option,
    trials_argument,
    validate_option,
)
from shipid.foundation.exit_codes import ExitCode


@click.command(cls=Variadic)
@trials_argument
@click.option(
    "--models",
    metavar="m1,m2,..",
    help="Candidates: names, or path/to/file.py:Class; by default one model of each usual structure.",
)
@ship_option()
@reading
@validate_option
@starts_option
@seed_option("the random starting points")
@delivered()
def compare(
    trials: tuple[str, ...],
    models: str | None,
    ship: str | None,
    read: TrialReader,
    validate: tuple[str, ...],
    starts: int,
    seed: int,
    delivery: Delivery,
) -> ExitCode:
    """Rank models by their predictions of trials they were not fitted to.

    Each trial is left out in turn, every model is fitted to the others and predicts it; a single trial is cut in two halves.
    Where the trials hold the true wind or an order of the rudder, the candidates have a moment of the wind and a lag. Trials of --validate
    are kept apart: what is predicted of them is printed, and only what their rudder does is used.
    """
    from shipid.identification.compare_models import compare_models
    from shipid.parameters.catalogue import find_model, find_ship

    candidates = None if models is None else [find_model(m) for m in names_of(models)]
    known = find_ship(ship) if ship else None
    with delivery.progress() as tell:
        ranking = compare_models(
            candidates,
            [read(t) for t in trials],
            ship=known,
            validate=[read(t) for t in validate],
            starts=starts,
            seed=seed,
            progress=tell,
        )
    return delivery.hand_over(ranking)
