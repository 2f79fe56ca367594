"""Write a result as one HTML file that needs nothing else: no network, no scripts, no other file."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from shipid.foundation.errors import UsageError
from shipid.foundation.replacing import check_place, write_text
from shipid.report.page import Page

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
    from shipid.identification.fit import Fit
    from shipid.identification.recursive.result import RecursiveIdentification
    from shipid.prediction.prediction import Prediction
    from shipid.prediction.sailing.voyage import Voyage
    from shipid.prediction.tracks.predicted_track import PredictedTrack
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
        | CampaignResult
        | FleetResult
        | Tracking
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
    "CampaignResult": "campaign.page:campaign_page",
    "FleetResult": "campaign.fleet:fleet_page",
    "Tracking": "tracking.page:tracking_page",
    "Trial": "record.page:trial_page",
    "Voyage": "record.page:voyage_page",
    "PredictedTrack": "record.page:track_page",
    "Smoothed": "record.page:smoothed_page",
    "MultipleModelRun": "record.page:multiple_page",
}


def write_report(
    result: Reported, path: str | Path, *, criteria: Criteria | str | None = None, overwrite: bool = True
) -> Path:
    """Write a result as a self-contained HTML report.

    The file appears under its name only when it is complete. The same result gives the same bytes. The report computes
    nothing: what it shows is in the result, and it says what was not asked for (`shipid.assess` of a fit, `observability` of a
    filter, `shipid.judge` of an autopilot).

    Parameters
    ----------
    result : Fit, FilterRun, Observability, WhichShip, RecursiveIdentification, Autopilot, Judgement, TuningComparison, Prediction, \
TrialSheet, CampaignResult, FleetResult, Tracking, Trial, Voyage, PredictedTrack, Smoothed or MultipleModelRun
        What to report.
    path : str or Path
        The file to write.
    criteria : Criteria or str, optional
        The manoeuvring criteria of an identified model, or why there are none: for a section of the report of a fit.
    overwrite : bool
        Whether a file of that name may be replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    OverwriteError
        If the file exists and `overwrite` is False.
    MissingFileError
        If the folder does not exist or cannot be written to.
    """
    path = Path(path)
    check_place(path, overwrite)
    write_text(path, render(result, criteria=criteria))
    return path


def render(result: Reported, *, criteria: Criteria | str | None = None) -> str:
    """Return the report of a result as HTML text.

    Parameters
    ----------
    result, criteria
        As for `write_report`.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    """
    return page_of(result, criteria).html()


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
    kind = next((c.__name__ for c in type(result).__mro__ if c.__name__ in _VIEWS), None)
    if kind is None:
        raise UsageError(f"there is no report for a {type(result).__name__}. Reports exist for: {', '.join(_VIEWS)}.")
    room, function = _VIEWS[kind].split(":")
    view = getattr(importlib.import_module(f"shipid.report.views.{room}"), function)
    page: Page = view(result, criteria) if kind == "Fit" else view(result)
    return page
