"""The trials beside their predictions, as the page shows them: figures, errors, and the manoeuvre measured in both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.numbers import fixed, last_place, number
from shipid.foundation.statistics import NORMAL_95
from shipid.identification.fit import Fit
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.predicted_manoeuvre import PredictedManoeuvre
from shipid.report.figures.runaway import runaway
from shipid.report.figures.svg import MOST_POINTS
from shipid.report.page import Row, Section
from shipid.report.typography.quantities import Shown, shown, shown_field
from shipid.report.views.fit.picture import error_rows
from shipid.report.views.fit.trial_figures import correlations_of, histories_of, predicted_signals, residuals_of
from shipid.report.views.fit.turning_circle import turn_rows
from shipid.trials.trial import Trial

_HEADING = shown_field("psi")
#: So many trials have figures, and share so many points of a curve, which keeps the page small.
_DRAWN, _POINTS = 10, 3000


def trials_section(fit: Fit) -> Section:
    """Return the section of the trials: those fitted, then those predicted.

    Parameters
    ----------
    fit : Fit
        The result.
    """
    pairs = [*(("fitted", c) for c in fit.fitted), *(("validation", c) for c in fit.validation)]
    drawn = len(pairs) if len(pairs) <= _DRAWN else _DRAWN
    most = int(np.clip(_POINTS // drawn, 150, MOST_POINTS))
    views = [
        _trial(fit, role, c, f"trial-{k}", most if k <= drawn else 0) for k, (role, c) in enumerate(pairs, start=1)
    ]
    return Section("Trials in detail", "fit/trials.html", {"trials": views}, short="Trials", folded=True)


def _trial(fit: Fit, role: str, comparison: Comparison, key: str, most: int) -> Row:
    """What is said of a trial; its figures with so many points a curve, none where that is zero."""
    model, trial = fit.model, comparison.trial
    manoeuvres = fit.assessment.manoeuvres if fit.assessment else None
    manoeuvre, lost = (manoeuvres or {}).get(trial.name), runaway(comparison)
    speed = "u" in predicted_signals(comparison, model)
    turn_title, turn = turn_rows(comparison, speed, fit.ship.particular("L", "m"), manoeuvre)
    return {
        "key": key,
        "name": trial.name,
        "role": role,
        "simulated": trial.source.simulated,
        "summary": _summary(trial, model),
        "inputs": [*_inputs(comparison, model), *_missing(comparison, model)],
        "runaway": "" if lost is None else number(lost),
        "errors": error_rows(fit, comparison),
        "bias": _bias(comparison, model, role),
        "overshoots": _overshoots(comparison, manoeuvre),
        "turn_title": turn_title,
        "turn": turn,
        "histories": histories_of(comparison, model, key, most) if most else None,
        "residuals": residuals_of(comparison, model, key, most) if most else None,
        "correlations": correlations_of(comparison, model, key) if most else None,
    }


def _inputs(comparison: Comparison, model: Model) -> list[str]:
    """Say which inputs were read from the record, and which were held although the record shows them."""
    trial, read, held = comparison.trial, [], []
    for name in (n for n in model.inputs if trial.has(n)):
        used, how = comparison.predicted.get(name), shown(model, name)
        there = np.isfinite(trial[name])
        if used is None or np.allclose(used[there], trial[name][there]):
            read.append(how.label.lower())
        elif np.ptp(used) < 1e-9 * max(1.0, float(np.abs(used).max())):
            held.append(f"{how.label} is an input of this model, held at {how.number(used[0])} {how.unit}.")
    words = [f"Read from the record: {', '.join(read)}."] if read else []
    if held and "x" in comparison.predicted:
        held.append("The predicted track is sailed at that speed, so compare its shape and not its size.")
    return words + held


def _missing(comparison: Comparison, model: Model) -> list[str]:
    """Say how many samples are there, and what was filled and left out."""
    counts = ", ".join(
        f"{shown(model, s).label.lower()} {there} of {possible}" for s, (there, possible) in comparison.samples.items()
    )
    return [] if comparison.whole else [f"Samples there: {counts}.", *comparison.notes]


def _summary(trial: Trial, model: Model) -> str:
    parts = [f"{len(trial)} samples", f"{number(trial.duration)} s", f"every {number(trial.sampling, 3)} s"]
    speed = next((n for n in ("u", "U") if trial.has(n)), None)
    for name, what, decimals in (("delta", "rudder", 1), (speed, "speed", 2)):
        if name is not None and trial.has(name) and np.isfinite(trial[name]).any():
            how = shown(model, name)
            low, high = (fixed(v * how.factor, decimals) for v in (np.nanmin(trial[name]), np.nanmax(trial[name])))
            parts.append(f"{what} {low} to {high} {how.unit}")
    return ", ".join(parts)


def _bias(comparison: Comparison, model: Model, role: str) -> str:
    if "delta" not in model or not np.isfinite(comparison.bias):
        return ""
    how = shown_field("delta")
    words = f"Rudder bias {_with_std(comparison.bias, comparison.bias_std, how)} {how.unit}"
    words += " (estimated with this trial)." if role == "fitted" else " (mean of the fitted trials)."
    if comparison.refitted_bias is not None and np.isfinite(comparison.refitted_bias):
        again = _with_std(comparison.refitted_bias, comparison.refitted_bias_std, how)
        words += f" Refitted on this record: {again} {how.unit}."
    return words


def _with_std(value: float, std: float | None, how: Shown) -> str:
    """An angle without powers of ten, which nobody reads in degrees."""
    if std is None:
        return fixed(value * how.factor, 2)
    places = max(0, last_place(std * how.factor))
    return f"{fixed(value * how.factor, places)} ± {fixed(std * how.factor, places)}"


def _overshoots(comparison: Comparison, manoeuvre: PredictedManoeuvre | None) -> list[Row]:
    closed = manoeuvre.closed_loop if manoeuvre else ()
    bands = (manoeuvre.band95, manoeuvre.closed_loop_band95) if manoeuvre else ((), ())
    places = _places(bands[0])
    foreseen = comparison.predicted_overshoots
    rows: list[Row] = []
    for k, measured in enumerate(comparison.overshoots):
        predicted = foreseen[k] if k < len(foreseen) else None
        error = np.nan if predicted is None else (predicted - measured) * _HEADING.factor
        rows.append(
            {
                "number": k + 1,
                "measured": _angle(measured, places),
                "predicted": _angle(predicted, places),
                "difference": fixed(error, places, sign=True) if np.isfinite(error) else "",
                "band": _band(bands[0][k] if k < len(bands[0]) else None, places),
                "closed": _angle(closed[k], places) if k < len(closed) else "",
                "closed_band": _band(bands[1][k] if k < len(bands[1]) else None, places),
            }
        )
    return rows


def _places(bands: Sequence[tuple[float, float] | None]) -> int:
    """Decimals of an overshoot in degrees: two digits of the standard deviation that the narrowest band has, and two decimals at most."""
    widths = [(band[1] - band[0]) * _HEADING.factor for band in bands if band is not None]
    stds = [width / (2 * NORMAL_95) for width in widths if np.isfinite(width) and width > 0]
    return min(2, last_place(min(stds))) if stds else 2


def _angle(value: float | None, places: int) -> str:
    return "not reached" if value is None or not np.isfinite(value) else fixed(value * _HEADING.factor, places)


def _band(band: tuple[float, float] | None, places: int) -> str:
    return "" if band is None else " to ".join(fixed(b * _HEADING.factor, places) for b in band)
