"""What a filter made of a record."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.estimation.records.arrangement import Arrangement
from shipid.estimation.records.consistency import whiteness
from shipid.estimation.recursion.step import MISSING, REJECTED, TAKEN
from shipid.foundation.errors import UnknownNameError

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.records.observability import Observability
    from shipid.estimation.records.smoother import Smoothed

_Z95 = 1.959963984540054


@dataclass(frozen=True)
class Innovations:
    """Innovations of one sensor: what it showed less what was expected, given the sensors before it in the same sample.

    Attributes
    ----------
    t : ndarray, shape (M,)
        Times of the samples that were there, in s.
    values, variances : ndarray, shape (M,)
        SI.
    taken : ndarray of bool, shape (M,)
        Which of them were taken in.
    rejected : int
        How many were beyond the gate.
    limited : int
        How many were outside the sensor's range (these are not among the M).
    nis_mean : float or None
        Mean of the squared normalised innovations that were taken in; 1 for a consistent filter.
    nis_band : tuple of float or None
        The 95 % band of that mean.
    white_p : float or None
        Probability of correlations as large as these if the normalised innovations were white (Ljung-Box).
    """

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
        """The innovations that were taken in, in standard deviations."""
        return self.values[self.taken] / np.sqrt(self.variances[self.taken])


@dataclass(frozen=True)
class ParameterEstimate:
    """The last estimate of a parameter.

    Attributes
    ----------
    name, unit, meaning : str
    value, std : float
        SI.
    interval : tuple of float
        95 %.
    follows : bool
        Whether it is a published coefficient that follows from the estimated ones.
    """

    name: str
    unit: str
    meaning: str
    value: float
    std: float
    interval: tuple[float, float]
    follows: bool = False

    @property
    def determined(self) -> bool:
        """Whether the standard deviation is below half the value, as for a fit."""
        return self.std < 0.5 * abs(self.value)


@dataclass(frozen=True, eq=False, repr=False)
class FilterRun:
    """A record and what the filter made of it; N samples.

    Attributes
    ----------
    filter : ExtendedKalmanFilter
        Which filter.
    record : str
        Name of the record.
    arranged : Arrangement
        The record as the filter took it.
    """

    filter: ExtendedKalmanFilter
    record: str
    arranged: Arrangement
    _control: np.ndarray = field(repr=False)
    _start: np.ndarray = field(repr=False)
    _out: np.ndarray = field(repr=False)

    def _rows(self, name: str) -> np.ndarray:
        return self._out[self.arranged.shown][:, self.filter.layout.full[name]]

    @property
    def t(self) -> np.ndarray:
        """Times of the samples in s, shape (N,)."""
        return self.arranged.t[self.arranged.shown]

    @property
    def x(self) -> np.ndarray:
        """Estimates of the states after each sample, SI, shape (N, states)."""
        return self._rows("x")

    @property
    def std(self) -> np.ndarray:
        """Their standard deviations, shape (N, states)."""
        return np.sqrt(np.maximum(self._rows("var"), 0.0))

    @property
    def states(self) -> tuple[str, ...]:
        """Names along the estimates."""
        return self.filter.model.states

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the estimates of any quantity of the model along the record, SI, shape (N,)."""
        return self.quantity(name)[0]

    def std_of(self, name: str) -> np.ndarray:
        """Return the standard deviations of a quantity along the record, SI, shape (N,).

        Parameters
        ----------
        name : str
            See `quantity`.
        """
        return self.quantity(name)[1]

    def quantity(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return a quantity of the model and its standard deviation along the record, SI, shapes (N,).

        Parameters
        ----------
        name : str
            A state, an estimated parameter, or what follows from them: its standard deviation is then first-order, by the
            exact Jacobian and the whole covariance.
        """
        if name in self.states or name in self.filter.parameters or name not in self.filter.model:
            return named(self.filter, self.x, self.std, name)
        from shipid.estimation.records.derived import along

        return along(self, name)

    @functools.cached_property
    def joint_covariance(self) -> np.ndarray:
        """Covariance after each sample of the states and the noise that sensors share with them, shape (N, joint, joint)."""
        return unpacked(self._rows("P"), self.filter.layout.joint)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the states after each sample, shape (N, states, states)."""
        n = self.filter.layout.n
        return self.joint_covariance[:, :n, :n]

    @property
    def log_likelihood(self) -> float:
        """Logarithm of the likelihood of what was taken in, given the model and the noise levels."""
        return float(self._out[:, self.filter.layout.full["ll"]].sum())

    @functools.cached_property
    def innovations(self) -> dict[str, Innovations]:
        """Innovations by sensor."""
        e, spread, fate = (self._rows(n) for n in ("e", "S", "fate"))
        return {n: _innovations(self, i, e[:, i], spread[:, i], fate[:, i]) for i, n in enumerate(self.filter.measured)}

    @property
    def nis(self) -> np.ndarray:
        """Sum of the squared normalised innovations taken in at each sample, shape (N,)."""
        fate = self._rows("fate") == TAKEN
        return np.where(fate, self._rows("e") ** 2 / self._rows("S"), 0.0).sum(axis=1)

    @functools.cached_property
    def parameters(self) -> dict[str, ParameterEstimate]:
        """The last estimate of each parameter, then of the published ones that follow, with 95 % intervals.

        The interval of one estimated by its logarithm is exact, that of one that follows first-order.
        """
        result = {}
        for name, state in self.filter.parameters.items():
            i = self.states.index(state)
            entry = self.filter.base[name]
            x, std = float(self.x[-1, i]), float(self.std[-1, i])
            value, spread = (x, std) if state == name else (float(np.exp(x)), float(np.exp(x)) * std)
            ends = (x - _Z95 * std, x + _Z95 * std)
            low, high = ends if state == name else (float(np.exp(ends[0])), float(np.exp(ends[1])))
            result[name] = ParameterEstimate(name, entry.unit, entry.quantity.meaning, value, spread, (low, high))
        for name in self._published:
            entry = self.filter.base[name]
            value, spread = (float(column[-1]) for column in self.quantity(name))
            # A gain or a time constant that passes infinity is no number.
            if np.isfinite([value, spread]).all():
                ends = (value - _Z95 * spread, value + _Z95 * spread)
                result[name] = ParameterEstimate(
                    name, entry.unit, entry.quantity.meaning, value, spread, ends, follows=True
                )
        return result

    @property
    def _published(self) -> tuple[str, ...]:
        from shipid.estimation.records.derived import published

        return published(self.filter.base, tuple(self.filter.parameters))

    def smooth(self) -> Smoothed:
        """Return estimates that every sample of the record bears on (see `shipid.estimation.records.smoother`)."""
        from shipid.estimation.records.smoother import smooth

        return smooth(self)

    def observability(self) -> Observability:
        """Return which directions of the state the record tells nothing of (see `shipid.estimation.records.observability`)."""
        from shipid.estimation.records.observability import observability

        return observability(self)

    def to_frame(self) -> Any:
        """Return a pandas table: time, estimates and standard deviations, SI, units in the headers."""
        import pandas as pd

        columns: dict[str, np.ndarray] = {"t [s]": self.t}
        names = [s for s in self.states if s not in self.filter.parameters.values()]
        for name in (*names, *self.filter.parameters, *self._published):
            unit = self.filter.model[name].unit
            columns[f"{name} [{unit}]"], columns[f"std_{name} [{unit}]"] = self.quantity(name)
        return pd.DataFrame(columns)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain values, free of NaN."""
        return {
            "model": self.filter.base.name,
            "ship": self.filter.ship.name,
            "record": self.record,
            "samples": int(self.t.size),
            "parameters": {
                n: {
                    "value": p.value,
                    "unit": p.unit,
                    "std": p.std,
                    "ci95": list(p.interval),
                    "identifiable": p.determined,
                    "meaning": p.meaning,
                }
                for n, p in self.parameters.items()
            },
            "states": {
                n: {"value": float(self[n][-1]), "std": float(self.std_of(n)[-1]), "unit": self.filter.model[n].unit}
                for n in self.states
                if n not in self.filter.parameters.values()
            },
            "innovations": {
                n: {
                    "nis_mean": i.nis_mean,
                    "nis_band95": None if i.nis_band is None else list(i.nis_band),
                    "white_p": i.white_p,
                    "rejected": i.rejected,
                    "out_of_range": i.limited,
                    "samples": int(i.t.size),
                }
                for n, i in self.innovations.items()
            },
            "clock_went_back": self.arranged.back,
            "log_likelihood": self.log_likelihood,
        }

    def __repr__(self) -> str:
        lines = [f"{self.filter!r}", f"record {self.record}: {self.t.size} samples, {self.t[0]:g} to {self.t[-1]:g} s"]
        for name, p in self.parameters.items():
            lines.append(f"  {name:<12s}{p.value:11.4g} ± {p.std:.2g} {p.unit}   {p.meaning}")
        for name, i in self.innovations.items():
            mean = "-" if i.nis_mean is None else f"{i.nis_mean:.3f}"
            white = "-" if i.white_p is None else f"{i.white_p:.2g}"
            lines.append(
                f"  innovations of {name:<10s} NIS {mean} (1 is right), whiteness p {white}, rejected {i.rejected}"
            )
        return "\n".join(lines)


def named(kalman: ExtendedKalmanFilter, x: np.ndarray, std: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return estimates and standard deviations of a state or an estimated parameter, SI, the states along the last axis.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        Whose states they are.
    x, std : ndarray, shape (..., states)
        Estimates and standard deviations; of a logarithm where a parameter is estimated by it.
    name : str
        A state or an estimated parameter.
    """
    state, states = kalman.parameters.get(name, name), kalman.model.states
    if state not in states:
        known = [*states, *kalman.parameters]
        raise UnknownNameError(f"state or estimated parameter of model {kalman.base.name} called", name, known)
    at, spread = x[..., states.index(state)], std[..., states.index(state)]
    return (at, spread) if state == name else (np.exp(at), np.exp(at) * spread)


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


def unpacked(packed: np.ndarray, n: int) -> np.ndarray:
    """Return symmetric matrices of packed upper triangles, shape (N, n, n).

    Parameters
    ----------
    packed : ndarray, shape (N, n (n + 1) / 2)
        Columns one after the other.
    n : int
        Size.
    """
    rows = np.concatenate([np.arange(j + 1) for j in range(n)]) if n else np.zeros(0, dtype=int)
    columns = np.repeat(np.arange(n), np.arange(1, n + 1))
    full = np.empty((packed.shape[0], n, n))
    full[:, rows, columns] = full[:, columns, rows] = packed
    return full
