"""The same filter for samples that arrive one by one, with its state saved to and restored from a file."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shipid.estimation.errors import FilterDivergedError, NotMeasurableError
from shipid.estimation.records.arrangement import column_of
from shipid.estimation.records.clock import Clock, steps
from shipid.estimation.records.run import named
from shipid.estimation.records.smoother import run_back
from shipid.estimation.records.vectors import carried_vector, check_scale
from shipid.estimation.recursion.step import REJECTED, TAKEN
from shipid.foundation.errors import UsageError
from shipid.generation.loop import Stepper

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter


@dataclass(frozen=True, eq=False)
class OnlineEstimate:
    """What is known after a sample.

    Attributes
    ----------
    t : float
        Time of the sample in s.
    x, std : ndarray, shape (states,)
        Estimates and standard deviations, SI.
    taken, rejected : tuple of str
        Sensors whose sample was taken in, and whose sample was beyond the gate or out of range.
    refused : str
        Why the whole sample was refused; empty where it was not.
    lagged : tuple or None
        ``(t, x, std)`` of the moment one lag ago, smoothed by what came since.
    """

    t: float
    x: np.ndarray
    std: np.ndarray
    taken: tuple[str, ...]
    rejected: tuple[str, ...]
    refused: str
    lagged: tuple[float, np.ndarray, np.ndarray] | None
    _filter: ExtendedKalmanFilter = field(repr=False)

    def __getitem__(self, name: str) -> float:
        """Return the estimate of a state or an estimated parameter, SI."""
        return float(named(self._filter, self.x, self.std, name)[0])

    def std_of(self, name: str) -> float:
        """Return the standard deviation of a state or an estimated parameter, SI.

        Parameters
        ----------
        name : str
            A state or an estimated parameter.
        """
        return float(named(self._filter, self.x, self.std, name)[1])

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, SI."""
        names = [s for s in self._filter.model.states if s not in self._filter.parameters.values()]
        names += list(self._filter.parameters)
        return {
            "t": self.t,
            "estimates": {n: {"value": self[n], "std": self.std_of(n)} for n in names},
            "taken": list(self.taken),
            "rejected": list(self.rejected),
            "refused": self.refused,
        }


