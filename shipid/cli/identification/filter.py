"""``shipid filter``: a trial through a Kalman filter, or samples as they arrive."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.completing import complete_file
from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.messages import say, warn
from shipid.cli.frame.options import (
    LEVELS,
    TrialReader,
    estimate_option,
    levels_option,
    model_option,
    optional_ship_given,
    reading,
    set_option,
    ship_option,
    ships_given,
)
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.cli.frame.typed import assignments
from shipid.foundation.exit_codes import ExitCode
from shipid.identification.recursive.methods import METHODS

if TYPE_CHECKING:
    from shipid.declaration.model import Model
    from shipid.estimation.levels.record_levels import BatchEstimate
    from shipid.estimation.settings.instruments import Amount
    from shipid.foundation.aliases import Plain
    from shipid.parameters.parameter_set import ParameterSet
    from shipid.trials.trial import Trial

_ESTIMATES = "estimates.csv"


@click.command("filter")
@click.argument("trial", required=False, metavar="[TRIAL]", shell_complete=complete_file)
@model_option
@ship_option(several="with --method imm, which tells the one that sails")
@click.option(
    "--method",
    type=click.Choice([*METHODS, "imm"]),
    default="ekf",
    show_default=True,
    metavar="METHOD",
    help=f"{', '.join(METHODS)} or imm. ekf filters; imm tells which of several ships sails; all others identify the parameters of one "
    "measured state.",
)
@set_option
@reading
@levels_option("--measured", f"Sensors and their noise per sample, {LEVELS}; standard ones by default.")
@estimate_option(", 'none' for none")
@levels_option("--noise", "Process noise of states and parameters, 'r=0.01 deg/s^1.5,K=1e-4 1/s'.")
@levels_option("--initial", "Standard deviations of the first estimates, 'K=0.02 1/s,psi=2 deg'.")
@levels_option("--start", "First estimates, 'K=0.05 1/s'; the ship's values by default.")
@levels_option("--rates", "How often a sensor is read, 'x=2 s,y=2 s'.")
@click.option(
    "--input", "inputs", multiple=True, metavar="NAME=VALUE", help="A constant input, as in cruise='9.5 m/s'."
)
@click.option(
    "--gate", default=5.0, show_default=True, help="Innovations beyond this many standard deviations are rejected."
)
@click.option(
    "--follow",
    metavar="FILE",
    help="Read samples as they arrive, one line a sample ('-': standard input), and write estimates.",
)
@click.option(
    "--wait",
    type=NumberWithUnit("s"),
    default="5 s",
    show_default=True,
    help="With --follow FILE: end when no line has come for this time.",
)
@delivered(_ESTIMATES, RESULT, REPORT)
def filter_trial(
    trial: str | None,
    model: str,
    ships: tuple[str, ...],
    method: str,
    values: dict[str, str],
    read: TrialReader,
    measured: dict[str, str] | None,
    estimate: list[str] | None,
    noise: dict[str, str] | None,
    initial: dict[str, str] | None,
    start: dict[str, str] | None,
    rates: dict[str, str] | None,
    inputs: tuple[str, ...],
    gate: float,
    follow: str | None,
    wait: str,
    delivery: Delivery,
) -> ExitCode:
    """Filter a trial with an extended Kalman filter generated from a model.

    Models made for filtering are yaw-filter, position-filter and own-ship-filter; any other model works too. Prints the last
    estimates with their intervals, and whether the innovations are as large as their predicted variance, and white. With --out, a
    table of the estimates against time, the result, and a report. With --follow, a log is read line by line as it is written: a
    table with a header, one that --format describes, or NMEA 0183; each sample gives a line of estimates.

    \b
    shipid filter trial.csv --model nomoto --ship soesterberg --out filtered
    shipid filter trial.csv --model yaw-filter --ship ship.toml --measured 'psi=0.2 deg,r=0.02 deg/s'
    shipid filter --follow live.nmea --model yaw-filter --ship ship.toml
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.estimation.settings.defaults import parameters_to_estimate
    from shipid.foundation.errors import UsageError
    from shipid.parameters.catalogue import find_model

    if (trial is None) == (follow is None):
        raise UsageError("give a TRIAL to filter, or --follow FILE for samples as they arrive, and not both.")
    if follow is not None and delivery.folder is not None:
        raise UsageError("--follow writes estimates to standard output as they are made; redirect it instead of --out.")
    if method != "ekf" and (follow is not None or rates is not None):
        raise UsageError(f"method {method} takes a whole record, each sample of it: leave --follow and --rates out.")
    if method == "imm" and (estimate is not None or follow is not None):
        raise UsageError("method imm compares ships as they are, on a whole record: leave --estimate and --follow out.")
    if (method == "imm") != (len(ships) > 1):
        raise UsageError(
            "several ships are compared by --method imm, and it needs two or more: --ship LOADED --ship BALLAST."
        )
    found = find_model(model)
    every = ships_given(ships, values, found)
    known = every[0] if every else optional_ship_given(None, values)
    names = parameters_to_estimate(found) if estimate is None else () if estimate == ["none"] else tuple(estimate)
    settings: dict[str, Plain] = {
        "noise": noise or {},
        "initial": initial or {},
        "start": start or {},
        "inputs": assignments(inputs),
    }
    if method == "imm":
        return _which_ship(read, str(trial), found, every, measured, settings, delivery)
    if method != "ekf":
        settings["estimate"] = None if estimate is None else names
        del settings["inputs"]
        given = assignments(inputs)
        return _recursively(read, str(trial), found, known, method, measured, given, settings, delivery)
    settings |= {"estimated": names, "rates": rates or {}, "gate": gate or None}
    if follow is not None:
        from shipid.cli.frame.following import follow as run_follow

        return run_follow(follow, found, known, measured, settings, read.format, wait, delivery)
    with delivery.progress() as tell:
        tell("reading")
        record = read(str(trial))
        return _filter(found, known, record, measured, settings, delivery, tell)


