"""The same filter for samples that arrive one by one, with its state saved to and restored from a file."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.online.online_estimate import OnlineEstimate
from shipid.estimation.online.samples import SampleReader
from shipid.estimation.online.saving import (
    check_carried,
    check_clock,
    check_counts,
    check_finite,
    check_late,
    examined,
    names_among,
    numbers,
    read_state,
    write_state,
)
from shipid.estimation.online.tally import Tally
from shipid.estimation.records.controls import check_scale, check_switch
from shipid.estimation.records.first_estimate import carried_vector
from shipid.estimation.records.smoother import run_back
from shipid.estimation.records.triangles import deviations_of
from shipid.estimation.recursion.gate import REJECTED, TAKEN
from shipid.estimation.recursion.layout import total
from shipid.estimation.settings.first_look import first_value
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief, moment
from shipid.foundation.result import Printed
from shipid.generation.loop import Stepper


class _Row(NamedTuple):
    """A row of the fixed-lag smoother's window."""

    t: float
    before: np.ndarray
    control: np.ndarray
    out: np.ndarray
    is_sample: bool


class OnlineFilter(Printed):
    """A filter that takes one sample at a time; made by `ExtendedKalmanFilter.start`.

    Parameters
    ----------
    design : FilterDesign
        What it runs.
    lag : float or None
        Fixed lag in s.

    Attributes
    ----------
    rejected : dict of str to int
        Samples of each sensor beyond the gate or out of range so far.
    tally : Tally
        Samples beyond the gate, and the size of the innovations, so far.
    stepper : Stepper or None
        The step alone on fixed memory (`control`, `step()`, `out`), for a loop in which microseconds count; None
        before the first sample.

    Raises
    ------
    UsageError
        If the lag is not longer than zero.
    """

    def __init__(self, design: FilterDesign, lag: float | None = None) -> None:
        if lag is not None and not lag > 0:
            raise UsageError(f"a lag of {lag:g} s is too short; give one greater than zero.")
        self.design, self.lag = design, lag
        self.rejected = dict.fromkeys(design.measured, 0)
        self.stepper: Stepper | None = None
        self._reader = SampleReader(design.instruments)
        self._unseen: set[str] = set()
        self._window: deque[_Row] = deque()
        self._first: dict[str, float] = {}
        self.tally = Tally(design)
        # Looked up once: a sample costs microseconds.
        model, lost = design.model, design.instruments.lost
        self._lost = tuple(
            (i, model.inputs.index(s.name), lost[s.name] / s.level, float(s.level != lost[s.name]))
            for i, s in enumerate(design.sources)
            if s.name in lost
        )

    def __repr__(self) -> str:
        at = "before its first sample" if self.t is None else f"at {brief(self.t, 6)} s"
        lagged = "" if self.lag is None else f", {brief(self.lag)} s behind"
        return f"<filter of '{self.design.model.name}', a sample at a time{lagged}: {at}>"

    @property
    def t(self) -> float | None:
        """Time of the last sample in s; None before the first."""
        return self._reader.t

    @property
    def refused(self) -> int:
        """Whole samples left out so far: their time stamp cannot be right (see `shipid.estimation.records.clock`)."""
        return self._reader.refused

    def look_at(self, samples: Sequence[Mapping[str, float]]) -> None:
        """Take the first estimates from several samples instead of the first one alone, which may be wild.

        Parameters
        ----------
        samples : sequence of mapping of str to float
            The first samples, SI, with ``t``; each is then given to `update` as well.
        """
        instruments = self.design.instruments
        for name, level in zip(self.design.measured, self.design.r):
            columns = [(s["t"], s.get(instruments.column_of(name, s) or "", math.nan)) for s in samples]
            shown = np.array([(t, float(v)) for t, v in columns if v is not None and math.isfinite(v)])
            if shown.size:
                quantity = instruments.quantity_of(name)
                values = shown[:, 1]
                if self.design.model[quantity].quantity.wraps:
                    # From the last sample back: a wild first one must not turn the others.
                    values = np.unwrap(values[::-1])[::-1]
                self._first[quantity] = first_value(shown[:, 0], values, float(level))

    def update(
        self, sample: Mapping[str, float], *, adapt: bool = True, scale: Mapping[str, float] | None = None
    ) -> OnlineEstimate:
        """Process a sample.

        Parameters
        ----------
        sample : mapping of str to float
            ``t`` in s and, SI, the sensors and inputs there are. A sensor that is missing or NaN has no sample; an input
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
        UnstatedInputError
            If the first sample lacks an input that declares no default.
        FilterDivergedError
            If the estimate diverges.
        """
        check_switch(self.design, not adapt)
        check_scale(self.design, scale)
        reader, carried = self._reader, self.design.layout.carried
        elapsed = reader.elapsed(sample)
        if elapsed is None:
            return self._estimate((), (), reader.why_refused(sample))
        shown = (
            sample if self.stepper is not None else {**sample, **{n: v for n, v in self._first.items() if n in sample}}
        )
        inputs, lost = reader.inputs(shown, None if self.stepper is None else self.stepper.z[carried["u"]])
        stepper = self.stepper or self._begin(sample, inputs)
        outside: tuple[str, ...] = ()
        for interval, between, is_sample in reader.bridge(elapsed, stepper.z[carried["u"]].astype(float), inputs):
            self._write(stepper, interval, between, lost, adapt, scale)
            if is_sample:
                outside = self._show(stepper, sample)
            self._run(stepper, is_sample)
        return self._outcome(stepper, outside)

    def _begin(self, sample: Mapping[str, float], inputs: np.ndarray) -> Stepper:
        design, instruments = self.design, self.design.instruments
        first = instruments.with_quantities(
            {n: float(v) for n, v in sample.items() if v is not None and np.isfinite(v)}
        )
        stated = {*first, *design.first.states}
        first |= {n: v for n, v in self._first.items() if n in first}
        self._unseen = {n for n in design.measured if instruments.quantity_of(n) not in stated}
        self.stepper = self.first_stepper(carried_vector(design, first, inputs))
        self._reader.begin()
        return self.stepper

    def first_stepper(self, carried: np.ndarray) -> Stepper:
        """Return the step that goes on from a carried vector.

        Parameters
        ----------
        carried : ndarray, shape (carried,)
            What is known before the first sample.
        """
        # Estimates before and after each row are only needed to smooth; the brief step is faster.
        return self.design.loop(full=self.lag is not None).one_at_a_time(carried, self.design.constants)

    def _write(
        self,
        stepper: Stepper,
        interval: float,
        inputs: np.ndarray,
        lost: np.ndarray,
        adapt: bool,
        scale: Mapping[str, float] | None,
    ) -> None:
        places, control, design = self.design.layout.control, stepper.control, self.design
        control[places["u"]] = inputs
        control[places["T"]] = interval
        control[places["z"]] = control[places["there"]] = 0.0
        factors = control[places["scale"]]
        factors[:] = 1.0 if scale is None else [scale.get(s.name, 1.0) for s in design.sources]
        for i, which, missing, usual in self._lost:
            factors[i] *= missing if lost[which] else usual
        if design.switchable:
            control[places["adapting"]] = float(adapt)

    def _show(self, stepper: Stepper, sample: Mapping[str, float]) -> tuple[str, ...]:
        """Write what the sensors show; return those out of range."""
        layout, states = self.design.layout, self.design.model.states
        z, there = (stepper.control[layout.control[n]] for n in ("z", "there"))
        outside = self._reader.shown(sample, z, there)
        for name in tuple(self._unseen):
            i = self.design.measured.index(name)
            if there[i]:
                # A state that has had no sample so far starts at the first sample of its sensor.
                self._unseen.remove(name)
                state = self.design.instruments.quantity_of(name)
                if state in states:
                    stepper.z[layout.carried["x"]][states.index(state)] = z[i]
        return outside

    def _run(self, stepper: Stepper, is_sample: bool) -> None:
        before = stepper.z.copy() if self.lag is not None else None
        stepper.step()
        if before is not None:
            now = self._reader.clock.now
            self._window.append(_Row(now, before, stepper.control.copy(), stepper.out.copy(), is_sample))

    def _outcome(self, stepper: Stepper, outside: tuple[str, ...]) -> OnlineEstimate:
        design = self.design
        self.tally.add(stepper.out)
        fate = stepper.out[design.layout.brief["fate"]].tolist()
        rejected = outside + tuple(n for n, f in zip(design.measured, fate) if f == REJECTED)
        for name in rejected:
            self.rejected[name] += 1
        estimate = self._estimate(tuple(n for n, f in zip(design.measured, fate) if f == TAKEN), rejected, "")
        if not math.isfinite(float(estimate.x.sum())):
            raise FilterDivergedError(
                f"the filter of model {design.base.name} diverges at {moment(self.t)} s. Restore an earlier state, or start "
                "closer to the true state with more noise on the states."
            )
        return estimate

    def _estimate(self, taken: tuple[str, ...], rejected: tuple[str, ...], refused: str) -> OnlineEstimate:
        assert self.stepper is not None
        brief = self.design.layout.brief
        x, variance = (self.stepper.out[brief[n]].astype(float) for n in ("x", "var"))
        std = np.sqrt(np.maximum(variance, 0.0))
        return OnlineEstimate(
            self._reader.clock.last or 0.0, x, std, taken, rejected, refused, self._lagged(), self.design
        )

    def _lagged(self) -> tuple[float, np.ndarray, np.ndarray] | None:
        if self.lag is None:
            return None
        window, now = self._window, self._reader.clock.now
        # The oldest sample kept is the one a lag ago, or the first after it.
        while len(window) > 1 and (
            not window[0].is_sample or now - window[1].t >= self.lag - 1e-9 * max(1.0, abs(now))
        ):
            window.popleft()
        if not window or now - window[0].t < 0.999 * self.lag:
            return None
        control, out = np.array([w.control for w in window]), np.array([w.out for w in window])
        x, packed, _ = run_back(self.design, control, out, window[0].before)
        return window[0].t - self._reader.clock.shift, x[0], deviations_of(packed[0], self.design.layout.n)

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
        if self.stepper is None:
            raise UsageError("a filter without a sample has no state to save.")
        out = self.stepper.out[: self.design.layout.brief["ll"].stop]
        state = self._reader.state | {
            "carried": [float(v).hex() for v in self.stepper.z],
            "out": [float(v).hex() for v in out],
            "rejected": self.rejected,
            "unseen": sorted(self._unseen),
        }
        write_state(Path(path), self.design.fingerprint, self.design.base.name, state)

    def load(self, path: str | Path) -> None:
        """Go on from a state as `save` left it.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        SavedStateError
            If the file cannot be read, or belongs to another filter.
        """
        path, design = Path(path), self.design
        state = read_state(path, design.fingerprint, "filter")
        layout = design.layout
        with examined(path, "filter"):
            check_clock(state, design.instruments.rates)
            check_late(state, design.instruments.delays)
            carried = numbers(state, "carried", total(layout.carried))
            out = numbers(state, "out", layout.brief["ll"].stop)
            check_carried(design, carried)
            check_finite("out", out[layout.brief["x"]])
            check_finite("out", out[layout.brief["var"]])
            rejected = check_counts("rejected", state["rejected"], design.measured)
            unseen = names_among("unseen", state["unseen"], design.measured)
        self._reader.state = state
        self.rejected, self._unseen = rejected, unseen
        self.stepper = self.first_stepper(carried)
        self.stepper.out[: len(out)] = out
