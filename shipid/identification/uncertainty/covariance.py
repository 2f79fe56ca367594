"""Covariance of the estimates, effective samples, correlation, and parameters that the data do not determine.

Residuals of a real trial are not white: the error of a slightly wrong model lasts for many samples, and waves disturb
heading and rate together. The covariance is therefore worked out from the spectrum of the residuals
(`shipid.identification.noise.autoregression`). The result is given in effective samples: as many
independent ones would hold as much information. For white residuals that is every sample, and the covariance is the Cramer-Rao bound.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np

from shipid.estimation.standing import AT_BOUND, UNKNOWN, Standing, standing_of
from shipid.identification.noise.autoregression import CORRECTIONS, Autoregression, autoregression_of, corrected
from shipid.identification.noise.filled_inputs import changes_by, effects_of
from shipid.identification.noise.residual_groups import ResidualGroup, groups_of
from shipid.identification.problem.losses import bends
from shipid.identification.search.solution import Solution
from shipid.identification.search.unseen import PART, UNSEEN


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance of all unknowns.

    Attributes
    ----------
    matrix : ndarray, shape (unknowns, unknowns)
        In the units of the unknowns; infinite variance along directions without information.
    condition_number : float
        Of the information matrix of the parameters, each scaled to unit information (1 is best).
    effective : ndarray, shape (trials, signals)
        Effective samples over samples: the variance of the unknowns if the signal's residuals were white and of the same
        power, over their variance as they are.
    excess : ndarray, shape (unknowns,)
        Variance of each unknown over the one it would have if all residuals were white.
    """

    matrix: np.ndarray
    condition_number: float
    effective: np.ndarray
    excess: np.ndarray


