"""Coefficients from residuals that are whitened by their own autoregression: generalized least squares.

An autopilot answers what its sensors show, noise included, so that the rudder carries the noise of samples before. Output error
takes every residual for itself; where the noise lasts, a part of it is then explained by the rudder that answered it, and the
coefficients are biased. What an autoregression leaves of the residuals is new in each sample, and no rudder has answered it yet
(the direct method: Ljung 1999, section 13.4; the iteration: Clarke 1967).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shipid.foundation.notices import Notice
from shipid.identification.noise.autoregression import Autoregression, autoregression_of, whitened
from shipid.identification.noise.filled_inputs import changes_by, effects_of
from shipid.identification.noise.residual_groups import ResidualGroup, groups_of
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import RUNAWAY, Problem
from shipid.identification.search.solution import Solution
from shipid.identification.search.unseen import covariance_by

#: In words.
WHITENED = "the residuals are whitened by their autoregression (generalized least squares)"
#: Kind of the notice where they cannot be, and should.
NOT_WHITENED = "not-whitened"
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
        groups = [g for i in range(len(problem.trials)) for g in _series(problem, i, residual, jacobian)]
        if k < _SETTLED:
            noises = [autoregression_of(g.residual) for g in groups]
        if any(not np.trace(noise.drive) > 0 for noise in noises):
            return None
        # In turns: with the numbers of the autoregression in the step the search stays near output error, where that is far off.
        white = np.vstack(
            [*(_white(g, noise) for g, noise in zip(groups, noises)), _of_prior(problem, residual, jacobian)]
        )
        cover, inverse = _covers(white)
        step = -inverse @ (white[:, 1:].T @ white[:, 0])
        q = q + step
        if (np.abs(step) <= _SMALL * np.sqrt(np.diag(inverse))).all():
            break
    else:
        return None
    residual, jacobian = problem.residuals(q)
    if not any(noise.order for noise in noises) or not (np.abs(residual) < RUNAWAY).all():
        return None
    parameters = q[: len(problem.estimated)]
    if (parameters < box.low).any() or (parameters > box.high).any():
        return None
    cover = _covariance(problem, q, residual, jacobian, noises)
    return replace(solution, q=q, residual=residual, jacobian=jacobian, covariance=cover, others=(), whitened=True)


def as_not_whitened(solution: Solution) -> Solution:
    """Return a solution whose residuals could not be whitened, with the notice that its coefficients may be biased.

    Parameters
    ----------
    solution : Solution
        Of output error; where its residuals have no colour nothing is said of it, since no rudder has answered them.
    """
    problem = solution.problem
    groups = [g for i in range(len(problem.trials)) for g in _series(problem, i, solution.residual, solution.jacobian)]
    if not any(autoregression_of(g.residual).order for g in groups):
        return solution
    notice = Notice(
        "the rudder may follow the heading, as that of an autopilot does, and the residuals last: output error, which takes each of them "
        "for itself, may be biased by more than its intervals say. Residuals that are whitened by their autoregression lead to no "
        "coefficients here. A zig-zag tells; so does a longer record.",
        NOT_WHITENED,
        serious=True,
    )
    return replace(solution, notices=(*solution.notices, notice))


def _covariance(
    problem: Problem, q: np.ndarray, residual: np.ndarray, jacobian: np.ndarray, noises: Sequence[Autoregression]
) -> np.ndarray:
    """Covariance of the unknowns, with what the autoregression and errors of the inputs leave unknown."""
    left, size = iter(noises), problem.size
    rows: list[np.ndarray] = [_of_prior(problem, residual, jacobian)]
    of_all, of_one = np.zeros((size, 0)), [np.zeros((size, 0))]
    for i, data in enumerate(problem.trials):
        unsure = None if data.unsure is None else changes_by(problem, q, i, data.unsure)
        drawn = effects_of(problem, q, i)
        changes = [np.zeros((0, len(problem.signals), data.intervals.size))]
        changes += [c for c in (unsure, None if drawn is None else drawn / np.sqrt(len(drawn))) if c is not None]
        together = np.concatenate(changes)
        series = _series(problem, i, residual, jacobian, together)
        white = np.vstack([np.zeros((0, 1 + size + len(together))), *(_beyond_past(g, next(left)) for g in series)])
        rows.append(white[:, : 1 + size])
        gradient = white[:, 1 : 1 + size].T @ white[:, 1 + size :]
        count = 0 if unsure is None else len(unsure)
        # An error of all trials moves the coefficients in each of them.
        if count:
            of_all = gradient[:, :count] + (of_all if of_all.shape[1] else 0.0)
        of_one.append(gradient[:, count:])
    cover, inverse = _covers(np.vstack(rows))
    moved = inverse @ np.concatenate([of_all, *of_one], axis=1)
    return np.asarray(cover + moved @ moved.T)


def _covers(white: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Covariance by whitened residuals and their derivatives, and the same with zeros where nothing is known."""
    cover = covariance_by(white[:, 1:].T @ white[:, 1:])
    known = np.isfinite(np.diag(cover))
    return cover, np.where(np.outer(known, known), cover, 0.0)


def _series(
    problem: Problem, i: int, residual: np.ndarray, jacobian: np.ndarray, changes: np.ndarray | None = None
) -> list[ResidualGroup]:
    """Residuals of a trial in series, with derivatives by all unknowns, and changes of shape (changes, signals, N) beside them."""
    rows, signals = problem.rows[i], len(problem.signals)
    block = jacobian[rows].reshape(signals, -1, problem.size)
    if changes is not None:
        block = np.concatenate([block, np.moveaxis(changes, 0, -1)], axis=2)
    return groups_of(problem.trials[i], i, residual[rows].reshape(signals, -1), block, np.arange(problem.size))


def _of_prior(problem: Problem, residual: np.ndarray, jacobian: np.ndarray) -> np.ndarray:
    """Residuals of the prior, each of which counts once, and beside them their derivatives."""
    once, last = 1.0 if problem.prior is None else 1.0 / np.sqrt(problem.prior.strength), problem.rows[-1]
    return np.asarray(once * np.column_stack([residual[last], jacobian[last]]))


def _white(group: ResidualGroup, noise: Autoregression) -> np.ndarray:
    """Whitened residuals of a series and, beside them, its derivatives, shape (rows, 1 + columns)."""
    return whitened(noise, np.concatenate([group.residual[:, :, None], group.jacobian], axis=2))[0]


def _beyond_past(group: ResidualGroup, noise: Autoregression) -> np.ndarray:
    """The same without what past residuals explain.

    Past residuals are the derivatives by the numbers of the autoregression, which are estimated with the coefficients. A rudder that
    answers past noise makes the two correlated, and the coefficients less certain than under known noise.
    """
    white = _white(group, noise)
    if not noise.order:
        return white
    signals, n = group.residual.shape
    by_signal = white.reshape(signals, -1, white.shape[1])
    count = by_signal.shape[1]
    past = np.concatenate([group.residual[:, n - count - k : n - k] for k in range(1, noise.order + 1)])
    basis, _ = np.linalg.qr(past.T)
    return np.asarray((by_signal - basis @ (basis.T @ by_signal)).reshape(white.shape))
