"""``shipid measure``: the numbers of a manoeuvre."""

from __future__ import annotations

import click

from shipid.cli.frame.delivery import Delivery, delivered
from shipid.cli.frame.options import TrialReader, reading
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode

_KINDS = ("zig-zag", "turning circle", "spiral", "pull-out")
_READINGS = ("order", "moved")


@click.command()
@click.argument("trial")
@reading
@click.option("--kind", type=click.Choice(_KINDS), help="Found from the trial by default.")
@click.option("--manoeuvre", metavar="N", type=click.IntRange(1), help="Which one, of a log that holds several.")
@click.option(
    "--execute", type=click.Choice(_READINGS), default="order", show_default=True,
    help="The order, read back from the ramp of the rudder where it is not logged; or the rudder 15 % off the angle it held.",
)  # fmt: skip
@click.option("--length", type=NumberWithUnit("m"), help="Ship length, as in '320 m', for the ratios to it.")
@delivered()
def measure(
    trial: str,
    read: TrialReader,
    kind: str | None,
    manoeuvre: int | None,
    execute: str,
    length: str | None,
    delivery: Delivery,
) -> ExitCode:
    """Measure a zig-zag, a turning circle, a spiral or a pull-out in the terms of ITTC and IMO.

    The executes are the orders. What lies in a gap, or where a sensor shows nothing, is not known, and it says why. Exit code 5
    where a serious finding of the doctor misleads the numbers.

    \b
    shipid measure trial.csv
    shipid measure turn.csv --length '45 m'
    shipid measure log.csv --manoeuvre 3
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.declaration.units import to_si
    from shipid.foundation.errors import UsageError
    from shipid.trials.measuring.measure import measure as run_measure

    if length is not None and not to_si(length, "m", "the ship length") > 0:
        raise UsageError(f"a ship length of {length} has no ratios to it: give one greater than zero.")
    measured = run_measure(read(trial), kind, execute=execute, length=length, manoeuvre=manoeuvre)
    return delivery.hand_over(measured)
