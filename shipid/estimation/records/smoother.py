"""Smoothing: the estimate of each moment that every sample of the record bears on.

Rauch, Tung and Striebel's smoothed estimate, worked out by the recursion of Bryson and Frazier (Bierman 1977, chapter X): an
adjoint of the state runs back over the record, and nothing is inverted but the variance of one innovation. It therefore
serves where a covariance is singular, as it is when a parameter has no noise. Where adaptation was switched off, every sample
that was taken in counts all the same.

The smoothed covariance is the difference of the filter's and what came later: of a state that was a million times surer in the
end than at the start, the first standard deviations keep few digits.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from shipid.estimation.records.run import named, unpacked
from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.step import TAKEN, leapt
from shipid.generation.loop import Loop, make_loop

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.records.run import FilterRun


@dataclass(frozen=True, eq=False)
class Smoothed:
    """Smoothed estimates of a record.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Times of the samples in s.
    states : tuple of str
        Names along the estimates.
    x, std : ndarray, shape (N, states)
        Estimates and standard deviations, SI.
    """

    t: np.ndarray
    states: tuple[str, ...]
    x: np.ndarray
    std: np.ndarray
    _packed: np.ndarray = field(repr=False)
    _filter: ExtendedKalmanFilter = field(repr=False)

    def __getitem__(self, name: str) -> np.ndarray:
        """Return the smoothed estimates of a state or an estimated parameter, SI, shape (N,)."""
        return named(self._filter, self.x, self.std, name)[0]

    def std_of(self, name: str) -> np.ndarray:
        """Return the standard deviations of a state or an estimated parameter, SI, shape (N,).

        Parameters
        ----------
        name : str
            A state or an estimated parameter.
        """
        return named(self._filter, self.x, self.std, name)[1]

    @functools.cached_property
    def covariance(self) -> np.ndarray:
        """Covariance of the states at each sample, shape (N, states, states)."""
        return unpacked(self._packed, len(self.states))


def make_backward(kalman: ExtendedKalmanFilter) -> Loop:
    """Return the backward recursion of a filter, as a loop over its rows from the last to the first.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        Whose step is run back.

    Notes
    -----
    Carried: adjoint and its covariance after the update of the row. Control of row k: what the forward pass predicted there
    and ended with, its control, which samples it took, the joint vector and the inputs before it.
    """
    eq, layout = kalman.equations, kalman.layout
    n, size = layout.joint, covariance_form.size(layout.joint)
    adjoint, spread_packed = ca.SX.sym("l", n), ca.SX.sym("L", size)
    spread = covariance_form.unpack(spread_packed, n)
    packed_ahead, packed_after = ca.SX.sym("Pp", size), ca.SX.sym("Pf", size)
    x_after = ca.SX.sym("xf", layout.n)
    ahead, before = ca.SX.sym("xp", n), ca.SX.sym("xb", n)
    z, taken, leap = (ca.SX.sym(k, layout.sensors) for k in ("z", "m", "leap"))
    deviation = ca.SX.sym("r", layout.sensors)
    switch = ca.SX.sym("a", int(kalman.switchable))
    factor = ca.SX.ones(n)
    if kalman.adapting is not None:
        for i in np.flatnonzero(kalman.adapting).tolist():
            factor[i] = switch

    after = covariance_form.unpack(packed_after, n)
    smoothed = x_after - (after @ adjoint)[: layout.n]
    shrunk = after - after @ spread @ after

    # The sensors of this row once more, forward, to have every gain; then back through them in reverse.
    sensitivity = ca.substitute(eq.sensitivity, eq.joint, ahead)
    shown = ca.substitute(eq.shown, eq.joint, ahead)
    covariance, correction, passed = covariance_form.unpack(packed_ahead, n), ca.SX.zeros(n), []
    for i in range(layout.sensors):
        row = sensitivity[i, :]
        e = z[i] - shown[i]
        if kalman.wraps[i]:
            e = e - 2 * np.pi * ca.floor(e / (2 * np.pi) + 0.5)
        e = e - row @ correction
        variance = deviation[i] ** 2 + sum(effect[i] ** 2 * power for effect, power in eq.doubled)
        wide = leapt(eq.sensitivity, i, kalman.leaping)
        for state in wide:
            covariance = covariance_form.stretched(covariance, state, leap[i])
        gain, covariance, s = covariance_form.updated(
            covariance, row, variance, taken[i], factor if kalman.switchable else None
        )
        correction = correction + gain * e
        passed.append((row, gain, s, e, taken[i], [leap[i] if k in wide else 1.0 for k in range(n)]))
    back, back_spread = adjoint, spread
    for row, gain, s, e, count, wider in reversed(passed):
        kept = ca.SX.eye(n) - gain @ row
        back = kept.T @ back - row.T * (e / s * count)
        back_spread = kept.T @ back_spread @ kept + (row.T @ row) * (count / s)
        # A state that leapt was an error grown so many times larger.
        stretch = ca.diag(ca.vertcat(*wider))
        back, back_spread = stretch @ back, stretch @ back_spread @ stretch
    # Through the prediction, to the end of the row before. Carried noise starts anew with each row.
    transition = ca.SX.zeros(n, n)
    transition[: layout.n, :] = ca.substitute(eq.transition, eq.joint, before)
    moves = eq.T > 0
    still = ca.SX.zeros(n, n)
    for i in range(layout.n):
        still[i, i] = 1
    transition = ca.if_else(moves, transition, still) if eq.sampled else transition
    earlier = transition.T @ back
    earlier_spread = transition.T @ back_spread @ transition

    control = [packed_ahead, packed_after, x_after, ahead, before, eq.u0, eq.u1, eq.T, z, taken, leap, eq.scale, switch]
    step = ca.Function(
        "backward",
        [
            ca.vertcat(adjoint, spread_packed),
            ca.vertcat(*(ca.vec(c) for c in control)),
            ca.vertcat(eq.p, eq.levels, deviation),
        ],
        ca.cse(
            [
                ca.densify(ca.vertcat(earlier, covariance_form.pack(earlier_spread))),
                ca.densify(ca.vertcat(smoothed, covariance_form.pack(shrunk[: layout.n, : layout.n]))),
            ]
        ),
    )
    return make_loop(step, kalman.compiled)


def backward_controls(
    kalman: ExtendedKalmanFilter, control: np.ndarray, out: np.ndarray, start: np.ndarray
) -> np.ndarray:
    """Return the controls of the backward loop in the order of the rows, shape (N, controls).

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    control, out : ndarray
        Controls and full outputs of its forward rows.
    start : ndarray
        Carried vector before the first of them.
    """
    full, places, carried = kalman.layout.full, kalman.layout.control, kalman.layout.carried
    first = np.concatenate([start[carried["x"]], start[carried["w"]]])
    joint = np.concatenate([out[:, full["x"]], out[:, full["w"]]], axis=1)
    before = np.vstack([first, joint[:-1]])
    inputs = control[:, places["u"]]
    inputs_before = np.vstack([start[carried["u"]], inputs[:-1]])
    parts = [
        out[:, full["P_ahead"]],
        out[:, full["P"]],
        out[:, full["x"]],
        out[:, full["ahead"]],
        before,
        inputs_before,
        inputs,
        control[:, places["T"]],
        control[:, places["z"]],
        out[:, full["fate"]] == TAKEN,
        out[:, full["leap"]],
        control[:, places["scale"]],
        control[:, places["adapting"]],
    ]
    return np.concatenate(parts, axis=1)


def run_back(kalman: ExtendedKalmanFilter, control: np.ndarray, out: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return smoothed states and their packed covariance along forward rows, shape (N, n + n (n + 1) / 2).

    Parameters
    ----------
    kalman, control, out, start
        See `backward_controls`.
    """
    loop = kalman.backward
    if kalman.switchable and not control[:, kalman.layout.control["adapting"]].all():
        control, out, start = _learning(kalman, control, out, start)
    rows = backward_controls(kalman, control, out, start)[::-1]
    _, shown = loop(np.zeros(loop.sizes[0]), rows, kalman.constants)
    return shown[::-1]


