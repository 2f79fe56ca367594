"""Prediction bands: what the uncertainty of a fit means for the overshoots and the circle of each trial.

Parameters, rudder bias and (for a fitted trial) initial state are drawn together from their covariance and run through the
recorded rudder, and through the zig-zag as its helmsman would have steered that ship. The bands are those of the model's
answer: the noise of a measured overshoot, and what a model of this structure cannot describe, come on top.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import ShipidError
from shipid.generation.record import make_record
from shipid.identification.problem.scale import unit_time_of
from shipid.identification.problem.trial_data import Sailed, prepare
from shipid.identification.uncertainty.draws import Draws, band_of, draws_of
from shipid.identification.validation.closed_loop import helmsman_of, zigzag_simulator
from shipid.trials.measuring.measure import detect, measure
from shipid.trials.measuring.measures import TurningCircle, ZigZag
from shipid.trials.measuring.zigzag import overshoots_of
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from shipid.identification.fit import Comparison, Fit

#: Key of a turning circle's quantity, its name in `TurningCircle`, and the factor from SI.
TURN = {
    "advance_m": ("advance", 1.0),
    "transfer_m": ("transfer", 1.0),
    "tactical_diameter_m": ("tactical_diameter", 1.0),
    "steady_rate_deg_s": ("steady_rate", float(np.rad2deg(1.0))),
    "steady_speed_m_s": ("steady_speed", 1.0),
}
_SHOWN = ("psi", "r", "u", "v", "x", "y")
#: Samples of a circle that are enough to measure it.
_ENOUGH = 3000
Band = tuple[float, float] | None


@dataclass(frozen=True)
class Foreseen:
    """A quantity of a turning circle, in the unit of its key.

    Attributes
    ----------
    measured, predicted : float or None
        None where it was not reached, or the model does not predict it.
    band95 : tuple of float or None
        95 % band of the prediction.
    """

    measured: float | None
    predicted: float | None
    band95: Band

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "measured": _rounded(self.measured),
            "predicted": _rounded(self.predicted),
            "band95": _rounded_band(self.band95),
        }


@dataclass(frozen=True)
class Manoeuvre:
    """The manoeuvre of a trial, measured and predicted.

    Attributes
    ----------
    trial : str
        Name of the trial.
    overshoots, open_loop, closed_loop : tuple of float or None
        Overshoots in rad, one a swing: measured, predicted with the recorded rudder, and predicted with the rudder reversed
        at the measured headings.
    band95, closed_loop_band95 : tuple of tuple of float or None
        95 % bands of both predictions, in rad.
    turn : mapping of str to Foreseen
        Quantities of a turning circle; empty where it is none.
    """

    trial: str
    overshoots: tuple[float, ...] = ()
    open_loop: tuple[float | None, ...] = ()
    closed_loop: tuple[float | None, ...] = ()
    band95: tuple[Band, ...] = ()
    closed_loop_band95: tuple[Band, ...] = ()
    turn: Mapping[str, Foreseen] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return plain values: angles in degrees, None where something was not reached."""
        return {
            "overshoots_deg": [_degrees(o) for o in self.overshoots],
            "predicted_overshoots_deg": [_degrees(o) for o in self.open_loop],
            "predicted_overshoots_closed_loop_deg": [_degrees(o) for o in self.closed_loop],
            "band95_deg": [_degrees_band(b) for b in self.band95],
            "closed_loop_band95_deg": [_degrees_band(b) for b in self.closed_loop_band95],
            **{key: value.to_dict() for key, value in self.turn.items()},
        }


def manoeuvres_of(fit: Fit) -> dict[str, Manoeuvre]:
    """Return the manoeuvre of every trial of a fit, fitted and predicted, with its bands.

    Parameters
    ----------
    fit : Fit
        The fit.
    """
    if fit._problem is None:
        return {c.trial.name: _bare(c) for c in (*fit.fitted, *fit.validation)}
    draws = draws_of(fit)
    places = {id(sailed.trial): i for i, sailed in enumerate(fit._problem.sailed)}
    return {c.trial.name: _manoeuvre(fit, c, draws, places.get(id(c.trial))) for c in (*fit.fitted, *fit.validation)}


