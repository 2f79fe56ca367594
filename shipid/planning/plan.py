"""The result of planning: trials, and the standard deviations they give the coefficients, beside the standard zig-zags."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import columns_of, number, quantity, spread, uncertain_text
from shipid.foundation.result import DrawnResult, ResultEntry
from shipid.planning.leg import Leg
from shipid.planning.selection import Criterion
from shipid.planning.timetable import Timetable, clock

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False)
class Forecast(ResultEntry):
    """The standard deviation one coefficient will have.

    Attributes
    ----------
    name, unit, meaning : str
        The coefficient as declared; SI.
    value : float
        Its value before the trials.
    std : float or None
        Standard deviation after the plan; None where it stays undetermined.
    standard_std : float or None
        The same after the standard zig-zags.
    """

    name: str
    unit: str
    meaning: str
    value: float
    std: float | None
    standard_std: float | None

    @property
    def ratio(self) -> float | None:
        """Standard deviation after the standard zig-zags over that after the plan: more than 1 is a gain."""
        return self.standard_std / self.std if self.std and self.standard_std else None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "value": self.value,
            "unit": self.unit,
            "std": self.std,
            "standard_std": self.standard_std,
            "ratio": self.ratio,
            "meaning": self.meaning,
        }


@dataclass(frozen=True, eq=False, repr=False)
class Plan(DrawnResult):
    """Trials to sail.

    Attributes
    ----------
    model : Model
        The model to identify.
    ship : str
        The ship.
    time : float
        The time available, in s.
    criterion : {"D", "A"}
        Determinant, or mean relative variance.
    worst_case : bool
        Whether the worst draw of the coefficients counted, or the average.
    legs : tuple of Leg
        The manoeuvres, in order. Information does not depend on the order: it is the fastest first, and from gentle to hard.
    standard : tuple of Leg
        The zig-zags it is compared with; empty where the model runs away in them.
    parameters : mapping of str to Forecast
        Coefficients to estimate.
    covariance : ndarray, shape (estimated, estimated)
        Predicted, SI; infinite variances where nothing determines a coefficient.
    det_ratio : float or None
        Determinant of the information over that of the standard. A direction that the standard does not determine counts with a
        standard deviation of a thousand times the size of the coefficients.
    det_gain : float or None
        The same for each coefficient: its n-th root for n that can be determined.
    det_gain_over_draws : float or None
        The geometric mean of `det_gain` over the draws of the coefficients.
    value, standard_value : float or None
        The criterion that was maximised, for the plan and the standard.
    noise : mapping of str to float
        Standard deviation of one sample of each fitted signal, SI.
    sampling, independent : float
        Sampling interval, and time between two independent samples, in s.
    draws, candidates : int
        Number of draws and of candidates.
    warnings : tuple of str
        Manoeuvres left out, and coefficients that stay undetermined.
    timetable : Timetable or None
        Its rudder orders, and the sea room it takes; None where a manoeuvre could not be simulated for it.
    """

    model: Model
    ship: str
    time: float
    criterion: Criterion
    worst_case: bool
    legs: tuple[Leg, ...]
    standard: tuple[Leg, ...]
    parameters: Mapping[str, Forecast]
    covariance: np.ndarray
    det_ratio: float | None
    det_gain: float | None
    det_gain_over_draws: float | None
    value: float
    standard_value: float | None
    noise: Mapping[str, float]
    sampling: float
    independent: float
    draws: int
    candidates: int
    warnings: tuple[str, ...]
    timetable: Timetable | None = None

    @property
    def duration(self) -> float:
        """Time the plan takes in s."""
        return self.legs[-1].start + self.legs[-1].duration if self.legs else 0.0

    def to_frame(self) -> pd.DataFrame:
        """Return the manoeuvres as a pandas table."""
        import pandas as pd

        return pd.DataFrame([columns_of(leg.to_dict()) for leg in self.legs])

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as plain values for JSON, free of NaN.

        ``gain_over_standard`` holds under ``det`` the gain in the determinant for each coefficient, and by coefficient the
        standard deviation after the standard over that after the plan.
        """
        return {
            "model": self.model.name,
            "ship": self.ship,
            "time": quantity(self.time, "s"),
            "duration": quantity(self.duration, "s"),
            "criterion": self.criterion,
            "robust": "worst case" if self.worst_case else "average",
            "plan": [leg.to_dict() for leg in self.legs],
            "timetable": None if self.timetable is None else self.timetable.to_dict(),
            "standard": [leg.to_dict() for leg in self.standard],
            "gain_over_standard": {"det": self.det_gain, **{n: f.ratio for n, f in self.parameters.items()}},
            "determinant": {
                "per_parameter": self.det_gain,
                "ratio": self.det_ratio,
                "per_parameter_over_draws": self.det_gain_over_draws,
            },
            "parameters": {n: f.to_dict() for n, f in self.parameters.items()},
            "noise": {s: quantity(v, FIELDS[s].unit) for s, v in self.noise.items()},
            "sampling": quantity(self.sampling, "s"),
            "independent": quantity(self.independent, "s"),
            "draws": self.draws,
            "candidates": self.candidates,
            "warnings": plain_notices(self.warnings),
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        over = (
            f"{'the worst' if self.worst_case else 'the average'} of {self.draws} draws" if self.draws else "no draws"
        )
        lines = [
            f"{clock(self.duration)} of trials for {self.model.name} of {self.ship} ({self.criterion}-optimal over {over}; "
            f"{', '.join(self.noise)} measured)"
        ]
        for leg in self.legs:
            seed = f"  seed {leg.seed}" if leg.manoeuvre.startswith("telegraph") else ""
            lines.append(
                f"  at {clock(leg.start):>7s}  {leg.manoeuvre:<18s} {number(leg.speed, 3)} m/s  takes {clock(leg.duration)}{seed}"
            )
        beside = " + ".join(f"{leg.manoeuvre} {clock(leg.duration)}" for leg in self.standard) or "no standard"
        lines.append(f"  standard deviations, planned beside {beside}:")
        for f in self.parameters.values():
            gain = "" if f.ratio is None else f"   gain {number(f.ratio, 3)}"
            unit = "" if pretty(f.unit) == "1" else f" {pretty(f.unit)}"
            planned, standard = _estimate(f.value, f.std, unit), _standard(f, unit)
            lines.append(f"  {f.name:<10s} {planned} beside {standard}{gain}")
        if self.det_gain is not None and self.det_ratio is not None:
            each, all_of_them = number(self.det_gain, 3), number(self.det_ratio, 3)
            lines.append(f"  determinant {each} times better for each coefficient ({all_of_them} in all)")
        orders = [] if self.timetable is None else [self.timetable.text()]
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings), *orders])


def _estimate(value: float, std: float | None, unit: str) -> str:
    """A value with its standard deviation, in the digits that this allows; in the words of the page where no trial tells it."""
    known = std is not None and isfinite(std)
    return f"{uncertain_text(value, std if known else None)}{unit}" + ("" if known else " stays open")


def _standard(f: Forecast, unit: str) -> str:
    return "stays open" if f.standard_std is None else spread(f.value, f.standard_std) + unit
