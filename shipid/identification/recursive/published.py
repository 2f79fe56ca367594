"""Published coefficients that follow from the estimated ones (K* and tau* from their quotients), to first order."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction
from shipid.generation.system import generate


def make_published(model: Model, names: Sequence[str], wanted: Sequence[str]) -> CasadiFunction:
    """Generate the published coefficients and their Jacobian by the estimated parameters.

    Parameters
    ----------
    model : Model
        The model.
    names : sequence of str
        The estimated parameters.
    wanted : sequence of str
        The published coefficients.

    Returns
    -------
    casadi.Function
        ``coefficients -> (values, Jacobian)``.
    """
    system = generate(model)
    values = system.expression(wanted)
    places = [system.coefficients.index(n) for n in names]
    return ca.Function(
        "published", [system.p], [ca.densify(values), ca.densify(ca.jacobian(values, system.p)[:, places])]
    )


def along(function: CasadiFunction, p: np.ndarray, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return published coefficients along a record: values and standard deviations, SI, shapes (coefficients, N).

    Parameters
    ----------
    function : casadi.Function
        See `make_published`.
    p : ndarray, shape (N, model coefficients)
        All coefficients after each sample.
    covariance : ndarray, shape (N, parameters, parameters)
        Covariance of the estimated ones.
    """
    count, n = covariance.shape[:2]
    values, slopes = (m.full() for m in function.map(count)(p.T))
    gradient = slopes.reshape(values.shape[0], count, n).transpose(1, 0, 2)
    with np.errstate(invalid="ignore", over="ignore"):
        variance = np.einsum("kwi,kij,kwj->wk", gradient, covariance, gradient)
    return values, np.sqrt(np.maximum(variance, 0.0))