def _bare(comparison: Comparison) -> Manoeuvre:
    open_loop = tuple(None if o is None or not np.isfinite(o) else o for o in comparison.predicted_overshoots)
    return Manoeuvre(comparison.trial.name, comparison.overshoots, open_loop)


@dataclass(frozen=True, eq=False)
class _Runs:
    """The runs of one trial: its inputs, and (initial state, coefficients, bias) of the prediction and of each draw."""

    sailed: Sailed
    outputs: tuple[str, ...]
    point: tuple[np.ndarray, np.ndarray, np.ndarray]
    drawn: list[tuple[np.ndarray, np.ndarray, np.ndarray]]


def _manoeuvre(fit: Fit, comparison: Comparison, draws: Draws, index: int | None) -> Manoeuvre:
    trial = comparison.trial
    turning = _measured(trial, TurningCircle.kind) if _kind(trial) == TurningCircle.kind else None
    zigzag = _measured(trial, ZigZag.kind) if comparison.overshoots else None
    bare = _bare(comparison)
    if not isinstance(turning, TurningCircle) and not isinstance(zigzag, ZigZag):
        return bare
    runs = _runs(fit, comparison, draws, index)
    found: dict[str, Any] = {}
    if isinstance(zigzag, ZigZag):
        found |= _swings(fit, runs, comparison, zigzag)
    if isinstance(turning, TurningCircle):
        found["turn"] = _circle(fit, runs, turning)
    return Manoeuvre(trial.name, bare.overshoots, found.pop("open_loop", bare.open_loop), **found)


def _kind(trial: Trial) -> str:
    try:
        return detect(trial)
    except ShipidError:
        return ""


def _measured(trial: Trial, kind: str) -> Any:
    try:
        return measure(trial, kind)
    except ShipidError:
        return None


def _runs(fit: Fit, comparison: Comparison, draws: Draws, index: int | None) -> _Runs:
    from shipid.identification.validation.predictions import warm_up_samples

    problem, q = fit._problem, fit._solution.q
    trial = comparison.trial
    if index is None:
        count = warm_up_samples(trial, unit_time_of(fit.ship, [trial]))
        sailed = prepare(fit.model, trial, problem.signals, fit.ship.particular("speed", "m/s"), count)
    else:
        sailed = problem.sailed[index]
    record, inputs = problem.record, problem.record.system.inputs
    states = record.system.states
    x0, bias = sailed.x0.copy(), np.zeros(len(inputs))
    for name, value in comparison.initial.items():
        x0[states.index(name)] = value
    for name, value in comparison.biases.items():
        bias[inputs.index(name)] = value

    def vector(values: np.ndarray) -> np.ndarray:
        known = {**problem.fixed, **dict(zip(problem.estimated, values))}
        return np.asarray(record.system.vector(record.system.coefficients, known))

    drawn = []
    for unknowns in draws.unknowns:
        start, offset = x0.copy(), bias.copy()
        if index is not None:
            own, at = unknowns[problem.own(index)], q[problem.own(index)]
            for k, name in enumerate(problem.initial):
                start[states.index(name)] += own[k] - at[k]
        else:
            each = [problem.own(i) for i in range(len(problem.sailed))]
            own, at = (np.mean([v[e] for e in each], axis=0) for v in (unknowns, q))
        for k, name in enumerate(problem.biases, start=len(problem.initial)):
            if index is not None or name != "cruise":
                offset[inputs.index(name)] += own[k] - at[k]
        drawn.append((start, vector(unknowns[: len(problem.estimated)]), offset))
    outputs = tuple(n for n in _SHOWN if n in fit.model)
    return _Runs(sailed, outputs, (x0, vector(q[: len(problem.estimated)]), bias), drawn)


