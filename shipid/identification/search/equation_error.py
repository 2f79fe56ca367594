"""Equation error: coefficients from the equations themselves, sample by sample, without running the model.

It needs neither a start near the solution nor a model that stays bounded over a whole record. Least squares takes the
measured states for the true ones: their noise biases the coefficients, the more the noisier they are. Instrumental variables
(Young 1970; Soderstrom and Stoica 1983) are free of that bias where the noise enters linearly: the errors are made
uncorrelated with the regressors of a simulated ship, in which there is no noise. Where an equation is not linear in its
coefficients, it is solved step by step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from shipid.foundation.numbers import percent
from shipid.generation.record import make_record
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.identification.noise.autoregression import autoregression_of
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import RUNAWAY
from shipid.identification.search.regression import Regression
from shipid.identification.search.trust_region import search
from shipid.identification.search.unseen import covariance_by

_STEPS = 30
_TURNS = 6
#: Relative change of the coefficients at which the instruments have converged.
_SETTLED = 1e-3
#: Error of an equation that counts as none, in shares of its left side.
_BALANCED = 1e-4


@dataclass(frozen=True, eq=False)
class EquationErrorResult:
    """Coefficients by equation error.

    Attributes
    ----------
    regression : Regression
        The equations.
    theta : ndarray, shape (size,)
        The unknowns.
    sigma : ndarray, shape (equations,)
        Standard deviation of each equation's error.
    instruments : list of ndarray
        The regressors with which the errors are uncorrelated, by trial, shapes (equations, windows, size).
    converged : bool
        Whether it converged to finite numbers.
    message : str
        How it went.
    """

    regression: Regression
    theta: np.ndarray
    sigma: np.ndarray
    instruments: list[np.ndarray]
    converged: bool
    message: str

    def parameters(self, box: Box) -> np.ndarray:
        """Return all estimated coefficients: those found, within their bounds, and the first value of the others.

        Parameters
        ----------
        box : Box
            Bounds and first values.
        """
        found = dict(zip(self.regression.covered, self.theta))
        values = [found.get(n, s) for n, s in zip(self.regression.problem.estimated, box.start)]
        return np.asarray(np.clip(values, box.low, box.high))

    def covariance(self) -> np.ndarray:
        """Return the covariance of the coefficients found, the errors correlated as they are; their bias is not in it."""
        regression = self.regression
        rows = regression.rows(self.theta)
        matrix, scatter = np.zeros((regression.size, regression.size)), np.zeros((regression.size, regression.size))
        for (error, slope), instrument in zip(rows, self.instruments):
            z = instrument / self.sigma[:, None, None]
            matrix += np.einsum("ewq,ewp->qp", z, slope / self.sigma[:, None, None])
            shaped = autoregression_of(error / self.sigma[:, None]).shaped(z)
            scatter += shaped.T @ shaped
        count = len(regression.covered)
        return covariance_by(matrix, scatter)[:count, :count]


def least_squares(regression: Regression, box: Box, tolerance: float = 1e-8) -> EquationErrorResult:
    """Solve the equations by least squares, within the bounds.

    Parameters
    ----------
    regression : Regression
        The equations; some coefficient is covered.
    box : Box
        Bounds and first values of the estimated coefficients.
    tolerance : float
        Relative change of cost and unknowns at which the search ends: a start need not go along a valley to its end.

    Returns
    -------
    EquationErrorResult
    """
    count = len(regression.covered)
    at = [regression.problem.estimated.index(n) for n in regression.covered]
    reach = np.full(regression.size - count, np.deg2rad(10))
    low, high = np.concatenate([box.low[at], -reach]), np.concatenate([box.high[at], reach])
    theta = np.concatenate([box.start[at], 0 * reach])
    sigma = _size(regression)
    none = np.zeros(regression.size, dtype=bool)
    converged = False
    for _ in range(2):

        def evaluate(q: np.ndarray, scale: np.ndarray = sigma) -> tuple[np.ndarray, np.ndarray]:
            rows = regression.rows(q)
            errors = np.concatenate([(e / scale[:, None]).ravel() for e, _ in rows])
            slopes = np.concatenate([(z / scale[:, None, None]).reshape(-1, regression.size) for _, z in rows])
            good = (np.abs(errors) < RUNAWAY) & (np.abs(slopes) < RUNAWAY**2).all(axis=1)
            return np.where(good, errors, RUNAWAY), np.where(good[:, None], -slopes, 0.0)

        found = search(evaluate, theta, none, low, high, most=60, tolerance=tolerance)
        theta = found.q
        converged = found.converged and bool(np.abs(evaluate(theta)[0]).max() < RUNAWAY)
        sigma = _scatter(regression, theta)
    how = "" if regression.linear else "not "
    return EquationErrorResult(
        regression, theta, sigma, [z for _, z in regression.rows(theta)], converged,
        f"regression of {_named(regression)}, {how}linear in the coefficients.",
    )  # fmt: skip


def instrumental_variables(first: EquationErrorResult, box: Box) -> EquationErrorResult:
    """Solve the equations by instrumental variables, simulated with the coefficients found so far.

    Parameters
    ----------
    first : EquationErrorResult
        Of `least_squares`.
    box : Box
        Bounds and first values of the estimated coefficients.

    Returns
    -------
    EquationErrorResult
    """
    result, moved = first, np.inf
    for _ in range(_TURNS):
        simulated = _simulated(result, box)
        if simulated is None:
            return replace(result, converged=False, message="the model runs away where it is run for the instruments.")
        before = result.theta
        result = _uncorrelated(result, simulated)
        if not np.isfinite(result.theta).all():
            return replace(
                first, converged=False, message="the instruments hold no information about the coefficients."
            )
        moved = float(np.max(np.abs(result.theta - before) / (np.abs(result.theta) + np.abs(before) + 1e-12)))
        if moved < _SETTLED:
            break
    settled = "settled" if moved < _SETTLED else f"still moved the coefficients by {percent(moved, 1)}"
    message = f"regression of {_named(first.regression)}, instruments from a run of the model; they {settled}."
    return replace(result, converged=moved < 10 * _SETTLED, message=message)


def _uncorrelated(result: EquationErrorResult, simulated: list[np.ndarray]) -> EquationErrorResult:
    """Newton's steps to where the errors are uncorrelated with the regressors of the simulated ship."""
    regression, theta = result.regression, result.theta
    instruments = [z for _, z in regression.rows(theta, simulated)]
    for _ in range(_STEPS):
        matrix, right = np.zeros((regression.size, regression.size)), np.zeros(regression.size)
        for (error, slope), instrument in zip(regression.rows(theta), instruments):
            z = instrument / result.sigma[:, None, None] ** 2
            matrix += np.einsum("ewq,ewp->qp", z, slope)
            right += np.einsum("ewq,ew->q", z, error)
        # The bias of a stretch in which no window is without holes stands in no equation.
        found = np.diag(matrix) != 0
        size, inside = np.sqrt(np.abs(np.diag(matrix)[found])), matrix[np.ix_(found, found)]
        if not np.isfinite(matrix).all() or np.linalg.cond(inside / np.outer(size, size)) > 1e12:
            return replace(result, theta=np.full_like(theta, np.nan))
        step = np.zeros_like(theta)
        step[found] = np.linalg.solve(inside, right[found])
        theta = theta + step
        if np.all(np.abs(step) <= 1e-9 * np.abs(theta) + 1e-15):
            break
    return replace(result, theta=theta, sigma=_scatter(regression, theta), instruments=instruments)