def _learning(
    kalman: ExtendedKalmanFilter, control: np.ndarray, out: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Run forward rows again with parameters that adapt throughout, on the samples that were taken in.

    Innovations of a filter that holds its parameters are correlated, and no recursion back over them is the best estimate:
    it may even claim to know more than everything. Smoothing asks what all samples say together.
    """
    places, bare = kalman.layout.control, start[: kalman.layout.carried["P"].stop]
    again = control.copy()
    again[:, places["there"]] = out[:, kalman.layout.full["fate"]] == TAKEN
    again[:, places["adapting"]] = 1.0
    _, learnt = kalman.loop(full=True, gated=False)(bare, again, kalman.constants)
    return again, np.asarray(learnt, dtype=float), start


def smooth(run: FilterRun) -> Smoothed:
    """Smooth a filtered record.

    Parameters
    ----------
    run : FilterRun
        What the filter made of it.

    Returns
    -------
    Smoothed
    """
    kalman = run.filter
    n = kalman.layout.n
    shown = run_back(kalman, run._control, run._out, run._start)[run.arranged.shown]
    x, packed = shown[:, :n], shown[:, n:]
    diagonal = np.cumsum(np.arange(1, n + 1)) - 1
    return Smoothed(run.t, run.states, x, np.sqrt(np.maximum(packed[:, diagonal], 0.0)), packed, kalman)
