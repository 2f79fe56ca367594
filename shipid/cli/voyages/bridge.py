"""``shipid bridge``: the live bridge page of a ship that is simulated, replayed or listened to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import output_file, overwrite_option
from shipid.cli.frame.messages import say
from shipid.cli.frame.options import (
    format_option,
    input_option,
    optional_model_option,
    seed_option,
    set_option,
    ship_option,
)
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.bridge.bridge_settings import BridgeSettings


@click.command()
@ship_option(required=False)
@optional_model_option
@set_option
@input_option
@click.option(
    "--schedule", metavar="FILE", help="The autopilot, a schedule.toml of shipid tune; one is designed by default."
)
@click.option(
    "--source",
    default="simulate",
    show_default=True,
    metavar="S",
    help="simulate, replay:TRIAL, nmea:udp:PORT, nmea:tcp:HOST:PORT or signalk:URL.",
)
@format_option
@click.option("--route", metavar="FILE", help="Planned route: RTZ, or CSV with units in its header.")
@click.option("--chart", metavar="FILE", help="Chart behind it: an S-57 cell or GeoJSON; with a --route on the earth.")
@click.option("--scenario", metavar="T1..T6", help="Sail a track of the tracking experiment of Passenier (1989).")
@click.option(
    "--condition",
    metavar="A|B|C|D",
    help="Of the experiment: planned track; ground-speed vector; predictor (the default); track pilot.",
)
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="Address to serve at: 0.0.0.0 for a tablet too, with a token.",
)
@click.option("--port", default=8000, show_default=True, type=click.IntRange(0, 65535), help="Port; 0 for any.")
@click.option("--token", metavar="TEXT", help="What the page has to show; made up where another host is served.")
@click.option("--record", metavar="FILE", help="Trial file (CSV) that every sample is added to.")
@overwrite_option
@click.option(
    "--clock-factor",
    default=1.0,
    show_default=True,
    type=click.FloatRange(0.1, 1000),
    help="Simulated or replayed seconds a second.",
)
@click.option("--filter-interval", type=NumberWithUnit("s"), default="0.4 s", show_default=True, help="Of the filter.")
@click.option(
    "--prediction-interval", type=NumberWithUnit("s"), default="2 s", show_default=True, help="Of the predictor."
)
@click.option("--current", metavar="C", help="Of the simulation, as in '3 kn to 30 deg' (or 'from').")
@click.option("--wind", metavar="W", help="Of the simulation, as in '10 m/s from 270 deg' (or 'to').")
@click.option("--waves", metavar="W", help="Of the simulation: yaw that the instruments show, '0.5 deg from 300 deg'.")
@seed_option("the noise of the simulated sensors")
def bridge(
    ship: str | None,
    model: str | None,
    values: dict[str, str],
    inputs: dict[str, str],
    schedule: str | None,
    source: str,
    format_: str | None,
    route: str | None,
    chart: str | None,
    scenario: str | None,
    condition: str | None,
    host: str,
    port: int,
    token: str | None,
    record: str | None,
    overwrite: bool,
    clock_factor: float,
    filter_interval: str,
    prediction_interval: str,
    current: str | None,
    wind: str | None,
    waves: str | None,
    seed: int,
) -> ExitCode:
    """Open the bridge page of a ship: her planned track, her past one and her predicted one. NOT FOR NAVIGATION.

    The page is served to this machine only, unless --host names another of its addresses (0.0.0.0: all), and steers nothing but its
    simulator. Ctrl-C ends it.

    \b
    shipid bridge
    shipid bridge --ship kvlcc2 --record voyage.csv
    shipid bridge --wind '10 m/s from 270 deg' --waves '0.5 deg from 300 deg'
    shipid bridge --source nmea:udp:10110 --format nmea.toml
    shipid bridge --scenario T1 --condition C
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.bridge.bridge_settings import BridgeSettings
    from shipid.trials.manoeuvres.flows import flow_of

    return _open(
        BridgeSettings(
            ship=ship,
            model=model,
            schedule=schedule,
            source=source,
            format=format_,
            route=route,
            chart=chart,
            scenario=scenario,
            condition=condition,
            record=None if record is None else output_file(record, overwrite),
            clock_factor=clock_factor,
            filter_interval=_interval(filter_interval, "--filter-interval"),
            prediction_interval=_interval(prediction_interval, "--prediction-interval"),
            current=flow_of(current, "current"),
            wind=flow_of(wind, "wind"),
            waves=flow_of(waves, "waves", "rad"),
            seed=seed,
            values=tuple(values.items()),
            inputs=tuple(inputs.items()),
        ),
        host,
        port,
        token,
    )


def _interval(text: str, option: str) -> float:
    """Seconds from 0.01 to 60: neither a filter nor a page runs at another pace."""
    from shipid.declaration.units import to_si
    from shipid.foundation.errors import UsageError

    seconds = to_si(text, "s", option)
    if not 0.01 <= seconds <= 60:
        raise UsageError(f"{option} is {seconds:g} s; it lies between 0.01 and 60 s.")
    return seconds


def _open(settings: BridgeSettings, host: str, port: int, token: str | None) -> ExitCode:
    """Serve the page until a signal comes; everything that can be refused is refused before."""
    import signal

    from shipid.bridge.open_bridge import open_bridge

    with open_bridge(settings, host, port, token, lambda score: click.echo(score.text())) as opened:
        for note in opened.notes:
            say(note)
        came = opened.serve(
            lambda: say(
                f"the bridge of {opened.ship} ({opened.source}): {opened.address}\nNOT FOR NAVIGATION. Ctrl-C ends it."
            )
        )
    if opened.score is not None and not opened.score.done:
        click.echo(opened.score.text())
    recorded = "" if opened.recording is None else f" The recording is {opened.recording}."
    say(f"the bridge has ended.{recorded}")
    if came == signal.SIGINT:
        return ExitCode.INTERRUPTED
    return ExitCode.TERMINATED if came == signal.SIGTERM else ExitCode.DONE
