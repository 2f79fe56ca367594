"""A search in scaled unknowns: positive ones by their logarithm, within bounds, each point evaluated once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

#: Part of the size of a column by which directions without information are held: far below the data's, far above rounding.
_HOLD = 1e-7
#: Part of its box by which an unknown begins inside its bounds.
_MARGIN = 1e-6
#: Why the search ended, by the status of `scipy.optimize.least_squares`, in words for the reader of a report.
_ENDED = {
    0: "the search was stopped after its largest number of runs.",
    1: "the residuals no longer depend on the coefficients at first order.",
    2: "a further step would not make the residuals smaller.",
    3: "a further step would not change the coefficients.",
    4: "a further step would change neither the residuals nor the coefficients.",
}
#: From unknowns to residuals and their Jacobian.
Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class SearchResult:
    """Where a search ended.

    Attributes
    ----------
    q : ndarray, shape (unknowns,)
        The unknowns.
    converged : bool
        Whether it met its tolerances.
    message : str
        Why it ended, in words.
    evaluations : int
        Points that were tried.
    """

    q: np.ndarray
    converged: bool
    message: str
    evaluations: int


def search(
    evaluate: Evaluate,
    q0: np.ndarray,
    logs: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    most: int,
    tolerance: float,
) -> SearchResult:
    """Minimise a sum of squares by Gauss-Newton steps in a trust region (`scipy.optimize.least_squares`, TRF).

    Parameters
    ----------
    evaluate : callable
        From unknowns to residuals and Jacobian; of many rows it may return fewer with the same products.
    q0 : ndarray, shape (unknowns,)
        Start.
    logs : ndarray of bool, shape (unknowns,)
        Which are searched by their logarithm.
    low, high : ndarray, shape (unknowns,)
        Bounds.
    most : int
        Largest number of points.
    tolerance : float
        Relative change of cost and unknowns at which the search ends.

    Returns
    -------
    SearchResult
    """

    def to_z(q: np.ndarray) -> np.ndarray:
        return np.where(logs, np.log(np.where(logs, np.maximum(q, 1e-300), 1)), q)

    def to_q(z: np.ndarray) -> np.ndarray:
        return np.where(logs, np.exp(np.where(logs, z, 0)), z)

    last: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def at(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = z.tobytes()
        if key not in last:
            last.clear()
            q = to_q(z)
            residual, jacobian = evaluate(q)
            last[key] = _held(residual, jacobian * np.where(logs, q, 1.0))
        return last[key]

    z_low, z_high = to_z(low), to_z(high)
    # A share of the box: what is a little off the bound of one unknown is the whole size of another.
    margin = np.where(np.isfinite(z_high - z_low), _MARGIN * (z_high - z_low), 0.0)
    found = least_squares(
        lambda z: at(z)[0],
        np.clip(to_z(q0), z_low + margin, z_high - margin),
        jac=lambda z: at(z)[1],
        bounds=(z_low, z_high),
        x_scale="jac",
        method="trf",
        ftol=tolerance,
        xtol=tolerance,
        gtol=1e-12,
        max_nfev=most,
    )
    return SearchResult(to_q(found.x), found.status > 0, _ENDED[found.status], found.nfev)


def _held(residual: np.ndarray, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows without cost that hold the directions on which no residual depends.

    Without them a step along such a direction is as long as the trust region or the bounds let it be, and the whole step is cut
    where it meets them.
    """
    norms = np.linalg.norm(jacobian, axis=0)
    holding = np.diag(np.where(norms > 0, _HOLD * norms, 1.0))
    return np.concatenate([residual, np.zeros(len(norms))]), np.concatenate([jacobian, holding])


def triangle(residual: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """Return R of [J r] = Q R: rows with the same cost, gradient and Gauss-Newton matrix, at most unknowns + 1 of them.

    It holds all that the search needs of thousands of samples, and its singular value decomposition at every step costs next
    to nothing.

    Parameters
    ----------
    residual : ndarray, shape (..., rows)
        Residuals.
    jacobian : ndarray, shape (..., rows, unknowns)
        Their Jacobian.
    """
    return np.asarray(np.linalg.qr(np.concatenate([jacobian, residual[..., None]], axis=-1), mode="r"))
