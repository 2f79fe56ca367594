"""A quantity of the model and its first-order variance as a generated function of one sample."""

from __future__ import annotations

import casadi as ca

from shipid.estimation.recursion.equations import Equations
from shipid.foundation.aliases import CasadiFunction


def make_quantity(equations: Equations, name: str) -> CasadiFunction:
    """Generate ``(joint, inputs, p, T, covariance) -> [value, variance]``.

    Parameters
    ----------
    equations : Equations
        The model.
    name : str
        A state, input, parameter, derived quantity or sensor.

    Returns
    -------
    casadi.Function

    Raises
    ------
    UnknownNameError
        If the model has no such quantity.
    """
    system = equations.system
    u = ca.SX.sym("u", system.u.shape[0])
    value = ca.densify(ca.substitute(system.expression([name]), system.u, u + equations.carried_noise))
    slope = ca.jacobian(value, equations.joint)
    size = equations.joint.shape[0]
    covariance = ca.SX.sym("P", size, size)
    variance = ca.densify(slope @ covariance @ slope.T)
    return ca.Function(
        "quantity", [equations.joint, u, system.p, system.T, ca.vec(covariance)], [ca.vertcat(value, variance)]
    )
