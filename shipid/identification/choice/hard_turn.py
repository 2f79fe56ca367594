"""What a fitted model does in a hard turn, which is where most ships go beyond the trials of a campaign."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity
from shipid.foundation.result import ResultEntry
from shipid.generation.record import make_record
from shipid.generation.simulator import coefficient_vector, initial_state, input_rows
from shipid.identification.identified import Identified

#: Rudder angle in rad where the ship states no largest one; duration, interval and time to put the rudder over, in L/U.
_HARD = np.deg2rad(35.0)
_DURATION, _INTERVAL, _PUT_OVER = 15.0, 0.02, 0.3
#: Dimensionless rate of turn r L/U that no ship reaches.
_IMPOSSIBLE = 3.0
_RATE = "r"


@dataclass(frozen=True, repr=False)
class HardTurn(ResultEntry):
    """A turn with the rudder hard over, from the usual speed of the trials.

    Attributes
    ----------
    rudder : float
        Rudder angle in rad.
    rate : float or None
        Steady rate of turn in rad/s; None where the model runs away.
    spread : float
        Standard deviation of that rate over draws of the coefficients, in shares of it.
    runs_away : float
        Share of the draws in which the model runs away, or leaves the range in which it is valid.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"rudder": "rad", "rate": "rad/s", "spread": "1", "runs_away": "1"}

    rudder: float
    rate: float | None
    spread: float
    runs_away: float

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {
            "rudder": quantity(self.rudder, "rad"),
            "rate": quantity(self.rate, "rad/s"),
            "spread": self.spread,
            "runs_away": self.runs_away,
        }


def hard_turn(identified: Identified, drawn: Iterable[np.ndarray], worthless: float) -> HardTurn | None:
    """Return a turn with the rudder hard over; None for a model without a rudder or a rate of turn.

    Parameters
    ----------
    identified : Identified
        What was identified.
    drawn : iterable of ndarray, shape (unknowns,)
        Unknowns drawn from the covariance.
    worthless : float
        Spread of a model that runs away.
    """
    model, scale = identified.model, identified.scale
    speed = scale.speed or 1.0
    if "delta" not in model.inputs or _RATE not in model:
        return None
    rudder = identified.ship.particular("delta_max", "rad") or _HARD
    count = int(_DURATION / _INTERVAL) + 1
    clock = np.arange(count) * _INTERVAL
    inputs: dict[str, float | np.ndarray] = {n: speed for n in ("u", "cruise") if n in model.inputs}
    inputs["delta"] = rudder * np.minimum(1.0, clock / _PUT_OVER)
    # What else the ship is told is as it was in the trials: her loading, the revolutions of her propeller.
    inputs |= {n: v for n, v in _usual(identified).items() if n not in inputs}
    rows = input_rows(model, inputs, count)
    intervals = np.full(count, _INTERVAL * scale.unit_time)
    intervals[-1] = 0.0
    x0 = initial_state(model, {"u": speed} if "u" in model.states else {})
    record = make_record(model, (_RATE,), guarded=True)
    bias = np.zeros(len(model.inputs))

    def steady(unknowns: np.ndarray) -> float:
        y, _, margins = record.run(
            x0, rows, intervals, coefficient_vector(model, identified.problem.values(unknowns)), bias
        )
        whole = np.isfinite(y).all() and (margins >= 0).all() and (np.abs(y) * scale.unit_time < _IMPOSSIBLE).all()
        return float(y[0, -count // 4 :].mean()) if whole else np.nan

    point, rates = steady(identified.solution.q), np.array([steady(q) for q in drawn])
    away = float(np.isnan(rates).mean()) if rates.size else 0.0
    if not np.isfinite(point):
        return HardTurn(rudder, None, worthless, 1.0)
    kept = rates[np.isfinite(rates)]
    spread = float(np.sqrt(np.mean((kept - point) ** 2)) / max(abs(point), 1e-12)) if kept.size else worthless
    return HardTurn(rudder, point, min(worthless, spread), away)


def _usual(identified: Identified) -> dict[str, float]:
    """Medians over the trials of the inputs that declare no default, SI."""
    model = identified.model
    rows = np.concatenate([data.inputs for data in identified.problem.trials], axis=1)
    return {
        name: float(np.nanmedian(rows[i]))
        for i, name in enumerate(model.inputs)
        if model[name].number("default") is None and np.isfinite(rows[i]).any()
    }
