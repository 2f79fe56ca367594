"""Quantities of the model out of estimated states and their covariance, with standard deviations."""

from __future__ import annotations

import casadi as ca
import numpy as np

from shipid.declaration.model import Model, reads_of
from shipid.estimation.design import FilterDesign
from shipid.foundation.errors import UnknownNameError


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


def quantity_along(
    design: FilterDesign,
    name: str,
    joint: np.ndarray,
    covariance: np.ndarray,
    inputs: np.ndarray,
    intervals: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return a quantity of the model and its first-order standard deviation at each sample, SI, shapes (N,).

    Parameters
    ----------
    design : FilterDesign
        The filter.
    name : str
        A state, input, parameter, derived quantity or sensor.
    joint : ndarray, shape (N, joint)
        Estimates of states and carried noise.
    covariance : ndarray, shape (N, joint, joint)
        Their covariance.
    inputs : ndarray, shape (N, inputs)
        The inputs of the model.
    intervals : ndarray, shape (N,)
        Seconds since the sample before.

    Raises
    ------
    UnknownNameError
        If the model has no such quantity.
    """
    count = len(joint)
    rows = (
        design.quantity(name)
        .map(count)(
            joint.T,
            inputs.T,
            ca.repmat(ca.DM(design.p), 1, count),
            intervals[None, :],
            covariance.reshape(count, -1).T,
        )
        .full()
    )
    return rows[0], np.sqrt(np.maximum(rows[1], 0.0))


def named(design: FilterDesign, x: np.ndarray, std: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return estimates and standard deviations of a state or an estimated parameter, SI, the states along the last axis.

    Parameters
    ----------
    design : FilterDesign
        Whose states they are.
    x, std : ndarray, shape (..., states)
        Estimates and standard deviations; of a logarithm where a parameter is estimated by it.
    name : str
        A state or an estimated parameter.

    Raises
    ------
    UnknownNameError
        If it is neither.
    """
    state, states = design.parameters.get(name, name), design.model.states
    if state not in states:
        known = [*states, *design.parameters]
        raise UnknownNameError(f"state or estimated parameter of model {design.base.name} called", name, known)
    at, spread = x[..., states.index(state)], std[..., states.index(state)]
    return (at, spread) if state == name else (np.exp(at), np.exp(at) * spread)
