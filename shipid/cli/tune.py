"""``shipid tune``: a gain-scheduled autopilot and its tuning report, or two tunings side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click

from shipid.cli.folder import fill, result_folder
from shipid.cli.shared import json_option, overwrite_option, print_json, progress_on_stderr, say

if TYPE_CHECKING:
    from collections.abc import Callable

    from shipid.autopilot.design.autopilot import Autopilot, Design, Mode
    from shipid.autopilot.judgement.compare_tunings import TuningComparison
    from shipid.autopilot.judgement.judgement import Judgement
    from shipid.autopilot.on_board.on_board_runs import Adaptation

_FILES = ("result.json", "schedule.toml", "report.html")
_COMPARED = ("result.json", "report.html")


@click.command()
@click.argument("model", required=False)
@click.option(
    "--ship",
    "ships",
    multiple=True,
    metavar="SHIP",
    help="A ship's name, or the path of a parameter set (TOML); several times for load conditions.",
)
@click.option("--speeds", metavar="A:B:STEP", help="Or a list; in m/s unless it names a unit: 4:12:1, '8,12,16 kn'.")
@click.option("--design", default="pole", show_default=True, metavar="pole|lqr|pid", help="How the gains are found.")
@click.option("--mode", default="course", show_default=True, metavar="course|rate", help="What the autopilot holds.")
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
@click.option("--seed", default=0, type=click.IntRange(0), show_default=True, help="Of the draws and the waves.")
@click.option(
    "--on-board", metavar="FILTER", help="Run it with this Kalman filter in the loop too: yaw-filter, or FILE.py:NAME."
)
@click.option(
    "--adapt", metavar="none|gains|reference", help="With --on-board: what follows the filter's estimates of the ship."
)
@click.option("--compare", nargs=2, metavar="A.toml B.toml", help="Put two schedules side by side instead.")
@click.option("--out", metavar="DIR", help="Folder for result.json, schedule.toml and report.html.")
@click.option("--open", "open_report", is_flag=True, help="Open the report in the browser.")
@overwrite_option
@json_option
def tune(
    model: str | None,
    ships: tuple[str, ...],
    speeds: str | None,
    design: str,
    mode: str,
    omega_n: str | None,
    zeta: float | None,
    integral: float | None,
    rudder_weight: float | None,
    rudder_limit: str,
    samples: int,
    seed: int,
    on_board: str | None,
    adapt: str | None,
    compare: tuple[str, str] | None,
    out: str | None,
    open_report: bool,
    overwrite: bool,
    as_json: bool,
) -> int:
    """Tune an autopilot for a ship: gains against speed, margins, robustness, course changes, and a report.

    The ship.toml of ``shipid identify`` holds the covariance of its coefficients, over which the robustness is worked out.
    """
    from shipid.foundation.errors import UsageError

    if compare is not None:
        if model is not None or ships or on_board is not None:
            raise UsageError(
                "--compare reads two schedules, which hold their model and ship: leave MODEL, --ship and --on-board out."
            )
        folder = result_folder(out, _COMPARED, overwrite)
        return _compare(compare, folder, samples, seed, as_json, open_report)
    if model is None or not ships:
        raise UsageError("tune needs a MODEL and a --ship, or --compare with two schedules. See shipid tune --help.")
    if adapt is not None and on_board is None:
        raise UsageError("--adapt says what follows the estimates of a filter: give the filter by --on-board.")
    from shipid.autopilot.judgement.judge import judge
    from shipid.autopilot.on_board.run_on_board import run_on_board

    folder = result_folder(out, _FILES, overwrite)
    pilot = _design(model, ships, speeds, design, mode, omega_n, zeta, integral, rudder_weight, rudder_limit)
    with progress_on_stderr(as_json) as tell:
        voyages = None
        if on_board is not None:
            voyages = run_on_board(
                pilot, on_board, adaptation=cast("Adaptation", adapt or "none"), seed=seed, progress=tell
            )
        judged = judge(pilot, samples, seed, on_board=voyages, progress=tell)
        if folder is not None:
            tell("writing the report")
            _write(judged, folder, model)
    _show(judged, folder, _FILES, as_json, open_report)
    return 0


def _design(
    model: str,
    ships: tuple[str, ...],
    speeds: str | None,
    design: str,
    mode: str,
    omega_n: str | None,
    zeta: float | None,
    integral: float | None,
    rudder_weight: float | None,
    rudder_limit: str,
) -> Autopilot:
    from shipid.autopilot.design.design_autopilot import INTEGRAL, RUDDER_WEIGHT, design_autopilot
    from shipid.foundation.errors import UsageError
    from shipid.parameters.catalogue import find_model, find_ship

    for name, value, its in (("--integral", integral, "pid"), ("--rudder-weight", rudder_weight, "lqr")):
        if value is not None and design != its:
            raise UsageError(f"{name} belongs to --design {its}; leave it out, or ask for that design.")
    return design_autopilot(
        find_model(model),
        [find_ship(s) for s in ships],
        speeds=speeds,
        design=cast("Design", design),
        mode=cast("Mode", mode),
        omega_n=_frequency(omega_n),
        damping=zeta,
        rudder_limit=rudder_limit,
        integral=INTEGRAL if integral is None else integral,
        rudder_weight=RUDDER_WEIGHT if rudder_weight is None else rudder_weight,
    )


def _frequency(text: str | None) -> str | float | None:
    """The option counts in rad/s; another unit may be named."""
    try:
        return None if text is None else float(text)
    except ValueError:
        return text


def _compare(
    files: tuple[str, str], folder: Path | None, samples: int, seed: int, as_json: bool, open_report: bool
) -> int:
    from shipid.autopilot.design.read_schedule import read_schedule
    from shipid.autopilot.judgement.compare_tunings import compare_tunings
    from shipid.autopilot.judgement.judge import judge

    pilots = [read_schedule(f) for f in files]
    with progress_on_stderr(as_json) as tell:
        first, second = (judge(p, samples, seed, progress=tell) for p in pilots)
        found = compare_tunings(first, second, _names(files))
        if folder is not None:
            from shipid.report.write_report import write_report

            fill(folder, {"result.json": _json(found), "report.html": lambda path: write_report(found, path)})
    _show(found, folder, _COMPARED, as_json, open_report)
    return 0


def _names(files: tuple[str, str]) -> tuple[str, str]:
    """What the two are called: their files, with the folder where the files are called alike."""
    first, second = (Path(f) for f in files)
    if first.name != second.name:
        return first.name, second.name
    return str(first), str(second)


def _json(result: Judgement | TuningComparison) -> Callable[[Path], object]:
    text = json.dumps(result.to_dict(), indent=1, allow_nan=False, ensure_ascii=False)
    return lambda path: path.write_text(text + "\n", encoding="utf-8")


def _write(judged: Judgement, folder: Path, model: str) -> None:
    from shipid.autopilot.design.write_schedule import write_schedule
    from shipid.report.write_report import write_report

    fill(
        folder,
        {
            "result.json": _json(judged),
            "schedule.toml": lambda path: write_schedule(judged.pilot, path, model),
            "report.html": lambda path: write_report(judged, path),
        },
    )


def _show(
    result: Judgement | TuningComparison, folder: Path | None, names: tuple[str, ...], as_json: bool, open_report: bool
) -> None:
    if as_json:
        print_json(result.to_dict())
    else:
        click.echo(repr(result))
        if folder is not None:
            click.echo(f"written: {', '.join(str(folder / n) for n in names)}")
    if open_report and folder is not None:
        import webbrowser

        report = folder / "report.html"
        if not webbrowser.open(report.resolve().as_uri()):
            say(f"there is no browser here to open {report} with.")
