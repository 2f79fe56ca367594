"""The figures of one trial beside its prediction: histories, residuals, track."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from markupsafe import Markup

from shipid.declaration.model import Model
from shipid.identification.validation.comparison import Comparison
from shipid.report.figures.svg import with_gaps
from shipid.report.figures.trials import Curve, Panel, histories, tracks
from shipid.report.typography.quantities import shown, shown_field
from shipid.report.views.fit.runaway import good_samples
from shipid.trials.filling import interpolated
from shipid.trials.measuring.track import track
from shipid.trials.trial import Trial

#: Signals that come first, whether or not they were fitted.
_FIRST = ("psi", "r", "u", "v")


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


def histories_of(comparison: Comparison, model: Model, key: str) -> Markup:
    """Return the measured and the predicted signals against time, with the rudder beneath.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    model : Model
        The fitted model.
    key : str
        What the names inside the figure start with.
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
    return histories(panels, f"{key}-h", f"Measured and predicted against time, trial {trial.name}: {_labels(panels)}")


def residuals_of(comparison: Comparison, model: Model, key: str) -> Markup | None:
    """Return the measured signals less the predicted ones against time; None where there is none.

    Parameters
    ----------
    comparison, model, key
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
    return histories(panels, f"{key}-r", f"Residuals, measured less predicted, trial {trial.name}: {_labels(panels)}")


def track_of(comparison: Comparison, key: str) -> tuple[Markup | None, str]:
    """Return the measured and the predicted track, and where the measured one comes from; None where there is none.

    Parameters
    ----------
    comparison, key
        As for `histories_of`.
    """
    trial, predicted, count = comparison.trial, comparison.predicted, good_samples(comparison)
    measured = _measured_track(trial)
    curves, note = [], ""
    shift = (0.0, 0.0)
    if measured is not None:
        north, east, source = measured
        curves.append(Curve("measured", east, north))
        note = f"Measured track from {source}."
        if source != "positions" and count and "x" in predicted:
            shift = (float(predicted["x"][0]), float(predicted["y"][0]))
    if "x" in predicted and "y" in predicted and count > 1:
        curves.append(Curve("predicted", predicted["y"][:count] - shift[1], predicted["x"][:count] - shift[0]))
    if not curves:
        return None, ""
    return tracks(curves, f"{key}-t", f"Track, north up, trial {trial.name}"), note


def _measured_track(trial: Trial) -> tuple[np.ndarray, np.ndarray, str] | None:
    """North and east in m, NaN where the line breaks, and where they come from."""
    t = trial["t"]
    if trial.has("x", "y") and (both := np.isfinite(trial["x"] + trial["y"])).any():
        north, east = (with_gaps(t[both], trial[n][both])[1] for n in ("x", "y"))
        return north, east, "positions"
    return track(_between_samples(trial))


def _between_samples(trial: Trial) -> Trial:
    """A trial with straight lines over the short holes of its signals, without the signals that have long ones."""
    if not trial.table.isna().to_numpy().any():
        return trial
    filled = {n: interpolated(trial["t"], trial[n]) for n in trial.table.columns if n != "t"}
    whole = np.isfinite(filled["psi"]) if "psi" in filled else np.ones(len(trial), dtype=bool)
    # Before the first heading and behind the last one there is no track.
    inside = slice(int(np.argmax(whole)), len(trial) - int(np.argmax(whole[::-1])))
    table = trial.table.assign(**filled).iloc[inside].reset_index(drop=True)
    return replace(trial, table=table.dropna(axis="columns"))


def _labels(panels: list[Panel]) -> str:
    return ", ".join(p.label.lower() for p in panels)
