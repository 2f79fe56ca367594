"""``shipid identify``: from trials to an identified ship, with its report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from shipid.cli.folder import fill, result_folder
from shipid.cli.shared import (
    Variadic,
    assignments,
    format_option,
    json_option,
    names_of,
    overwrite_option,
    print_json,
    progress_on_stderr,
    read,
    say,
    window_of,
)
from shipid.identification.methods import LOSSES, METHODS, PURPOSES, Loss, Method, Purpose


@click.command(cls=Variadic)
@click.argument("trials", nargs=-1, required=True, metavar="TRIAL...")
@click.option("--model", required=True, metavar="MODEL", help="A model's name, or path/to/file.py:Class.")
@click.option("--ship", metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@format_option
@click.option("--window", metavar="A:B", help="For every trial without a window of its own (FILE@A:B).")
@click.option("--estimate", metavar="a,b,..", help="Coefficients to estimate; the model's own choice by default.")
@click.option(
    "--fix", multiple=True, metavar="NAME=VALUE", help="Hold a coefficient, with its unit: n3='0.4 s^2/deg^2'."
)
@click.option("--validate", multiple=True, metavar="TRIAL...", help="Trials to predict that are not fitted.")
@click.option("--signals", metavar="a,b,..", help="Signals to fit: psi, r, u, v, x, y. By default what is measured.")
@click.option("--noise", metavar="LIST", help="Noise levels, 'psi=0.2 deg,r=0.02 deg/s'; estimated by default.")
@click.option(
    "--for",
    "purpose",
    type=click.Choice(list(PURPOSES)),
    help="For prediction, rudder biases are pooled over the trials; by default each trial has its own.",
)
@click.option(
    "--method",
    type=click.Choice(list(METHODS)),
    help="The only method to try; by default one after the other as needed.",
)
@click.option(
    "--loss",
    default="linear",
    type=click.Choice(list(LOSSES)),
    show_default=True,
    help="How residuals count: by their squares, or the largest less, for logs with outliers.",
)
@click.option("--posterior", metavar="N", type=click.IntRange(1), help="Sample the posterior: N draws (needs emcee).")
@click.option("--no-check", is_flag=True, help="Leave the trials' doctor out.")
@click.option("--no-rudder-bias", is_flag=True, help="Believe the rudder: no bias of its own in each trial.")
@click.option("--starts", default=5, type=click.IntRange(1), show_default=True, help="Number of starting points.")
@click.option("--seed", default=0, type=click.IntRange(0), show_default=True, help="Of the random starting points.")
@click.option("--out", metavar="DIR", help="Folder for result.json, ship.toml and report.html.")
@click.option("--open", "open_report", is_flag=True, help="Open the report in the browser.")
@overwrite_option
@json_option
def identify(
    trials: tuple[str, ...],
    model: str,
    ship: str | None,
    format_: str | None,
    window: str | None,
    estimate: str | None,
    fix: tuple[str, ...],
    validate: tuple[str, ...],
    signals: str | None,
    noise: str | None,
    purpose: Purpose | None,
    method: Method | None,
    loss: Loss,
    posterior: int | None,
    no_check: bool,
    no_rudder_bias: bool,
    starts: int,
    seed: int,
    out: str | None,
    open_report: bool,
    overwrite: bool,
    as_json: bool,
) -> int:
    """Identify a model from one trial or several, jointly.

    Writes result.json, ship.toml (a parameter set every later command takes as --ship) and report.html into DIR.
    """
    from shipid.identification.assess import assess
    from shipid.identification.identify import identify as run_identify
    from shipid.parameters.catalogue import find_model, find_ship

    folder = result_folder(out, _FILES, overwrite)
    span = window_of(window)
    found, known = find_model(model), find_ship(ship) if ship else None
    with progress_on_stderr(as_json) as tell:
        fit = run_identify(
            found,
            [read(t, format_, span) for t in trials],
            ship=known,
            estimate=names_of(estimate),
            fixed=assignments(fix),
            signals=names_of(signals),
            noise=None if noise is None else assignments(noise.split(",")),
            validate=[read(t, format_, span) for t in validate],
            purpose=purpose,
            method=method,
            loss=loss,
            rudder_bias=not no_rudder_bias,
            starts=starts,
            seed=seed,
            progress=tell,
        )
        if posterior is not None and fit.converged:
            tell("sampling the posterior")
            fit = replace(fit, posterior=fit.sample_posterior(posterior, seed))
        fit = assess(fit, bands=folder is not None or as_json, findings=not no_check)
        if folder is not None:
            tell("writing the report")
            _write(fit, folder)
    if as_json:
        print_json(fit.to_dict())
    else:
        click.echo(repr(fit))
        if folder is not None:
            click.echo(f"written: {', '.join(str(folder / n) for n in _FILES)}")
    if open_report and folder is not None:
        import webbrowser

        report = folder / _FILES[2]
        if not webbrowser.open(report.resolve().as_uri()):
            say(f"there is no browser here to open {report} with.")
    if not fit.converged:
        say(f"the search did not converge: {fit.message} What it knows is above; do not use it as a ship.")
        return 4
    return 0


_FILES = ("result.json", "ship.toml", "report.html")


def _write(fit: Any, folder: Path) -> None:
    import json

    from shipid.parameters.parameter_file import write_parameter_set
    from shipid.report.write_report import write_report

    result = json.dumps(fit.to_dict(), indent=1, allow_nan=False, ensure_ascii=False)
    writers: dict[str, Callable[[Path], object]] = {
        "result.json": lambda path: path.write_text(result + "\n", encoding="utf-8"),
        "ship.toml": lambda path: write_parameter_set(fit.ship, path),
        "report.html": lambda path: write_report(fit, path),
    }
    fill(folder, writers)
