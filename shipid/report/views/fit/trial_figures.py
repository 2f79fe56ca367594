"""The figures of one trial beside its prediction: histories, residuals and their correlation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from markupsafe import Markup

from shipid.declaration.model import Model
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.residual_correlation import residual_correlations
from shipid.report.figures.correlations import correlations_drawing
from shipid.report.figures.runaway import good_samples
from shipid.report.figures.svg import MOST_POINTS
from shipid.report.figures.trials import Curve, Panel, histories
from shipid.report.typography.quantities import shown, shown_field

#: Signals that come first, whether or not they were fitted.
_FIRST = ("psi", "r", "u", "v")
#: Of so many signals the correlation of the residuals is drawn.
_CORRELATED = 3


def predicted_signals(comparison: Comparison, model: Model) -> Mapping[str, np.ndarray]:
    """Return what the model predicts itself, and does not read from the record.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    model : Model
        The fitted model.
    """
    return {n: p for n, p in comparison.predicted.items() if n not in model or model[n].quantity.kind != "given"}


def histories_of(comparison: Comparison, model: Model, key: str, most: int = MOST_POINTS) -> Markup:
    """Return the measured and the predicted signals against time, with the rudder beneath.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    model : Model
        The fitted model.
    key : str
        What the names inside the figure start with.
    most : int
        Most points of a curve.
    """
    trial, own, count = comparison.trial, predicted_signals(comparison, model), good_samples(comparison)
    t, panels = trial["t"], []
    for name in dict.fromkeys((*_FIRST, *(n for n in own if n not in ("x", "y")))):
        how = shown(model, name)
        curves = [Curve("measured", t, trial[name] * how.factor)] if trial.has(name) else []
        if name in own and count > 1:
            curves.append(Curve("predicted", t[:count], own[name][:count] * how.factor))
        if curves:
            panels.append(Panel(how.label, how.unit, curves))
    how = shown_field("delta")
    rudder = [
        Curve(kind, t, trial[n] * how.factor)
        for n, kind in (("delta", "rudder"), ("delta_order", "order"))
        if trial.has(n)
    ]
    if rudder:
        panels.append(Panel(how.label, how.unit, rudder))
    return histories(
        panels, f"{key}-h", f"Measured and predicted against time, trial {trial.name}: {_labels(panels)}", most
    )


def residuals_of(comparison: Comparison, model: Model, key: str, most: int = MOST_POINTS) -> Markup | None:
    """Return the measured signals less the predicted ones against time; None where there is none.

    Parameters
    ----------
    comparison, model, key, most
        As for `histories_of`.
    """
    trial, own, count = comparison.trial, predicted_signals(comparison, model), good_samples(comparison)
    panels = []
    for name in comparison.rmse:
        if count < 2 or name not in own or not trial.has(name):
            continue
        how = shown(model, name)
        error = (trial[name][:count] - own[name][:count]) * how.factor
        panels.append(Panel(how.label, how.unit, [Curve("residual", trial["t"][:count], error)]))
    if not panels:
        return None
    return histories(
        panels, f"{key}-r", f"Residuals, measured less predicted, trial {trial.name}: {_labels(panels)}", most
    )


def correlations_of(comparison: Comparison, model: Model, key: str) -> Markup | None:
    """Return the residuals of the first signals against themselves and against the rudder; None where there is none.

    Parameters
    ----------
    comparison, model, key
        As for `histories_of`.
    """
    found = residual_correlations(comparison)[:_CORRELATED]
    if not found:
        return None
    labels = {c.signal: shown(model, c.signal).label for c in found}
    title = f"Residuals with themselves and with the rudder, trial {comparison.trial.name}"
    return correlations_drawing(found, labels, title).svg(f"{key}-c")


def _labels(panels: list[Panel]) -> str:
    return ", ".join(p.label.lower() for p in panels)
