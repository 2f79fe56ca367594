"""The manoeuvre of a trial, measured and predicted with 95 % bands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity
from shipid.foundation.result import Result, table
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd

#: Quantities of a turning circle by their names in `TurningCircle`: the unit they are handed over in, and the factor to it from SI.
TURN = {
    "advance": ("m", 1.0),
    "transfer": ("m", 1.0),
    "tactical_diameter": ("m", 1.0),
    "steady_rate": ("deg/s", float(np.rad2deg(1.0))),
    "steady_speed": ("m/s", 1.0),
}
Band = tuple[float, float] | None


@dataclass(frozen=True, repr=False)
class PredictedQuantity(Result):
    """A quantity of a turning circle, in the unit of `TURN`.

    Attributes
    ----------
    measured, predicted : float or None
        None where it was not reached, or the model does not predict it.
    band95 : tuple of float or None
        95 % band of the prediction.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"measured": "SI", "predicted": "SI", "band95": "SI"}

    measured: float | None
    predicted: float | None
    band95: Band

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "measured": _rounded(self.measured),
            "predicted": _rounded(self.predicted),
            "interval_95": None if self.band95 is None else [_rounded(b) for b in self.band95],
        }


@dataclass(frozen=True, repr=False)
class PredictedManoeuvre(Result):
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
    turn : mapping of str to PredictedQuantity
        Quantities of a turning circle; empty where it is none.
    growth : float
        How far the prediction goes beyond the amplitudes that were fitted, 1 where it does not: the part of the bands that is due to
        the structure is so many times as wide.
    """

    UNITS: ClassVar[Mapping[str, str]] = {
        "overshoots": "rad",
        "open_loop": "rad",
        "closed_loop": "rad",
        "band95": "rad",
        "closed_loop_band95": "rad",
        "growth": "1",
    }

    trial: str
    overshoots: tuple[float, ...] = ()
    open_loop: tuple[float | None, ...] = ()
    closed_loop: tuple[float | None, ...] = ()
    band95: tuple[Band, ...] = ()
    closed_loop_band95: tuple[Band, ...] = ()
    turn: Mapping[str, PredictedQuantity] = field(default_factory=dict)
    growth: float = 1.0

    def to_frame(self) -> pd.DataFrame:
        """Return overshoots and quantities of a turn as a pandas table: measured, predicted, 95 % band; angles in degrees."""
        rows = [
            _row(f"overshoot {k}, {kind}", "deg", self.overshoots[k - 1 : k], predicted[k - 1 : k], bands[k - 1 : k])
            for kind, predicted, bands in (
                ("recorded rudder", self.open_loop, self.band95),
                ("rudder reversed at the headings", self.closed_loop, self.closed_loop_band95),
            )
            for k in range(1, len(predicted) + 1)
        ]
        rows += [
            {"quantity": n, "measured": q.measured, "predicted": q.predicted, **_ends(q.band95), "unit": TURN[n][0]}
            for n, q in self.turn.items()
        ]
        return table(rows, "quantity", ("measured", "predicted", "low_95", "high_95", "unit"))

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values: angles in degrees, None where something was not reached."""
        return {
            "overshoots": quantity(in_degrees(self.overshoots), "deg"),
            "predicted_overshoots": _with_bands(self.open_loop, self.band95),
            "predicted_overshoots_closed_loop": _with_bands(self.closed_loop, self.closed_loop_band95),
            **{key: value.to_dict() | {"unit": TURN[key][0]} for key, value in self.turn.items()},
            "times_beyond_fitted": None if self.growth == 1 else round(self.growth, 3),
        }


def _row(
    name: str, unit: str, measured: Sequence[float | None], predicted: Sequence[float | None], bands: Sequence[Band]
) -> dict[str, Plain]:
    """A row of angles, each given as a sequence of one, or of none where it was not reached."""
    found = {n: next(iter(in_degrees(tuple(v))), None) for n, v in (("measured", measured), ("predicted", predicted))}
    band = next(iter(bands), None)
    return {"quantity": name, **found, **_ends(None if band is None else in_degrees(band)), "unit": unit}


def _ends(band: Sequence[float | None] | None) -> dict[str, Plain]:
    low, high = band or (None, None)
    return {"low_95": low, "high_95": high}


def _with_bands(angles: tuple[float | None, ...], bands: tuple[Band, ...]) -> dict[str, Plain]:
    return {
        **quantity(in_degrees(angles), "deg"),
        "interval_95": [None if b is None else in_degrees(b) for b in bands],
    }


def in_degrees(angles: tuple[float | None, ...]) -> list[float | None]:
    """Return angles in degrees with four decimals, for JSON.

    Parameters
    ----------
    angles : tuple of float or None
        In rad; None or not finite where one was not reached.

    Returns
    -------
    list of float or None
    """
    finite = [plain(a) for a in angles]
    return [None if a is None else round(float(np.rad2deg(a)), 4) for a in finite]


def _rounded(value: float | None) -> float | None:
    value = plain(value)
    return None if value is None else float(f"{value:.6g}")
