"""The statistics of a campaign as a page."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup

import shipid
from shipid.campaign.moments import Statistic
from shipid.campaign.result import CampaignResult, summary
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_factor, display_unit
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import estimate, number
from shipid.report.figures.charts import Axes, Line, chart
from shipid.report.page import Page, Row, Section
from shipid.report.views.campaign.means_figure import means_figures
from shipid.report.views.words import count, sentence

_COLUMNS = [
    ("Mean", "mean", "n"), ("95 % interval", "interval", "keep"), ("RMSE", "rmse", "n"), ("95 % interval", "rmse_interval", "keep"),
    ("Standard deviation", "std", "n"), ("Smallest", "low", "n"), ("Largest", "high", "n"), ("Unit", "unit", "keep"),
    ("Missing in", "missing", "n"),
]  # fmt: skip


def campaign_page(found: CampaignResult) -> Page:
    """Return what the page says of a campaign.

    Parameters
    ----------
    found : CampaignResult
        The campaign.
    """
    numbers = [s for s in found.statistics.values() if s.texts is None]
    texts = [s for s in found.statistics.values() if s.texts is not None]
    courses = [s for s in numbers if s.course is not None]
    sections = []
    if numbers:
        rows = [_row(s) for s in numbers]
        # A column in which no measure has anything to say is left out.
        columns = [c for c in _COLUMNS if any(row[c[1]] for row in rows)]
        view = {"columns": columns, "rows": rows, "figures": means_figures(numbers)}
        sections.append(Section("Measures", "campaign/measures.html", view))
    if courses:
        sections.append(Section("Over the run", "campaign/course.html", {"figure": _courses(courses)}))
    if texts:
        outcomes = [{"what": s.name, "counts": sentence(summary(s))} for s in texts]
        sections.append(Section("Outcomes", "campaign/texts.html", {"rows": outcomes}))
    sections.append(Section("Provenance", "campaign/provenance.html", {"rows": provenance_rows(found.provenance)}))
    return Page(
        f"Campaign {found.name}",
        [("", [f"{sentence(count(found.runs, 'run'))} with seed {found.seed}."])],
        sections,
        warnings=[sentence(w) for w in found.warnings if w.serious],
        cautions=[sentence(w) for w in found.warnings if not w.serious],
        footer=f"shipid {shipid.__version__}",
    )


def provenance_rows(provenance: Plain) -> list[Row]:
    """Return the provenance of a campaign as rows.

    Parameters
    ----------
    provenance : mapping
        Versions, and the identity of the study.
    """
    rows = [{"what": name, "value": version} for name, version in provenance["versions"].items()]
    identity = provenance.get("identity")
    return [*rows, *([{"what": "identity of the study (SHA-256)", "value": identity}] if identity else [])]


def _row(s: Statistic) -> Row:
    error, factor = s.measure.kind == "error", display_factor("", s.measure.unit)
    (mean, between), (rmse, rmse_between) = (
        estimate(value, ends, factor) for value, ends in ((s.mean, s.mean_interval), (s.rmse, s.rmse_interval))
    )
    # Of an event the share says it all.
    std, low, high = ("", "", "") if s.measure.kind == "event" else s.told(factor)
    unit = pretty(display_unit("", s.measure.unit))
    return {
        "what": sentence(s.measure.meaning) or s.name,
        "mean": mean,
        "interval": between,
        "rmse": rmse if error else "",
        "rmse_interval": rmse_between if error else "",
        "std": std,
        "low": low,
        "high": high,
        "unit": "" if unit == "1" else unit,
        "missing": str(s.missing) if s.missing else "",
        "remark": _remark(s),
    }


def _remark(s: Statistic) -> str:
    words = [f"`{s.name}`"] if s.measure.meaning else []
    if s.measure.kind == "nees":
        words = [f"{words[0]}."] if words else []
        words.append(f"A normalised squared error of {s.measure.degrees} degrees of freedom")
        band = (
            f" has a mean of {_interval(s.expected_interval)} in 95 % of campaigns if the filter is consistent."
            if s.expected_interval
            else "."
        )
        words[-1] += band
    return " ".join(words)


def _number(value: float | None, factor: float) -> str:
    return number(None if value is None else value * factor, 3)


def _interval(ends: tuple[float, float] | None) -> str:
    if ends is None or not np.isfinite(ends).all():
        return ""
    return f"{_number(ends[0], 1.0)} to {_number(ends[1], 1.0)}"


def _courses(courses: list[Statistic]) -> Markup:
    """Root mean square of errors, mean of everything else, each with its 95 % band."""
    panels = []
    for s in courses:
        assert s.course is not None
        shown = "rmse" if s.measure.kind == "error" else "mean"
        middle = np.asarray(s.course[shown])
        low, high = s.course[f"{shown}_interval"]
        places = np.arange(middle.size)
        lines = [Line(shown.upper() if shown == "rmse" else "mean", places, middle)]
        lines += [Line("95 % band", places, np.asarray(low), "faint"), Line("", places, np.asarray(high), "faint")]
        if s.measure.kind == "nees":
            lines += [Line("consistent", places, np.asarray(e), "limit") for e in s.course["expected_interval"][:1]]
            lines += [Line("", places, np.asarray(e), "limit") for e in s.course["expected_interval"][1:]]
        panels.append(Axes(s.name, pretty(s.measure.unit), lines))
    return chart(panels, "Place in the run", "course", "Statistics of the measures over the run")
