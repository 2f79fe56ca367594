"""One trial beside its prediction, as the page shows it: figures, errors, and the manoeuvre measured in both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from markupsafe import Markup

from shipid.declaration.model import Model
from shipid.declaration.units import factor, pretty
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import ShipidError
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.predicted_manoeuvre import TURN, PredictedManoeuvre
from shipid.report.figures.trials import Curve, Panel, histories, tracks
from shipid.report.typography.numbers import fixed, number
from shipid.trials.measuring.measure import detect, measure
from shipid.trials.measuring.measures import TurningCircle
from shipid.trials.measuring.track import track
from shipid.trials.trial import Trial

LABELS = {
    "psi": "Heading",
    "r": "Rate of turn",
    "u": "Forward speed",
    "v": "Sway speed",
    "U": "Speed over all",
    "x": "Position north",
    "y": "Position east",
    "phi": "Roll angle",
    "delta": "Rudder angle",
}
#: A prediction this many spans of the measured signal away from it has run away.
_FAR = 10.0
_SHOWN = ("psi", "r", "u", "v")
_TURN = ("advance", "transfer", "tactical_diameter", "steady_diameter", "steady_rate", "steady_speed")


@dataclass(frozen=True, eq=False)
class TrialView:
    """What the page says of one trial.

    Attributes
    ----------
    key : str
        Its anchor.
    name, role : str
        Its name, and "fitted" or "validation".
    simulated : bool
        Whether it is a simulation.
    summary : str
        One line: samples, duration, rudder, speed.
    histories, residuals, track : Markup or None
        Figures.
    track_note : str
        Where the measured track comes from.
    errors : list of dict
        One row a signal.
    bias : str
        Rudder bias in words.
    overshoots : list of dict
        One row a swing.
    turn_title : str
        What the turning circle is called.
    turn : list of dict
        One row a quantity of a turning circle.
    runaway : float or None
        Time in s at which the prediction ran away.
    inputs : list of str
        Where the inputs of the model came from, a sentence an entry.
    """

    key: str
    name: str
    role: str
    simulated: bool
    summary: str
    histories: Markup | None
    residuals: Markup | None
    track: Markup | None
    track_note: str
    errors: list[dict[str, str]]
    bias: str
    overshoots: list[dict[str, str]]
    turn_title: str
    turn: list[dict[str, str]]
    runaway: float | None
    inputs: list[str]


def label_of(model: Model, name: str) -> str:
    """Return what a signal is called."""
    if name in LABELS:
        return LABELS[name]
    return model[name].quantity.meaning.split(",")[0].capitalize() if name in model else name


def shown_unit(model: Model, name: str) -> tuple[str, float]:
    """Return the unit a signal is shown in, and the factor from SI to it."""
    if name in FIELDS:
        unit = FIELDS[name].display
        return pretty(unit), factor(FIELDS[name].unit, unit)
    return pretty(model[name].unit), 1.0


def good_samples(comparison: Comparison) -> int:
    """Return how many samples the prediction stays finite and within ten spans of the record.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    """
    trial, lost = comparison.trial, np.zeros(len(comparison.trial), dtype=bool)
    for name, values in comparison.predicted.items():
        lost |= ~np.isfinite(values)
        if not trial.has(name):
            continue
        with np.errstate(invalid="ignore", over="ignore"):
            lost |= np.abs(values - trial[name]) > _FAR * _span(trial, name)
    return int(np.argmax(lost)) if lost.any() else len(lost)


def _span(trial: Trial, name: str) -> float:
    span = float(np.ptp(trial[name]))
    if name == "psi":
        return max(span, np.pi)
    if name in ("u", "v", "U"):
        speeds = [float(np.abs(trial[n]).max()) for n in ("u", "U", "v") if trial.has(n)]
        return max(span, *speeds)
    if name in ("x", "y") and trial.has("x", "y"):
        return max(float(np.ptp(trial["x"])), float(np.ptp(trial["y"])))
    return span


def view_of(
    comparison: Comparison,
    model: Model,
    key: str,
    role: str,
    length: float | None,
    manoeuvre: PredictedManoeuvre | None = None,
) -> TrialView:
    """Return what the page says of one trial.

    Parameters
    ----------
    comparison : Comparison
        The trial and its prediction.
    model : Model
        The fitted model.
    key : str
        Anchor in the page, and what the names inside its figures start with.
    role : {"fitted", "validation"}
        What it was used for.
    length : float or None
        Ship length in m, for ratios.
    manoeuvre : PredictedManoeuvre, optional
        The manoeuvre with its bands.
    """
    trial = comparison.trial
    count = good_samples(comparison)
    runaway = float(trial["t"][count]) if count < len(trial) else None
    own = {n: p for n, p in comparison.predicted.items() if n not in model or model[n].quantity.kind != "given"}
    turn_title, turn = _turn(comparison, "u" in own, count, length, manoeuvre)
    drawn, note = _track(comparison, count, key, role)
    return TrialView(
        key=key,
        name=trial.name,
        role=role,
        simulated=trial.source.simulated,
        summary=_summary(trial),
        histories=_histories(trial, own, model, count, key),
        residuals=_residuals(trial, own, comparison, model, count, key),
        track=drawn,
        track_note=note,
        errors=_errors(comparison, model, runaway),
        bias=_bias(comparison, model, role),
        overshoots=_overshoots(comparison, manoeuvre),
        turn_title=turn_title,
        turn=turn,
        runaway=runaway,
        inputs=_inputs(comparison, model),
    )


def _inputs(comparison: Comparison, model: Model) -> list[str]:
    """Say which inputs were read from the record, and which were held although the record shows them."""
    trial, read, held = comparison.trial, [], []
    for name in (n for n in model.inputs if trial.has(n)):
        used = comparison.predicted.get(name)
        if used is None or np.allclose(used, trial[name], equal_nan=True):
            read.append(label_of(model, name).lower())
        elif np.ptp(used) < 1e-9 * max(1.0, float(np.abs(used).max())):
            unit, scale = shown_unit(model, name)
            held.append(
                f"{label_of(model, name)} is an input of this model, held at {number(used[0] * scale, 3)} {unit}."
            )
    words = [f"Read from the record: {', '.join(read)}."] if read else []
    if held and "x" in comparison.predicted:
        held.append("The predicted track is sailed at that speed, so compare its shape and not its size.")
    return words + held


def _summary(trial: Trial) -> str:
    parts = [f"{len(trial)} samples", f"{number(trial.duration)} s", f"every {number(trial.sampling, 3)} s"]
    if trial.has("delta"):
        low, high = np.rad2deg([trial["delta"].min(), trial["delta"].max()])
        parts.append(f"rudder {fixed(low, 1)} to {fixed(high, 1)} deg")
    for name in ("u", "U"):
        if trial.has(name):
            parts.append(f"speed {fixed(trial[name].min(), 2)} to {fixed(trial[name].max(), 2)} m/s")
            break
    return ", ".join(parts)


def _histories(trial: Trial, own: Mapping[str, np.ndarray], model: Model, count: int, key: str) -> Markup:
    t, panels = trial["t"], []
    for name in dict.fromkeys((*_SHOWN, *(n for n in own if n not in ("x", "y")))):
        if name not in own and not trial.has(name):
            continue
        unit, scale = shown_unit(model, name)
        curves = [Curve("measured", t, trial[name] * scale)] if trial.has(name) else []
        if name in own and count > 1:
            curves.append(Curve("predicted", t[:count], own[name][:count] * scale))
        if curves:
            panels.append(Panel(label_of(model, name), unit, curves))
    rudder = [
        Curve(kind, t, np.rad2deg(trial[n]))
        for n, kind in (("delta", "rudder"), ("delta_order", "order"))
        if trial.has(n)
    ]
    if rudder:
        panels.append(Panel(LABELS["delta"], "deg", rudder))
    shown = ", ".join(p.label.lower() for p in panels)
    return histories(panels, f"{key}-h", f"Measured and predicted against time, trial {trial.name}: {shown}")


def _residuals(
    trial: Trial, own: Mapping[str, np.ndarray], comparison: Comparison, model: Model, count: int, key: str
) -> Markup | None:
    panels = []
    for name in comparison.rmse:
        if count < 2 or name not in own or not trial.has(name):
            continue
        unit, scale = shown_unit(model, name)
        error = (trial[name][:count] - own[name][:count]) * scale
        panels.append(Panel(label_of(model, name), unit, [Curve("residual", trial["t"][:count], error)]))
    if not panels:
        return None
    shown = ", ".join(p.label.lower() for p in panels)
    return histories(panels, f"{key}-r", f"Residuals, measured less predicted, trial {trial.name}: {shown}")


def _track(comparison: Comparison, count: int, key: str, role: str) -> tuple[Markup | None, str]:
    trial, predicted = comparison.trial, comparison.predicted
    measured = track(trial)
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


def _errors(comparison: Comparison, model: Model, runaway: float | None) -> list[dict[str, str]]:
    rows = []
    for name, value in comparison.rmse.items():
        unit, scale = shown_unit(model, name)
        again = comparison.refitted.get(name)
        rows.append(
            {
                "label": label_of(model, name),
                "unit": unit,
                "rms": "ran away" if runaway is not None else number(value * scale, 3),
                "refitted": "" if again is None else number(again * scale, 3) if np.isfinite(again) else "ran away",
            }
        )
    return rows


def _bias(comparison: Comparison, model: Model, role: str) -> str:
    if "delta" not in model or not np.isfinite(comparison.bias):
        return ""
    words = f"Rudder bias {fixed(np.rad2deg(comparison.bias), 2)} deg"
    words += " (estimated with this trial)." if role == "fitted" else " (mean of the fitted trials)."
    if comparison.refitted_bias is not None and np.isfinite(comparison.refitted_bias):
        words += f" Refitted on this record: {fixed(np.rad2deg(comparison.refitted_bias), 2)} deg."
    return words


def _overshoots(comparison: Comparison, manoeuvre: PredictedManoeuvre | None) -> list[dict[str, str]]:
    rows = []
    closed = manoeuvre.closed_loop if manoeuvre else ()
    bands = (manoeuvre.band95, manoeuvre.closed_loop_band95) if manoeuvre else ((), ())
    foreseen = comparison.predicted_overshoots
    for k, measured in enumerate(comparison.overshoots):
        predicted = foreseen[k] if k < len(foreseen) else None
        error = np.nan if predicted is None else float(np.rad2deg(predicted - measured))
        rows.append(
            {
                "number": str(k + 1),
                "measured": _degrees(measured),
                "predicted": _degrees(predicted),
                "difference": fixed(error, 2, sign=True) if np.isfinite(error) else "–",
                "band": _band(bands[0][k] if k < len(bands[0]) else None, 2, float(np.rad2deg(1.0))),
                "closed": _degrees(closed[k]) if k < len(closed) else "–",
                "closed_band": _band(bands[1][k] if k < len(bands[1]) else None, 2, float(np.rad2deg(1.0))),
            }
        )
    return rows


def _degrees(angle: float | None) -> str:
    return "not reached" if angle is None or not np.isfinite(angle) else fixed(float(np.rad2deg(angle)), 2)


def _turn(
    comparison: Comparison, speed: bool, count: int, length: float | None, manoeuvre: PredictedManoeuvre | None
) -> tuple[str, list[dict[str, str]]]:
    """Measure a turning circle, and the predicted one with the recorded rudder."""
    trial = comparison.trial
    metres = None if not length else f"{length!r} m"
    try:
        if detect(trial) != TurningCircle.kind:
            return "", []
        measured = measure(trial, TurningCircle.kind, length=metres)
    except ShipidError:
        return "", []
    found: dict[str, Any] = {n: (v, u, m) for n, v, u, m in measured.quantities()}
    foreseen = _predicted_turn(comparison, count, metres)
    rows = []
    for name in (n for base in _TURN for n in (base, f"{base}_ratio")):
        if name == "steady_speed" and not speed:
            continue  # the model reads the speed from the record, so it predicts none
        value, unit, meaning = found.get(name, (None, "", ""))
        predicted = foreseen.get(name)
        if value is None and predicted is None:
            continue
        ratio = name.endswith("_ratio")
        rows.append(
            {
                "label": name.removesuffix("_ratio").replace("_", " ") + (" in ship lengths" if ratio else ""),
                "meaning": meaning,
                "unit": pretty(unit),
                "measured": _reached(value),
                "predicted": _reached(predicted),
                "difference": _percent(value, predicted),
                "band": _turn_band(name, manoeuvre, length),
            }
        )
    return measured.title, rows


def _turn_band(name: str, manoeuvre: PredictedManoeuvre | None, length: float | None) -> str:
    """The band of one quantity, in ship lengths where its name says so."""
    base = name.removesuffix("_ratio")
    found = [v for k, v in (manoeuvre.turn if manoeuvre else {}).items() if TURN[k][0] == base]
    if not found or found[0].band95 is None:
        return ""
    low, high = (b / length if name.endswith("_ratio") and length else b for b in found[0].band95)
    return f"{number(low, 3)} to {number(high, 3)}"


def _band(band: tuple[float, float] | None, decimals: int, scale: float) -> str:
    return "–" if band is None else f"{fixed(band[0] * scale, decimals)} to {fixed(band[1] * scale, decimals)}"


def _predicted_turn(comparison: Comparison, count: int, length: str | None) -> dict[str, Any]:
    trial = comparison.trial
    if count < len(trial):
        return {}
    kept = {n: trial[n] for n in ("t", "delta", "delta_order") if trial.has(n)}
    table = pd.DataFrame({**kept, **{n: p for n, p in comparison.predicted.items() if n in FIELDS}})
    try:
        return {
            n: v for n, v, _, _ in measure(Trial(trial.name, table), TurningCircle.kind, length=length).quantities()
        }
    except ShipidError:
        return {}


def _reached(value: float | None) -> str:
    return "not reached" if value is None else number(value, 3)


def _percent(value: float | None, predicted: float | None) -> str:
    return "–" if not value or predicted is None else fixed(100 * (predicted - value) / abs(value), 0, sign=True) + " %"
