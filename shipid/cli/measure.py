"""``shipid measure``: the numbers of a manoeuvre."""

from __future__ import annotations

from typing import Any

import click

from shipid.cli.shared import format_option, json_option, print_json, read, window_of


@click.command()
@click.argument("trial")
@format_option
@click.option("--window", metavar="A:B", help="Seconds of the trial's own clock. A trial may carry its own: FILE@A:B.")
@click.option("--kind", type=click.Choice(["zig-zag", "turning circle"]), help="Found out by itself by default.")
@click.option("--length", metavar="L", help="Ship length, as in '320 m', for the ratios to it.")
@json_option
def measure(
    trial: str, format_: str | None, window: str | None, kind: str | None, length: str | None, as_json: bool
) -> None:
    """Measure a zig-zag or a turning circle in the terms of ITTC and IMO."""
    from shipid.declaration.units import to_si
    from shipid.foundation.errors import UsageError
    from shipid.trials.measuring.measure import measure as run_measure

    if length is not None and not to_si(length, "m", "the ship length") > 0:
        raise UsageError(f"a ship length of {length} has no ratios to it: give one greater than zero.")
    measured = run_measure(read(trial, format_, window_of(window)), kind, length=length)
    if not as_json:
        click.echo(repr(measured))
        return
    flat: dict[str, Any] = {"kind": measured.kind, "trial": measured.trial, "execute": measured.execute}
    flat |= {n: getattr(measured, n) for n in ("nominal", "first_side", "side", "track") if hasattr(measured, n)}
    for name, value, unit, _ in measured.quantities():
        key = name if unit == "1" else f"{name}_{unit.replace('/', '_')}"
        flat[key] = list(value) if isinstance(value, tuple) else value
    print_json(flat)
