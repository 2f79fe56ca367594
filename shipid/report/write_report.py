"""Write a result as one HTML file that needs nothing else: no network, no scripts, no other file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.judgement.compare_tunings import TuningComparison
from shipid.autopilot.judgement.judgement import Judgement
from shipid.foundation.errors import UsageError
from shipid.foundation.replacing import check_place, write_text
from shipid.report.page import Page

if TYPE_CHECKING:
    from shipid.criteria.criteria import Criteria
    from shipid.criteria.measured.sheet import TrialSheet
    from shipid.estimation.records.observability import Observability
    from shipid.estimation.records.run import FilterRun
    from shipid.identification.fit import Fit
    from shipid.identification.recursive.result import RecursiveIdentification
    from shipid.prediction.prediction import Prediction

    Reported: TypeAlias = (
        Fit
        | FilterRun
        | Observability
        | RecursiveIdentification
        | Autopilot
        | Judgement
        | TuningComparison
        | Prediction
        | TrialSheet
    )


def write_report(
    result: Reported, path: str | Path, *, criteria: Criteria | str | None = None, overwrite: bool = True
) -> Path:
    """Write a result as a self-contained HTML report.

    The file appears under its name only when it is complete. The same result gives the same bytes. The report computes
    nothing: what it shows is in the result, and it says what was not asked for (`shipid.assess` of a fit, `observability` of a
    filter, `shipid.judge` of an autopilot).

    Parameters
    ----------
    result : Fit, FilterRun, Observability, RecursiveIdentification, Autopilot, Judgement, TuningComparison, Prediction \
or TrialSheet
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
    return _page(result, criteria).html()


def _page(result: Reported, criteria: Criteria | str | None) -> Page:
    from shipid.criteria.measured.sheet import TrialSheet
    from shipid.estimation.records.observability import Observability
    from shipid.estimation.records.run import FilterRun
    from shipid.identification.fit import Fit
    from shipid.identification.recursive.result import RecursiveIdentification
    from shipid.prediction.prediction import Prediction

    if isinstance(result, Fit):
        from shipid.report.views.fit.page import fit_page

        return fit_page(result, criteria)
    if isinstance(result, FilterRun):
        from shipid.report.views.filter.page import filter_page

        return filter_page(result)
    if isinstance(result, Observability):
        from shipid.report.views.filter.page import filter_page

        return filter_page(result.run, result)
    if isinstance(result, RecursiveIdentification):
        from shipid.report.views.filter.recursive import recursive_page

        return recursive_page(result)
    if isinstance(result, Autopilot):
        from shipid.report.views.tuning.page import design_page

        return design_page(result)
    if isinstance(result, Judgement):
        from shipid.report.views.tuning.page import tuning_page

        return tuning_page(result)
    if isinstance(result, TuningComparison):
        from shipid.report.views.tuning.comparison import comparison_page

        return comparison_page(result)
    if isinstance(result, Prediction):
        from shipid.report.views.prediction.page import prediction_page

        return prediction_page(result)
    if isinstance(result, TrialSheet):
        from shipid.report.views.sheet.page import sheet_page

        return sheet_page(result)
    known = "Fit, FilterRun, Observability, RecursiveIdentification, Autopilot, Judgement, TuningComparison, Prediction, TrialSheet"
    raise UsageError(f"there is no report for a {type(result).__name__}. Reports exist for: {known}.")
