"""``shipid tune``: a gain-scheduled autopilot and its tuning report, or two tunings side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.completing import complete_model
from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, delivered
from shipid.cli.frame.options import (
    input_option,
    levels_option,
    model_given,
    seed_option,
    set_option,
    ship_given,
    ship_option,
)
from shipid.cli.frame.quantities import NumberWithUnit
from shipid.foundation.exit_codes import ExitCode

if TYPE_CHECKING:
    from shipid.autopilot.course_changes.weather import Weather
    from shipid.autopilot.design.autopilot import Autopilot, Design, Mode
    from shipid.autopilot.judgement.judgement import Judgement
    from shipid.autopilot.on_board.on_board_runs import Adaptation, OnBoardRuns

_SCHEDULE = "schedule.toml"


@click.command()
@click.argument("model", required=False, shell_complete=complete_model)
@ship_option(several="for load conditions")
@set_option
@input_option
@click.option("--speeds", metavar="A:B:STEP", help="With the unit: '4:12:1 m/s'; or a list, '8,12,16 kn'.")
@click.option(
    "--design",
    metavar="pid|pole|lqr",
    help="How the gains are found: poles placed with an integral, which wind needs (default for a course); poles placed; least cost.",
)
@click.option("--mode", default="course", show_default=True, metavar="course|rate", help="What the autopilot holds.")
@click.option(
    "--omega-n",
    type=NumberWithUnit("rad/s"),
    help="Natural frequency at the ship's own speed, as in '0.05 rad/s'; it follows the speed.",
)
@click.option("--zeta", type=float, metavar="Z", help="Damping ratio; 0.9 by default.")
@click.option("--integral", type=float, metavar="R", help="For pid: the third pole over the natural frequency.")
@click.option("--rudder-weight", type=float, metavar="W", help="For lqr: weight of the rudder against the heading.")
@click.option(
    "--rudder-limit",
    type=NumberWithUnit("deg"),
    default="15 deg",
    show_default=True,
    help="Largest rudder angle the autopilot orders.",
)
@click.option(
    "--wind",
    type=NumberWithUnit("m/s"),
    help="Wind of the judgement, from eight directions, as in '15 m/s'; by the ship's length.",
)
@click.option(
    "--sea",
    metavar="S",
    help="Waves of the judgement: heading rms of the ship at rest, with frequency or period, '0.3 deg at 9 s'.",
)
@click.option("--current", type=NumberWithUnit("m/s"), help="Current of the judgement, across the wind, as in '1 m/s'.")
@levels_option("--limits", "Limits of the judgement, 'disk margin=0.6,phase margin=40 deg,overshoot=0.05'.")
@click.option(
    "--samples", default=200, type=click.IntRange(0), show_default=True, help="Ships drawn from the uncertainty."
)
@seed_option("the draws and the waves")
@click.option(
    "--on-board", metavar="FILTER", help="Run it with this Kalman filter in the loop too: yaw-filter, or FILE.py:NAME."
)
@click.option(
    "--adapt", metavar="none|gains|reference", help="With --on-board: what follows the filter's estimates of the ship."
)
@click.option("--compare", nargs=2, metavar="A.toml B.toml", help="Put two schedules side by side instead.")
@delivered(RESULT, _SCHEDULE, REPORT, instead={"compare": (RESULT, REPORT)})
def tune(
    model: str | None,
    ships: tuple[str, ...],
    values: dict[str, str],
    inputs: dict[str, str],
    speeds: str | None,
    design: Design | None,
    mode: Mode,
    omega_n: str | None,
    zeta: float | None,
    integral: float | None,
    rudder_weight: float | None,
    rudder_limit: str,
    wind: str | None,
    sea: str | None,
    current: str | None,
    limits: dict[str, str] | None,
    samples: int,
    seed: int,
    on_board: str | None,
    adapt: Adaptation | None,
    compare: tuple[str, str] | None,
    delivery: Delivery,
) -> ExitCode:
    """Tune an autopilot for a ship: gains against speed, margins, robustness, course changes, and a report.

    The ship.toml of ``shipid identify`` holds the covariance of its coefficients, over which the robustness is worked out. Weather
    and limits that are not given are those of this project, in proportion to the ship.

    \b
    shipid tune de-keizer --ship soesterberg --out tuning
    shipid tune norrbin --ship ship.toml --speeds '4:10:1 kn' --wind '15 m/s' --limits 'disk margin=0.6' --out tuning
    shipid tune --compare first/schedule.toml second/schedule.toml
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.autopilot.design.design_autopilot import INTEGRAL, RUDDER_WEIGHT, default_design, design_autopilot
    from shipid.autopilot.design.write_schedule import write_schedule
    from shipid.autopilot.on_board.run_on_board import run_on_board
    from shipid.foundation.errors import UsageError
    from shipid.parameters.catalogue import names_a_file

    asked = _Asked(samples, seed, wind, sea, current, limits or {})
    if compare is not None:
        if (model is not None and not names_a_file(model)) or ships or on_board is not None or values or inputs:
            raise UsageError(
                "--compare reads two schedules, which hold their model and ship: leave MODEL, --ship, --set, --input and --on-board out. Only a "
                "model file is given, as FILE.py:NAME."
            )
        return _compare(compare, model, asked, delivery)
    if model is None or not ships:
        raise UsageError("tune needs a MODEL and a --ship, or --compare with two schedules. See shipid tune --help.")
    if adapt is not None and on_board is None:
        raise UsageError("--adapt says what follows the estimates of a filter: give the filter by --on-board.")
    # A filter adapts two poles: its design is that of two poles, unless another is asked for.
    design = design or ("pole" if adapt not in (None, "none") else default_design(mode))
    for name, value, its in (("--integral", integral, "pid"), ("--rudder-weight", rudder_weight, "lqr")):
        if value is not None and design != its:
            raise UsageError(f"{name} belongs to --design {its}; leave it out, or ask for that design.")
    found = model_given(model, inputs)
    pilot = design_autopilot(
        found,
        [ship_given(s, values, found) for s in ships],
        speeds=speeds,
        design=design,
        mode=mode,
        omega_n=omega_n,
        damping=zeta,
        rudder_limit=rudder_limit,
        integral=INTEGRAL if integral is None else integral,
        rudder_weight=RUDDER_WEIGHT if rudder_weight is None else rudder_weight,
    )
    with delivery.progress() as tell:
        runs = None
        if on_board is not None:
            runs = run_on_board(
                pilot, on_board, adaptation=adapt or "none", weather=asked.weather(pilot), seed=seed, progress=tell
            )
        judged = asked.judgement(pilot, tell, runs)
    return delivery.hand_over(
        judged,
        {
            _SCHEDULE: lambda path: write_schedule(judged.pilot, path, model),
            REPORT: delivery.report(judged),
        },
    )


