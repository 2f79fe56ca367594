"""``shipid measure``: the numbers of a manoeuvre."""

from __future__ import annotations

import click

from shipid.cli.delivery import Delivery, delivered
from shipid.cli.options import TrialReader, reading
from shipid.foundation.aliases import Plain


@click.command()
@click.argument("trial")
@reading
@click.option("--kind", type=click.Choice(["zig-zag", "turning circle"]), help="Found from the trial by default.")
@click.option("--length", metavar="L", help="Ship length, as in '320 m', for the ratios to it.")
@delivered()
def measure(trial: str, read: TrialReader, kind: str | None, length: str | None, delivery: Delivery) -> None:
    """Measure a zig-zag or a turning circle in the terms of ITTC and IMO."""
    from shipid.declaration.units import to_si
    from shipid.foundation.errors import UsageError
    from shipid.trials.measuring.measure import measure as run_measure

    if length is not None and not to_si(length, "m", "the ship length") > 0:
        raise UsageError(f"a ship length of {length} has no ratios to it: give one greater than zero.")
    measured = run_measure(read(trial), kind, length=length)
    flat: dict[str, Plain] = {"kind": measured.kind, "trial": measured.trial, "execute": measured.execute}
    flat |= {n: getattr(measured, n) for n in ("nominal", "first_side", "side", "track") if hasattr(measured, n)}
    for name, value, unit, _ in measured.quantities():
        key = name if unit == "1" else f"{name}_{unit.replace('/', '_')}"
        flat[key] = list(value) if isinstance(value, tuple) else value
    delivery.hand_over_parts(flat, repr(measured))
