"""The likelihood of a record through the filter, with its exact gradient by coefficients, noise levels and first states.

The sensitivity of everything the filter carries (estimate, covariance, gate aside) runs along inside the generated step, as
it does in `shipid.generation.record`: one pass over the record, compiled once whatever its length. Expected information comes
with it (Fisher's matrix from the innovations' first derivatives).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from shipid.estimation.records.vectors import carried_vector, controls_of, first_sample
from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.step import Layout, make_filter_step, total
from shipid.foundation.errors import UnknownNameError
from shipid.generation.loop import Loop, make_loop
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter


@dataclass(frozen=True, eq=False)
class Likelihood:
    """Logarithm of the likelihood of one record as a function of unknowns; made by `make_likelihood`.

    Attributes
    ----------
    unknowns : tuple of str
        Coefficients by name, ``noise:NAME`` and ``sensor:NAME`` (natural logarithms of levels), ``x0:STATE``,
        ``bias:INPUT``.
    start : ndarray, shape (unknowns,)
        Their values in the filter.
    """

    unknowns: tuple[str, ...]
    start: np.ndarray
    _loop: Loop = field(repr=False)
    _carried: np.ndarray = field(repr=False)
    _control: np.ndarray = field(repr=False)
    _constants: np.ndarray = field(repr=False)
    _places: Mapping[str, tuple[str, int]] = field(repr=False)
    _inputs: int = field(repr=False)

    def __call__(self, q: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Evaluate at unknowns.

        Parameters
        ----------
        q : ndarray, shape (unknowns,)
            SI; natural logarithms of noise levels.

        Returns
        -------
        value : float
            Logarithm of the likelihood; minus infinity where the filter runs away.
        gradient : ndarray, shape (unknowns,)
        information : ndarray, shape (unknowns, unknowns)
            Fisher's, summed over the record.
        """
        size = len(self.unknowns)
        z0, control, constants = self._carried.copy(), self._control, self._constants.copy()
        shift = np.zeros(self._inputs)
        for value, name in zip(q, self.unknowns):
            kind, at = self._places[name]
            if kind == "constant":
                constants[at] = value
            elif kind == "level":
                constants[at] = np.exp(value)
            elif kind == "state":
                z0[at] = value
            else:
                shift[at] += value
        if shift.any():
            control = control.copy()
            control[:, : self._inputs] += shift
        end, out = self._loop(z0, control, constants)
        value, gradient = float(out[:, 0].sum()), out[:, 1:].sum(axis=0)
        triangle = end[z0.size - covariance_form.size(size) :]
        information = np.zeros((size, size))
        rows = np.concatenate([np.arange(j + 1) for j in range(size)]) if size else np.zeros(0, dtype=int)
        columns = np.repeat(np.arange(size), np.arange(1, size + 1))
        information[rows, columns] = information[columns, rows] = triangle
        if not (np.isfinite(value) and np.isfinite(gradient).all()):
            return -np.inf, np.zeros(size), np.zeros((size, size))
        return value, gradient, information


def make_likelihood(
    kalman: ExtendedKalmanFilter, record: Trial | Mapping[str, np.ndarray], unknowns: Sequence[str]
) -> Likelihood:
    """Generate the likelihood of a record; samples are not gated, since a gate has no derivative.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter (covariance form).
    record : Trial or mapping of str to ndarray
        What was measured.
    unknowns : sequence of str
        See `Likelihood`.

    Returns
    -------
    Likelihood

    Raises
    ------
    UnknownNameError
        If an unknown is none of the filter.
    """
    layout = Layout(kalman.equations, "covariance", False, kalman.switchable)
    places = {n: _place(kalman, layout, n) for n in unknowns}
    loop = _score_loop(kalman, layout, tuple(unknowns), tuple(places.items()))
    arranged = kalman.arrangement(record)
    gated = carried_vector(kalman, first_sample(kalman, record), arranged.inputs[0])
    bare = gated[: total(layout.carried)]
    size = len(unknowns)
    seed = np.zeros((bare.size, size))
    for j, name in enumerate(unknowns):
        kind, at = places[name]
        if kind == "state":
            seed[at, j] = 1.0
        elif kind == "input":
            seed[layout.carried["u"].start + at, j] = 1.0
    carried = np.concatenate([bare, seed.ravel(order="F"), np.zeros(covariance_form.size(size))])
    constants = kalman.constants
    start = np.array([_value(constants, bare, *places[n]) for n in unknowns])
    return Likelihood(
        tuple(unknowns), start, loop, carried, controls_of(kalman, arranged), constants, places, layout.inputs
    )


