"""The estimate after a sample."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.vocabulary import shown_estimate
from shipid.estimation.design import FilterDesign
from shipid.estimation.records.derived import named
from shipid.foundation.aliases import Plain
from shipid.foundation.result import Result, table
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class OnlineEstimate(Result):
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

    def __getitem__(self, name: str) -> float:
        """Return the estimate of a state or an estimated parameter, SI."""
        return float(named(self.design, self.x, self.std, name)[0])

    def std_of(self, name: str) -> float:
        """Return the standard deviation of a state or an estimated parameter, SI.

        Parameters
        ----------
        name : str
            A state or an estimated parameter.
        """
        return float(named(self.design, self.x, self.std, name)[1])

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI; None where a number is not finite."""
        names = [s for s in self.design.model.states if s not in self.design.parameters.values()]
        names += list(self.design.parameters)
        model = self.design.model
        return {
            "t": self.t,
            "estimates": {
                n: {"value": plain(self[n]), "unit": model[n].unit, "std": plain(self.std_of(n))} for n in names
            },
            "taken": list(self.taken),
            "rejected": list(self.rejected),
            "refused": self.refused,
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the estimates as a pandas table, SI."""
        return table(({"name": n, **e} for n, e in self.to_dict()["estimates"].items()), "name")

    def text(self) -> str:
        """Return the estimate in lines of text."""
        estimates = self.to_dict()["estimates"].items()
        lines = [
            f"estimate at {self.t:g} s",
            *(f"  {n:<12s} {shown_estimate(e['value'], e['std'], n, e['unit'])}" for n, e in estimates),
        ]
        lines += [f"  rejected: {', '.join(self.rejected)}"] if self.rejected else []
        return "\n".join(lines + ([f"  refused: {self.refused}"] if self.refused else []))
