"""``shipid compare``: models ranked by how they predict what they were not fitted to."""

from __future__ import annotations

import click

from shipid.cli.shared import (
    Variadic,
    format_option,
    json_option,
    names_of,
    print_json,
    progress_on_stderr,
    read,
    window_of,
)


@click.command(cls=Variadic)
@click.argument("trials", nargs=-1, required=True, metavar="TRIAL...")
@click.option("--models", required=True, metavar="m1,m2,..", help="Candidates: names, or path/to/file.py:Class.")
@click.option("--ship", metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@format_option
@click.option("--window", metavar="A:B", help="For every trial without a window of its own (FILE@A:B).")
@click.option("--validate", multiple=True, metavar="TRIAL...", help="Trials kept apart: reported, never ranked by.")
@click.option("--starts", default=5, show_default=True, type=click.IntRange(1), help="Number of starting points.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Of the random starting points.")
@json_option
def compare(
    trials: tuple[str, ...],
    models: str,
    ship: str | None,
    format_: str | None,
    window: str | None,
    validate: tuple[str, ...],
    starts: int,
    seed: int,
    as_json: bool,
) -> None:
    """Rank models by their predictions of trials they were not fitted to.

    Each trial is left out in turn, every model is fitted to the others and predicts it; a single trial is cut in two halves.
    """
    from shipid.identification.validation.compare_models import compare_models
    from shipid.parameters.catalogue import find_model, find_ship

    span = window_of(window)
    candidates = [find_model(m) for m in names_of(models) or []]
    known = find_ship(ship) if ship else None
    with progress_on_stderr(as_json) as tell:
        ranking = compare_models(
            candidates,
            [read(t, format_, span) for t in trials],
            ship=known,
            validate=[read(t, format_, span) for t in validate],
            starts=starts,
            seed=seed,
            progress=tell,
        )
    if as_json:
        print_json(ranking.to_dict())
    else:
        click.echo(repr(ranking))