def _over(fit: Fit, runs: _Runs, outputs: tuple[str, ...], read: Callable[[np.ndarray], Any]) -> tuple[Any, list[Any]]:
    """Run the record for the prediction and each draw, and read each result."""
    record, s = make_record(fit.model, outputs), runs.sailed
    results = [read(record(x0, s.inputs, s.intervals, p, bias)[0]) for x0, p, bias in (runs.point, *runs.drawn)]
    return results[0], results[1:]


def _swings(fit: Fit, runs: _Runs, comparison: Comparison, measured: ZigZag) -> dict[str, Any]:

    trial, count = comparison.trial, len(comparison.overshoots)
    executes = [e for e in measured.executes or () if e is not None]
    side = 1 if measured.first_side == "starboard" else -1

    def read(y: np.ndarray) -> tuple[float | None, ...]:
        if not np.isfinite(y).all():
            return (None,) * count
        found = overshoots_of(trial["t"], y[0], executes, side=side)[:count]
        return found + (None,) * (count - len(found))

    point, drawn = _over(fit, runs, ("psi",), read)
    found: dict[str, Any] = {"open_loop": point, "band95": _bands(point, drawn)}
    helmsman = helmsman_of(trial, measured)
    if helmsman is None:
        return found
    simulator = zigzag_simulator(fit.model, trial, runs.sailed.inputs, helmsman, unit_time_of(fit.ship, [trial]))
    if simulator is None:
        return found
    point = simulator(*runs.point)[:count]
    drawn = [simulator(*d)[:count] for d in runs.drawn]
    lacking = (None,) * (count - len(point))
    return found | {"closed_loop": point + lacking, "closed_loop_band95": _bands(point, drawn) + lacking}


def _bands(point: tuple[float | None, ...], drawn: list[tuple[float | None, ...]]) -> tuple[Band, ...]:
    """Bands of overshoots, which are not negative."""
    found = [band_of(p, [d[k] for d in drawn]) for k, p in enumerate(point)]
    return tuple(None if b is None else (max(0.0, b[0]), b[1]) for b in found)


def _circle(fit: Fit, runs: _Runs, measured: TurningCircle) -> dict[str, Foreseen]:
    trial = runs.sailed.trial
    every = max(1, len(trial) // _ENOUGH)
    kept = {n: trial[n][::every] for n in ("t", "delta", "delta_order") if trial.has(n)}
    predicts_speed = "u" in fit.model and fit.model["u"].quantity.kind != "given"

    def read(y: np.ndarray) -> dict[str, float | None]:
        if not np.isfinite(y).all():
            return {}
        signals = {n: row[::every] for n, row in zip(runs.outputs, y) if n in FIELDS}
        try:
            found = measure(
                Trial(trial.name, pd.DataFrame({**kept, **signals})), measured.kind, execute=measured.execute
            )
        except ShipidError:
            return {}
        values = {key: getattr(found, name) for key, (name, _) in TURN.items()}
        return values if predicts_speed else values | {"steady_speed_m_s": None}

    point, drawn = _over(fit, runs, runs.outputs, read)
    result = {}
    for key, (name, scale) in TURN.items():
        own, foreseen = getattr(measured, name), point.get(key)
        band = band_of(foreseen, [d.get(key) for d in drawn])
        result[key] = Foreseen(
            None if own is None else own * scale,
            None if foreseen is None else foreseen * scale,
            None if band is None else (band[0] * scale, band[1] * scale),
        )
    return result


def _rounded(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else float(f"{value:.6g}")


def _rounded_band(band: Band) -> list[float | None] | None:
    return None if band is None else [_rounded(b) for b in band]


def _degrees(angle: float | None) -> float | None:
    return None if angle is None or not np.isfinite(angle) else round(float(np.rad2deg(angle)), 4)


def _degrees_band(band: Band) -> list[float | None] | None:
    return None if band is None else [_degrees(b) for b in band]
