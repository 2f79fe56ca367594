"""Two tunings side by side as a page."""

from __future__ import annotations

from markupsafe import Markup

import shipid
from shipid.autopilot.judgement.compare_tunings import OVER_DRAWS, TuningComparison
from shipid.foundation.notices import notice_of
from shipid.foundation.numbers import number
from shipid.report.figures.tuning import comparison_figures
from shipid.report.page import Page, Row, Section
from shipid.report.views.tuning.page import answer
from shipid.report.views.words import sentence


def comparison_page(found: TuningComparison) -> Page:
    """Return what the page says of two tunings side by side.

    Parameters
    ----------
    found : TuningComparison
        The comparison.
    """
    told = [(notice_of(w).serious, w if w.startswith(found.names) else sentence(w)) for w in found.warnings]
    return Page(
        f"Two tunings: {found.names[0]} and {found.names[1]}",
        [(name, answer(judged)) for name, judged in zip(found.names, found.judged)],
        [_rows(found), Section("Figures", "tuning/figures.html", comparison_figures(found))],
        warnings=[w for serious, w in told if serious],
        cautions=[w for serious, w in told if not serious],
        footer=f"shipid {shipid.__version__}",
    )


def _rows(found: TuningComparison) -> Section:
    rows: list[Row] = []
    for r in found.rows:
        nothing = "not known" if r.what == OVER_DRAWS else "none"
        texts = [nothing if v is None else number(v, 4) for v in r.values]
        if r.better is not None:
            texts[r.better] = Markup('<span class="yes">{}</span>').format(texts[r.better])
        rows.append({"what": sentence(r.what), "unit": r.unit, "first": texts[0], "second": texts[1]})
    columns = [(name, key, "n") for name, key in zip(found.names, ("first", "second"))]
    return Section("Side by side", "tuning/rows.html", {"columns": columns, "rows": rows})
