"""One filter step as a generated function: predict to a sample, gate it, take it in.

What is carried from sample to sample is one vector, what comes with a sample another, so that a record is a loop in C and
an arriving sample one call.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Any

import casadi as ca
import numpy as np

from shipid.estimation.recursion import covariance_form, square_root_form
from shipid.estimation.recursion.equations import Equations

FORMS: dict[str, ModuleType] = {"covariance": covariance_form, "square-root": square_root_form}
#: What became of a sample: taken in, not there, beyond the gate.
TAKEN, MISSING, REJECTED = 1, 0, -1
#: So many equal values in a row make a sensor suspect, and its gate this part as wide.
_SUSPECT, _NARROW = 5, 0.5
#: Values are equal within this part of the sensor's noise; a sensor whose values differ by less than that part is a fine one.
_EQUAL, _FINE = 1e-6, 0.1
#: What a gate remembers of each sensor: its last value, how often it repeated it and for how long, how long it has been refused,
#: and the smallest difference of two values.
MEMORY = ("last", "same", "refused", "held", "grain")


@dataclass(frozen=True)
class Gate:
    """When a sample is refused.

    Attributes
    ----------
    width : float
        In standard deviations of the innovation.
    patience : float
        Seconds of refusals after which a sensor whose value changes is believed again. What it shows is then taken to have
        leapt: its standard deviation is stretched until the innovation is one of its own, so that the estimate follows at
        once and says how unsure it is.
    """

    width: float
    patience: float


class Layout:
    """Where everything stands in the vectors of a filter step.

    Parameters
    ----------
    equations : Equations
        The model.
    form : str
        Key of `FORMS`.
    gated : bool
        Whether the gate's memory is carried.
    switchable : bool
        Whether each sample says if parameters adapt.
    """

    def __init__(self, equations: Equations, form: str, gated: bool, switchable: bool) -> None:
        self.n = equations.system.x.shape[0]
        self.joint = equations.joint.shape[0]
        self.inputs = equations.system.u.shape[0]
        self.sensors = len(equations.measured)
        self.sources = len(equations.sources)
        self.root = FORMS[form].size(self.joint)
        self.carried = _places(
            x=self.n,
            w=self.joint - self.n,
            u=self.inputs,
            P=self.root,
            last=self.sensors * gated,
            same=self.sensors * gated,
            refused=self.sensors * gated,
            held=self.sensors * gated,
            grain=self.sensors * gated,
        )
        self.control = _places(
            u=self.inputs, T=1, z=self.sensors, there=self.sensors, scale=self.sources, adapting=int(switchable)
        )
        self.constants = _places(p=equations.p.shape[0], q=self.sources, r=self.sensors)
        self.brief = _places(x=self.n, var=self.n, e=self.sensors, S=self.sensors, fate=self.sensors, ll=1)
        triangle = covariance_form.size(self.joint)
        self.full = _places(
            x=self.n,
            var=self.n,
            e=self.sensors,
            S=self.sensors,
            fate=self.sensors,
            ll=1,
            w=self.joint - self.n,
            P=triangle,
            ahead=self.joint,
            P_ahead=triangle,
            leap=self.sensors,
        )


def _places(**sizes: int) -> dict[str, slice]:
    places, at = {}, 0
    for name, count in sizes.items():
        places[name] = slice(at, at + count)
        at += count
    return places


def _part(vector: Any, place: slice) -> Any:
    """Take a part of a column; CasADi takes an empty part of a single number for a row."""
    return vector[place] if place.stop > place.start else ca.SX(0, 1)


def total(places: dict[str, slice]) -> int:
    """Return the length of a vector with these places."""
    return max((p.stop for p in places.values()), default=0)


def make_filter_step(
    equations: Equations,
    layout: Layout,
    form: str,
    gate: Gate | None,
    wraps: np.ndarray,
    floor: np.ndarray,
    ceiling: np.ndarray,
    adapting: np.ndarray | None,
    leaping: np.ndarray,
    full: bool = False,
) -> Any:
    """Generate the step ``(carried, control, constants) -> (carried, outputs)``.

    Parameters
    ----------
    equations : Equations
        The model.
    layout : Layout
        Where everything stands.
    form : {"covariance", "square-root"}
        What is carried of the covariance.
    gate : Gate or None
        When samples are refused; None takes in every one.
    wraps : ndarray of bool, shape (sensors,)
        Which sensors show an angle that wraps.
    floor, ceiling : ndarray, shape (states,)
        Bounds of each state, infinite where it has none.
    adapting : ndarray of bool or None, shape (states,)
        Which states hold still where a sample says so.
    leaping : ndarray of bool, shape (states,)
        Which states can leap to a sensor that insists: those that are no parameters.
    full : bool
        Whether covariances and predicted values are returned as well.

    Returns
    -------
    casadi.Function
    """
    rules = FORMS[form]
    before = ca.SX.sym("carried", total(layout.carried))
    control = ca.SX.sym("control", total(layout.control))
    constants = ca.SX.sym("constants", total(layout.constants))

    def of(vector: Any, places: dict[str, slice], name: str) -> Any:
        return _part(vector, places[name])

    packed, root = rules.symbol(layout.joint)
    u1, interval = of(control, layout.control, "u"), of(control, layout.control, "T")
    joint = ca.vertcat(of(before, layout.carried, "x"), of(before, layout.carried, "w"))
    deviation = of(constants, layout.constants, "r")

    ahead, root_ahead = equations.advanced, rules.predicted(equations, root)
    if equations.sampled:
        # A sampled state moves whenever its step is run: with no time between two samples it is not.
        n, moves = layout.n, equations.T > 0
        ahead = ca.if_else(moves, ahead, equations.joint[:n])
        kept = root + 0
        kept[n:, :] = root_ahead[n:, :]
        kept[:, n:] = root_ahead[:, n:]
        root_ahead = ca.if_else(moves, root_ahead, kept)
    ahead = ca.vertcat(ahead, ca.SX.zeros(layout.joint - layout.n))

    # The update is written over symbols of its own, so that its expressions stay small; they are joined at the end.
    sensed = _sensed(equations, layout, rules, gate, wraps, adapting, leaping)
    predict = ca.Function(
        "predict",
        [
            equations.joint,
            packed,
            equations.u0,
            equations.u1,
            equations.T,
            equations.p,
            equations.levels,
            equations.scale,
        ],
        [ahead, rules.pack(root_ahead)],
    )
    x_ahead, packed_ahead = predict(
        joint,
        of(before, layout.carried, "P"),
        of(before, layout.carried, "u"),
        u1,
        interval,
        of(constants, layout.constants, "p"),
        of(constants, layout.constants, "q"),
        of(control, layout.control, "scale"),
    )
    memory = [of(before, layout.carried, k) for k in MEMORY]
    switch = of(control, layout.control, "adapting")
    after, packed_after, e, spread, fate, ll, leap, *memory = sensed(
        x_ahead,
        packed_ahead,
        u1,
        interval,
        of(control, layout.control, "z"),
        of(control, layout.control, "there"),
        of(constants, layout.constants, "p"),
        deviation,
        switch,
        of(constants, layout.constants, "q"),
        of(control, layout.control, "scale"),
        *memory,
    )
    states = after[: layout.n]
    for i in range(layout.n):
        if np.isfinite(floor[i]):
            states[i] = ca.fmax(states[i], floor[i])
        if np.isfinite(ceiling[i]):
            states[i] = ca.fmin(states[i], ceiling[i])
    noise = _part(after, slice(layout.n, layout.joint))
    root_after = _unpacked(rules, packed_after, layout.joint)
    following = ca.vertcat(states, noise, u1, packed_after, *memory)
    shown = [states, rules.variances(root_after, layout.n), e, spread, fate, ll]
    if full:
        shown += [
            noise,
            _triangle(rules, root_after),
            x_ahead,
            _triangle(rules, _unpacked(rules, packed_ahead, layout.joint)),
            leap,
        ]
    outputs = ca.vertcat(*(ca.densify(s) for s in shown))
    following, outputs = ca.cse([ca.densify(following), outputs])
    return ca.Function("filter_step", [before, control, constants], [following, outputs])


def _unpacked(rules: ModuleType, packed: Any, n: int) -> Any:
    return covariance_form.unpack(packed, n) if rules is covariance_form else ca.reshape(packed, n, n)


def _triangle(rules: ModuleType, root: Any) -> Any:
    return covariance_form.pack(root if rules is covariance_form else square_root_form.covariance(root))


def _sensed(
    equations: Equations,
    layout: Layout,
    rules: ModuleType,
    gate: Gate | None,
    wraps: np.ndarray,
    adapting: np.ndarray | None,
    leaping: np.ndarray,
) -> Any:
    """The update by all sensors, as a function of what was predicted."""
    packed, root = rules.symbol(layout.joint)
    z, there = ca.SX.sym("z", layout.sensors), ca.SX.sym("m", layout.sensors)
    deviation = ca.SX.sym("r", layout.sensors)
    switch = ca.SX.sym("a", layout.control["adapting"].stop - layout.control["adapting"].start)
    count = layout.carried["last"].stop - layout.carried["last"].start
    memory = [ca.SX.sym(k, count) for k in MEMORY]
    followed = [m + 0 for m in memory]
    factor = None
    if adapting is not None:
        factor = ca.SX.ones(layout.joint)
        for held in np.flatnonzero(adapting).tolist():
            factor[held] = switch
    correction = ca.SX.zeros(layout.joint)
    innovations, spreads, fates, leaps, ll = [], [], [], [], ca.SX(0)
    for i in range(layout.sensors):
        row = equations.sensitivity[i, :]
        e = z[i] - equations.shown[i]
        if wraps[i]:
            e = e - 2 * np.pi * ca.floor(e / (2 * np.pi) + 0.5)
        e = e - row @ correction
        variance = deviation[i] ** 2 + sum(effect[i] ** 2 * power for effect, power in equations.doubled)
        expected = rules.innovation(root, row, variance)
        counts, beyond = _judged(gate, i, e, expected, z, there, memory, followed, equations.T, deviation[i])
        leap = ca.if_else(counts * beyond, ca.sqrt(e**2 / expected), 1.0) if gate is not None else ca.SX(1)
        if gate is not None:
            for state in leapt(equations.sensitivity, i, leaping):
                root = rules.stretched(root, state, leap)
        gain, root, spread = rules.updated(root, row, variance, counts, factor)
        correction = correction + gain * e
        innovations.append(e)
        spreads.append(spread)
        fates.append(counts - there[i] * beyond * (1 - counts))
        leaps.append(leap)
        ll = ll - counts * 0.5 * (ca.log(2 * np.pi * spread) + e**2 / spread)
    after = equations.joint + correction
    function = ca.Function(
        "sensed",
        [
            equations.joint,
            packed,
            equations.u1,
            equations.T,
            z,
            there,
            equations.p,
            deviation,
            switch,
            equations.levels,
            equations.scale,
            *memory,
        ],
        [
            after,
            rules.pack(root),
            ca.vertcat(*innovations),
            ca.vertcat(*spreads),
            ca.vertcat(*fates),
            ll,
            ca.vertcat(*leaps),
            *followed,
        ],
    )
    return function


def leapt(sensitivity: Any, sensor: int, leaping: np.ndarray) -> list[int]:
    """Return the states that leap to a sensor that insists, by index.

    Parameters
    ----------
    sensitivity : casadi.SX, shape (sensors, unknowns)
        What the sensors show of the unknowns.
    sensor : int
        Which of them.
    leaping : ndarray of bool, shape (states,)
        Which states can.
    """
    return [k for k in sensitivity[sensor, :].sparsity().get_col() if k < leaping.size and leaping[k]]


def _judged(
    gate: Gate | None,
    i: int,
    e: Any,
    spread: Any,
    z: Any,
    there: Any,
    memory: list[Any],
    followed: list[Any],
    interval: Any,
    deviation: Any,
) -> tuple[Any, Any]:
    """Whether a sample counts (1 or 0), and whether it lies beyond the gate; what is remembered is brought up to date."""
    if gate is None:
        return there[i], ca.SX(0)
    last, same, refused, held, grain = (m[i] for m in memory)
    change, patience = ca.fabs(z[i] - last), (1 - 1e-6) * gate.patience
    equal = change <= _EQUAL * deviation
    repeats = ca.if_else(there[i], ca.if_else(equal, same + 1, 0), same)
    holding = ca.if_else(there[i], ca.if_else(equal, held + interval, 0), held)
    width = ca.if_else(repeats >= _SUSPECT, _NARROW * gate.width, gate.width)
    outside = e**2 > width**2 * spread
    # Once found out, it is stuck for as long as it repeats itself, even where what it says comes true for a moment. A fine
    # sensor would not show the same noise for so long at all.
    stuck = ca.fmax((repeats >= _SUSPECT) * (refused > 0), (holding >= patience) * (grain < _FINE * deviation))
    beyond = ca.fmax(outside, stuck)
    waited = refused + interval
    # A sensor that keeps saying something else is right in the end; one that repeats itself is stuck.
    insists = (waited >= patience) * (repeats == 0)
    counts = there[i] * (1 - beyond * (1 - insists))
    followed[0][i] = ca.if_else(there[i], z[i], last)
    followed[1][i] = repeats
    # Between the samples of a slow sensor the waiting goes on.
    followed[2][i] = ca.if_else(there[i], beyond, refused > 0) * waited
    followed[3][i] = holding
    followed[4][i] = ca.if_else(there[i] * (1 - equal), ca.fmin(grain, change), grain)
    return counts, beyond
