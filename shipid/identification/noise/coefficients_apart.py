"""Whether the coefficients of a filter are those that simulate the ship.

Where a model is exact, prediction error and output error estimate the same coefficients, and differ by less than either is known
(Hausman 1978). Where it is not, prediction error takes what the model leaves out for noise that drives the ship, and its
intervals hold another value than the one that simulates her.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import pretty
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity, uncertain_text
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import NORMAL_95


@dataclass(frozen=True, repr=False)
class CoefficientApart(ResultEntry):
    """A coefficient of which two estimates from the same record differ.

    Attributes
    ----------
    name, unit : str
        The coefficient.
    value, std : float
        Estimate of prediction error and its standard deviation, SI.
    simulated, simulated_std : float
        The same of output error.
    """

    name: str
    unit: str
    value: float
    std: float
    simulated: float
    simulated_std: float

    @property
    def words(self) -> str:
        """Both in words."""
        unit = "" if self.unit in ("", "1") else f" {pretty(self.unit)}"
        own, other = uncertain_text(self.value, self.std), uncertain_text(self.simulated, self.simulated_std)
        return f"{self.name} {own}{unit} (by output error {other}{unit})"

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {
            "name": self.name,
            "prediction_error": quantity(self.value, self.unit) | {"std": self.std},
            "output_error": quantity(self.simulated, self.unit) | {"std": self.simulated_std},
        }


def coefficients_apart(
    model: Model,
    names: Sequence[str],
    filtered: tuple[np.ndarray, np.ndarray],
    simulated: tuple[np.ndarray, np.ndarray],
) -> tuple[CoefficientApart, ...]:
    """Return the coefficients whose two estimates differ by more than two independent ones would, once in twenty times.

    The estimates share their record, so that they differ by less where the model is exact.

    Parameters
    ----------
    model : Model
        For the units.
    names : sequence of str
        The coefficients.
    filtered, simulated : tuple of ndarray
        Values, shape (coefficients,), and standard deviations of prediction error and of output error, SI.
    """
    found = []
    for name, value, std, other, spread in zip(names, *filtered, *simulated):
        both = float(np.hypot(std, spread))
        if np.isfinite([value, other, both]).all() and abs(value - other) > NORMAL_95 * both:
            found.append(CoefficientApart(name, model[name].unit, *map(float, (value, std, other, spread))))
    return tuple(found)
