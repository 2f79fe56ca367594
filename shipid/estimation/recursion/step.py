"""One filter step as a generated function: predict to a sample, gate it, update.

What is carried from sample to sample is one vector, what comes with a sample another, so that a record is a loop in C and
an arriving sample one call.
"""

from __future__ import annotations

from types import ModuleType

import casadi as ca
import numpy as np

from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.equations import Equations
from shipid.estimation.recursion.gate import MEMORY, apply_gate, states_to_reset
from shipid.estimation.recursion.layout import FORMS, Places, StepLayout, StepSettings, part, total
from shipid.foundation.aliases import CasadiFunction, Expression


def make_filter_step(equations: Equations, settings: StepSettings, full: bool = False) -> CasadiFunction:
    """Generate the step ``(carried, control, constants) -> (carried, outputs)``; `StepLayout` says what stands where.

    Parameters
    ----------
    equations : Equations
        The model.
    settings : StepSettings
        What the step does.
    full : bool
        Whether covariances and predicted values are returned as well.

    Returns
    -------
    casadi.Function
    """
    layout, form = StepLayout(equations, settings), FORMS[settings.form]
    carried = ca.SX.sym("carried", total(layout.carried))
    control = ca.SX.sym("control", total(layout.control))
    constants = ca.SX.sym("constants", total(layout.constants))
    old, new, fixed = (
        _parts(v, p) for v, p in ((carried, layout.carried), (control, layout.control), (constants, layout.constants))
    )
    # Prediction and update are functions of symbols of their own, so that their expressions stay small.
    x_ahead, packed_ahead = make_prediction(equations, layout, form)(
        ca.vertcat(old["x"], old["w"]), old["P"], old["u"], new["u"], new["T"], fixed["p"], fixed["q"], new["scale"]
    )
    after, packed_after, e, spread, fate, ll, inflation, *memory = _update(equations, layout, form, settings)(
        x_ahead,
        packed_ahead,
        new["u"],
        new["T"],
        new["z"],
        new["there"],
        fixed["p"],
        fixed["r"],
        new["adapting"],
        fixed["q"],
        new["scale"],
        *(old[k] for k in MEMORY),
    )
    states = after[: layout.n]
    for i in range(layout.n):
        if np.isfinite(settings.low[i]):
            states[i] = ca.fmax(states[i], settings.low[i])
        if np.isfinite(settings.high[i]):
            states[i] = ca.fmin(states[i], settings.high[i])
    noise = part(after, slice(layout.n, layout.joint))
    root = form.unpack(packed_after, layout.joint)
    following = ca.vertcat(states, noise, new["u"], packed_after, *memory)
    shown = [states, form.variances(root, layout.n), e, spread, fate, ll]
    if full:
        triangles = [
            covariance_form.pack(form.covariance_of(r)) for r in (root, form.unpack(packed_ahead, layout.joint))
        ]
        shown += [noise, triangles[0], x_ahead, triangles[1], inflation]
    outputs = ca.vertcat(*(ca.densify(s) for s in shown))
    following, outputs = ca.cse([ca.densify(following), outputs])
    return ca.Function("filter_step", [carried, control, constants], [following, outputs])


def _parts(vector: Expression, places: Places) -> dict[str, Expression]:
    return {name: part(vector, place) for name, place in places.items()}


def make_prediction(equations: Equations, layout: StepLayout, form: ModuleType) -> CasadiFunction:
    """Return the prediction to a sample, as a function of the estimate after the sample before.

    Parameters
    ----------
    equations : Equations
        The model.
    layout : StepLayout
        Where everything stands.
    form : module
        The functions of the covariance's form.

    Returns
    -------
    casadi.Function
        ``(joint, packed, u0, u1, T, p, levels, scale) -> (joint, packed)``.
    """
    packed, root = form.symbol(layout.joint)
    ahead, root_ahead = equations.advanced, form.predicted(equations, root)
    if equations.sampled:
        # A sampled state changes whenever its step is run; where no time passes between two samples, it is not run.
        n, moves = layout.n, equations.T > 0
        ahead = ca.if_else(moves, ahead, equations.joint[:n])
        kept = root + 0
        kept[n:, :] = root_ahead[n:, :]
        kept[:, n:] = root_ahead[:, n:]
        root_ahead = ca.if_else(moves, root_ahead, kept)
    ahead = ca.vertcat(ahead, ca.SX.zeros(layout.joint - layout.n))
    interval = [equations.u0, equations.u1, equations.T, equations.p, equations.levels, equations.scale]
    return ca.Function("predict", [equations.joint, packed, *interval], [ahead, form.pack(root_ahead)])


def _update(equations: Equations, layout: StepLayout, form: ModuleType, settings: StepSettings) -> CasadiFunction:
    """Return the update by all sensors, one after the other, as a function of the prediction."""
    gate = settings.gate
    packed, root = form.symbol(layout.joint)
    z, there, deviation = (ca.SX.sym(n, layout.sensors) for n in ("z", "m", "r"))
    switch = ca.SX.sym("a", int(settings.switchable))
    memory = [ca.SX.sym(k, layout.sensors if gate is not None else 0) for k in MEMORY]
    remembered = [m + 0 for m in memory]
    factors = settings.gain_factors(layout.joint, switch)
    correction = ca.SX.zeros(layout.joint)
    innovations, spreads, fates, inflations, ll = [], [], [], [], ca.SX(0)
    for i in range(layout.sensors):
        row = equations.sensitivity[i, :]
        e = equations.innovation(i, z, equations.shown, bool(settings.wraps[i])) - row @ correction
        variance = equations.sensor_variance(i, deviation)
        expected = form.innovation(root, row, variance)
        own = [m[i] for m in memory] if gate is not None else []
        counts, beyond, kept = apply_gate(gate, e, expected, z[i], there[i], own, equations.T, deviation[i])
        for vector, value in zip(remembered, kept):
            vector[i] = value
        inflation = ca.SX(1)
        if gate is not None:
            inflation = ca.if_else(counts * beyond, ca.sqrt(e**2 / expected), 1.0)
            for state in states_to_reset(equations.sensitivity, i, settings.resettable):
                root = form.inflated(root, state, inflation)
        gain, root, spread = form.updated(root, row, variance, counts, factors)
        correction = correction + gain * e
        innovations.append(e)
        spreads.append(spread)
        fates.append(counts - there[i] * beyond * (1 - counts))
        inflations.append(inflation)
        ll = ll - counts * 0.5 * (ca.log(2 * np.pi * spread) + e**2 / spread)
    sample = [equations.u1, equations.T, z, there, equations.p, deviation, switch, equations.levels, equations.scale]
    columns = [ca.vertcat(*c) for c in (innovations, spreads, fates)]
    return ca.Function(
        "update",
        [equations.joint, packed, *sample, *memory],
        [equations.joint + correction, form.pack(root), *columns, ll, ca.vertcat(*inflations), *remembered],
    )
