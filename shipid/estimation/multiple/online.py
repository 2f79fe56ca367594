"""The same multiple-model filter for samples that arrive one by one, as a tracker needs it: predicted, updated, merged."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from shipid.declaration.delays import refuse_delay
from shipid.declaration.model import Model
from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.multiple.design import MultipleModelDesign
from shipid.estimation.multiple.first_state import FirstState, packed
from shipid.estimation.multiple.record import first_carried, spread_covariances
from shipid.estimation.multiple.transition import over_intervals
from shipid.estimation.multiple.whitening import whitened
from shipid.estimation.named_quantities import SampleEstimate
from shipid.estimation.online.samples import SampleReader
from shipid.estimation.records.clock import steps
from shipid.estimation.records.triangles import unpacked
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.numbers import brief, moment
from shipid.foundation.result import Result
from shipid.generation.loop import Stepper

#: The sampling interval is the median of so many of the last.
_RECENT = 9


@dataclass(frozen=True, eq=False, repr=False)
class MultipleModelEstimate(SampleEstimate):
    """The estimate after a sample.

    Attributes
    ----------
    t : float
        Time of the sample in s.
    x : ndarray, shape (states,)
        Combined estimate, SI.
    covariance : ndarray, shape (states, states)
        Its covariance, the spread between the modes included.
    probabilities : ndarray, shape (modes,)
        Of the modes.
    log_likelihood : float
        Of this sample given those before it.
    design : MultipleModelDesign
        Which filter.
    """

    t: float
    x: np.ndarray
    covariance: np.ndarray
    probabilities: np.ndarray
    log_likelihood: float
    design: MultipleModelDesign = field(repr=False)

    @property
    def model(self) -> Model:
        """The model of the first mode."""
        return self.design.first.model

    @property
    def names(self) -> tuple[str, ...]:
        """The states of the combined estimate."""
        return self.design.states

    def quantity(self, name: str) -> tuple[float, float]:
        """Return the combined estimate of a state and its standard deviation, SI.

        Parameters
        ----------
        name : str
            The state.

        Raises
        ------
        UnknownNameError
            If the combined estimate has no such state.
        """
        if name not in self.names:
            raise UnknownNameError("state of the combined estimate called", name, self.names)
        at = self.names.index(name)
        return float(self.x[at]), float(np.sqrt(max(self.covariance[at, at], 0.0)))

    @property
    def mode(self) -> str:
        """The most probable mode."""
        return self.design.names[int(np.argmax(self.probabilities))]

    @property
    def remarks(self) -> tuple[str, ...]:
        """The probabilities of the modes."""
        return (
            "modes: " + ", ".join(f"{n} {brief(p, 4)}" for n, p in zip(self.design.names, self.probabilities.tolist())),
        )


@dataclass(frozen=True, eq=False, repr=False)
class MultipleModelPrediction(Result):
    """What each mode expects of the sensors at a time.

    Attributes
    ----------
    t : float
        Time in s.
    probabilities : ndarray, shape (modes,)
        Predicted probabilities of the modes.
    shown : ndarray, shape (modes, sensors)
        What each mode expects, SI.
    spread : ndarray, shape (modes, sensors, sensors)
        Covariance of that, without the errors of the sensors.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"t": "s", "probabilities": "1", "shown": "SI", "spread": "SI"}

    t: float
    probabilities: np.ndarray
    shown: np.ndarray
    spread: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        """The combined expectation, shape (sensors,); for sensors that do not wrap."""
        return np.asarray(self.probabilities @ self.shown)

    @property
    def covariance(self) -> np.ndarray:
        """Its covariance, without the errors of the sensors, shape (sensors, sensors)."""
        apart = self.shown - self.mean
        return np.asarray(
            np.einsum("m,mij->ij", self.probabilities, self.spread + apart[:, :, None] * apart[:, None, :])
        )