def _simulated(result: EquationErrorResult, box: Box) -> list[np.ndarray] | None:
    """States of the simulated ship in each trial, shape (states, N), or None where it runs away."""
    regression, problem = result.regression, result.regression.problem
    record = make_record(problem.model, problem.model.states)
    p = coefficient_vector(problem.model, problem.values(result.parameters(box)))
    out = []
    for i, (block, data) in enumerate(zip(regression.blocks, problem.trials)):
        bias, x0 = regression.bias(result.theta, i), initial_state(problem.model, data.start)
        x, _ = record(x0, block.inputs, block.intervals, p, bias)
        if not x.shape[1]:
            out.append(x)  # a stretch that is shorter than a window
            continue
        size = np.maximum(np.abs(block.states).max(axis=1), 1e-6)
        needed = [problem.model.states.index(n) for n in problem.initial if data.shows(n)]
        if not (np.abs(x[needed]) < 100 * size[needed, None]).all():
            return None
        out.append(np.nan_to_num(x, posinf=0.0, neginf=0.0))
    return out


def _scatter(regression: Regression, theta: np.ndarray) -> np.ndarray:
    """Standard deviation of each equation's error, at least that of rounding, so that no weight is infinite."""
    errors = np.concatenate([e for e, _ in regression.rows(theta)], axis=1)
    found = np.sqrt(np.mean(np.nan_to_num(errors, nan=RUNAWAY) ** 2, axis=1))
    return np.asarray(np.maximum(found, _BALANCED * _size(regression)))


def _size(regression: Regression) -> np.ndarray:
    """Standard deviation of the left side of each equation."""
    return np.asarray(np.maximum(np.std(np.concatenate([b.left for b in regression.blocks], axis=1), axis=1), 1e-12))


def _named(regression: Regression) -> str:
    states = regression.problem.model.states
    return ", ".join(f"d{n}/dt" if n in states else n for n in regression.equations)
