"""The coefficients of a fit as the page shows them: their values and their correlation."""

from __future__ import annotations

import numpy as np

from shipid.declaration.units import pretty
from shipid.estimation.estimate import Estimate
from shipid.foundation.numbers import brief, fixed, given, interval, number, uncertain
from shipid.identification.fit import Fit
from shipid.parameters.parameter_set import PARTICULARS
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import named, symbol_markup
from shipid.report.views.words import standing_remark


def coefficients_section(fit: Fit) -> Section:
    """Return the section of the coefficients: fitted, and following from those.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    estimates = list(fit.parameters.values())
    view = {
        "fitted": [_coefficient(fit, e) for e in estimates if not e.follows],
        "following": [_coefficient(fit, e) for e in estimates if e.follows],
    }
    return Section("Coefficients", "fit/coefficients.html", view)


def held_section(fit: Fit) -> Section:
    """Return the section of what was held fixed, and of the ship's particulars.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    view = {"fixed": _fixed(fit), "particulars": _particulars(fit)}
    title = "Held fixed, and particulars of the ship"
    return Section(title, "fit/held.html", view, short="Held fixed", folded=True)


def correlation_section(fit: Fit) -> Section:
    """Return the section of the correlation of the estimates, and of what the trials do not determine.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    names = fit.estimated
    view = {
        "condition": _condition(fit),
        "symbols": [{"symbol": symbol_markup(fit.model, n), "name": n} for n in names],
        "rows": [
            {"symbol": symbol_markup(fit.model, n), "name": n, "cells": [_cell(fit, i, j) for j in range(len(names))]}
            for i, n in enumerate(names)
        ],
        "undetermined": [{"named": named(fit.model, n), "why": fit.parameters[n].why} for n in fit.unidentifiable],
        "assessed": fit.assessment is not None,
        "directions": [
            {
                "names": ", ".join(d.parameters),
                "spread": "open" if d.relative_std is None else f"±{brief(100 * d.relative_std, 2)} %",
                "words": d.words,
            }
            for d in (fit.assessment.directions if fit.assessment else ())
        ],
    }
    return Section(
        "Correlation, and what is not determined", "fit/correlation.html", view, short="Correlation", folded=True
    )


def _coefficient(fit: Fit, e: Estimate) -> Row:
    other = "none"
    if e.prime is not None and np.isfinite(e.prime):
        spread = abs(e.std * e.prime / e.value) if e.std is not None and e.value else None
        other = uncertain(e.prime, spread)
    return {
        "named": named(fit.model, e.name),
        "meaning": e.meaning,
        "value": e.lacks or uncertain(e.value, e.std),
        "interval": interval(e.ci95, e.std),
        "unit": pretty(e.unit),
        "other": other,
        "other_unit": pretty(e.prime_unit) if other != "none" else "",
        "determined": e.identifiable,
        "remark": standing_remark(e),
    }


def _fixed(fit: Fit) -> list[Row]:
    rows: list[Row] = []
    for name, value in fit.fixed.items():
        held = fit.ship.find(fit.model, name)
        rows.append(
            {
                "named": named(fit.model, name),
                "meaning": fit.model[name].quantity.meaning,
                "value": given(value),
                "unit": pretty(fit.model[name].unit),
                "source": held.source if held is not None else "",
            }
        )
    return rows


def _particulars(fit: Fit) -> list[Row]:
    return [
        {"name": n, "value": given(v.value), "unit": pretty(v.unit), "source": v.source}
        for n, v in fit.ship.sections.get(PARTICULARS, {}).items()
        if isinstance(v.value, (int, float))
    ]


def _cell(fit: Fit, i: int, j: int) -> Row:
    value = float(fit.correlation[i, j])
    hue = "47, 127, 196" if value >= 0 else "217, 112, 10"
    shade = f"rgba({hue}, {0.55 * abs(value):.2f})" if np.isfinite(value) and i != j else "transparent"
    return {"text": fixed(value, 2), "shade": shade, "own": i == j}


def _condition(fit: Fit) -> str:
    value = fit.condition_number
    if len(fit.estimated) < 2:
        return "One coefficient was fitted, so there is no correlation."
    if value is None or not np.isfinite(value):
        return "The condition number is infinite: the trials do not determine at least one combination of coefficients."
    words = (
        "the coefficients are hardly correlated" if value < 30
        else "some coefficients are moderately correlated" if value < 300
        else "some coefficients are strongly correlated: their combination is known much better than each alone"
        if value < 10_000
        else "some coefficients are nearly interchangeable: only their combination is known"
    )  # fmt: skip
    return f"The condition number of this matrix is {number(value, 2)} (1 is best): {words}."