class OnlineMultipleModel:
    """A multiple-model filter that takes one sample at a time; made by `InteractingMultipleModel.start`.

    Parameters
    ----------
    design : MultipleModelDesign
        What it runs.
    first : FirstState, optional
        What is known before the first sample.

    Attributes
    ----------
    t : float or None
        Time of the last sample in s; None before the first.
    """

    def __init__(self, design: MultipleModelDesign, first: FirstState | None = None) -> None:
        self.design, self._first = design, first
        self.t: float | None = None
        self._recent: tuple[float, ...] = ()
        self._stepper: Stepper | None = None
        for one in design.designs:
            refuse_delay(one.model, "A multiple-model filter that takes one sample at a time")
        self._readers = tuple(SampleReader(d.instruments) for d in design.designs)

    @property
    def carried(self) -> np.ndarray:
        """What is carried from scan to scan, shape (carried,); `CycleLayout.carried` says what stands where.

        Raises
        ------
        UsageError
            If no sample has come yet.
        """
        return self._running.z

    @property
    def _running(self) -> Stepper:
        if self._stepper is None:
            raise UsageError("a multiple-model filter without a sample has no estimate: give it a first one (update).")
        return self._stepper

    @property
    def estimate(self) -> MultipleModelEstimate:
        """The estimate after the last sample or prediction.

        Raises
        ------
        UsageError
            If no sample has come yet.
        """
        places, out = self.design.layout.full, self._running.out
        assert self.t is not None
        return MultipleModelEstimate(
            self.t,
            out[places["x"]].copy(),
            unpacked(out[None, places["P"]], self.design.layout.n)[0],
            out[places["mu"]].copy(),
            float(out[places["ll"]][0]),
            self.design,
        )

    def copy(self) -> OnlineMultipleModel:
        """Return a filter that goes on from here on its own."""
        return copy.copy(self)

    def __copy__(self) -> OnlineMultipleModel:
        other = type(self)(self.design, self._first)
        vars(other).update(vars(self))
        if self._stepper is not None:
            stepper = self.design.loop().one_at_a_time(self._stepper.z, self.design.constants)
            stepper.out[:] = self._stepper.out
            vars(other)["_stepper"] = stepper
        return other

    def update(self, sample: Mapping[str, float], covariance: np.ndarray | None = None) -> MultipleModelEstimate:
        """Process a sample.

        Parameters
        ----------
        sample : mapping of str to float
            ``t`` in s and, SI, the sensors and inputs there are. A sensor that is missing or NaN has no sample; an input that is
            missing keeps its last value. A sample of the same time as the last one only updates.
        covariance : ndarray, shape (sensors, sensors), optional
            Of the sensors' errors in this sample, SI.

        Returns
        -------
        MultipleModelEstimate

        Raises
        ------
        UsageError
            If the sample has no time, or an earlier one than the last.
        CovarianceError
            If the covariance does not fit.
        FilterDivergedError
            If the estimate diverges.
        """
        self._go_to(sample.get("t"), sample, covariance)
        return self._checked()

    def predict(self, t: float, sample: Mapping[str, float] | None = None) -> MultipleModelPrediction:
        """Go on to a time without a sample, and return what the modes expect there; `update` at the same time then only updates.

        Parameters
        ----------
        t : float
            Time in s.
        sample : mapping of str to float, optional
            Inputs at that time, SI.

        Returns
        -------
        MultipleModelPrediction

        Raises
        ------
        UsageError
            If no sample has come yet, or the time is before the last.
        """
        _ = self._running
        inputs = {n: v for n, v in (sample or {}).items() if n not in self.design.measured}
        self._go_to(t, inputs, None)
        self._checked()
        return self.expected

    @property
    def expected(self) -> MultipleModelPrediction:
        """What the modes expected of the sensors at the last time, before its sample.

        Raises
        ------
        UsageError
            If no sample has come yet.
        """
        places, out, layout = self.design.layout.full, self._running.out, self.design.layout
        modes = range(layout.modes)
        assert self.t is not None
        return MultipleModelPrediction(
            self.t,
            out[places["ahead"]].copy(),
            np.array([out[places[f"shown{j}"]] for j in modes]),
            unpacked(np.array([out[places[f"spread{j}"]] for j in modes]), layout.sensors),
        )

    def merge(self, others: Sequence[OnlineMultipleModel], weights: Sequence[float]) -> None:
        """Take the mixture of several filters of the same design: hypotheses of which plot was the ship's.

        Parameters
        ----------
        others : sequence of OnlineMultipleModel
            The hypotheses, all at the same time.
        weights : sequence of float
            Their probabilities.

        Raises
        ------
        UsageError
            If the probabilities are not one for each, or do not sum to one.
        """
        beta = np.asarray(weights, dtype=float)
        if len(others) != beta.size or not (beta >= 0).all() or abs(beta.sum() - 1) > 1e-6:
            raise UsageError(
                f"{len(others)} hypotheses have {beta.size} probabilities that sum to {beta.sum():g}; they must sum to 1."
            )
        layout, places = self.design.layout, self.design.layout.carried
        vectors = np.array([o.carried for o in others])
        mu = vectors[:, places["mu"]]
        shares = beta[:, None] * mu
        probable = shares.sum(axis=0)
        z = vectors.T @ beta
        z[places["mu"]] = probable
        for j, n in enumerate(layout.sizes):
            weight = shares[:, j] / probable[j]
            x = vectors[:, places[f"x{j}"]]
            mean = weight @ x
            apart = x - mean
            spread = unpacked(vectors[:, places[f"P{j}"]], n) + apart[:, :, None] * apart[:, None, :]
            z[places[f"x{j}"]] = mean
            z[places[f"P{j}"]] = packed(np.einsum("k,kij->ij", weight, spread))
        self.t = others[0].t
        stepper = self.design.loop().one_at_a_time(z, self.design.constants)
        self._stepper = stepper
        # A scan without time and without a sample computes the combined estimate.
        self._write(0.0, [z[places[f"u{j}"]] for j in range(layout.modes)])
        stepper.step()

    def _go_to(self, t: float | None, sample: Mapping[str, float], covariance: np.ndarray | None) -> None:
        if t is None or not math.isfinite(t):
            raise UsageError("a sample needs its time 't' in s, a finite number.")
        elapsed = 0.0 if self.t is None else float(t) - self.t
        if elapsed < 0:
            raise UsageError(f"the time of the sample, {moment(t)} s, lies before the last one, {moment(self.t)} s.")
        if covariance is not None:
            covariance = spread_covariances(self.design, np.asarray(covariance, dtype=float), 1)
        inputs = self._inputs(sample)
        if self._stepper is None:
            first = [
                d.instruments.with_quantities(
                    {n: float(v) for n, v in sample.items() if v is not None and math.isfinite(v)}
                )
                for d in self.design.designs
            ]
            carried = first_carried(self.design, first, inputs, self._first)
            self._stepper = self.design.loop().one_at_a_time(carried, self.design.constants)
        if elapsed > 0:
            self._recent = (*self._recent[1 - _RECENT :], elapsed)
        typical = sorted(self._recent)[len(self._recent) // 2] if self._recent else 0.0
        count = steps(elapsed, typical)
        before = [self._stepper.z[self.design.layout.carried[f"u{j}"]].copy() for j in range(len(inputs))]
        for k in range(1, count + 1):
            self._write(elapsed / count, [a + k / count * (b - a) for a, b in zip(before, inputs)])
            if k == count:
                self._show(sample, covariance)
            self._stepper.step()
        self.t = float(t)

    def _inputs(self, sample: Mapping[str, float]) -> list[np.ndarray]:
        places = self.design.layout.carried
        held = [None if self._stepper is None else self._stepper.z[places[f"u{j}"]] for j in range(len(self._readers))]
        return [reader.inputs(sample, last)[0] for reader, last in zip(self._readers, held)]

    def _write(self, interval: float, inputs: Sequence[np.ndarray]) -> None:
        places, control = self.design.layout.control, self._running.control
        for j, values in enumerate(inputs):
            control[places[f"u{j}"]] = values
        control[places["T"]] = interval
        control[places["z"]] = control[places["there"]] = control[places["whitening"]] = 0.0
        control[places["variance"]] = 1.0
        if self.design.per is None:
            chances = self.design.transition if interval > 0 else np.eye(self.design.layout.modes)
        else:
            chances = over_intervals(self.design.transition, self.design.per, np.array([interval]))[0]
        control[places["transition"]] = chances.ravel()

    def _show(self, sample: Mapping[str, float], covariance: np.ndarray | None) -> None:
        places, control = self.design.layout.control, self._running.control
        z, there = control[places["z"]], control[places["there"]]
        self._readers[0].shown(sample, z, there)
        if covariance is None:
            control[places["variance"]] = self.design.first.r**2
            return
        variance, below = whitened(covariance, there[None] > 0)
        control[places["variance"]] = variance[0]
        if self.design.settings.correlated:
            control[places["whitening"]] = below[0]

    def _checked(self) -> MultipleModelEstimate:
        estimate = self.estimate
        if not math.isfinite(float(estimate.x.sum() + estimate.covariance.sum())):
            raise FilterDivergedError(
                f"{self.design!r} diverges at {moment(self.t)} s. Start closer to the true state, or put more noise on the states."
            )
        return estimate
