"""``shipid tune``: a gain-scheduled autopilot and its tuning report, or two tunings side by side."""

from __future__ import annotations

from pathlib import Path

import click

from shipid.cli.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.options import seed_option, ship_option
from shipid.foundation.aliases import Plain

_SCHEDULE = "schedule.toml"


@click.command()
@click.argument("model", required=False)
@ship_option(several="for load conditions")
@click.option("--speeds", metavar="A:B:STEP", help="Or a list; in m/s unless it names a unit: 4:12:1, '8,12,16 kn'.")
@click.option("--design", default="pole", show_default=True, metavar="pole|lqr|pid", help="How the gains are found.")
@click.option(
    "--omega-n", metavar="W", help="Natural frequency in rad/s at the ship's own speed; it follows the speed."
)
@click.option("--zeta", type=float, metavar="Z", help="Damping ratio; 0.9 by default.")
@click.option("--integral", type=float, metavar="R", help="For pid: the third pole over the natural frequency.")
@click.option("--rudder-weight", type=float, metavar="W", help="For lqr: weight of the rudder against the heading.")
@click.option("--rudder-limit", default="15 deg", show_default=True, help="Largest rudder angle the autopilot orders.")
@click.option(
    "--samples", default=200, type=click.IntRange(0), show_default=True, help="Ships drawn from the uncertainty."
)
@seed_option("the draws and the waves")
@click.option("--compare", nargs=2, metavar="A.toml B.toml", help="Put two schedules side by side instead.")
@delivered(RESULT, _SCHEDULE, REPORT, instead={"compare": (RESULT, REPORT)})
def tune(
    model: str | None,
    ships: tuple[str, ...],
    speeds: str | None,
    design: str,
    omega_n: str | None,
    zeta: float | None,
    integral: float | None,
    rudder_weight: float | None,
    rudder_limit: str,
    samples: int,
    seed: int,
    compare: tuple[str, str] | None,
    delivery: Delivery,
) -> None:
    """Tune an autopilot for a ship: gains against speed, margins, robustness, course changes, and a report.

    The ship.toml of ``shipid identify`` holds the covariance of its coefficients, over which the robustness is worked out.
    """
    from shipid.autopilot.design.design_autopilot import design_autopilot
    from shipid.autopilot.design.schedule_file import write_schedule
    from shipid.foundation.errors import UsageError
    from shipid.parameters.catalogue import find_model, find_ship
    from shipid.report.write_report import write_report

    if compare is not None:
        if model is not None or ships:
            raise UsageError(
                "--compare reads two schedules, which hold their model and ship: leave MODEL and --ship out."
            )
        _compare(compare, samples, seed, delivery)
        return
    if model is None or not ships:
        raise UsageError("tune needs a MODEL and a --ship, or --compare with two schedules. See shipid tune --help.")
    for name, value, its in (("--integral", integral, "pid"), ("--rudder-weight", rudder_weight, "lqr")):
        if value is not None and design != its:
            raise UsageError(f"{name} belongs to --design {its}; leave it out, or ask for that design.")
    chosen: dict[str, Plain] = {"integral": integral, "rudder_weight": rudder_weight}
    pilot = design_autopilot(
        find_model(model),
        [find_ship(s) for s in ships],
        speeds=speeds,
        design=design,
        omega_n=_frequency(omega_n),
        damping=zeta,
        rudder_limit=rudder_limit,
        **{name: value for name, value in chosen.items() if value is not None},
    )
    with delivery.progress() as tell:
        judged = pilot.judge(samples=samples, seed=seed, progress=tell)
    delivery.hand_over(
        judged,
        {
            _SCHEDULE: lambda path: write_schedule(judged.pilot, path, model),
            REPORT: lambda path: write_report(judged, path),
        },
    )


def _frequency(text: str | None) -> str | float | None:
    """The option counts in rad/s; another unit may be named."""
    try:
        return None if text is None else float(text)
    except ValueError:
        return text


def _compare(files: tuple[str, str], samples: int, seed: int, delivery: Delivery) -> None:
    from shipid.autopilot.design.schedule_file import read_schedule
    from shipid.autopilot.judgement.compare_tunings import compare_tunings
    from shipid.report.write_report import write_report

    pilots = [read_schedule(f) for f in files]
    with delivery.progress() as tell:
        first, second = (p.judge(samples=samples, seed=seed, progress=tell) for p in pilots)
        found = compare_tunings(first, second, _names(files))
    delivery.hand_over(found, {REPORT: lambda path: write_report(found, path)})


def _names(files: tuple[str, str]) -> tuple[str, str]:
    """What the two are called: their files, with the folder where the files are called alike."""
    first, second = (Path(f) for f in files)
    if first.name != second.name:
        return first.name, second.name
    return str(first), str(second)
