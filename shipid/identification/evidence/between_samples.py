"""What a rudder does between the samples of a coarse log: found from the residuals, as far as they show it, and followed.

A rudder that goes over in two seconds, logged once a second, sets out and stops between two samples. There the straight line between the
samples cuts the corner, always to the same side of a bend: in every execute the rudder of the log is smoothed alike. A gain
is off by that, far beyond its interval where the sensors are good. How far the line is off follows from the bends of the input, as where
samples are missing (`shipid.identification.noise.filled_inputs`); a little of it depends on when the sample came.

Where the bends of a corner stand by themselves, a log shows at which part of its interval it is. Of the others only the mean is known, and
all of a kind may come at the same part of an interval: orders that are given on the clock of the samples do. So unknowns say how much
there is of each kind of corner: all of it, beforehand, within a share, since rudders have a rate and a lag; or
nothing at all, where a log of straight lines is what the rudder really did. With them each interval has an error of its own, a random
effect. The unknowns and the spread of those effects come from the likelihood of the residuals, in which the others are free. The
inputs are corrected, the search goes on from there, and what is left unknown is put into the covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.identification.noise.autoregression import Autoregression, autoregression_of, whitened
from shipid.identification.noise.filled_inputs import changes_by, gap_errors
from shipid.identification.noise.residual_groups import ResidualGroup, groups_of
from shipid.identification.problem.box import Box
from shipid.identification.problem.trial_data import TrialData
from shipid.identification.search.least_squares import minimise_robustly
from shipid.identification.search.solution import Solution
from shipid.identification.uncertainty.covariance import covariance_of
from shipid.parameters.draws import normal_draws

#: Of corners that a log does not show one by one, the triangle in the middle of each interval that has the same area, in shares of the error
#: by the bends at its ends: what all corners have in common, the scatter about it, and that of an input that moves within one interval. So
#: it is, within a fifth, for rudders of constant rate and for machines with a time constant, sampled at L/U/4 and more often.
_COMMON, _SCATTER, _WITHIN = 0.8, 0.35, 0.8
#: Kinds of corners, each with a share of its own: those that a log shows one by one, those at which the rudder sets out, and those at which
#: it stops. Where orders and samples have one clock, all of a kind come at the same part of an interval.
KINDS = 3
#: How much of each kind there is beforehand: all, within so much. A corner anywhere in its interval cuts off 6 a (1 - a) of the mean area,
#: whose standard deviation is 0.45. Spreads of the scatter that are tried, in shares of its size.
_SURE, _SPREADS = np.array([0.2, 0.45, 0.45]), np.concatenate([[0.0], np.geomspace(0.1, 2.0, 20)])
#: Scatter of a corner that is shown, in shares of its size.
_SHOWN = 0.2
#: Probability beforehand that there are no corners between the samples: a rudder of straight lines, as a simulation may have it.
_STRAIGHT = 0.2
#: Intervals whose errors are looked at one by one; of more random sums stand for all, and those below this share of the largest are nothing.
_MOST, _SMALL = 96, 0.05
#: Power of the common error, in variances of the residuals, and standard deviations by which it moves a coefficient, below which it is nothing.
_NOTHING, _MOVES = 0.05, 0.2
#: How often the noise is found anew without the errors.
_TURNS = 3
#: Weighted residuals below this are rounding: the rudder of a record without noise is what the model was sailed with.
_EXACT = 1e-6
#: Singular values below this share of the largest are nothing.
_TINY = 1e-8


@dataclass(frozen=True, eq=False)
class _Found:
    """How much of the errors of each kind there is, a root of its covariance (rows), and the mean square of the spread of the others."""

    likelihood: float
    share: np.ndarray
    share_root: np.ndarray
    power: float
    scatter: np.ndarray


def follow_corners(solution: Solution, box: Box) -> Solution:
    """Return the solution with the inputs as they are most likely between their samples.

    Parameters
    ----------
    solution : Solution
        At its optimum on every sample, of least squares.
    box : Box
        Bounds of the parameters.

    Returns
    -------
    Solution
        The same where corners move no coefficient, inputs have missing samples, or a signal has no noise.
    """
    problem = solution.problem
    if not (solution.finite and problem.size) or any(data.sampled is not None for data in problem.trials):
        return solution
    split = problem.by_signal(solution.residual)
    if any(np.isfinite(r).any() and not np.nanmax(np.abs(r)) > _EXACT for trial in split for r in trial):
        return solution
    levels = [np.array([_size(r) for r in trial]) for trial in split]
    errors = [input_errors(data) for data in problem.trials]
    along = [changes_by(problem, solution.q, i, e[:KINDS]) for i, e in enumerate(errors)]
    common = [c for c in along if c is not None]
    if len(common) < len(along):
        return solution
    shown = sum(np.sum((c / level[:, None]) ** 2, axis=(1, 2)) for c, level in zip(common, levels))
    whole = np.concatenate([c.reshape(KINDS, -1) for c in common], axis=1)
    # What they are likely to be, and by how much each kind may be off that.
    likely = np.vstack([whole.sum(axis=0), _SURE[:, None] * whole])
    if not (shown > _NOTHING).any() or not _moves(solution, likely):
        return solution
    # Errors of single intervals belong to one trial, the common one to all.
    ends = KINDS + np.cumsum([len(e) - KINDS for e in errors])
    every = []
    for e, end in zip(errors, ends):
        padded = np.zeros((ends[-1], *e.shape[1:]))
        padded[:KINDS], padded[end - len(e) + KINDS : end] = e[:KINDS], e[KINDS:]
        every.append(padded)
    answers = [changes_by(problem, solution.q, i, e) for i, e in enumerate(every)]
    if any(a is None for a in answers):
        return solution
    found = _weigh(solution, [a for a in answers if a is not None])
    left = np.full(ends[-1] - KINDS, np.sqrt(found.power))
    trials = tuple(
        replace(
            data,
            inputs=data.inputs + np.tensordot(found.share, e[:KINDS], axes=1),
            unsure=np.concatenate([np.tensordot(found.share_root, e[:KINDS], axes=1), left[:, None, None] * e[KINDS:]]),
        )
        for data, e in zip(problem.trials, every)
    )
    followed = minimise_robustly(replace(problem, trials=trials), solution.q, box, most=100)
    followed = replace(followed, evaluations=solution.evaluations + followed.evaluations)
    if not followed.finite:
        return solution
    step = followed.q - solution.q
    others = tuple(replace(o, problem=replace(o.problem, trials=trials), q=o.q + step) for o in solution.others)
    return replace(followed, others=others, notices=solution.notices)


def input_errors(data: TrialData) -> np.ndarray:
    """Return changes of the samples of the inputs that have the area of an error between them, shape (kinds + errors, inputs, N).

    Parameters
    ----------
    data : TrialData
        A trial whose inputs are sampled in every row.

    Returns
    -------
    ndarray
        The first are the corrections of each kind of corner, the others one standard deviation of each interval's own error.
    """
    t = data.t
    steps = np.diff(t)
    common, alone = np.zeros((KINDS, *data.inputs.shape)), []
    for k, values in enumerate(data.inputs):
        if t.size < 3 or not np.ptp(values) > 0:
            continue
        heights, size = _corners(t, values)
        # In longer intervals samples are missing, and errors are drawn for that.
        whole = steps <= 1.5 * np.median(steps)
        common[:, k] = _at_samples(steps, np.where(whole, heights, 0.0))
        size = np.where(whole, size, 0.0)
        at = np.flatnonzero(size > _SMALL * size.max())
        drawn = np.eye(at.size) if at.size <= _MOST else normal_draws(at.size, _MOST, k) / np.sqrt(_MOST)
        gaps = np.zeros((len(drawn), steps.size))
        gaps[:, at] = drawn * size[at]
        rows = np.zeros((len(drawn), *data.inputs.shape))
        rows[:, k] = _at_samples(steps, gaps)
        alone.append(rows)
    return np.concatenate([common, *alone])


def _corners(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Errors in the middle of each interval: of each kind, shape (kinds, intervals), and the standard deviation of its own error.

    A corner at the part a of an interval bends the samples before and after it by 1 - a and a of the change of slope, which tell
    where it is. So it is shown one by one where the bends about it are its own.
    """
    _, (early, late), _ = gap_errors(t, values, np.ones(t.size, dtype=bool))
    steps = np.diff(t)
    slopes = np.diff(values) / steps
    bends = np.pad(np.diff(slopes), 1)
    before, first, second, after = np.lib.stride_tricks.sliding_window_view(np.pad(bends, 1), 4).T
    sign, whole = np.sign(first + second), np.abs(first) + np.abs(second)
    whole = np.where(whole > 0, whole, 1.0)
    # Bends to the other side belong to other corners.
    others = np.maximum(-sign * before, 0.0) + np.maximum(-sign * after, 0.0)
    others += np.where(first * second < 0, np.minimum(np.abs(first), np.abs(second)), 0.0)
    shown = np.clip(1 - others / whole, 0.0, 1.0)
    # A bend is shared with the interval on its other side as the bends there stand to those here.
    x, y, left, right = (np.maximum(sign * b, 0.0) for b in (first, second, before, after))
    x, y = x * y / np.where(y + left > 0, y + left, 1.0), y * x / np.where(x + right > 0, x + right, 1.0)
    alone = (x + y) / whole
    share = x * y / np.where(x + y > 0, x + y, 1.0)
    # Exact for one corner, and for one constant bend over many intervals, of which each has two thirds of that.
    height = -sign * share * (1 / 3 + 2 / 3 * alone) * steps
    sets_out = np.abs(np.pad(slopes, (0, 1), mode="edge")) > np.abs(np.pad(slopes, (1, 0), mode="edge"))
    kinds = [(1 - shown) * _COMMON * 0.5 * (early * kind[:-1] + late * kind[1:]) for kind in (sets_out, ~sets_out)]
    square = (1 - shown) ** 2 * (_SCATTER**2 * 0.5 * (early**2 + late**2) + _WITHIN**2 * np.maximum(-early * late, 0.0))
    return np.array([shown * height, *kinds]), np.sqrt(square + (_SHOWN * shown * height) ** 2)


