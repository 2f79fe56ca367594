"""The backward recursion of the smoother as a generated function, one row of a filtered record at a time.

Rauch, Tung and Striebel's smoothed estimate by the recursion of Bryson and Frazier (Bierman 1977, chapter X): an adjoint of
the state runs back over the record, and nothing is inverted but the variance of one innovation. It therefore serves where a
covariance is singular, as it is when a parameter has no noise.
"""

from __future__ import annotations

import casadi as ca

from shipid.estimation.recursion import covariance_form
from shipid.estimation.recursion.equations import Equations
from shipid.estimation.recursion.gate import states_to_reset
from shipid.estimation.recursion.layout import StepLayout, StepSettings
from shipid.foundation.aliases import CasadiFunction


def make_backward_step(equations: Equations, settings: StepSettings) -> CasadiFunction:
    """Generate the backward recursion ``(carried, row, constants) -> (carried, smoothed)``.

    Parameters
    ----------
    equations : Equations
        The model.
    settings : StepSettings
        What its forward step does.

    Returns
    -------
    casadi.Function

    Notes
    -----
    Carried are the adjoint and its covariance after the update of the row. The control of a row is what the forward pass
    predicted there and ended with, its own control, which samples it took, and the joint vector and the inputs before it.
    Returned are the smoothed states and the packed triangle of their covariance.
    """
    eq, layout = equations, StepLayout(equations, settings)
    n, size = layout.joint, covariance_form.size(layout.joint)
    adjoint, spread_packed = ca.SX.sym("l", n), ca.SX.sym("L", size)
    spread = covariance_form.unpack(spread_packed, n)
    packed_ahead, packed_after = ca.SX.sym("Pp", size), ca.SX.sym("Pf", size)
    x_after = ca.SX.sym("xf", layout.n)
    ahead, before = ca.SX.sym("xp", n), ca.SX.sym("xb", n)
    z, taken, inflation = (ca.SX.sym(k, layout.sensors) for k in ("z", "m", "inflation"))
    deviation = ca.SX.sym("r", layout.sensors)
    switch = ca.SX.sym("a", int(settings.switchable))
    factors = settings.gain_factors(n, switch)

    after = covariance_form.unpack(packed_after, n)
    smoothed = x_after - (after @ adjoint)[: layout.n]
    shrunk = after - after @ spread @ after

    # The update of this row is repeated to get every gain; then the sensors are taken in reverse order.
    sensitivity = ca.substitute(eq.sensitivity, eq.joint, ahead)
    shown = ca.substitute(eq.shown, eq.joint, ahead)
    covariance, correction, passed = covariance_form.unpack(packed_ahead, n), ca.SX.zeros(n), []
    for i in range(layout.sensors):
        row = sensitivity[i, :]
        e = eq.innovation(i, z, shown, bool(settings.wraps[i])) - row @ correction
        reset = states_to_reset(eq.sensitivity, i, settings.resettable)
        for state in reset:
            covariance = covariance_form.inflated(covariance, state, inflation[i])
        variance = eq.sensor_variance(i, deviation)
        gain, covariance, s = covariance_form.updated(covariance, row, variance, taken[i], factors)
        correction = correction + gain * e
        passed.append((row, gain, s, e, taken[i], [inflation[i] if k in reset else 1.0 for k in range(n)]))
    back, back_spread = adjoint, spread
    for row, gain, s, e, count, inflations in reversed(passed):
        kept = ca.SX.eye(n) - gain @ row
        back = kept.T @ back - row.T * (e / s * count)
        back_spread = kept.T @ back_spread @ kept + (row.T @ row) * (count / s)
        # The error of a state that was reset grew with its standard deviation.
        stretch = ca.diag(ca.vertcat(*inflations))
        back, back_spread = stretch @ back, stretch @ back_spread @ stretch
    # Through the prediction, to the end of the row before. Carried noise starts anew with each row.
    transition = ca.SX.zeros(n, n)
    transition[: layout.n, :] = ca.substitute(eq.transition, eq.joint, before)
    if eq.sampled:
        still = ca.SX.zeros(n, n)
        for i in range(layout.n):
            still[i, i] = 1
        transition = ca.if_else(eq.T > 0, transition, still)
    earlier = transition.T @ back
    earlier_spread = transition.T @ back_spread @ transition

    control = [
        packed_ahead,
        packed_after,
        x_after,
        ahead,
        before,
        eq.u0,
        eq.u1,
        eq.T,
        z,
        taken,
        inflation,
        eq.scale,
        switch,
    ]
    results = [
        ca.vertcat(earlier, covariance_form.pack(earlier_spread)),
        ca.vertcat(smoothed, covariance_form.pack(shrunk[: layout.n, : layout.n])),
    ]
    return ca.Function(
        "backward",
        [
            ca.vertcat(adjoint, spread_packed),
            ca.vertcat(*(ca.vec(c) for c in control)),
            ca.vertcat(eq.p, eq.levels, deviation),
        ],
        ca.cse([ca.densify(r) for r in results]),
    )
