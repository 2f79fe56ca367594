"""``shipid campaign``: many runs of a study, or one identification for each trial of a folder."""

from __future__ import annotations

import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import click

from shipid.cli.frame.delivery import REPORT, RESULT, Delivery, Writer, delivered
from shipid.cli.frame.messages import say
from shipid.cli.frame.options import (
    TrialReader,
    estimate_option,
    optional_model_option,
    reading,
    seed_option,
    set_option,
    ship_option,
    starts_option,
)
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.processes.stopping import Terminated

if TYPE_CHECKING:
    from shipid.campaign.campaign import Campaign
    from shipid.campaign.find_campaign import CampaignFile

_TABLE = "runs.csv"


@click.command
@click.argument("study", metavar="STUDY|FOLDER")
@click.option(
    "--runs", metavar="N", type=click.IntRange(1), help="Number of runs; of a folder, all its trials by default."
)
@optional_model_option
@ship_option()
@set_option
@reading
@estimate_option()
@starts_option
@seed_option("the runs; of the random starting points, for a folder")
@click.option(
    "--scheduler", metavar="ADDRESS", help="Scheduler of a dask cluster to run on, as in tcp://10.0.0.1:8786."
)
@click.option(
    "--workers", metavar="N", type=click.IntRange(1), help="Threads or processes here; one a processor by default."
)
@click.option("--resume", is_flag=True, help="Go on with the runs that --out DIR holds, of the same study and seed.")
@delivered(RESULT, _TABLE, REPORT, replaced_by="resume")
def campaign(
    study: str,
    runs: int | None,
    model: str | None,
    ship: str | None,
    values: dict[str, str],
    read: TrialReader,
    estimate: list[str] | None,
    starts: int,
    seed: int,
    scheduler: str | None,
    workers: int | None,
    resume: bool,
    delivery: Delivery,
) -> ExitCode:
    """Run a study many times, or identify a model from each trial of a folder.

    STUDY is the name of a shipped one, or path/to/file.py:name, a file that declares a shipid.Campaign. FOLDER holds trials:
    each becomes a row with its coefficients, and a file that cannot be used is a row that says why. With --out, finished runs
    are kept in DIR while the campaign goes on: after an interruption the same command with --resume loses none of them.

    \b
    shipid campaign study.py:drawn --runs 200 --out runs
    shipid campaign trials/ --model nomoto --ship zeefakkel --out fleet
    """  # noqa: D301 - the escape is click's mark for text that is not rewrapped
    from shipid.campaign.find_campaign import find_campaign, whole
    from shipid.campaign.fleet import FleetSettings, fleet_campaign, not_read
    from shipid.campaign.fleet_result import fleet_result
    from shipid.campaign.run_campaign import run_campaign
    from shipid.campaign.table import write_table
    from shipid.foundation.errors import UsageError

    folder = Path(study).is_dir()
    if folder and model is None:
        raise UsageError(f"'{study}' is a folder of trials; say with --model what to identify from each.")
    if not folder and (model or ship or values or estimate or read.format or read.window):
        raise UsageError(
            "--model, --ship, --set, --format, --window and --estimate are for a folder of trials; a study has its own."
        )
    declared = None if folder else find_campaign(study)
    if declared is not None and runs is None:
        raise UsageError("say with --runs how many runs the study is to have.")
    if values and not ship:
        raise UsageError("--set replaces values of a ship: name the ship with --ship.")
    if resume and delivery.folder is None:
        raise UsageError("--resume goes on with the runs of --out DIR, which is not given.")
    chosen: Campaign | CampaignFile
    if declared is None:
        assert model is not None
        chosen = fleet_campaign(
            study,
            FleetSettings(
                model,
                ship,
                read.format,
                read.window,
                None if estimate is None else tuple(estimate),
                starts,
                seed,
                tuple(values.items()),
            ),
        )
    else:
        chosen = declared
    count = runs or whole(chosen).most or 0
    with ExitStack() as stack:
        # Rows of a fleet are shown also where they are not kept.
        place = delivery.folder or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="shipid-campaign-")))
        try:
            with delivery.progress() as tell:
                result = run_campaign(
                    chosen,
                    count,
                    seed=seed,
                    folder=place,
                    resume=resume,
                    overwrite=delivery.overwrite and not resume,
                    scheduler=scheduler,
                    workers=workers,
                    progress=tell,
                )
        except (KeyboardInterrupt, Terminated):
            _tell_kept(delivery, count)
            raise
        shown = fleet_result(result, model or "", ship or "", not_read(Path(study))) if folder else result
        writers: dict[str, Writer] = {
            _TABLE: lambda path: write_table(place, count, path, "csv"),
            REPORT: delivery.report(shown),
        }
        return delivery.hand_over(shown, writers)


def _tell_kept(delivery: Delivery, count: int) -> None:
    """Say what an interruption leaves."""
    from shipid.campaign.store import HEAD, read_store

    if delivery.folder is not None and (delivery.folder / HEAD).exists():
        done = read_store(delivery.folder).done()
        say(f"{done} of {count} runs are kept in {delivery.folder}; the same command with --resume goes on with them.")
