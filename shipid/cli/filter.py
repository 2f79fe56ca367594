"""``shipid filter``: a trial through a Kalman filter, or samples as they arrive."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from shipid.cli.folder import fill, result_folder
from shipid.cli.shared import (
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
from shipid.identification.recursive.methods import METHODS

_FILES = ("estimates.csv", "result.json", "report.html")


@click.command("filter")
@click.argument("trial", required=False, metavar="[TRIAL]")
@click.option(
    "--model",
    required=True,
    metavar="MODEL",
    help="yaw-filter, position-filter, own-ship-filter, any model's name, or path/to/file.py:Class.",
)
@click.option("--ship", metavar="SHIP", help="A ship's name, or the path of a parameter set (TOML).")
@click.option(
    "--method",
    type=click.Choice(list(METHODS)),
    default="ekf",
    show_default=True,
    metavar="METHOD",
    help=f"{', '.join(METHODS)}. All but ekf identify the parameters of one measured state.",
)
@format_option
@click.option("--window", metavar="A:B", help="Seconds of the trial's clock.")
@click.option(
    "--measured",
    metavar="LIST",
    help="Sensors and their noise per sample, 'psi=0.2 deg,r=0.02 deg/s'; standard ones by default.",
)
@click.option(
    "--estimate", metavar="a,b,..", help="Parameters to estimate; the model's own choice by default, 'none' for none."
)
@click.option("--noise", metavar="LIST", help="What drives states and parameters, 'r=0.01 deg/s^1.5,K=1e-4 1/s'.")
@click.option("--initial", metavar="LIST", help="Standard deviations of the first estimates, 'K=0.02 1/s,psi=2 deg'.")
@click.option("--start", metavar="LIST", help="First estimates, 'K=0.05 1/s'; the ship's values by default.")
@click.option("--rates", metavar="LIST", help="How often a sensor is read, 'x=2 s,y=2 s'.")
@click.option(
    "--input", "inputs", multiple=True, metavar="NAME=VALUE", help="A constant input, as in cruise='9.5 m/s'."
)
@click.option(
    "--gate", default=5.0, show_default=True, help="Innovations beyond so many standard deviations are rejected."
)
@click.option("--out", metavar="DIR", help="Folder for estimates.csv, result.json and report.html.")
@click.option(
    "--follow",
    metavar="FILE",
    help="Read samples as they arrive, one line a sample ('-': standard input), and write estimates.",
)
@click.option(
    "--wait",
    default="5 s",
    show_default=True,
    metavar="T",
    help="With --follow FILE: end when nothing has come for so long.",
)
@overwrite_option
@json_option
def filter_trial(
    trial: str | None,
    model: str,
    ship: str | None,
    method: str,
    format_: str | None,
    window: str | None,
    measured: str | None,
    estimate: str | None,
    noise: str | None,
    initial: str | None,
    start: str | None,
    rates: str | None,
    inputs: tuple[str, ...],
    gate: float,
    out: str | None,
    follow: str | None,
    wait: str,
    overwrite: bool,
    as_json: bool,
) -> None:
    """Filter a trial with an extended Kalman filter generated from a model.

    Prints the last estimates with their intervals, and whether the innovations are as large and as white as the filter
    expects. With --out, a table of the estimates against time, the result, and a report. With --follow, samples are read
    line by line after a header with units ("t [s], psi [deg], delta [deg]"), and each gives a line of estimates.
    """
    from shipid.estimation.settings.defaults import parameters_to_estimate
    from shipid.foundation.errors import UsageError
    from shipid.parameters.catalogue import find_model, find_ship

    if (trial is None) == (follow is None):
        raise UsageError("give a TRIAL to filter, or --follow FILE for samples as they arrive, and not both.")
    if follow is not None and out is not None:
        raise UsageError("--follow writes estimates to standard output as they are made; redirect it instead of --out.")
    folder = result_folder(out, _FILES, overwrite)
    found, known = find_model(model), find_ship(ship) if ship else None
    names = parameters_to_estimate(found) if estimate is None else () if estimate == "none" else names_of(estimate)
    settings: dict[str, Any] = {
        "estimated": tuple(names or ()),
        "noise": _listed(noise),
        "initial": _listed(initial),
        "start": _listed(start),
        "rates": _listed(rates),
        "inputs": assignments(inputs),
        "gate": gate or None,
    }
    if method != "ekf":
        if follow is not None or rates is not None:
            raise UsageError(
                f"method {method} takes a whole record, each sample of it: leave --follow and --rates out."
            )
        chosen = {"estimate": names if estimate is not None else None}
        chosen |= {n: settings[n] for n in ("noise", "initial", "start", "inputs")}
        _recursively(trial, format_, window, found, known, method, measured, chosen, folder, as_json)
        return
    if follow is not None:
        from shipid.cli.following import follow as run_follow

        run_follow(follow, found, known, None if measured is None else _listed(measured), settings, wait, as_json)
        return

    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.settings.defaults import standard_sensors
    from shipid.generation.reduction import reduced

    with progress_on_stderr(as_json) as tell:
        assert trial is not None
        record = read(trial, format_, window_of(window))
        sensors = standard_sensors(found, tuple(record.table.columns)) if measured is None else _listed(measured)
        tell("generating the filter")
        # Positions that no sensor bears on are dead reckoning, not estimation.
        kalman = ExtendedKalmanFilter(reduced(found, tuple(sensors)), known, measured=sensors, **settings)
        tell("filtering")
        run = kalman.filter(record)
        shown = kalman.observability(run)
        if folder is not None:
            tell("writing the report")
            _write(run, run.to_dict() | {"observability": shown.to_dict()}, folder, shown)
    if as_json:
        print_json(run.to_dict() | {"observability": shown.to_dict()})
        return
    click.echo(repr(run))
    for message in shown.messages:
        say(message)
    if folder is not None:
        click.echo(f"written: {', '.join(str(folder / n) for n in _FILES)}")


def _recursively(
    trial: str | None,
    format_: str | None,
    window: str | None,
    model: Any,
    ship: Any,
    method: str,
    measured: str | None,
    settings: dict[str, Any],
    folder: Path | None,
    as_json: bool,
) -> None:
    """Run one of the family of recursive identification over a record."""
    from shipid.identification.recursive.identifier import identify_recursively

    with progress_on_stderr(as_json) as tell:
        record = read(str(trial), format_, window_of(window))
        tell(f"identifying by {method}")
        sensors = None if measured is None else _listed(measured)
        run: Any = identify_recursively(model, record, ship=ship, method=method, measured=sensors, **settings)
        if folder is not None:
            tell("writing the report")
            _write(run, run.to_dict(), folder)
    if as_json:
        print_json(run.to_dict())
    else:
        click.echo(repr(run))
        if folder is not None:
            click.echo(f"written: {', '.join(str(folder / n) for n in _FILES)}")
    if run.diverged:
        say(f"not to be believed: {run.why_diverged}")


def _listed(text: str | None) -> dict[str, str]:
    return {} if text is None else assignments(text.split(","))


def _write(run: Any, result: dict[str, Any], folder: Path, reported: Any = None) -> None:
    from shipid.report.write_report import write_report

    text = json.dumps(result, indent=1, allow_nan=False, ensure_ascii=False)
    fill(
        folder,
        {
            _FILES[0]: lambda p: run.to_frame().to_csv(p, index=False, float_format="%.9g"),
            _FILES[1]: lambda p: p.write_text(text + "\n", encoding="utf-8"),
            _FILES[2]: lambda p: write_report(reported or run, p),
        },
    )