@dataclass(frozen=True)
class _Asked:
    """How a design is judged, as the command line says it."""

    samples: int
    seed: int
    wind: str | None
    sea: str | None
    current: str | None
    limits: Mapping[str, str]

    def weather(self, pilot: Autopilot) -> Weather:
        """Return the weather for a ship: what is not stated is in proportion to it."""
        from shipid.autopilot.course_changes.weather import standard_weather, stated_weather

        usual = standard_weather(pilot.length, pilot.service_speed)
        return stated_weather(usual, wind=self.wind, sea=self.sea, current=self.current)

    def judgement(
        self, pilot: Autopilot, tell: Callable[[str], object], on_board: OnBoardRuns | None = None
    ) -> Judgement:
        """Judge a design."""
        from shipid.autopilot.judgement.judge import judge

        return judge(
            pilot,
            self.samples,
            self.seed,
            weather=self.weather(pilot),
            limits=self.limits,
            on_board=on_board,
            progress=tell,
        )


def _compare(files: tuple[str, str], model: str | None, asked: _Asked, delivery: Delivery) -> ExitCode:
    from shipid.autopilot.judgement.compare_tunings import compare_tunings

    pilots = [_read(f, model) for f in files]
    with delivery.progress() as tell:
        first, second = (asked.judgement(p, tell) for p in pilots)
        found = compare_tunings(first, second, _names(files))
    return delivery.hand_over(found, {REPORT: delivery.report(found)})


def _read(file: str, model: str | None) -> Autopilot:
    """Read a schedule; where it names no model that is installed, it belongs to the model file of the command line."""
    from shipid.autopilot.design.read_schedule import read_schedule
    from shipid.autopilot.errors import ModelFileError
    from shipid.foundation.errors import UnknownNameError

    try:
        return read_schedule(file)
    except (ModelFileError, UnknownNameError):
        if model is None:
            raise
        return read_schedule(file, model)


def _names(files: tuple[str, str]) -> tuple[str, str]:
    """What the two are called: their files, with the folder where the files are called alike."""
    first, second = (Path(f) for f in files)
    if first.name != second.name:
        return first.name, second.name
    return str(first), str(second)
