"""The spiral of a model: which rudder holds which rate of turn, and whether the curve folds back on itself.

A ship that is unstable on a straight course turns to starboard with the rudder a little to port. The reversed spiral shows
it as a loop: between its folds one rudder angle belongs to three rates of turn. The curve is followed from a straight
course outwards: at each rate of turn the steady state of all other states, and the rudder that holds it, are found by
Newton's method from the point before.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction
from shipid.generation.simulator import coefficient_vector, initial_state, input_rows
from shipid.generation.system import generate
from shipid.parts.rudder_delay import steered_by

#: Largest rate of turn that is tried, and the step to it, as r L/U.
_FARTHEST, _STEP = 1.2, 0.004
_ITERATIONS = 8


@dataclass(frozen=True, eq=False)
class Spiral:
    """The reversed spiral of a model; SI.

    Attributes
    ----------
    rate : ndarray, shape (n,)
        Rates of turn, from port to starboard.
    rudder : ndarray, shape (n,)
        The rudder angle that holds each.
    stable : bool
        Whether the ship keeps a straight course by itself: the curve rises at zero.
    loop_width : float
        Rudder angle from fold to fold; 0 for a stable ship.
    loop_height : float or None
        Rate of turn between both branches with the rudder where it holds a straight course; None where a branch was
        not followed so far.
    """

    rate: np.ndarray
    rudder: np.ndarray
    stable: bool
    loop_width: float
    loop_height: float | None

    @property
    def half_width(self) -> float:
        """Half of the loop's width in rad, which IMO and Norrbin give."""
        return 0.5 * self.loop_width


def spiral_of(
    model: Model, values: Mapping[str, float], speed: float, length: float, limit: float | None = None
) -> Spiral | None:
    """Return the reversed spiral of a model.

    Parameters
    ----------
    model : Model
        A ship model that reads the rudder angle.
    values : mapping of str to float
        Its coefficients, SI.
    speed, length : float
        Of the ship, in m/s and m: they set the scale of the rates.
    limit : float, optional
        Largest rudder angle in rad; the curve ends there.

    Returns
    -------
    Spiral or None
        None where the model has no steady turn: its turn depends on the heading, it is sampled, or it reads no rudder.

    Raises
    ------
    UnstatedInputError
        If the model reads an input that nothing states.
    """
    system = generate(model)
    behind = system.states_behind(["r"]) if "r" in model else ()
    rudder_input = steered_by(model)
    if not behind or rudder_input is None or set(behind) & {"psi", "x", "y"} or system.nexts:
        return None
    rates = np.arange(0.0, _FARTHEST, _STEP) * speed / length
    known = {"u": speed, "cruise": speed}
    # The rudder is the unknown: its value here is replaced.
    inputs = input_rows(model, {**known, rudder_input: 0.0}, 1, needed=system.inputs_behind(["r"]))[:, 0]
    at_rest = dict(zip(model.states, initial_state(model, known)))
    start = [*(at_rest[n] for n in behind), 0.0]
    p = coefficient_vector(model, values)
    walk = _walk(model, rudder_input, len(rates))
    halves = []
    for side in (1.0, -1.0):
        rudder, miss = walk(start, side * rates, inputs, p).full()
        ended = ~np.isfinite(rudder) | ~(miss < 1e-6)
        if limit is not None:
            ended |= (np.abs(rudder) > limit) & (np.gradient(side * np.nan_to_num(rudder)) > 0)
        count = int(np.argmax(ended)) if ended.any() else len(rates)
        halves.append((side * rates[:count], rudder[:count]))
    (r, delta), (r_port, delta_port) = halves
    if r.size < 3 or r_port.size < 3:
        return None
    neutral = float(delta[0])
    stable = bool(delta[1] > neutral and delta_port[1] < neutral)
    # A curve that rises at zero has no loop there; where it falls later, the model runs away from a hard turn.
    folds = [0.0] if stable else [_fold(r, delta - neutral), _fold(-r_port, neutral - delta_port)]
    returns = [_return(r, delta - neutral), _return(-r_port, neutral - delta_port)]
    heights = [h for h in returns if h is not None]
    return Spiral(
        np.concatenate([r_port[:0:-1], r]),
        np.concatenate([delta_port[:0:-1], delta]),
        stable,
        sum(folds),
        0.0 if stable else sum(heights) if len(heights) == 2 else None,
    )


def _fold(rate: np.ndarray, rudder: np.ndarray) -> float:
    """How far the rudder goes to the other side while the rate grows; the vertex of the parabola at the turn."""
    k = int(np.argmin(rudder))
    if k == 0:
        return 0.0
    if k == len(rate) - 1:
        return float(-rudder[k])
    vertex = np.polynomial.Polynomial.fit(rate[k - 1 : k + 2], rudder[k - 1 : k + 2], 2)
    return float(-vertex(vertex.deriv().roots()[0]))


def _return(rate: np.ndarray, rudder: np.ndarray) -> float | None:
    """Rate of turn at which the rudder is back where it holds a straight course; 0 where it never left to that side."""
    k = int(np.argmin(rudder))
    if k == 0:
        return 0.0
    back = np.flatnonzero(rudder[k:] >= 0)
    if not back.size:
        return None
    i = k + int(back[0])
    return float(np.interp(0.0, rudder[i - 1 : i + 1], rate[i - 1 : i + 1]))


@functools.lru_cache(maxsize=32)
def _walk(model: Model, rudder_input: str, count: int) -> CasadiFunction:
    """The CasADi function ``(start, rates, inputs, coefficients) -> (rudder, remaining relative error)``."""
    system = generate(model)
    behind = system.states_behind(["r"])
    moves = system.rates
    r, unknown = ca.SX.sym("r"), ca.SX.sym("unknown", len(behind) + 1)
    x = ca.vertcat(*(unknown[behind.index(n)] if n in behind else 0.0 for n in system.states))
    given = ca.SX.sym("given", system.u.shape[0])
    u = given + 0
    u[system.inputs.index(rudder_input)] = unknown[len(behind)]
    wanted = ca.vertcat(*(moves[system.states.index(n)] for n in behind), system.values["r"])
    at = ca.Function("moves", [system.x, system.u, system.p], [ca.substitute(wanted, system.T, 1.0)])
    error = at(x, u, system.p) - ca.vertcat(ca.SX.zeros(len(behind)), r)
    newton = ca.Function(
        "newton",
        [unknown, r, given, system.p],
        [unknown - ca.solve(ca.jacobian(error, unknown), error)],
    )
    found = unknown
    for _ in range(_ITERATIONS):
        before, found = found, newton(found, r, given, system.p)
    last = ca.norm_inf(found - before) / (1e-6 + ca.norm_inf(found))
    step = ca.Function("steady", [unknown, r, given, system.p], [found, ca.vertcat(found[len(behind)], last)])
    start, rates = ca.MX.sym("start", len(behind) + 1), ca.MX.sym("rates", 1, count)
    fixed, p = ca.MX.sym("given", given.shape[0]), ca.MX.sym("p", system.p.shape[0])
    _, rows = step.mapaccum(count)(start, rates, ca.repmat(fixed, 1, count), ca.repmat(p, 1, count))
    return ca.Function("walk", [start, rates, fixed, p], [rows])