def autocorrelation_time(residual: np.ndarray) -> float:
    """Return the integrated autocorrelation time of a residual in samples; 1 for white noise.

    The sum runs over pairs of lags while their correlation is positive (Geyer 1992, the initial positive sequence).

    Parameters
    ----------
    residual : ndarray, shape (N,)
        Residuals in the order of time.
    """
    n = residual.size
    centred = residual - (residual.mean() if n else 0.0)
    power = float(centred @ centred)
    if n < 8 or power <= 0:
        return 1.0
    size = 1 << (2 * n - 1).bit_length()
    spectrum = np.fft.rfft(centred, size)
    correlation = np.fft.irfft(spectrum * spectrum.conj(), size)[: n // 2] / power
    # White residuals exceed this limit once in 700 times; residuals that exceed it count as correlated.
    if correlation[1] < 3 / np.sqrt(n):
        return 1.0
    pairs = correlation[: correlation.size // 2 * 2].reshape(-1, 2).sum(axis=1)
    negative = np.flatnonzero(pairs <= 0)
    last = negative[0] if negative.size else pairs.size
    return float(min(max(1.0, 2 * pairs[:last].sum() - 1), n / 4))


def covariance_of(solution: Solution, spread: np.ndarray | None = None) -> Covariance:
    """Return the covariance of the unknowns of a solution: ``H^-1 M H^-1``.

    H is the information matrix of the search, M the covariance of its gradient under the residuals as they are, each
    trial with an autoregression of its own (Huber 1967; White 1982). For white residuals M is H, and the covariance the
    Cramer-Rao bound.

    Parameters
    ----------
    solution : Solution
        At its optimum.
    spread : ndarray, shape (parameters,), optional
        Standard deviation the parameters have without any data, which makes their variances finite; infinite where they have none.

    Returns
    -------
    Covariance
    """
    if spread is not None:
        return _found(solution, spread)
    if solution not in _KNOWN:
        _KNOWN[solution] = _found(solution)
    return _KNOWN[solution]


#: Of solutions that are in use: what is asked of one twice is worked out once.
_KNOWN: WeakKeyDictionary[Solution, Covariance] = WeakKeyDictionary()


def _found(solution: Solution, spread: np.ndarray | None = None) -> Covariance:
    """The covariance, worked out."""
    problem = solution.problem
    trials, signals = len(problem.trials), len(problem.signals)
    if solution.covariance is not None:
        by_residuals = covariance_of(replace(solution, covariance=None))
        matrix = solution.covariance.copy()
        if spread is not None:
            lost = np.flatnonzero(np.isinf(np.diag(matrix)[: len(spread)]))
            matrix[lost, lost] = spread[lost] ** 2
        return replace(by_residuals, matrix=matrix, condition_number=_condition(matrix, len(problem.estimated)))
    if not problem.size:
        return Covariance(np.zeros((0, 0)), 1.0, np.ones((trials, signals)), np.zeros(0))
    if solution.others:
        return _over_spreads(solution, spread)
    solution = _bent(solution)
    jacobian = solution.jacobian
    if spread is not None:
        # In as many samples as the terms of a prior count.
        strength = 1.0 if problem.prior is None else problem.prior.strength
        jacobian = np.vstack([jacobian, np.sqrt(strength) * np.eye(len(spread), problem.size) / spread[:, None]])
    norms = np.linalg.norm(jacobian, axis=0)
    seen = norms > 0
    scaled = jacobian[:, seen] / norms[seen]
    _, singular, rows = np.linalg.svd(scaled, full_matrices=False)
    small = singular < UNSEEN * singular[0]
    inverse = np.where(small, 0.0, 1 / np.where(small, 1.0, singular))
    half = rows.T * inverse
    found, effective = _sandwich(solution, scaled, half)
    index = np.flatnonzero(seen)
    scales = np.outer(norms[seen], norms[seen])
    matrix = np.zeros((problem.size, problem.size))
    matrix[np.ix_(index, index)] = found / scales
    white = np.zeros(problem.size)
    white[index] = (half**2).sum(axis=1) / norms[seen] ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        excess = np.where(white > 0, np.diag(matrix) / white, 1.0)
    # A direction without information has no finite variance: neither has any unknown that takes part in it.
    lost = ~seen
    if small.any():
        lost[index] |= (np.abs(rows[small]) > PART).any(axis=0)
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    return Covariance(matrix, _condition(matrix, len(problem.estimated)), effective, excess)


def _over_spreads(solution: Solution, spread: np.ndarray | None) -> Covariance:
    """The covariance where the spread of the biases is estimated: its mean over the spreads, and the scatter about the estimate."""
    alone = covariance_of(replace(solution, others=()), spread)
    matrix = np.zeros_like(alone.matrix)
    for one in solution.others:
        residual, jacobian = one.problem.residuals(one.q)
        there = replace(solution, others=(), problem=one.problem, q=one.q, residual=residual, jacobian=jacobian)
        step = one.q - solution.q
        matrix += one.probability * (covariance_of(there, spread).matrix + np.outer(step, step))
    variance = np.diag(matrix).copy()
    lost = np.isinf(variance)
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    before = np.diag(alone.matrix)
    with np.errstate(invalid="ignore", divide="ignore"):
        excess = np.where(lost | ~(before > 0), alone.excess, alone.excess * variance / before)
    return replace(
        alone, matrix=matrix, condition_number=_condition(matrix, len(solution.problem.estimated)), excess=excess
    )


def _bent(solution: Solution) -> Solution:
    """The solution of a robust loss for its covariance: slopes without weights, residuals by their influence.

    Slopes are scaled by the curvature of the loss, residuals the other way: their product stays (Huber 1981).
    """
    problem = solution.problem
    if problem.weights is None:
        return solution
    rows = np.ones(solution.residual.size)
    bend = np.array(bends(problem))[:, None]
    weighted = np.concatenate([(bend / np.sqrt(w)).ravel() for w in problem.weights])
    rows[: weighted.size] = weighted
    return replace(solution, residual=solution.residual / rows, jacobian=solution.jacobian * rows[:, None])


def _sandwich(solution: Solution, scaled: np.ndarray, half: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Covariance in scaled unknowns, and the effective share of samples by trial and signal; half half' inverts J'J."""
    problem, signals, flat = solution.problem, len(solution.problem.signals), half @ half.T
    groups: list[ResidualGroup] = []
    # Rows whose squares sum to what the inputs, the prior and the bounds add, in the directions of the columns of half.
    added: list[np.ndarray] = []
    unsure: list[np.ndarray] = []
    *own, of_prior = problem.rows
    for i, (data, rows) in enumerate(zip(problem.trials, own)):
        used = np.flatnonzero(np.abs(scaled[rows]).max(axis=0) > 0)
        block = scaled[rows][:, used].reshape(signals, data.intervals.size, -1)
        if (effects := effects_of(problem, solution.q, i)) is not None:
            added.append(effects.reshape(len(effects), -1) @ scaled[rows] @ half / np.sqrt(len(effects)))
        if data.unsure is not None and (changes := changes_by(problem, solution.q, i, data.unsure)) is not None:
            unsure.append(changes.reshape(len(changes), -1) @ scaled[rows] @ half)
        groups += groups_of(data, i, solution.residual[rows].reshape(signals, -1), block, used)
    strength = 1.0 if problem.prior is None else problem.prior.strength
    if unsure:
        # An error of all trials moves the coefficients in each of them.
        added.append(np.sum(unsure, axis=0))
    added.append(np.sqrt(strength) * scaled[of_prior] @ half)

    noise = [autoregression_of(g.residual) for g in groups]
    # Where noise is white it stays so, and the order of the samples says nothing.
    slopes = [
        np.asarray(np.linalg.qr(g.jacobian, mode="r")) if model.white else g.jacobian for g, model in zip(groups, noise)
    ]

    def rows_under(noise: list[Autoregression]) -> list[np.ndarray]:
        return [
            _in_fewer(model.shaped(j), g.used.size < len(half) and not model.white) @ half[g.used]
            for g, j, model in zip(groups, slopes, noise)
        ]

    def covariance_by(rows: list[np.ndarray]) -> np.ndarray:
        # As the square of a root, which is never negative: half has columns of very different size where a direction is hardly seen.
        root = np.linalg.qr(np.vstack(rows), mode="r") @ half.T
        return np.asarray(root.T @ root)

    for _ in range(CORRECTIONS):
        # What the fit absorbed of the noise: what it may be off by for other reasons took nothing from the residuals.
        absorbed = covariance_by(rows_under(noise))
        noise = [
            corrected(model, g.residual, j, flat[np.ix_(g.used, g.used)], absorbed[np.ix_(g.used, g.used)])
            for model, j, g in zip(noise, slopes, groups)
        ]
    found = covariance_by([*added, *rows_under(noise)])
    shares = np.ones((len(problem.trials), signals))
    for g, model in zip(groups, noise):
        for k, signal in enumerate(g.signals):
            shares[g.trial, signal] = _share(g.jacobian, g.used, half, model, g.powers[k], k)
    return found, shares


def _in_fewer(rows: np.ndarray, several: bool) -> np.ndarray:
    """The rows of one of several trials, in as many as it has unknowns of its own, with the same products."""
    return np.asarray(np.linalg.qr(rows, mode="r")) if several else rows


def _share(
    block: np.ndarray, used: np.ndarray, half: np.ndarray, noise: Autoregression, power: float, signal: int
) -> float:
    """Variance by one signal, were its residuals white and of the same power, over the variance by it as it is."""
    if not noise.order:
        return 1.0
    alone = np.zeros_like(block)
    alone[signal] = block[signal]
    true = float(np.sum((noise.shaped(alone) @ half[used]) ** 2))
    white = float(power * np.sum((block[signal] @ half[used]) ** 2))
    return 1.0 if true <= 0 or white <= 0 else min(1.0, white / true)


def _condition(matrix: np.ndarray, shared: int) -> float:
    """Condition number of the correlation matrix of the parameters: 1 when no parameters trade off."""
    block = matrix[:shared, :shared]
    spread = np.sqrt(np.diag(block))
    if shared == 0:
        return 1.0
    if not np.isfinite(spread).all() or (spread <= 0).any():
        return float("inf")
    return float(np.linalg.cond(block / np.outer(spread, spread)))


def correlation_of(matrix: np.ndarray) -> np.ndarray:
    """Return the correlation matrix of a covariance; zero where a variance is not finite.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        The covariance.
    """
    spread = np.sqrt(np.diag(matrix))
    good = np.isfinite(spread) & (spread > 0)
    out = np.eye(len(spread))
    index = np.ix_(good, good)
    out[index] = matrix[index] / np.outer(spread[good], spread[good])
    return out


def verdict(
    value: float, std: float, size: float, low: float, high: float, partners: str, before: float = float("inf")
) -> tuple[Standing, str]:
    """Return what the data say of a parameter, and why where they do not determine it.

    Parameters
    ----------
    value, std : float
        Estimate and its standard deviation.
    size : float
        A typical size of the parameter.
    low, high : float
        Its bounds.
    partners : str
        Names of the parameters it trades off with, in words; may be empty.
    before : float
        The standard deviation of its prior; infinite without one.
    """
    standing, why = standing_of(value, std, low=low, size=size, before=before)
    span = high - low
    if np.isfinite([std, span]).all() and min(value - low, high - value) < 1e-4 * span * min(
        1.0, abs(value) / span + 1e-3
    ):
        standing, why = UNKNOWN, AT_BOUND
    return standing, f"{why} It trades off with {partners}." if why and partners else why