class OnlineFilter:
    """A filter that takes one sample at a time; made by `ExtendedKalmanFilter.start`.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        What it runs.
    lag : float or None
        Fixed lag in s.

    Attributes
    ----------
    rejected : dict of str to int
        Samples of each sensor beyond the gate or out of range so far.
    refused : int
        Whole samples refused so far: their time stamp cannot be right (see `shipid.estimation.records.clock`).
    stepper : Stepper or None
        The bare step on memory laid out once (`control`, `step()`, `out`), for a loop in which microseconds count; None
        before the first sample.
    """

    def __init__(self, kalman: ExtendedKalmanFilter, lag: float | None = None) -> None:
        if lag is not None and not lag > 0:
            raise UsageError(f"a lag of {lag:g} s smooths nothing; give one greater than zero.")
        self.filter, self.lag = kalman, lag
        self.rejected = dict.fromkeys(kalman.measured, 0)
        self.refused = 0
        self.stepper: Stepper | None = None
        self._clock = Clock()
        self._began: float | None = None
        self._unseen: set[str] = set()
        self._counts = {n: -1 for n in kalman.rates}
        self._window: deque[tuple[float, np.ndarray, np.ndarray, np.ndarray, bool]] = deque()
        # Looked up once: a sample costs microseconds.
        model, free = kalman.model, (-math.inf, math.inf)
        self._given = tuple((n, kalman.inputs.get(n), n in kalman.lost) for n in model.inputs)
        self._sensors = tuple(
            (i, n, model[n].quantity.measures, kalman.rates.get(n), *kalman.ranges.get(n, free))
            for i, n in enumerate(kalman.measured)
        )
        self._lost = tuple(
            (i, model.inputs.index(s.name), kalman.lost[s.name] / s.level, float(s.level != kalman.lost[s.name]))
            for i, s in enumerate(kalman.sources)
            if s.name in kalman.lost
        )

    @property
    def t(self) -> float | None:
        """Time of the last sample in s; None before the first."""
        return None if self.stepper is None else self._clock.last

    def update(
        self, sample: Mapping[str, float], *, adapt: bool = True, scale: Mapping[str, float] | None = None
    ) -> OnlineEstimate:
        """Take in a sample.

        Parameters
        ----------
        sample : mapping of str to float
            ``t`` in s and, SI, what there is of sensors and inputs. A sensor that is missing or NaN showed nothing; an input
            that is missing keeps its last value.
        adapt : bool
            Whether parameters adapt (needs ``switchable=True``).
        scale : mapping of str to float
            Factors on the noise of states and inputs.

        Returns
        -------
        OnlineEstimate

        Raises
        ------
        UsageError
            If the sample has no time, or adaptation is to be switched off where it cannot be.
        NotMeasurableError
            If the first sample lacks an input that has no default.
        FilterDivergedError
            If the estimate runs away.
        """
        t = sample.get("t")
        if t is None or (self.stepper is None and not math.isfinite(t)):
            raise UsageError("a sample needs its time 't' in s, a finite number.")
        if not adapt and not self.filter.switchable:
            raise UsageError("adaptation is to be switched off, and the filter was made without switchable=True.")
        check_scale(self.filter, scale)
        if self.stepper is None:
            self._clock = Clock()
        elapsed = self._clock.let(float(t))
        if elapsed is None:
            self.refused += 1
            return self._estimate((), (), f"its time {t:g} s does not follow the last one, {self.t:g} s")
        held = None if self.stepper is None else self.stepper.z[self.filter.layout.carried["u"]]
        inputs, lost = self._inputs(sample, held)
        if self.stepper is None:
            self._begin(sample, inputs)
        assert self.stepper is not None
        count = steps(elapsed, self._clock.typical)
        last = self.stepper.z[self.filter.layout.carried["u"]].astype(float)
        for k in range(1, count + 1):
            self._write(elapsed / count, last + k / count * (inputs - last), lost, adapt, scale)
            if k == count:
                outside = self._show(sample)
            self._run(k == count)
        return self._outcome(outside)

    def _begin(self, sample: Mapping[str, float], inputs: np.ndarray) -> None:
        kalman = self.filter
        first = {n: float(v) for n, v in sample.items() if v is not None and np.isfinite(v)}
        for name in kalman.measured:
            column = column_of(kalman.model, name, first)
            if column is not None:
                first.setdefault(kalman.model[name].quantity.measures or name, first[column])
        self._unseen = {n for n in kalman.measured if self._state_of(n) not in {*first, *kalman._given_starts}}
        # Records before and after rows are only needed to smooth; the brief step is the faster one.
        loop = kalman.loop(full=self.lag is not None)
        self.stepper = loop.one_at_a_time(carried_vector(kalman, first, inputs), kalman.constants)
        self._began = self._clock.now

    def _state_of(self, sensor: str) -> str:
        return self.filter.model[sensor].quantity.measures or sensor

    def _inputs(self, sample: Mapping[str, float], held: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Inputs of a sample, and which of them are missing."""
        kalman = self.filter
        values, lost = np.empty(len(self._given)), np.zeros(len(self._given), dtype=bool)
        for i, (name, fixed, can_be_lost) in enumerate(self._given):
            value = sample.get(name) if fixed is None else fixed
            if value is not None and math.isfinite(value):
                values[i] = value
                continue
            lost[i] = name in sample or can_be_lost
            if held is not None:
                values[i] = held[i]
                continue
            default = kalman.model[name].number("default")
            if name in ("cruise", "u") and (speed := _known(sample.get("u"), kalman._speed)) is not None:
                values[i] = speed
            elif default is not None or name not in kalman.needed_inputs:
                values[i] = default or 0.0
            else:
                raise NotMeasurableError(
                    f"the first sample lacks '{name}' ({kalman.model[name].quantity.meaning}), which model "
                    f"{kalman.base.name} reads. It has {', '.join(sample)}."
                )
        return values, lost

    def _write(
        self, interval: float, inputs: np.ndarray, lost: np.ndarray, adapt: bool, scale: Mapping[str, float] | None
    ) -> None:
        assert self.stepper is not None
        places, control, kalman = self.filter.layout.control, self.stepper.control, self.filter
        control[places["u"]] = inputs
        control[places["T"]] = interval
        control[places["z"]] = control[places["there"]] = 0.0
        factors = control[places["scale"]]
        factors[:] = 1.0 if scale is None else [scale.get(s.name, 1.0) for s in kalman.sources]
        for i, which, missing, usual in self._lost:
            factors[i] *= missing if lost[which] else usual
        if kalman.switchable:
            control[places["adapting"]] = float(adapt)

    def _show(self, sample: Mapping[str, float]) -> tuple[str, ...]:
        """Write what the sensors show; return those out of range."""
        assert self.stepper is not None and self._began is not None
        kalman, outside = self.filter, []
        z, there = (self.stepper.control[kalman.layout.control[n]] for n in ("z", "there"))
        for i, name, measures, seconds, low, high in self._sensors:
            value = sample.get(name, sample.get(measures) if measures else None)
            if value is None or not math.isfinite(value):
                continue
            if seconds is not None:
                number = int((self._clock.now - self._began + 0.5 * self._clock.typical) // seconds)
                if number <= self._counts[name]:
                    continue
                self._counts[name] = number
            if not low <= value <= high:
                outside.append(name)
                continue
            z[i], there[i] = value, 1.0
            if name in self._unseen:
                # A state that nothing has shown so far is where its sensor first says.
                self._unseen.remove(name)
                if (state := self._state_of(name)) in kalman.model.states:
                    self.stepper.z[kalman.layout.carried["x"]][kalman.model.states.index(state)] = value
        return tuple(outside)

    def _run(self, shown: bool) -> None:
        assert self.stepper is not None
        before = self.stepper.z.copy() if self.lag is not None else None
        self.stepper.step()
        if before is not None:
            self._window.append((self._clock.now, before, self.stepper.control.copy(), self.stepper.out.copy(), shown))

    def _outcome(self, outside: tuple[str, ...]) -> OnlineEstimate:
        assert self.stepper is not None
        kalman = self.filter
        fate = self.stepper.out[kalman.layout.brief["fate"]].tolist()
        rejected = outside + tuple(n for n, f in zip(kalman.measured, fate) if f == REJECTED)
        for name in rejected:
            self.rejected[name] += 1
        estimate = self._estimate(tuple(n for n, f in zip(kalman.measured, fate) if f == TAKEN), rejected, "")
        if not math.isfinite(float(estimate.x.sum())):
            raise FilterDivergedError(
                f"the filter of model {kalman.base.name} runs away at {self.t:.5g} s. Restore an earlier state, or start "
                "nearer to the truth with more noise on the states."
            )
        return estimate

    def _estimate(self, taken: tuple[str, ...], rejected: tuple[str, ...], refused: str) -> OnlineEstimate:
        assert self.stepper is not None
        brief = self.filter.layout.brief
        x, variance = (self.stepper.out[brief[n]].astype(float) for n in ("x", "var"))
        std = np.sqrt(np.maximum(variance, 0.0))
        return OnlineEstimate(self._clock.last or 0.0, x, std, taken, rejected, refused, self._lagged(), self.filter)

    def _lagged(self) -> tuple[float, np.ndarray, np.ndarray] | None:
        if self.lag is None:
            return None
        window, now = self._window, self._clock.now
        # The oldest sample kept is the one a lag ago, or the first after it.
        while len(window) > 1 and (not window[0][4] or now - window[1][0] >= self.lag - 1e-9 * max(1.0, abs(now))):
            window.popleft()
        if not window or now - window[0][0] < 0.999 * self.lag:
            return None
        control, out = np.array([w[2] for w in window]), np.array([w[3] for w in window])
        first = run_back(self.filter, control, out, window[0][1])[0]
        n = self.filter.layout.n
        variance = first[n:][np.cumsum(np.arange(1, n + 1)) - 1]
        return window[0][0] - self._clock.shift, first[:n], np.sqrt(np.maximum(variance, 0.0))

    def save(self, path: str | Path) -> None:
        """Write the state to a file, whole or not at all; every number exactly.

        Parameters
        ----------
        path : str or Path
            A JSON file; one that exists is replaced.

        Raises
        ------
        UsageError
            If no sample has come yet.
        """
        from shipid.estimation.online.saving import save_state

        save_state(self, Path(path))


def _known(*values: float | None) -> float | None:
    """The first that is a number."""
    return next((v for v in values if v is not None and np.isfinite(v)), None)
