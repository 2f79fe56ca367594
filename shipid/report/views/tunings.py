"""Two tunings side by side as the page shows them."""

from __future__ import annotations

import shipid
from shipid.autopilot.judgement.compare_tunings import TuningComparison
from shipid.foundation.aliases import Plain
from shipid.report.figures.tuning import comparison_figures
from shipid.report.typography.numbers import number
from shipid.report.views.tuning import answer


def comparison_view(found: TuningComparison) -> dict[str, Plain]:
    """Return what the page says of two tunings side by side.

    Parameters
    ----------
    found : TuningComparison
        The comparison.
    """
    return {
        "title": f"Two tunings: {found.names[0]} and {found.names[1]}",
        "names": found.names,
        "answers": [answer(j) for j in found.judged],
        "rows": [
            {
                "what": r.what[:1].upper() + r.what[1:],
                "unit": r.unit,
                "cells": [
                    {"text": "none" if v is None else number(v, 4), "better": r.better == k}
                    for k, v in enumerate(r.values)
                ],
            }
            for r in found.rows
        ],
        "warnings": found.warnings,
        "figures": comparison_figures(found),
        "version": shipid.__version__,
    }
