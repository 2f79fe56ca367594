"""The result of a filter on a record."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.estimate import Estimate, estimate_of
from shipid.estimation.named_quantities import RecordRun
from shipid.estimation.records.arrangement import Arrangement
from shipid.estimation.records.consistency import whiteness
from shipid.estimation.records.derived import named, published, quantity_along
from shipid.estimation.records.first_estimate import first_estimate
from shipid.estimation.records.triangles import unpacked
from shipid.estimation.recursion.gate import MISSING, REJECTED, TAKEN
from shipid.estimation.standing import UNKNOWN, standing_of
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import moment, probability
from shipid.foundation.result import DrawnResult, Result
from shipid.foundation.statistics import interval_95

if TYPE_CHECKING:
    import pandas as pd

#: Largest standard deviation of a logarithm whose interval is still a number.
_WIDEST = 150.0
#: The fields of an estimate that are reported as plain values.
_REPORTED = ("value", "unit", "std", "interval_95", "identifiable", "standing", "why", "meaning")


@dataclass(frozen=True, repr=False)
class Innovations(Result):
    """Innovations of one sensor: measured less predicted value, given the sensors before it in the same sample.

    Attributes
    ----------
    t : ndarray, shape (M,)
        Times of the samples that were there, in s.
    values, variances : ndarray, shape (M,)
        SI.
    taken : ndarray of bool, shape (M,)
        Which of them were used.
    rejected : int
        How many were beyond the gate.
    limited : int
        How many were outside the sensor's range (these are not among the M).
    nis_mean : float or None
        Mean of the squared normalised innovations that were used; 1 for a consistent filter.
    nis_band : tuple of float or None
        The 95 % band of that mean.
    white_p : float or None
        Probability of correlations as large as these if the normalised innovations were white (Ljung-Box).
    """

    TABLE: ClassVar[str] = "t"
    UNITS: ClassVar[Mapping[str, str]] = {
        "t": "s",
        "values": "SI",
        "variances": "SI",
        "nis_mean": "1",
        "nis_band": "1",
        "white_p": "1",
        "taken": "",
    }

    t: np.ndarray
    values: np.ndarray
    variances: np.ndarray
    taken: np.ndarray
    rejected: int
    limited: int
    nis_mean: float | None
    nis_band: tuple[float, float] | None
    white_p: float | None

    @property
    def normalised(self) -> np.ndarray:
        """The innovations that were used, in standard deviations."""
        return np.asarray(self.values[self.taken] / np.sqrt(self.variances[self.taken]))


@dataclass(frozen=True, eq=False, repr=False)
class FilterRun(RecordRun, DrawnResult):
    """A record and the result of the filter; N samples.

    Attributes
    ----------
    design : FilterDesign
        Which filter.
    record : str
        Name of the record.
    arranged : Arrangement
        The record as the filter took it.
    control : ndarray, shape (rows, controls)
        What the step took of each row; `StepLayout.control` says what stands where.
    starts : tuple of ndarray, shape (carried,)
        What it carried into the first row of each stretch between holes of an input (`StepLayout.carried`).
    out : ndarray, shape (rows, outputs)
        What it returned for each row (`StepLayout.full`).
    warnings : tuple of Notice
        What speaks against the result (`shipid.estimation.levels.judge_filter`); empty as long as nothing was examined.
    widening : mapping of str to float
        By estimated parameter: how many times wider its interval is than by the filter's own covariance.
    withheld : str
        Why no interval of a parameter is given; empty where they are.
    learnt : tuple of str
        ``sensor:NAME`` and ``noise:NAME`` whose level comes from the record.
    added : mapping of str to tuple of float and str
        By input to which a constant is added that comes from the record: its standard deviation, SI, and what speaks against it.
    smoothable : bool
        Whether the rows are those of one filter, so that it can be run back over them; a mixture of several is not.
    """

    design: FilterDesign
    record: str
    arranged: Arrangement
    control: np.ndarray
    starts: tuple[np.ndarray, ...]
    out: np.ndarray
    warnings: tuple[Notice, ...] = field(default=(), kw_only=True)
    widening: Mapping[str, float] = field(default_factory=dict, kw_only=True)
    withheld: str = field(default="", kw_only=True)
    learnt: tuple[str, ...] = field(default=(), kw_only=True)
    added: Mapping[str, tuple[float, str]] = field(default_factory=dict, kw_only=True)
    smoothable: ClassVar[bool] = True

    @property
    def places(self) -> Mapping[str, slice]:
        """Where each part stands among the outputs of the step (`StepLayout.full`)."""
        return self.design.layout.full

    @property
    def start(self) -> np.ndarray:
        """What it carried into the first row of all, shape (carried,)."""
        return self.starts[0]

    @property
    def std(self) -> np.ndarray:
        """Their standard deviations, shape (N, states)."""
        return np.asarray(np.sqrt(np.maximum(self.rows("var"), 0.0)))

    @property
    def states(self) -> tuple[str, ...]:
        """Names along the estimates."""
        return self.design.model.states

    def quantity(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return a quantity of the model and its standard deviation along the record, SI, shapes (N,).

        Parameters
        ----------
        name : str
            A state, an estimated parameter, or what follows from them: its standard deviation is then first-order, by the
            exact Jacobian and the whole covariance.
        """
        if name in self.states or name in self.design.parameters or name not in self.design.model:
            return named(self.design, self.x, self.std, name)
        shown = self.arranged.shown
        joint = np.concatenate([self.x, self.rows("w")], axis=1)
        inputs, intervals = self.arranged.inputs[shown], self.arranged.intervals[shown]
        return quantity_along(self.design, name, joint, self.joint_covariance, inputs, intervals)

    @functools.cached_property
    def joint_covariance(self) -> np.ndarray:
        """Covariance after each sample of the states and the noise that sensors share with them, shape (N, joint, joint)."""
        return unpacked(self.rows("P"), self.design.layout.joint)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the states after each sample, shape (N, states, states)."""
        n = self.design.layout.n
        return self.joint_covariance[:, :n, :n]

    @functools.cached_property
    def innovations(self) -> dict[str, Innovations]:
        """Innovations by sensor."""
        e, spread, fate = (self.rows(n) for n in ("e", "S", "fate"))
        return {n: _innovations(self, i, e[:, i], spread[:, i], fate[:, i]) for i, n in enumerate(self.design.measured)}

    @property
    def nis(self) -> np.ndarray:
        """Sum of the squared normalised innovations used at each sample, shape (N,)."""
        fate = self.rows("fate") == TAKEN
        return np.asarray(np.where(fate, self.rows("e") ** 2 / self.rows("S"), 0.0).sum(axis=1))

    @functools.cached_property
    def parameters(self) -> dict[str, Estimate]:
        """The last estimate of each parameter, then of the published ones that follow, with 95 % intervals.

        The interval of one estimated by its logarithm is exact, that of one that follows first-order.
        """
        result = {}
        _, first = first_estimate(self.design, {})
        scale = self.design.instruments.scale
        for name, state in self.design.parameters.items():
            value, spread = (float(column[-1]) for column in self._widened(name))
            ends = None
            if state != name and not self.withheld:
                i = self.states.index(state)
                wide = self.widening.get(name, 1.0) * float(self.std[-1, i])
                low, high = interval_95(float(self.x[-1, i]), min(wide, _WIDEST))
                ends = (float(np.exp(low)), float(np.exp(high)))
            entry, i = self.design.base[name], self.states.index(state)
            # In the state's own terms, which may be the logarithm: how much the record has added to the first estimate.
            # Where the ship's set states a standard deviation, the first estimate is knowledge too.
            held = self.design.ship.find(self.design.base, name)
            assumed = held is None or not held.std
            own = spread / self.widening.get(name, 1.0)
            before = own * float(first[i] / self.std[-1, i]) if assumed and self.std[-1, i] > 0 else np.inf
            size = abs(scale.start_of(entry) or 0.0)
            standing = standing_of(value, spread, low=scale.bounds_of(entry)[0], size=size, before=before)
            if self.withheld:
                standing = UNKNOWN, self.withheld
            result[name] = estimate_of(entry, value, spread, ci95=ends, standing=standing)
        for name in self._published:
            value, spread = (float(column[-1]) for column in self._widened(name))
            # A gain or a time constant that passes through infinity has no value.
            if np.isfinite(value) and (np.isfinite(spread) or self.withheld):
                why = (UNKNOWN, self.withheld) if self.withheld else None
                result[name] = estimate_of(self.design.base[name], value, spread, standing=why, follows=True)
        return result

    def _widened(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """A parameter, or what follows from several, with standard deviations as wide as the innovations ask for."""
        value, spread = self.quantity(name)
        if self.withheld and (name in self.design.parameters or name in self._published):
            return value, np.full_like(spread, np.nan)
        others = max(self.widening.values(), default=1.0) if name in self._published else 1.0
        return value, spread * self.widening.get(name, others)

    @property
    def _published(self) -> tuple[str, ...]:
        return published(self.design.base, tuple(self.design.parameters))

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table: time, estimates and standard deviations, SI, units in the headers."""
        import pandas as pd

        columns: dict[str, np.ndarray] = {"t [s]": self.t}
        names = [s for s in self.states if s not in self.design.parameters.values()]
        for name in (*names, *self.design.parameters, *self._published):
            unit = self.design.model[name].unit
            columns[f"{name} [{unit}]"], columns[f"std_{name} [{unit}]"] = self._widened(name)
        return pd.DataFrame(columns)

    def to_dict(self) -> dict[str, Plain]:
        """Return the result as plain values, free of NaN."""
        return {
            "model": self.design.base.name,
            "ship": self.design.ship.name,
            "record": self.record,
            "samples": int(self.t.size),
            "parameters": {
                n: {key: value for key, value in p.to_dict().items() if key in _REPORTED}
                for n, p in self.parameters.items()
            },
            "states": {
                n: {"value": float(self[n][-1]), "std": float(self.std_of(n)[-1]), "unit": self.design.model[n].unit}
                for n in self.states
                if n not in self.design.parameters.values()
            },
            "innovations": {
                n: {
                    "nis_mean": i.nis_mean,
                    "nis_interval_95": None if i.nis_band is None else list(i.nis_band),
                    "white_p": i.white_p,
                    "rejected": i.rejected,
                    "out_of_range": i.limited,
                    "samples": int(i.t.size),
                }
                for n, i in self.innovations.items()
            },
            "clock_went_back": self.arranged.back,
            "holes": self.arranged.to_dict(),
            "log_likelihood": self.log_likelihood,
            "warnings": plain_notices(self.warnings),
            "widening": dict(self.widening),
        }

    @property
    def reliable(self) -> bool:
        """Whether nothing serious speaks against the result, as far as it was examined."""
        return not any(n.serious for n in self.warnings)

    def text(self) -> str:
        """Return the result in lines of text."""
        lines = [
            repr(self.design).strip("<>"),
            f"record {self.record}: {self.t.size} samples, {moment(self.t[0])} to {moment(self.t[-1])} s",
        ]
        lines += [f"  {p}" for p in self.parameters.values()]
        for name, i in self.innovations.items():
            mean = "-" if i.nis_mean is None else f"{i.nis_mean:.3f}"
            white = "-" if i.white_p is None else probability(i.white_p)
            lines.append(
                f"  innovations of {name:<10s} NIS {mean} (1 is right), whiteness p {white}, rejected {i.rejected}"
                + ("" if i.t.size == self.t.size else f", {i.t.size} samples at {self.t.size} times")
            )
        lines += [f"  {sentence}" for sentence in self.arranged.words]
        return "\n".join(lines)


def _innovations(run: FilterRun, i: int, e: np.ndarray, spread: np.ndarray, fate: np.ndarray) -> Innovations:
    there = fate != MISSING
    taken = fate[there] == TAKEN
    normalised = e[there][taken] / np.sqrt(spread[there][taken])
    count = normalised.size
    mean = float(np.mean(normalised**2)) if count else None
    band = None
    if count:
        from scipy.special import chdtri

        band = (float(chdtri(count, 0.975)) / count, float(chdtri(count, 0.025)) / count)
    return Innovations(
        run.t[there],
        e[there],
        spread[there],
        taken,
        int(np.count_nonzero(fate == REJECTED)),
        int(run.arranged.limited[i]),
        mean,
        band,
        whiteness(normalised),
    )
