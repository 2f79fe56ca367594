"""The observability Gramian as a generated function, summed one sample at a time."""

from __future__ import annotations

import casadi as ca

from shipid.estimation.recursion.equations import Equations
from shipid.foundation.aliases import CasadiFunction


def make_gramian_step(equations: Equations) -> CasadiFunction:
    """Generate the sum ``W = sum Phi' H' R^-1 H Phi``, with the transition Phi from the first state.

    Parameters
    ----------
    equations : Equations
        The model.

    Returns
    -------
    casadi.Function
        ``(Phi and W, row, coefficients and sensor levels) -> (Phi and W, 0)``. A row is the joint vector before it, the
        predicted one, the inputs at both ends, the interval, and which samples were taken.
    """
    eq = equations
    n, sensors = eq.system.x.shape[0], len(eq.measured)
    # Carried noise is no state: its first value is left out.
    phi, gramian = ca.SX.sym("F", n, n), ca.SX.sym("W", n, n)
    before, ahead = ca.SX.sym("xb", eq.joint.shape[0]), ca.SX.sym("xp", eq.joint.shape[0])
    taken, deviation = ca.SX.sym("m", sensors), ca.SX.sym("r", sensors)
    transition = ca.substitute(eq.transition[:, :n], eq.joint, before)
    if eq.sampled:
        transition = ca.if_else(eq.T > 0, ca.densify(transition), ca.SX.eye(n))
    moved = transition @ phi
    rows = ca.substitute(eq.sensitivity[:, :n], eq.joint, ahead) @ moved
    summed = gramian + rows.T @ ca.diag(taken / deviation**2) @ rows
    return ca.Function(
        "gramian",
        [
            ca.vertcat(ca.vec(phi), ca.vec(gramian)),
            ca.vertcat(before, ahead, eq.u0, eq.u1, eq.T, taken),
            ca.vertcat(eq.p, deviation),
        ],
        [ca.densify(ca.vertcat(ca.vec(moved), ca.vec(summed))), ca.SX(1, 1)],
    )
