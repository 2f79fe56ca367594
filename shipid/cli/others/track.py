"""``shipid track``: the tracks of other ships from the plots of radar, lidar or AIS."""

from __future__ import annotations

import click

from shipid.cli.frame.completing import complete_file
from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.options import format_option, optional_ship_given, set_option, ship_option
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode

_TRACKS = "tracks.csv"
#: As `shipid.encounter.tracking.filters.trackers.NAMES`, which is numeric to import.
_TRACKERS = ("imm", "cv", "fs-aimm", "vs-aimm", "agimm", "alpha-beta")


@click.command()
@click.argument("detections", shell_complete=complete_file)
@click.option(
    "--tracker", type=click.Choice(_TRACKERS), default="imm", show_default=True, help="How targets are taken to move."
)
@ship_option()
@set_option
@click.option(
    "--truth", metavar="FILE", help="True tracks: t, x, y (or lat, lon) and ship. The tracks are then judged."
)
@click.option("--own", metavar="FILE", help="Own ship's path, a trial: for plots that count from her, and for CPA.")
@format_option
@click.option("--position-std", type=NumberWithUnit("m"), help="Standard deviation of a plot along each axis.")
@click.option(
    "--bias-std", type=NumberWithUnit("m"), help="What all plots of a target may be off together; none by default."
)
@click.option(
    "--bearing-bias-std", type=NumberWithUnit("deg"), help="What all bearings may be off together; none by default."
)
@click.option("--latency", type=NumberWithUnit("s"), help="How old a plot is at its time stamp; none by default.")
@click.option("--scan", type=NumberWithUnit("s"), help="Time of a scan, where plots come one by one; found by default.")
@click.option("--nearest", is_flag=True, help="Assign each plot to the nearest track: quicker, and worse in clutter.")
@delivered(RESULT, _TRACKS, REPORT)
def track(
    detections: str,
    tracker: str,
    ship: str | None,
    values: dict[str, str],
    truth: str | None,
    own: str | None,
    format_: str | None,
    position_std: str | None,
    bias_std: str | None,
    bearing_bias_std: str | None,
    latency: str | None,
    scan: str | None,
    nearest: bool,
    delivery: Delivery,
) -> ExitCode:
    """Track other ships: from plots with clutter and without names to tracks with course, speed and closest approach.

    DETECTIONS is a table with t and range, bearing (or relative_bearing) or x, y or lat, lon, each with its unit; a log of
    NMEA 0183 with TTM or AIS; or what a format file describes: columns or JSON keys, sensors, the truth. A track that is not sure
    any longer says that it is lost.

    \b
    shipid track plots.csv --own trial.csv
    shipid track radar.nmea --tracker vs-aimm --out tracks
    shipid track detections.json --format studies/formats/autoferry.toml --truth groundTruth.json
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.encounter.plots.read_plots import read_detections
    from shipid.encounter.tracking.track import track as run
    from shipid.encounter.tracking.tracker import TrackerSettings

    with delivery.progress() as tell:
        tell("reading")
        known = optional_ship_given(ship, values)
        found = read_detections(
            detections,
            format=format_,
            own=own,
            truth=truth,
            sensor_values=_given(
                position_std=(position_std, "m"),
                bias_std=(bias_std, "m"),
                bearing_bias_std=(bearing_bias_std, "rad"),
                latency=(latency, "s"),
                period=(scan, "s"),
            ),
        )
        tell("tracking")
        result = run(
            found, tracker, ship=known, settings=TrackerSettings(association="nearest" if nearest else "joint")
        )
    return delivery.hand_over(
        result,
        {
            _TRACKS: delivery.table(result),
            REPORT: delivery.report(result),
        },
    )


def _given(**options: tuple[str | None, str]) -> dict[str, float]:
    """What the command line says of the sensors, SI."""
    from shipid.declaration.units import to_si

    return {name: to_si(text, unit, name) for name, (text, unit) in options.items() if text is not None}
