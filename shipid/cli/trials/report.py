"""``shipid report``: the sheet of a trial day, without a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.options import TrialReader, optional_ship_given, reading, set_option, ship_option, trials_argument
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.trials.conditions import Conditions


@click.command()
@trials_argument
@reading
@ship_option()
@set_option
@click.option(
    "--length", type=NumberWithUnit("m"), help="Ship length, as in '320 m'; of the conditions or the ship by default."
)
@click.option(
    "--conditions",
    metavar="FILE",
    help="TOML file with a table [trial]: ship, loading, depth, wind, who. By default that of the format file.",
)
@delivered(RESULT, REPORT)
def report(
    trials: tuple[str, ...],
    read: TrialReader,
    ship: str | None,
    values: dict[str, str],
    length: str | None,
    conditions: str | None,
    delivery: Delivery,
) -> ExitCode:
    """Report a trial day: every manoeuvre of the logs measured, and the values beside the limits of IMO MSC.137(76).

    No model is needed. The page has the plots of the manoeuvres, a table for the wheelhouse poster, and the record of the trial with
    a blank for whatever was not stated; it prints as a sheet.

    \b
    shipid report zigzag.csv turn.csv --length '175 m' --out sheet --open
    shipid report day/ --format logger.toml --conditions day.toml --out sheet
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.criteria.measured.trial_sheet import trial_sheet

    stated = _conditions(conditions)
    known = optional_ship_given(ship, values)
    with delivery.progress() as tell:
        sheet = trial_sheet(trials, length=length, ship=known, conditions=stated, reader=read, tell=tell)
    return delivery.hand_over(sheet, {REPORT: delivery.report(sheet)})


def _conditions(file: str | None) -> Conditions | None:
    from shipid.trials.conditions import conditions_of
    from shipid.trials.logs.format import read_format_table

    return None if file is None else conditions_of(read_format_table(file).table("trial"))
