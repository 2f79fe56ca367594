"""The estimate after a sample."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.design import FilterDesign
from shipid.estimation.named_quantities import SampleEstimate
from shipid.estimation.records.derived import named
from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity


@dataclass(frozen=True, eq=False, repr=False)
class OnlineEstimate(SampleEstimate):
    """The estimate after a sample.

    Attributes
    ----------
    t : float
        Time of the sample in s.
    x, std : ndarray, shape (states,)
        Estimates and standard deviations, SI.
    taken, rejected : tuple of str
        Sensors whose sample was used, and whose sample was beyond the gate or out of range.
    refused : str
        Why the whole sample was refused; empty where it was not.
    lagged : tuple or None
        ``(t, x, std)`` one lag ago, smoothed with the samples since.
    design : FilterDesign
        Which filter.
    """

    t: float
    x: np.ndarray
    std: np.ndarray
    taken: tuple[str, ...]
    rejected: tuple[str, ...]
    refused: str
    lagged: tuple[float, np.ndarray, np.ndarray] | None
    design: FilterDesign = field(repr=False)

    @property
    def model(self) -> Model:
        """The model whose quantities they are."""
        return self.design.model

    @property
    def names(self) -> tuple[str, ...]:
        """The states, and the parameters that are estimated."""
        hidden = self.design.parameters.values()
        return (*(s for s in self.design.model.states if s not in hidden), *self.design.parameters)

    def quantity(self, name: str) -> tuple[float, float]:
        """Return a state or an estimated parameter and its standard deviation, SI.

        Parameters
        ----------
        name : str
            A state or an estimated parameter.
        """
        value, std = named(self.design, self.x, self.std, name)
        return float(value), float(std)

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI; None where a number is not finite."""
        return {
            "t": quantity(self.t, "s"),
            "estimates": self.estimates,
            "taken": list(self.taken),
            "rejected": list(self.rejected),
            "refused": self.refused,
        }

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was not used, and why."""
        lines = (f"rejected: {', '.join(self.rejected)}", f"refused: {self.refused}")
        return tuple(line for line, there in zip(lines, (self.rejected, self.refused)) if there)
