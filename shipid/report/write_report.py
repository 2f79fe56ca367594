"""Write a result as one HTML file that needs nothing else: no network, no scripts, no other file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.judgement.compare_tunings import TuningComparison
from shipid.autopilot.judgement.judgement import Judgement
from shipid.foundation.errors import UsageError
from shipid.foundation.replacing import check_place, replacing


def write_report(result: Any, path: str | Path, *, overwrite: bool = True) -> Path:
    """Write a result as a self-contained HTML report.

    The file appears under its name only when it is complete. The same result gives the same bytes.

    Parameters
    ----------
    result : Fit, FilterRun, Observability, RecursiveIdentification, Autopilot, Judgement or TuningComparison
        What to report.
    path : str or Path
        The file to write.
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
    page = render(result)
    with replacing(path) as temporary:
        Path(temporary).write_text(page, encoding="utf-8", newline="\n")
    return path


def render(result: Any) -> str:
    """Return the report of a result as HTML text.

    Parameters
    ----------
    result : Fit, FilterRun, Observability, RecursiveIdentification, Autopilot, Judgement or TuningComparison
        What to report.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    """
    from shipid.estimation.records.observability import Observability
    from shipid.estimation.records.run import FilterRun
    from shipid.identification.fit import Fit
    from shipid.identification.recursive.result import RecursiveIdentification

    if isinstance(result, Fit):
        from shipid.report.views.fit import fit_view

        return _page("fit.html", fit_view(result))
    if isinstance(result, FilterRun):
        from shipid.report.views.filter import filter_view

        return _page("filter.html", filter_view(result))
    if isinstance(result, Observability):
        from shipid.report.views.filter import filter_view

        return _page("filter.html", filter_view(result.run, result))
    if isinstance(result, RecursiveIdentification):
        from shipid.report.views.recursive import recursive_view

        return _page("filter.html", recursive_view(result))
    if isinstance(result, Autopilot):
        from shipid.report.views.tuning import design_view

        return _page("tuning.html", design_view(result))
    if isinstance(result, Judgement):
        from shipid.report.views.tuning import tuning_view

        return _page("tuning.html", tuning_view(result))
    if isinstance(result, TuningComparison):
        from shipid.report.views.tunings import comparison_view

        return _page("tunings.html", comparison_view(result))
    known = "Fit, FilterRun, Observability, RecursiveIdentification, Autopilot, Judgement, TuningComparison"
    raise UsageError(f"there is no report for a {type(result).__name__}. Reports exist for: {known}.")


def _page(template: str, view: Any) -> str:
    return str(_environment().get_template(template).render(view=view))


def _environment() -> Any:
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("shipid.report", ""),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["zip"] = zip
    return environment