def _at_samples(steps: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Changes of the samples whose straight lines have the areas of triangles so high in the middle of the intervals."""
    half = 0.25 * middle * steps
    width = 0.5 * (np.pad(steps, (1, 0)) + np.pad(steps, (0, 1)))
    return np.asarray((np.pad(half, ((0, 0), (1, 0))) + np.pad(half, ((0, 0), (0, 1)))) / width)


def _moves(solution: Solution, changes: np.ndarray) -> bool:
    """Whether one of some changes of the residuals moves a coefficient by more than a small share of its standard deviation."""
    shared = len(solution.problem.estimated)
    norms = np.linalg.norm(solution.jacobian, axis=0)
    norms = np.where(norms > 0, norms, 1.0)
    whole = np.pad(changes, ((0, 0), (0, solution.residual.size - changes.shape[1])))
    step = np.linalg.lstsq(solution.jacobian / norms, whole.T, rcond=_TINY)[0] / norms[:, None]
    alone = replace(solution, others=()) if solution.others else solution
    spread = np.sqrt(np.diag(covariance_of(alone).matrix)[:shared])
    return bool((np.abs(step[:shared]) > _MOVES * spread[:, None]).any())


def _size(residual: np.ndarray) -> float:
    """Root mean square of the samples that are there; one where none is."""
    there = residual[np.isfinite(residual)]
    return float(np.sqrt(np.mean(there**2))) or 1.0 if there.size else 1.0


def _weigh(solution: Solution, answers: Sequence[np.ndarray]) -> _Found:
    """How much of the errors the residuals hold, from their changes by each, shape (errors, signals, N) for each trial."""
    problem, signals = solution.problem, len(solution.problem.signals)
    norms = np.linalg.norm(solution.jacobian, axis=0)
    scaled = solution.jacobian / np.where(norms > 0, norms, 1.0)
    groups: list[ResidualGroup] = []
    every = np.arange(problem.size)
    along = np.zeros((problem.size, len(answers[0])))
    for i, (data, answer, rows) in enumerate(zip(problem.trials, answers, problem.rows)):
        count = data.intervals.size
        changes = np.moveaxis(answer, 0, -1)
        along += scaled[rows].T @ changes.reshape(count * signals, -1)
        both = np.concatenate([scaled[rows].reshape(signals, count, -1), changes], axis=2)
        groups += groups_of(data, i, solution.residual[rows].reshape(signals, count), both, every)
    # What an error leaves in the residuals when the unknowns have followed it.
    moved = np.linalg.pinv(scaled.T @ scaled, rcond=_TINY**2, hermitian=True) @ along
    left = [g.jacobian[:, :, problem.size :] - g.jacobian[:, :, : problem.size] @ moved for g in groups]
    best: _Found | None = None
    for _ in range(_TURNS):
        size = np.zeros(along.shape[1]) if best is None else np.concatenate([best.share, best.scatter])
        noise = [autoregression_of(g.residual + e @ size) for g, e in zip(groups, left)]
        found = _weighed(groups, noise, problem.size)
        if best is not None and found.likelihood <= best.likelihood:
            break
        best = found
    assert best is not None, "there is one turn at least"
    return best


def _weighed(groups: Sequence[ResidualGroup], noise: Sequence[Autoregression], unknowns: int) -> _Found:
    """The posterior of the errors under one noise: the residuals are noise less the errors, and the unknowns are free."""
    whole, volume = [], 0.0
    for g, model in zip(groups, noise):
        white, log_volume = whitened(model, np.concatenate([g.residual[:, :, None], g.jacobian], axis=2))
        whole.append(white)
        volume += log_volume
    together = np.concatenate(whole)
    left, sizes, _ = np.linalg.svd(together[:, 1 : 1 + unknowns], full_matrices=False)
    basis = left[:, sizes > _TINY * sizes.max(initial=0.0)]
    kept = np.delete(together, np.s_[1 : 1 + unknowns], axis=1)
    kept = kept - basis @ (basis.T @ kept)
    residual, common, alone = -kept[:, 0], kept[:, 1 : 1 + KINDS], kept[:, 1 + KINDS :]
    information, vectors = np.linalg.eigh(alone.T @ alone)
    information = np.clip(information, 0.0, None)
    of_residual, of_common = vectors.T @ (alone.T @ residual), vectors.T @ (alone.T @ common)
    square = _SPREADS[:, None] ** 2
    # Products under the noise and the errors of single intervals.
    shrunk = square / (1 + square * information)
    beforehand = np.diag(_SURE**-2)
    precision = common.T @ common - np.einsum("sk,ki,kj->sij", shrunk, of_common, of_common) + beforehand
    force = common.T @ residual - (shrunk * of_residual) @ of_common + beforehand.sum(axis=0)
    variance = np.linalg.inv(precision)
    mean = np.einsum("sij,sj->si", variance, force)
    gains = 0.5 * (shrunk @ of_residual**2 - np.log1p(square * information).sum(axis=1))
    gains += 0.5 * (
        (mean * force).sum(axis=1) - beforehand.sum() - np.linalg.slogdet(precision @ np.linalg.inv(beforehand))[1]
    )
    of_spread = np.exp(-0.5 * _SPREADS**2) * np.gradient(_SPREADS)
    chances = np.append((1 - _STRAIGHT) * of_spread / of_spread.sum(), _STRAIGHT)
    # The last is the rudder of straight lines.
    gains, mean = np.append(gains, 0.0), np.vstack([mean, np.zeros(KINDS)])
    variance = np.concatenate([variance, np.zeros((1, KINDS, KINDS))])
    density = chances * np.exp(gains - gains.max())
    chance = density / density.sum()
    middle = chance @ mean
    scatter = chance[:-1] @ (shrunk * (of_residual - mean[:-1] @ of_common.T))
    apart = mean - middle
    cover = np.einsum("s,sij->ij", chance, variance + apart[:, :, None] * apart[:, None, :])
    values, turned = np.linalg.eigh(cover)
    return _Found(
        -0.5 * (volume + float(residual @ residual)) + float(gains.max() + np.log(density.sum())),
        middle,
        np.sqrt(np.clip(values, 0.0, None))[:, None] * turned.T,
        float(chance[:-1] @ _SPREADS**2),
        vectors @ scatter,
    )