def _value(constants: np.ndarray, carried: np.ndarray, kind: str, at: int) -> float:
    values = {"constant": constants, "level": constants, "state": carried}
    if kind == "input":
        return 0.0
    return float(np.log(values[kind][at]) if kind == "level" else values[kind][at])


def _place(kalman: ExtendedKalmanFilter, layout: Layout, name: str) -> tuple[str, int]:
    """Where an unknown stands: among the constants, the first states or the inputs."""
    head, colon, tail = name.partition(":")
    driven = [s.name for s in kalman.sources]
    if not colon and name in kalman.system.coefficients:
        return "constant", layout.constants["p"].start + kalman.system.coefficients.index(name)
    if head == "noise" and tail in driven:
        return "level", layout.constants["q"].start + driven.index(tail)
    if head == "sensor" and tail in kalman.measured:
        return "level", layout.constants["r"].start + kalman.measured.index(tail)
    if head == "x0" and tail in kalman.model.states:
        return "state", layout.carried["x"].start + kalman.model.states.index(tail)
    if head == "bias" and tail in kalman.model.inputs:
        return "input", kalman.model.inputs.index(tail)
    known = [
        *kalman.system.coefficients,
        *(f"noise:{n}" for n in driven),
        *(f"sensor:{n}" for n in kalman.measured),
        *(f"x0:{n}" for n in kalman.model.states),
        *(f"bias:{n}" for n in kalman.model.inputs),
    ]
    raise UnknownNameError("unknown of the likelihood called", name, known)


def _score_loop(
    kalman: ExtendedKalmanFilter,
    layout: Layout,
    unknowns: tuple[str, ...],
    places: tuple[tuple[str, tuple[str, int]], ...],
) -> Loop:
    """The step with its sensitivities, compiled once for each choice of unknowns."""
    cache: dict[Any, Loop] = kalman.__dict__.setdefault("_scores", {})
    if unknowns in cache:
        return cache[unknowns]
    unbounded = np.full(layout.n, np.inf)
    step = make_filter_step(
        kalman.equations,
        layout,
        "covariance",
        None,
        kalman.wraps,
        -unbounded,
        unbounded,
        kalman.adapting,
        kalman.leaping,
    )
    size = len(unknowns)
    z, control, constants = (ca.SX.sym(n, step.size1_in(i)) for i, n in enumerate(("z", "c", "k")))
    carried = ca.SX.sym("S", z.shape[0], size)
    information = ca.SX.sym("I", covariance_form.size(size))
    by_control, by_constant = ca.SX(control.shape[0], size), ca.SX(constants.shape[0], size)
    for j, (_, (kind, at)) in enumerate(places):
        if kind == "constant":
            by_constant[at, j] = 1.0
        elif kind == "level":
            by_constant[at, j] = constants[at]
        elif kind == "input":
            by_control[layout.control["u"].start + at, j] = 1.0
    z_next, out = step(z, control, constants)
    e, spread, fate = (out[layout.brief[n]] for n in ("e", "S", "fate"))
    everything, moved = ca.vertcat(z, control, constants), ca.vertcat(carried, by_control, by_constant)
    shown = ca.vertcat(z_next, out[layout.brief["ll"]], e, spread)
    slopes = ca.jtimes(shown, everything, ca.densify(moved)) if size else ca.SX(shown.shape[0], 0)
    n, m = z.shape[0], layout.sensors
    by_e, by_spread = slopes[n + 1 : n + 1 + m, :], slopes[n + 1 + m :, :]
    told = ca.SX.zeros(size, size)
    for i in range(m):
        mean, power = by_e[i, :], by_spread[i, :]
        told += fate[i] * ((mean.T @ mean) / spread[i] + (power.T @ power) / (2 * spread[i] ** 2))
    following = ca.vertcat(z_next, ca.vec(slopes[:n, :]), information + covariance_form.pack(told))
    outputs = ca.vertcat(shown[n], slopes[n, :].T)
    following, outputs = ca.cse([ca.densify(following), ca.densify(outputs)])
    function = ca.Function(
        "score_step", [ca.vertcat(z, ca.vec(carried), information), control, constants], [following, outputs]
    )
    cache[unknowns] = make_loop(function, kalman.compiled)
    return cache[unknowns]
