"""An identified model as the page shows it: words first, then rows of tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PureWindowsPath
from typing import Any

import numpy as np
from markupsafe import Markup

from shipid.declaration.units import pretty
from shipid.estimation.estimate import Estimate
from shipid.generation.typesetting import symbol, typeset
from shipid.identification.fit import Fit
from shipid.parameters.parameter_set import PARTICULARS
from shipid.report.typography.numbers import fixed, given, interval, number, uncertain
from shipid.report.typography.symbols import html_symbol
from shipid.report.views.search import findings_view, ladder_view, method_view, posterior_view
from shipid.report.views.trial import TrialView, label_of, shown_unit, view_of
from shipid.report.views.uncertainty import criteria_view, directions_view, residuals_view
from shipid.trials.trial import Trial

#: A validation trial that goes this much beyond the fitted ones is an extrapolation.
_BEYOND = 1.1


@dataclass(frozen=True, eq=False)
class FitView:
    """Everything the template of a fit reads; see the template for where it stands."""

    title: str
    ship_name: str
    ship_title: str
    model_name: str
    answer: list[str]
    warnings: list[str]
    cautions: list[str]
    fitted_coefficients: list[dict[str, Any]]
    following_coefficients: list[dict[str, Any]]
    fixed: list[dict[str, Any]]
    particulars: list[dict[str, str]]
    equations: list[dict[str, str]]
    trials: list[TrialView]
    correlation: dict[str, Any]
    condition: str
    undetermined: list[dict[str, Any]]
    noise: list[dict[str, Any]]
    directions: list[dict[str, str]]
    criteria: dict[str, Any] | None
    method: list[str]
    ladder: list[dict[str, Any]]
    findings: list[dict[str, str]]
    checked: bool
    posterior: dict[str, Any] | None
    versions: dict[str, str]
    model_sha256: str
    files: list[dict[str, Any]]


def fit_view(fit: Fit) -> FitView:
    """Return what the page says of a fit.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    length = fit.ship.particular("L", "m")
    pairs = [("fitted", c) for c in fit.fitted] + [("validation", c) for c in fit.validation]
    views = [
        view_of(
            c,
            fit.model,
            f"trial-{i}",
            role,
            length,
            ((fit.assessment and fit.assessment.manoeuvres) or {}).get(c.trial.name),
        )
        for i, (role, c) in enumerate(pairs, start=1)
    ]
    estimates = list(fit.parameters.values())
    provenance = fit.provenance
    return FitView(
        title=f"Identification of {fit.ship.name} with model {fit.model.name}",
        ship_name=fit.ship.name,
        ship_title=fit.ship.title,
        model_name=fit.model.name,
        answer=_answer(fit, views),
        warnings=_warnings(fit, views),
        cautions=_cautions(fit),
        fitted_coefficients=[_coefficient(fit, e) for e in estimates if not e.follows],
        following_coefficients=[_coefficient(fit, e) for e in estimates if e.follows],
        fixed=_fixed(fit),
        particulars=_particulars(fit),
        equations=[
            {"plain": t.plain, "source": t.source, "where": f"{t.component}.{t.method}"} for t in typeset(fit.model)
        ],
        trials=views,
        correlation=_correlation(fit),
        condition=_condition(fit),
        undetermined=[{"symbol": _symbol(fit, n), "name": n, "why": fit.parameters[n].why} for n in fit.unidentifiable],
        noise=residuals_view(fit),
        directions=directions_view(fit),
        criteria=criteria_view(fit),
        method=method_view(fit),
        ladder=ladder_view(fit),
        findings=findings_view(fit),
        checked=fit.assessment is not None and fit.assessment.findings is not None,
        posterior=posterior_view(fit),
        versions=dict(provenance.get("versions", {})),
        model_sha256=str(provenance.get("model_sha256", "")),
        files=[_file(c.trial, role) for role, c in pairs],
    )


