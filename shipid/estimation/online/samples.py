"""Samples that arrive one by one, as the rows a generated step takes: their time, their inputs, and what the sensors show.

It is the counterpart of `shipid.estimation.records.arrangement`, which does the same to a whole record.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from shipid.estimation.online.delay_line import DelayLine
from shipid.estimation.records.clock import LATEST, FilterClock, steps
from shipid.estimation.settings.instruments import Instruments
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import moment
from shipid.generation.simulator import unstated_input
from shipid.trials.speed import check_ahead


class SampleReader:
    """The preparation of samples for a filter or a recursion.

    Parameters
    ----------
    instruments : Instruments
        Sensors and inputs.

    Attributes
    ----------
    clock : FilterClock
        Its own time.
    refused : int
        Whole samples left out so far: their time stamp cannot be right (see `shipid.estimation.records.clock`).
    """

    def __init__(self, instruments: Instruments) -> None:
        self.instruments = instruments
        self.clock = FilterClock()
        self.refused = 0
        self._began: float | None = None
        self._counts = {n: -1 for n in instruments.rates}
        # Looked up once: a sample costs microseconds.
        model, free = instruments.model, (-math.inf, math.inf)
        self._inputs = tuple(
            (n, instruments.inputs.get(n), n in instruments.lost, instruments.biases.get(n, 0.0)) for n in model.inputs
        )
        self._late = {model.inputs.index(n): DelayLine(delay) for n, delay in instruments.delays.items()}
        self._sensors = tuple(
            (i, n, model[n].quantity.measures, instruments.rates.get(n), *instruments.ranges.get(n, free))
            for i, n in enumerate(instruments.sensors)
        )

    @property
    def t(self) -> float | None:
        """Time stamp of the last sample in s; None before the first."""
        return None if self._began is None else self.clock.last

    @property
    def state(self) -> dict[str, Plain]:
        """Its state as plain values; numbers as text that keeps every digit."""
        return {
            "began": float(self._began or 0.0).hex(),
            "clock": [[float(v).hex() for v in part] for part in self.clock.state],
            "counts": self._counts,
            "refused": self.refused,
            **(
                {"late": {self.instruments.model.inputs[i]: line.state for i, line in self._late.items()}}
                if self._late
                else {}
            ),
        }

    @state.setter
    def state(self, plain: Mapping[str, Plain]) -> None:
        self._began = float.fromhex(plain["began"])
        self.clock.state = [[float.fromhex(v) for v in part] for part in plain["clock"]]
        self._counts, self.refused = dict(plain["counts"]), int(plain["refused"])
        for i, line in self._late.items():
            line.state = plain["late"][self.instruments.model.inputs[i]]

    def elapsed(self, sample: Mapping[str, float]) -> float | None:
        """Return the seconds since the sample before, or None for a sample that is left out, and go on to its time.

        Parameters
        ----------
        sample : mapping of str to float
            ``t`` in s and the rest.

        Raises
        ------
        UsageError
            If it has no time.
        """
        t = sample.get("t")
        if t is None or (self._began is None and not abs(t) < LATEST):
            raise UsageError("a sample needs its time 't' in s, a finite number.")
        if self._began is None:
            self.clock = FilterClock()
        elapsed = self.clock.elapsed(float(t))
        if elapsed is None:
            self.refused += 1
        return elapsed

    def begin(self) -> None:
        """Take the sample whose time was read last as the first one; it is not counted as refused."""
        self._began = self.clock.now

    def why_refused(self, sample: Mapping[str, float]) -> str:
        """Return in words why a sample was left out.

        Parameters
        ----------
        sample : mapping of str to float
            The sample.
        """
        return f"its time {sample['t']:.10g} s does not follow the last one, {moment(self.t)} s"

    def inputs(self, sample: Mapping[str, float], held: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Return the inputs that act at a sample, SI, and which of them are missing, shapes (inputs,).

        Parameters
        ----------
        sample : mapping of str to float
            SI.
        held : ndarray, shape (inputs,), or None
            Their last values, which stand in; None for the first sample.

        Raises
        ------
        UnstatedInputError
            If the first sample lacks an input that is needed and declares no default.
        """
        values, lost = np.empty(len(self._inputs)), np.zeros(len(self._inputs), dtype=bool)
        for i, (name, fixed, can_be_lost, bias) in enumerate(self._inputs):
            value = sample.get(name) if fixed is None else fixed
            if value is not None and math.isfinite(value):
                values[i] = value + bias
                continue
            lost[i] = name in sample or can_be_lost
            # What is carried of a late input is what acted, and not what was given last.
            line = self._late.get(i)
            before = line.last if line is not None else None if held is None else held[i]
            values[i] = self._first_input(name, sample) if before is None else before
        for i, line in self._late.items():
            line.take(self.clock.now, float(values[i]))
            values[i] = line.at(self.clock.now)
        return values, lost

    def _first_input(self, name: str, sample: Mapping[str, float]) -> float:
        """An input that the first sample lacks: of the cruising speed the speed there or the ship's, of others the default."""
        instruments = self.instruments
        for speed in (sample.get("u"), instruments.scale.speed) if name in ("cruise", "u") else ():
            if speed is not None and math.isfinite(speed):
                if name == "cruise" and name in instruments.needed:
                    check_ahead(float(speed), "being followed", instruments.model.name)
                return speed
        default = instruments.model[name].number("default")
        if default is None and name in instruments.needed:
            raise unstated_input(instruments.model, name, "the first sample")
        return default or 0.0

    def bridge(self, elapsed: float, last: np.ndarray, inputs: np.ndarray) -> Iterator[tuple[float, np.ndarray, bool]]:
        """Yield the rows up to a sample: interval in s, inputs, and whether the row is the sample; a gap takes several.

        Parameters
        ----------
        elapsed : float
            Seconds since the sample before.
        last, inputs : ndarray, shape (inputs,)
            Inputs at both ends.
        """
        count = steps(elapsed, self.clock.typical)
        for k in range(1, count):
            between = last + k / count * (inputs - last)
            for i, line in self._late.items():
                between[i] = line.at(self.clock.now - (1 - k / count) * elapsed)
            yield elapsed / count, between, False
        yield elapsed / count, inputs, True

    def shown(self, sample: Mapping[str, float], z: np.ndarray, there: np.ndarray) -> tuple[str, ...]:
        """Write what the sensors show, and return those whose value is out of their range.

        Parameters
        ----------
        sample : mapping of str to float
            SI.
        z, there : ndarray, shape (sensors,)
            Written: values, and 1 where a sensor shows one.

        Returns
        -------
        tuple of str
        """
        outside = []
        for i, name, measures, seconds, low, high in self._sensors:
            value = sample.get(name, sample.get(measures) if measures else None)
            if value is None or not math.isfinite(value):
                continue
            if seconds is not None:
                number = int((self.clock.now - (self._began or 0.0) + 0.5 * self.clock.typical) // seconds)
                if number <= self._counts[name]:
                    continue
                self._counts[name] = number
            if not low <= value <= high:
                outside.append(name)
                continue
            z[i], there[i] = value, 1.0
        return tuple(outside)
