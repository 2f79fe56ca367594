"""``shipid identify``: from trials to an identified ship, with its report."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.messages import say
from shipid.cli.frame.options import (
    LEVELS,
    TrialReader,
    Variadic,
    estimate_option,
    input_option,
    levels_option,
    model_given,
    model_option,
    optional_ship_given,
    reading,
    seed_option,
    set_option,
    ship_option,
    starts_option,
    trials_argument,
    validate_option,
)
from shipid.cli.frame.typed import assignments, names_of
from shipid.foundation.exit_codes import ExitCode
from shipid.identification.methods import LOSSES, METHODS, PURPOSES, Loss, Method, Purpose

if TYPE_CHECKING:
    from shipid.criteria.criteria import Criteria
    from shipid.identification.fit import Fit

_SHIP = "ship.toml"
#: Draws for the bands of the criteria: five manoeuvres to both sides for each of them, for a page that is to be quick.
_DRAWS = 12


@click.command(cls=Variadic)
@trials_argument
@model_option
@ship_option()
@reading
@estimate_option()
@click.option(
    "--fix", multiple=True, metavar="NAME=VALUE", help="Hold a coefficient, with its unit: n3='0.4 s^2/deg^2'."
)
@set_option
@input_option
@validate_option
@click.option("--signals", metavar="a,b,..", help="Signals to fit: psi, r, u, v, x, y. By default what is measured.")
@levels_option("--noise", f"Noise levels of the signals, {LEVELS}; estimated by default.")
@click.option(
    "--for",
    "purpose",
    type=click.Choice(list(PURPOSES)),
    help="Prediction is the default; filter finds noise levels for a Kalman filter as well.",
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
    help="Loss of a residual: its square, or one that grows more slowly, for logs with outliers.",
)
@click.option("--posterior", metavar="N", type=click.IntRange(1), help="Sample the posterior: N draws (needs emcee).")
@click.option("--no-check", is_flag=True, help="Do not check the trials first.")
@click.option("--no-rudder-bias", is_flag=True, help="Take the rudder angle as exact: no bias in each trial.")
@starts_option
@seed_option("the random starting points")
@delivered(RESULT, _SHIP, REPORT)
def identify(
    trials: tuple[str, ...],
    model: str,
    ship: str | None,
    read: TrialReader,
    estimate: list[str] | None,
    fix: tuple[str, ...],
    values: dict[str, str],
    inputs: dict[str, str],
    validate: tuple[str, ...],
    signals: str | None,
    noise: dict[str, str] | None,
    purpose: Purpose | None,
    method: Method | None,
    loss: Loss,
    posterior: int | None,
    no_check: bool,
    no_rudder_bias: bool,
    starts: int,
    seed: int,
    delivery: Delivery,
) -> int:
    """Identify a model from one trial or several, jointly.

    Writes result.json, ship.toml (a parameter set every later command takes as --ship) and report.html into DIR.

    \b
    shipid identify zigzag.csv --model norrbin --ship zeefakkel --out result --open
    shipid identify first.csv second.csv --model de-keizer --ship ship.toml --validate turn.csv --out result
    shipid identify log.csv@1622:1712 --format log.toml --model nomoto --fix tau='20 s'
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    found = model_given(model, inputs)
    known = optional_ship_given(ship, values, found)
    with delivery.progress() as tell:
        # Before the machinery is loaded: a trial that cannot be used is told at once.
        read_trials, predicted = [read(t) for t in trials], [read(t) for t in validate]
        from shipid.identification.assess import assess
        from shipid.identification.identify import identify as run_identify
        from shipid.parameters.parameter_file import write_parameter_set

        fit = run_identify(
            found,
            read_trials,
            ship=known,
            estimate=estimate,
            fixed=assignments(fix),
            signals=None if signals is None else names_of(signals),
            noise=noise,
            validate=predicted,
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
        tell("assessing the fit")
        written = delivery.folder is not None
        fit = assess(fit, bands=written or delivery.as_json, findings=not no_check)
        criteria = _criteria(fit) if written else None
    code = delivery.hand_over(
        fit,
        {
            _SHIP: lambda path: write_parameter_set(fit.ship, path),
            REPORT: delivery.report(fit, criteria=criteria),
        },
    )
    if not fit.converged:
        say(f"the search did not converge: {fit.message} What it knows is above; do not use it as a ship.")
        return ExitCode.NO_CONVERGENCE
    return code


def _criteria(fit: Fit) -> Criteria | str | None:
    """Return the manoeuvring criteria of the identified model for its report, or why there are none; None without a length."""
    from shipid.criteria.manoeuvring_criteria import manoeuvring_criteria
    from shipid.foundation.errors import ShipidError

    if fit.ship.particular("L", "m") is None:
        return None
    try:
        return manoeuvring_criteria(fit, draws=_DRAWS)
    except ShipidError as error:
        return str(error)
