"""Published coefficients that follow from the estimated ones (K* and tau* from their quotients), to first order."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from shipid.declaration.model import Model, reads_of
from shipid.generation.system import generate


@functools.lru_cache(maxsize=64)
def followers(model: Model, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the published coefficients that the estimated parameters determine, in order.

    Parameters
    ----------
    model : Model
        The model.
    names : tuple of str
        The estimated parameters.
    """
    published = set().union(*(reads_of(model, model[p]) for p in names if model[p].equation is not None), set())
    return tuple(n for n in model.derived if n in published)


@functools.lru_cache(maxsize=64)
def _function(model: Model, names: tuple[str, ...]) -> Any:
    system = generate(model)
    wanted = system.expression(followers(model, names))
    places = [system.coefficients.index(n) for n in names]
    slope = ca.jacobian(wanted, system.p)[:, places]
    return ca.Function("following", [system.p], [ca.densify(wanted), ca.densify(slope)])


def following(
    model: Model, names: tuple[str, ...], known: Mapping[str, float], theta: np.ndarray, covariance: np.ndarray
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return the published coefficients along a record: values and standard deviations, SI, each of shape (N,).

    Parameters
    ----------
    model : Model
        The model.
    names : tuple of str
        The estimated parameters.
    known : mapping of str to float
        Other coefficients.
    theta : ndarray, shape (N, parameters)
        Estimates.
    covariance : ndarray, shape (N, parameters, parameters)
        Their covariance.
    """
    wanted = followers(model, names)
    if not wanted:
        return {}
    system = generate(model)
    count, n = theta.shape
    p = np.tile(system.vector(system.coefficients, {**dict.fromkeys(names, 0.0), **known}, default=0.0), (count, 1))
    p[:, [system.coefficients.index(name) for name in names]] = theta
    values, slopes = (m.full() for m in _function(model, names).map(count)(p.T))
    gradient = slopes.reshape(len(wanted), count, n).transpose(1, 0, 2)
    with np.errstate(invalid="ignore", over="ignore"):
        variance = np.einsum("kwi,kij,kwj->kw", gradient, covariance, gradient)
    return {name: (values[i], np.sqrt(np.maximum(variance[:, i], 0.0))) for i, name in enumerate(wanted)}
