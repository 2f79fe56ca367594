"""The result of a multiple-model filter on a record."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from shipid.estimation.multiple.design import MultipleModelDesign
from shipid.estimation.named_quantities import RecordRun
from shipid.estimation.records.arrangement import Arrangement
from shipid.estimation.records.derived import quantity_along
from shipid.estimation.records.triangles import unpacked
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError
from shipid.foundation.numbers import fixed, moment
from shipid.foundation.result import DrawnResult

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class MultipleModelRun(RecordRun, DrawnResult):
    """A record and what a multiple-model filter made of it; N samples, M modes.

    Attributes
    ----------
    design : MultipleModelDesign
        Which filter.
    record : str
        Name of the record.
    arranged : Arrangement
        The record as the filter took it.
    control : ndarray, shape (rows, controls)
        What the cycle took of each row (`CycleLayout.control`).
    out : ndarray, shape (rows, outputs)
        What it returned for each row (`CycleLayout.full`).
    """

    design: MultipleModelDesign
    record: str
    arranged: Arrangement
    control: np.ndarray
    out: np.ndarray

    @property
    def places(self) -> Mapping[str, slice]:
        """Where each part stands among the outputs of the cycle (`CycleLayout.full`)."""
        return self.design.layout.full

    @property
    def states(self) -> tuple[str, ...]:
        """Names along the combined estimates."""
        return self.design.states

    @property
    def modes(self) -> tuple[str, ...]:
        """Names of the modes."""
        return self.design.names

    @functools.cached_property
    def covariance(self) -> np.ndarray:
        """Their covariance, the spread between the modes included, shape (N, states, states)."""
        return unpacked(self.rows("P"), self.design.layout.n)

    @property
    def std(self) -> np.ndarray:
        """Their standard deviations, shape (N, states)."""
        return np.asarray(np.sqrt(np.maximum(np.einsum("kii->ki", self.covariance), 0.0)))

    @property
    def probabilities(self) -> np.ndarray:
        """Probability of each mode after each sample, shape (N, M)."""
        return self.rows("mu")

    @property
    def most_probable(self) -> tuple[str, ...]:
        """The most probable mode after each sample."""
        return tuple(self.modes[j] for j in np.argmax(self.probabilities, axis=1))

    @property
    def parameter(self) -> np.ndarray:
        """The moving parameter of each mode after each sample, its displacement included, SI, shape (N, M); no column where none moves."""
        return self.rows("theta")

    def mode(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the estimates of one mode, shapes (N, n), and their covariances, (N, n, n), in its own states, SI.

        Parameters
        ----------
        name : str
            The mode.

        Raises
        ------
        UnknownNameError
            If there is no such mode.
        """
        if name not in self.modes:
            raise UnknownNameError("mode called", name, self.modes)
        j = self.modes.index(name)
        return self.rows(f"x{j}"), unpacked(self.rows(f"P{j}"), self.design.layout.sizes[j])

    def quantity(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return a quantity and its standard deviation along the record, SI, shapes (N,).

        Parameters
        ----------
        name : str
            A state of the combined estimate, or a quantity of the first mode's model: its standard deviation is then first-order.
        """
        if name in self.states:
            at = self.states.index(name)
            return self.x[:, at], self.std[:, at]
        shown = self.arranged.shown
        inputs, intervals = self.arranged.inputs[shown], self.arranged.intervals[shown]
        return quantity_along(self.design.first, name, self.x, self.covariance, inputs, intervals)

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table: time, combined estimates with standard deviations, and mode probabilities, units in the headers."""
        import pandas as pd

        columns: dict[str, np.ndarray] = {"t [s]": self.t}
        for name in self.states:
            unit = self.design.first.model[name].unit
            columns[f"{name} [{unit}]"], columns[f"std_{name} [{unit}]"] = self.quantity(name)
        for j, name in enumerate(self.modes):
            columns[f"probability_{name} [1]"] = self.probabilities[:, j]
        return pd.DataFrame(columns)

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as plain values, free of NaN."""
        last, mean = self.probabilities[-1], self.probabilities.mean(axis=0)
        return {
            "record": self.record,
            "samples": int(self.t.size),
            "modes": {
                n: {
                    "model": d.base.name,
                    "ship": d.ship.name,
                    "probability": float(last[j]),
                    "mean_probability": float(mean[j]),
                }
                for j, (n, d) in enumerate(self.design.modes.items())
            },
            "most_probable": self.most_probable[-1],
            "states": {
                n: {
                    "value": float(self.x[-1, i]),
                    "std": float(self.std[-1, i]),
                    "unit": self.design.first.model[n].unit,
                }
                for i, n in enumerate(self.states)
            },
            "clock_went_back": self.arranged.back,
            "holes": self.arranged.to_dict(),
            "log_likelihood": self.log_likelihood,
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        lines = [
            repr(self.design).strip("<>"),
            f"record {self.record}: {self.t.size} samples, {moment(self.t[0])} to {moment(self.t[-1])} s",
        ]
        last, mean = self.probabilities[-1], self.probabilities.mean(axis=0)
        lines += [
            f"  mode {n:<16s} probability {fixed(last[j], 4)} at the end, {fixed(mean[j], 4)} on average"
            for j, n in enumerate(self.modes)
        ]
        lines += [f"  {sentence}" for sentence in self.arranged.words]
        return "\n".join(lines)
