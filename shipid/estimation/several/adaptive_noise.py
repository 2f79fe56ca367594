"""Noise that changes its level at random: several filters with different noise levels, mixed by their probabilities.

The noise of a slowly changing quantity (a current, a wind) is a compromise: little makes a smooth estimate, much one that
recovers fast when the quantity jumps. Here the level is itself unknown: it changes at random between a few levels, each of
which lasts so long on average, and the innovations show which it is. One filter runs for each level; before each sample
each starts from the mixture of all, weighted by how probable it is that its level was reached from theirs. These are the
interacting multiple models of Blom and Bar-Shalom (1988), with models that differ in their noise only. The whole is one
generated step, so a record stays one loop in C.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import casadi as ca
import numpy as np

from shipid.declaration.units import to_si
from shipid.estimation.kalman import ExtendedKalmanFilter, check_finite
from shipid.estimation.online.online_filter import OnlineFilter
from shipid.estimation.records.arrangement import FilterRecord, Hole, arrange, columns_of
from shipid.estimation.records.controls import controls_of
from shipid.estimation.records.first_estimate import first_carried
from shipid.estimation.records.restart import restarted, run_stretches
from shipid.estimation.records.run import FilterRun
from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.layout import Places
from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.result import Printed
from shipid.generation.loop import Loop, Stepper, make_loop


@dataclass(frozen=True, eq=False, repr=False)
class AdaptiveRun(FilterRun):
    """The result of an adaptive filter on a record: estimates and covariances of the mixture.

    Attributes
    ----------
    probabilities : ndarray, shape (N, levels)
        Of each level, after each sample.
    smoothable : bool
        Always False: there is no smoother for a mixture of several filters.
    """

    probabilities: np.ndarray
    smoothable: ClassVar[bool] = False


class AdaptiveFilter(Printed):
    """A Kalman filter in which the level of some noise changes at random.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter, in covariance form, with the noise of quiet times.
    raised : sequence of str
        States and inputs whose noise changes its level.
    factors : sequence of float
        The levels, as multiples of the noise of quiet times.
    lasting : sequence of str
        How long each level lasts on average; the first probabilities are proportional to these times.

    Raises
    ------
    UnknownNameError
        If nothing drives a name that is to be raised.
    UsageError
        If the levels do not fit.
    """

    def __init__(
        self,
        kalman: ExtendedKalmanFilter,
        raised: Sequence[str],
        *,
        factors: Sequence[float] = (1.0, 20.0),
        lasting: Sequence[str] = ("600 s", "60 s"),
    ) -> None:
        design = kalman.design
        driven = [s.name for s in design.sources]
        for name in raised:
            if name not in driven:
                raise UnknownNameError("noise of the filter to raise called", name, driven)
        if not raised or len(factors) < 2 or len(factors) != len(lasting):
            raise UsageError(
                f"an adaptive filter needs noise to raise ({len(raised)} given), at least two factors ({len(factors)}) and "
                f"as many times they last ({len(lasting)})."
            )
        if not all(f > 0 for f in factors):
            raise UsageError(
                f"the factors {', '.join(f'{f:g}' for f in factors)} multiply a noise: each must be above zero."
            )
        if design.form != "covariance":
            raise UsageError("an adaptive filter mixes covariances: make its filter with form='covariance'.")
        self.design, self.raised, self.factors = design, tuple(raised), tuple(float(f) for f in factors)
        self.lasting = tuple(to_si(v, "s", "how long a level lasts") for v in lasting)
        if not all(v > 0 for v in self.lasting):
            raise UsageError(f"levels that last {', '.join(lasting)}: each time must be longer than zero.")
        self._sources = [i for i, s in enumerate(design.sources) if s.name in raised]

    def __repr__(self) -> str:
        levels = ", ".join(f"x{f:g} for {v:g} s" for f, v in zip(self.factors, self.lasting))
        return f"<noise on {', '.join(self.raised)} at {levels}; {self.design!r}>"

    def step(self, full: bool = False) -> CasadiFunction:
        """Return the generated step; its carried vector is that of one filter after the other, then the probabilities.

        Parameters
        ----------
        full : bool
            Whether it returns covariances and predicted values as well; the probabilities come last.
        """
        base, layout, count = self.design.step(full), self.design.layout, len(self.factors)
        before = [ca.SX.sym(f"z{j}", base.size1_in(0)) for j in range(count)]
        control, constants = (ca.SX.sym(n, base.size1_in(i)) for i, n in ((1, "c"), (2, "k")))
        weight = ca.SX.sym("weight", count)
        chance = self._transition(control[layout.control["T"]])
        ahead = chance.T @ weight
        followed, outs, likelihoods = [], [], []
        for j, factor in enumerate(self.factors):
            shares = chance[:, j] * weight / ahead[j]
            raised = control + 0
            for i in self._sources:
                raised[layout.control["scale"].start + i] *= factor
            following, out = base(self._mixed(before, before[j], shares), raised, constants)
            followed.append(following)
            outs.append(out)
            likelihoods.append(self._log_likelihood(out, control[layout.control["there"]]))
        logs = ca.vertcat(*likelihoods)
        best = ca.mmax(logs)
        after = ahead * ca.exp(logs - best)
        evidence = ca.sum1(after)
        # A probability never becomes zero: the level could not come back in finite time.
        after = ca.fmax(after / evidence, 1e-9)
        after = after / ca.sum1(after)
        places = layout.full if full else layout.brief
        out = self._mixture(outs, after, ahead, places, ca.log(evidence) + best)
        z = ca.vertcat(*followed, after)
        following, out = ca.cse([ca.densify(z), ca.densify(ca.vertcat(out, after))])
        return ca.Function("adaptive_step", [ca.vertcat(*before, weight), control, constants], [following, out])

    def _transition(self, interval: Expression) -> Expression:
        """Chance of every level (row) to be followed by every other (column)."""
        count = len(self.factors)
        chance = ca.SX(count, count)
        for i, lasting in enumerate(self.lasting):
            stays = ca.exp(-interval / lasting)
            for j in range(count):
                chance[i, j] = stays if i == j else (1 - stays) / (count - 1)
        return ca.densify(chance)

    def _mixed(self, before: Sequence[Expression], own: Expression, shares: Expression) -> Expression:
        """The carried vector of one filter with its estimate and covariance replaced by the mixture of all."""
        layout = self.design.layout
        joint = slice(0, layout.joint)
        mixture = sum(shares[i] * z[joint] for i, z in enumerate(before))
        packed = sum(
            shares[i] * (z[layout.carried["P"]] + covariance_form.pack(_outer(z[joint] - mixture)))
            for i, z in enumerate(before)
        )
        mixed = own + 0
        mixed[joint], mixed[layout.carried["P"]] = mixture, packed
        return mixed

    def _log_likelihood(self, out: Expression, there: Expression) -> Expression:
        """Logarithm of the likelihood of a sample; a sample that one filter rejects counts as rejected for all."""
        brief, gate = self.design.layout.brief, self.design.gate
        squares = out[brief["e"]] ** 2 / out[brief["S"]]
        if gate is not None:
            squares = ca.fmin(squares, gate.width**2)
        return -0.5 * ca.sum1(there * (ca.log(2 * np.pi * out[brief["S"]]) + squares))

    def _mixture(
        self, outs: Sequence[Expression], after: Expression, ahead: Expression, places: Places, evidence: Expression
    ) -> Expression:
        """The outputs of the mixture of all filters: means and variances, before a sample (`ahead`) and after it."""
        joined = sum(after[j] * out for j, out in enumerate(outs))
        predicted = sum(ahead[j] * out for j, out in enumerate(outs))
        off = [out - joined for out in outs]
        joined[places["var"]] += sum(after[j] * d[places["x"]] ** 2 for j, d in enumerate(off))
        early = [out - predicted for out in outs]
        for name in ("e", "S"):
            joined[places[name]] = predicted[places[name]]
        joined[places["S"]] += sum(ahead[j] * d[places["e"]] ** 2 for j, d in enumerate(early))
        joined[places["fate"]] = functools.reduce(ca.fmax, (out[places["fate"]] for out in outs))
        joined[places["ll"]] = evidence
        if "P" in places:
            scatter = [ca.vertcat(d[places["x"]], d[places["w"]]) for d in off]
            joined[places["P"]] += sum(after[j] * covariance_form.pack(_outer(d)) for j, d in enumerate(scatter))
            joined[places["ahead"]], joined[places["P_ahead"]] = (
                predicted[places["ahead"]],
                predicted[places["P_ahead"]],
            )
            joined[places["P_ahead"]] += sum(
                ahead[j] * covariance_form.pack(_outer(d[places["ahead"]])) for j, d in enumerate(early)
            )
        return joined

    def loop(self, full: bool = False) -> Loop:
        """Return the step with the loop over samples, compiled once.

        Parameters
        ----------
        full : bool
            See `step`.
        """
        return self._full if full else self._brief

    @functools.cached_property
    def _brief(self) -> Loop:
        return make_loop(self.step(), self.design.compiled, self.design.single)

    @functools.cached_property
    def _full(self) -> Loop:
        return make_loop(self.step(full=True), self.design.compiled, self.design.single)

    def filter(
        self,
        record: FilterRecord,
        *,
        adapt: np.ndarray | bool = True,
        scale: Mapping[str, np.ndarray | float] | None = None,
    ) -> AdaptiveRun:
        """Filter a whole record.

        Parameters
        ----------
        record, adapt, scale
            As `ExtendedKalmanFilter.filter` takes them.

        Returns
        -------
        AdaptiveRun

        Raises
        ------
        FilterDivergedError
            If the estimate runs away.
        """
        design, count = self.design, len(self.factors)
        arranged = arrange(design.instruments, record)
        control = controls_of(design, arranged, adapt, scale)
        start = first_carried(design, record, arranged)

        def anew(carried: np.ndarray, hole: Hole) -> np.ndarray:
            """Each filter for itself, with the probability it had."""
            own = np.split(carried[:-count], count)
            return np.concatenate([*(restarted(design, arranged, z, hole) for z in own), carried[-count:]])

        _, out, _ = run_stretches(
            self.loop(full=True), self.mixed_start(start), control, design.constants, arranged, anew
        )
        check_finite(design, arranged, out)
        mixture, probabilities = out[:, :-count], out[arranged.shown, -count:]
        return AdaptiveRun(design, columns_of(record)[1], arranged, control, (start,), mixture, probabilities)

    def start(self) -> OnlineAdaptive:
        """Return the filter for samples that arrive one by one."""
        return OnlineAdaptive(self)

    def mixed_start(self, first: np.ndarray) -> np.ndarray:
        """Return the carried vector that starts every level from the same estimate.

        Parameters
        ----------
        first : ndarray
            The carried vector of the filter it is made of.
        """
        lasting = np.array(self.lasting)
        return np.concatenate([np.tile(first, lasting.size), lasting / lasting.sum()])


class OnlineAdaptive(OnlineFilter):
    """An adaptive filter that takes one sample at a time; made by `AdaptiveFilter.start`.

    Parameters
    ----------
    adaptive : AdaptiveFilter
        What it runs.
    """

    def __init__(self, adaptive: AdaptiveFilter) -> None:
        super().__init__(adaptive.design)
        self.adaptive = adaptive

    @property
    def probabilities(self) -> np.ndarray | None:
        """Of each level, after the last sample; None before the first."""
        return None if self.stepper is None else np.array(self.stepper.out[-len(self.adaptive.factors) :], dtype=float)

    def first_stepper(self, carried: np.ndarray) -> Stepper:
        """Return the step of all filters, each of which starts from the same carried vector.

        Parameters
        ----------
        carried : ndarray, shape (carried,)
            What is known before the first sample.
        """
        return self.adaptive.loop().one_at_a_time(self.adaptive.mixed_start(carried), self.design.constants)

    def save(self, path: str | Path) -> None:
        """Raise an error: `ExtendedKalmanFilter.restore` cannot read the state of several filters.

        Parameters
        ----------
        path : str or Path
            The file.

        Raises
        ------
        UsageError
            Always.
        """
        raise UsageError(
            f"the state of an adaptive filter cannot be saved to {path}; start it anew from recent samples."
        )


def _outer(d: Expression) -> Expression:
    return d @ d.T
