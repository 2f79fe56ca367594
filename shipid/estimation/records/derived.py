"""Quantities that follow from the estimated states, along a filtered record, with first-order standard deviations."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from shipid.declaration.model import Model, reads_of

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter
    from shipid.estimation.records.run import FilterRun


def published(model: Model, estimated: tuple[str, ...]) -> tuple[str, ...]:
    """Return the published coefficients that take the place of estimated parameters, as K* and tau* do of K*/tau* and 1/tau*.

    Parameters
    ----------
    model : Model
        The model in which they are parameters.
    estimated : tuple of str
        The estimated ones.
    """
    read = {n for p in estimated if model[p].equation is not None for n in reads_of(model, model[p])}
    return tuple(n for n in model.derived if n in read)


@functools.lru_cache(maxsize=256)
def _function(kalman: ExtendedKalmanFilter, name: str) -> Any:
    """The CasADi function ``(joint, inputs, p, T, P) -> (value, variance)`` of one sample."""
    equations = kalman.equations
    system = equations.system
    at_end = ca.SX.zeros(system.u.shape[0])
    for k, i in enumerate(equations.carried):
        at_end[system.inputs.index(equations.sources[i].name)] += equations.joint[system.x.shape[0] + k]
    u = ca.SX.sym("u", system.u.shape[0])
    value = ca.densify(ca.substitute(system.expression([name]), system.u, u + at_end))
    slope = ca.jacobian(value, equations.joint)
    size = equations.joint.shape[0]
    covariance = ca.SX.sym("P", size, size)
    variance = ca.densify(slope @ covariance @ slope.T)
    return ca.Function(
        "quantity", [equations.joint, u, system.p, system.T, ca.vec(covariance)], [ca.vertcat(value, variance)]
    )


def along(run: FilterRun, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return a quantity of the model and its standard deviation at each sample, SI, shapes (N,).

    Parameters
    ----------
    run : FilterRun
        The filtered record.
    name : str
        A state, input, parameter, derived quantity or sensor.

    Raises
    ------
    UnknownNameError
        If the model has no such quantity.
    """
    kalman, arranged = run.filter, run.arranged
    function = _function(kalman, name)
    joint = np.concatenate([run.x, run._rows("w")], axis=1)
    count = len(joint)
    p = kalman.constants[kalman.layout.constants["p"]]
    rows = function.map(count)(
        joint.T,
        arranged.inputs[arranged.shown].T,
        ca.repmat(ca.DM(p), 1, count),
        arranged.intervals[arranged.shown][None, :],
        run.joint_covariance.reshape(count, -1).T,
    ).full()
    return rows[0], np.sqrt(np.maximum(rows[1], 0.0))