def _symbol(fit: Fit, name: str) -> Markup:
    return html_symbol(symbol(fit.model[name]), name) if name in fit.model else html_symbol("", name)


def _count(n: int, what: str) -> str:
    words = ("no", "one", "two", "three", "four", "five", "six")
    return f"{words[n] if n < len(words) else n} {what}{'' if n == 1 else 's'}"


def _listed(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def _answer(fit: Fit, views: Sequence[TrialView]) -> list[str]:
    """The one-paragraph answer, a sentence an entry."""
    simulated = sum(v.simulated for v in views if v.role == "fitted")
    kind = "simulated trial" if simulated == len(fit.fitted) else "trial"
    ship = fit.ship.name + (f" ({fit.ship.title})" if fit.ship.title else "")
    sentences = [
        f"Model {fit.model.name} was fitted to {_count(len(fit.fitted), kind)} of {ship}"
        + (f" ({simulated} of them simulated)." if 0 < simulated < len(fit.fitted) else "."),
        "The search converged." if fit.converged else "The search did not converge: do not use these coefficients.",
    ]
    lead = "psi" if any("psi" in c.rmse for c in fit.fitted) else next(iter(fit.noise), None)
    if lead is not None:
        what = label_of(fit.model, lead).lower()
        unit, scale = shown_unit(fit.model, lead)
        for role, words in (("fitted", "reproduces"), ("validation", "predicts")):
            pairs = zip([*fit.fitted, *fit.validation], views)
            found = [(v, c.rmse.get(lead)) for c, v in pairs if v.role == role]
            if not found:
                continue
            errors = [
                f"{number(e * scale, 2)} {unit} rms ({v.name})" for v, e in found if e is not None and v.runaway is None
            ]
            where = "of the fitted trials" if role == "fitted" else "of trials that were not fitted"
            if errors:
                sentences.append(f"It {words} the {what} {where} to within {_listed(errors)}.")
            lost = [v.name for v, _ in found if v.runaway is not None]
            if lost:
                sentences.append(f"Its prediction of {_listed(lost)} runs away.")
    if not fit.validation:
        sentences.append("No trial was kept apart to test its prediction.")
    if fit.unidentifiable:
        sentences.append(f"Not determined by these trials: {_listed(fit.unidentifiable)}.")
    else:
        sentences.append("The trials determine all fitted coefficients.")
    open_signs = [n for n in fit.estimated if fit.parameters[n].identifiable and _sign_is_open(fit.parameters[n])]
    if open_signs:
        sentences.append(f"The interval of {_listed(open_signs)} holds zero: even the sign is open.")
    following = [n for n, e in fit.parameters.items() if e.follows and not e.identifiable]
    if following:
        sentences.append(f"The published coefficients that follow leave open: {_listed(following)}.")
    return sentences


def _sign_is_open(e: Estimate) -> bool:
    return e.ci95 is not None and e.ci95[0] < 0 < e.ci95[1]


def _warnings(fit: Fit, views: Sequence[TrialView]) -> list[str]:
    found = []
    if not fit.converged:
        found.append(f"The search did not converge. It said: {fit.message}")
    found += [
        f"The prediction of {v.name} runs away at t = {number(v.runaway)} s; its curves stop there, and it has no rms error."
        for v in views
        if v.runaway is not None
    ]
    return found


def _cautions(fit: Fit) -> list[str]:
    """Where a validation trial leaves the range of the fitted ones."""
    beyond: dict[int, list[str]] = {}
    for name, what in (("delta", "rudder angle"), ("r", "rate of turn")):
        sizes = [float(np.abs(c.trial[name]).max()) for c in fit.fitted if c.trial.has(name)]
        unit, scale = shown_unit(fit.model, name)
        for i, c in enumerate(fit.validation):
            size = float(np.abs(c.trial[name]).max()) if sizes and c.trial.has(name) else 0.0
            if sizes and size > _BEYOND * max(sizes):
                beyond.setdefault(i, []).append(
                    f"{what} up to {number(size * scale, 3)} {unit} (fitted up to {number(max(sizes) * scale, 3)} {unit})"
                )
    return [
        f"{fit.validation[i].trial.name} goes beyond the fitted trials: {_listed(words)}. Its prediction is an extrapolation."
        for i, words in beyond.items()
    ]


def _coefficient(fit: Fit, e: Estimate) -> dict[str, Any]:
    other = "none"
    if e.prime is not None and np.isfinite(e.prime):
        spread = abs(e.std * e.prime / e.value) if e.std is not None and e.value else None
        other = uncertain(e.prime, spread)
    return {
        "symbol": _symbol(fit, e.name),
        "name": e.name,
        "meaning": e.meaning,
        "value": "runs to infinity" if e.value is None else uncertain(e.value, e.std),
        "interval": interval(e.ci95, e.std),
        "unit": pretty(e.unit),
        "other": other,
        "other_unit": pretty(e.prime_unit) if other != "none" else "",
        "other_kind": "dimensional" if e.unit in ("", "1") else "normalised",
        "determined": e.identifiable,
        "why": e.why,
        "sign": "The interval holds zero, so even its sign is open." if _sign_is_open(e) and e.identifiable else "",
    }


def _fixed(fit: Fit) -> list[dict[str, Any]]:
    rows = []
    for name, value in fit.fixed.items():
        held = fit.ship.find(fit.model, name)
        rows.append(
            {
                "symbol": _symbol(fit, name),
                "name": name,
                "meaning": fit.model[name].quantity.meaning,
                "value": given(value),
                "unit": pretty(fit.model[name].unit),
                "source": held.source if held is not None else "",
            }
        )
    return rows


def _particulars(fit: Fit) -> list[dict[str, str]]:
    return [
        {"name": n, "value": given(v.value), "unit": pretty(v.unit), "source": v.source}
        for n, v in fit.ship.sections.get(PARTICULARS, {}).items()
        if isinstance(v.value, (int, float))
    ]


def _correlation(fit: Fit) -> dict[str, Any]:
    names = fit.estimated
    rows = []
    for i, name in enumerate(names):
        cells = []
        for j in range(len(names)):
            value = float(fit.correlation[i, j])
            finite = np.isfinite(value)
            hue = "47, 127, 196" if value >= 0 else "217, 112, 10"
            shade = f"rgba({hue}, {0.55 * abs(value):.2f})" if finite and i != j else "transparent"
            cells.append({"text": fixed(value, 2), "shade": shade, "own": i == j})
        rows.append({"symbol": _symbol(fit, name), "cells": cells})
    return {"symbols": [_symbol(fit, n) for n in names], "rows": rows}


def _condition(fit: Fit) -> str:
    value = fit.condition_number
    if len(fit.estimated) < 2:
        return "One coefficient was fitted, so nothing can trade off with it."
    if value is None or not np.isfinite(value):
        return (
            "The condition number is infinite: the trials leave at least one combination of coefficients entirely open."
        )
    words = (
        "the coefficients hardly trade off against each other" if value < 30
        else "some coefficients trade off against each other, within bounds" if value < 300
        else "some coefficients trade off strongly: their combination is known much better than each alone"
        if value < 10_000
        else "some coefficients are nearly interchangeable: only their combination is known"
    )  # fmt: skip
    return f"The condition number of this matrix is {number(value, 2)} (1 is best): {words}."


def _file(trial: Trial, role: str) -> dict[str, Any]:
    source = trial.source
    return {
        "name": trial.name,
        "role": role,
        "ship": trial.ship or "",
        "file": "" if source.path is None else PureWindowsPath(source.path).name,
        "sha256": source.sha256 or "",
        "format": "" if source.format is None else PureWindowsPath(source.format).name,
        "notes": source.notes,
        "simulated": source.simulated,
        "samples": len(trial),
    }