def _filter(
    model: Model,
    ship: ParameterSet | None,
    record: Trial,
    measured: dict[str, str] | None,
    settings: dict[str, Plain],
    delivery: Delivery,
    tell: Callable[[str], None],
) -> ExitCode:
    """Run the extended Kalman filter over a record, with noise levels from it where none are given."""
    from shipid.estimation.by_record import filter_by_record
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.records.observability import observability
    from shipid.generation.reduction import reduced
    from shipid.identification.beside_filter import beside_filter
    from shipid.identification.uncertainty.amplitudes import beyond_of_record

    sensors = _sensors(model, record) if measured is None else measured
    # A position that no sensor measures is dead reckoning, not an estimate.
    kalman = ExtendedKalmanFilter(reduced(model, tuple(sensors)), ship, measured=sensors, **settings)
    # What the user gave stays, and so does what a model declares to drive its states. What drives an input, such as waves, is of
    # the day and not of the model: it is found.
    kept = [f"sensor:{n}" for n in measured or ()]
    given = settings["noise"]
    kept += [
        f"noise:{s.name}" for s in kalman.design.sources if not s.assumed and (s.place == "state" or s.name in given)
    ]

    def identified() -> BatchEstimate | None:
        # With constants in place of columns it would be another record.
        if settings["inputs"]:
            return None
        signals = None if measured is None else [kalman.design.instruments.quantity_of(n) for n in measured]
        return beside_filter(model, record, ship, tuple(kalman.design.parameters), signals)

    run, levels = filter_by_record(kalman, record, kept, tell, identified)
    for notice in beyond_of_record(model, ship, record, kalman.design.instruments.inputs):
        warn(notice)
    seen = observability(run)
    for message in seen.messages:
        warn(message)
    said = [*levels.words, *(f"{'WARNING' if n.serious else 'note'}: {n}" for n in run.warnings)]
    return delivery.hand_over_parts(
        run.to_dict() | levels.to_dict() | {"observability": seen.to_dict()},
        "\n".join([run.text(), *(f"  {sentence}" for sentence in said)]),
        {
            _ESTIMATES: delivery.table(run),
            REPORT: delivery.report(seen),
        },
    )


def _sensors(model: Model, record: Trial) -> Mapping[str, Amount | None]:
    """What of a record a filter of a model takes where nothing is named: standard sensors, and own states that were logged."""
    from shipid.estimation.settings.defaults import own_sensors, standard_sensors

    columns = {name: record[name] for name in record.table.columns}
    return standard_sensors(model, tuple(columns)) | own_sensors(model, columns)


def _recursively(
    read: TrialReader,
    trial: str,
    model: Model,
    ship: ParameterSet | None,
    method: str,
    measured: dict[str, str] | None,
    given: dict[str, str],
    settings: dict[str, Plain],
    delivery: Delivery,
) -> ExitCode:
    """Run one of the family of recursive identification over a record."""
    from shipid.estimation.settings.instruments import read_inputs
    from shipid.identification.recursive.identifier import identify_recursively
    from shipid.identification.uncertainty.amplitudes import beyond_of_record

    with delivery.progress() as tell:
        record = read(trial)
        tell(f"identifying by {method}")
        run = identify_recursively(model, record, ship=ship, method=method, measured=measured, inputs=given, **settings)
    for notice in beyond_of_record(model, ship, record, read_inputs(model, given)):
        warn(notice)
    assert not isinstance(run, list), "one record gives one result"
    for sentence in run.warnings:
        say(sentence)
    return delivery.hand_over(
        run,
        {
            _ESTIMATES: delivery.table(run),
            REPORT: delivery.report(run),
        },
    )


def _which_ship(
    read: TrialReader,
    trial: str,
    model: Model,
    ships: Sequence[ParameterSet],
    measured: dict[str, str] | None,
    settings: dict[str, Plain],
    delivery: Delivery,
) -> ExitCode:
    """Compare parameter sets on a record by a multiple-model filter."""
    from shipid.estimation.multiple.which_ship import which_ship
    from shipid.generation.reduction import reduced

    with delivery.progress() as tell:
        tell("reading")
        record = read(trial)
        sensors = _sensors(model, record) if measured is None else measured
        kept = [f"sensor:{n}" for n in measured or ()] + [f"noise:{n}" for n in settings["noise"]]
        found = which_ship(
            reduced(model, tuple(sensors)),
            ships,
            record,
            measured=sensors,
            kept=kept,
            tell=tell,
            **settings,
        )
    return delivery.hand_over_parts(
        found.to_dict(),
        "\n".join([found.text(), *(f"  {sentence}" for sentence in found.levels.words)]),
        {
            _ESTIMATES: delivery.table(found.run),
            REPORT: delivery.report(found),
        },
    )
