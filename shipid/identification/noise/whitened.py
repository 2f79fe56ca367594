"""Coefficients from residuals that are whitened by their own autoregression: generalized least squares.

An autopilot answers what its sensors show, noise included, so that the rudder carries the noise of samples before. Output error
takes every residual for itself; where the noise lasts, a part of it is then explained by the rudder that answered it, and the
coefficients are biased. What an autoregression leaves of the residuals is new in each sample, and no rudder has answered it yet
(the direct method: Ljung 1999, section 13.4; the iteration: Clarke 1967).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.identification.noise.autoregression import Autoregression, autoregression_of, whitened
from shipid.identification.noise.residual_groups import ResidualGroup, groups_of
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import RUNAWAY
from shipid.identification.search.solution import Solution
from shipid.identification.search.unseen import covariance_by

#: In words.
WHITENED = "the residuals are whitened by their autoregression (generalized least squares)"
#: Most steps; those after which the colour stays as it is; and the step, in standard deviations, at which no further one is taken.
_STEPS, _SETTLED, _SMALL = 30, 8, 0.01


def on_white_residuals(solution: Solution, box: Box) -> Solution | None:
    """Return the solution with residuals whitened by their autoregression.

    Parameters
    ----------
    solution : Solution
        Of output error, at its optimum.
    box : Box
        Bounds of the parameters.

    Returns
    -------
    Solution or None
        With the covariance of the unknowns; None where the residuals have no colour, or the search leads nowhere or out of the bounds.
    """
    problem, q = solution.problem, solution.q
    noises: list[Autoregression] = []
    for k in range(_STEPS):
        residual, jacobian = problem.residuals(q)
        if not (np.abs(residual) < RUNAWAY).all():
            return None
        groups, rest = _groups(solution, residual, jacobian)
        if k < _SETTLED:
            noises = [autoregression_of(g.residual) for g in groups]
        if any(not np.trace(noise.drive) > 0 for noise in noises):
            return None
        rows = [rest, *(_rows(g, noise, problem.size) for g, noise in zip(groups, noises))]
        slopes = np.vstack([j for _, j in rows])
        information = slopes.T @ slopes
        cover = covariance_by(information)
        known = np.isfinite(np.diag(cover))
        inverse = np.where(np.outer(known, known), cover, 0.0)
        step = -inverse @ (slopes.T @ np.concatenate([e for e, _ in rows]))
        q = q + step
        if (np.abs(step[known]) <= _SMALL * np.sqrt(np.diag(cover)[known])).all():
            break
    else:
        return None
    residual, jacobian = problem.residuals(q)
    if not any(noise.order for noise in noises) or not (np.abs(residual) < RUNAWAY).all():
        return None
    parameters = q[: len(problem.estimated)]
    if (parameters < box.low).any() or (parameters > box.high).any():
        return None
    return replace(solution, q=q, residual=residual, jacobian=jacobian, covariance=cover, others=(), whitened=True)


def _groups(
    solution: Solution, residual: np.ndarray, jacobian: np.ndarray
) -> tuple[list[ResidualGroup], tuple[np.ndarray, np.ndarray]]:
    """Residuals in series, and those of the prior, each of which counts once."""
    problem, signals, at = solution.problem, len(solution.problem.signals), 0
    groups: list[ResidualGroup] = []
    for i, data in enumerate(problem.trials):
        count = data.intervals.size
        rows = slice(at, at + count * signals)
        at += count * signals
        used = np.flatnonzero(np.abs(jacobian[rows]).max(axis=0) > 0)
        block = jacobian[rows][:, used].reshape(signals, count, -1)
        groups += groups_of(data, i, residual[rows].reshape(signals, count), block, used)
    once = 1.0 if problem.prior is None else 1.0 / np.sqrt(problem.prior.strength)
    return groups, (once * residual[at:], once * jacobian[at:])


def _rows(group: ResidualGroup, noise: Autoregression, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Whitened residuals of a series and their slopes by all unknowns."""
    white, _ = whitened(noise, np.concatenate([group.residual[:, :, None], group.jacobian], axis=2))
    slopes = np.zeros((len(white), size))
    slopes[:, group.used] = white[:, 1:]
    return white[:, 0], slopes
