"""Write a result as one HTML file that needs nothing else (no network, no scripts, no other file), or as PDF."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from shipid.foundation.errors import UsageError
from shipid.foundation.replacing import check_place, put_in_place, write_text
from shipid.foundation.scratch import scratch_folder
from shipid.report.page import Page
from shipid.report.pdf import write_pdf

if TYPE_CHECKING:
    from shipid.autopilot.design.autopilot import Autopilot
    from shipid.autopilot.judgement.compare_tunings import TuningComparison
    from shipid.autopilot.judgement.judgement import Judgement
    from shipid.campaign.fleet_result import FleetResult
    from shipid.campaign.result import CampaignResult
    from shipid.criteria.criteria import Criteria
    from shipid.criteria.measured.sheet import TrialSheet
    from shipid.encounter.tracking.tracking import Tracking
    from shipid.estimation.multiple.multiple_run import MultipleModelRun
    from shipid.estimation.multiple.which_ship import WhichShip
    from shipid.estimation.records.observability import Observability
    from shipid.estimation.records.run import FilterRun
    from shipid.estimation.records.smoother import Smoothed
    from shipid.identification.choice.ranking import Ranking
    from shipid.identification.fit import Fit
    from shipid.identification.recursive.result import RecursiveIdentification
    from shipid.planning.plan import Plan
    from shipid.prediction.prediction import Prediction
    from shipid.prediction.sailing.voyage import Voyage
    from shipid.prediction.tracks.predicted_track import PredictedTrack
    from shipid.trials.doctor.findings import Diagnosis
    from shipid.trials.measuring.results.measures import Measures
    from shipid.trials.trial import Trial

    Reported: TypeAlias = (
        Fit
        | FilterRun
        | Observability
        | WhichShip
        | RecursiveIdentification
        | Autopilot
        | Judgement
        | TuningComparison
        | Prediction
        | TrialSheet
        | Measures
        | CampaignResult
        | FleetResult
        | Tracking
        | Ranking
        | Plan
        | Criteria
        | Diagnosis
        | Sequence[Diagnosis]
        | Trial
        | Voyage
        | PredictedTrack
        | Smoothed
        | MultipleModelRun
    )

#: The page of each kind of result, by the name of its class: the module below ``shipid.report.views``, and the function.
_VIEWS = {
    "Fit": "fit.page:fit_page",
    "FilterRun": "filter.page:filter_page",
    "Observability": "filter.page:observability_page",
    "WhichShip": "filter.which_ship:which_ship_page",
    "RecursiveIdentification": "filter.recursive:recursive_page",
    "Autopilot": "tuning.page:design_page",
    "Judgement": "tuning.page:tuning_page",
    "TuningComparison": "tuning.comparison:comparison_page",
    "Prediction": "prediction.page:prediction_page",
    "TrialSheet": "sheet.page:sheet_page",
    "Measures": "sheet.page:measures_page",
    "CampaignResult": "campaign.page:campaign_page",
    "FleetResult": "campaign.fleet:fleet_page",
    "Tracking": "tracking.page:tracking_page",
    "Ranking": "choice.page:ranking_page",
    "Plan": "planning.page:plan_page",
    "Criteria": "criteria.page:criteria_page",
    "Diagnosis": "checking.page:check_page",
    "several Diagnosis": "checking.page:checks_page",
    "Trial": "record.page:trial_page",
    "Voyage": "record.page:voyage_page",
    "PredictedTrack": "record.page:track_page",
    "Smoothed": "record.page:smoothed_page",
    "MultipleModelRun": "record.page:multiple_page",
}

#: How the name of a report ends.
_SUFFIXES = (".html", ".htm", ".pdf")


def write_report(
    result: Reported,
    path: str | Path,
    *,
    criteria: Criteria | str | None = None,
    command: str = "",
    overwrite: bool = True,
) -> Path:
    """Write a result as a self-contained HTML report, or as PDF where the name ends in ``.pdf``.

    The file appears under its name only when it is complete. The same result gives the same page on the same day. The report
    computes nothing expensive: what it shows is in the result, and it says what was not asked for (`shipid.assess` of a fit,
    `observability` of a filter, `shipid.judge` of an autopilot).

    Parameters
    ----------
    result : Fit, FilterRun, Observability, WhichShip, RecursiveIdentification, Autopilot, Judgement, TuningComparison, Prediction, \
TrialSheet, Measures, CampaignResult, FleetResult, Tracking, Ranking, Plan, Criteria, Diagnosis or a sequence of these, Trial, Voyage, PredictedTrack, \
Smoothed or MultipleModelRun
        What to report.
    path : str or Path
        The file to write.
    criteria : Criteria or str, optional
        The manoeuvring criteria of an identified model, or why there are none: for a section of the report of a fit.
    command : str
        What was typed to make it, for the last line of the page.
    overwrite : bool
        Whether a file of that name may be replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    UsageError
        If there is no report for this kind of result, or the name ends in another way.
    OverwriteError
        If the file exists and `overwrite` is False.
    MissingFileError
        If the folder does not exist or cannot be written to.
    MissingExtraError
        If it is to be a PDF, and there is no browser that prints one.
    PdfError
        If the browser does not print it.
    """
    path = Path(path)
    check_place(path, overwrite)
    if path.suffix.lower() not in _SUFFIXES:
        raise UsageError(
            f"a report is an HTML page or a PDF: let the name end in .html or .pdf, and not as '{path.name}'."
        )
    page = render(result, criteria=criteria, command=command, made=date.today())
    if path.suffix.lower() != ".pdf":
        write_text(path, page)
        return path
    with scratch_folder(path.parent) as scratch:
        (scratch / "page.html").write_text(page, encoding="utf-8")
        write_pdf(scratch / "page.html", scratch / "page.pdf")
        put_in_place({scratch / "page.pdf": path}, overwrite)
    return path


def render(
    result: Reported, *, criteria: Criteria | str | None = None, command: str = "", made: date | None = None
) -> str:
    """Return the report of a result as HTML text.

    Parameters
    ----------
    result, criteria, command
        As for `write_report`.
    made : date, optional
        When, for the last line of the page and the foot of a printed one.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    """
    return page_of(result, criteria).html(command, made)


def page_of(result: Reported, criteria: Criteria | str | None = None) -> Page:
    """Return what the report of a result says.

    Parameters
    ----------
    result, criteria
        As for `write_report`.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    """
    one, several = (result[0], "several ") if isinstance(result, list | tuple) and result else (result, "")
    # Several results of one kind make a page together: the trials that were checked.
    kind = next((name for c in type(one).__mro__ if (name := f"{several}{c.__name__}") in _VIEWS), None)
    if kind is None:
        what = f"{several or 'a '}{type(one).__name__}"
        raise UsageError(f"there is no report for {what}. Reports exist for: {', '.join(_VIEWS)}.")
    room, function = _VIEWS[kind].split(":")
    view = getattr(importlib.import_module(f"shipid.report.views.{room}"), function)
    page: Page = view(result, criteria) if kind == "Fit" else view(result)
    return page
