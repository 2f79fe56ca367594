"""How sure the estimates are: covariance, effective samples, correlation, and what the data do not determine.

Residuals of a real trial are not white: a model that is a little wrong is wrong for many samples in a row. The information
in each signal is therefore counted in effective samples, the number of samples over the integrated autocorrelation time
of its residuals. For white residuals that is every sample, and the covariance is the Cramer-Rao bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.identification.solve import Solution

#: A parameter whose standard deviation exceeds this part of its size is not determined by the data.
UNDETERMINED = 0.5


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance of all unknowns.

    Attributes
    ----------
    matrix : ndarray, shape (unknowns, unknowns)
        In the units of the unknowns; infinite variance along directions the data do not see.
    condition_number : float
        Of the information matrix of the parameters, each scaled to unit information (1 is best).
    effective : ndarray, shape (trials, signals)
        Effective samples over samples.
    """

    matrix: np.ndarray
    condition_number: float
    effective: np.ndarray


def autocorrelation_time(residual: np.ndarray) -> float:
    """Return the integrated autocorrelation time of a residual in samples; 1 for white noise.

    The sum runs over pairs of lags while their correlation is positive (Geyer 1992, the initial positive sequence).

    Parameters
    ----------
    residual : ndarray, shape (N,)
        Residuals in the order of time.
    """
    centred = residual - residual.mean()
    n = centred.size
    power = float(centred @ centred)
    if n < 8 or power <= 0:
        return 1.0
    size = 1 << (2 * n - 1).bit_length()
    spectrum = np.fft.rfft(centred, size)
    correlation = np.fft.irfft(spectrum * spectrum.conj(), size)[: n // 2] / power
    # White residuals pass this gate once in 700 times; what passes is counted as correlated.
    if correlation[1] < 3 / np.sqrt(n):
        return 1.0
    pairs = correlation[: correlation.size // 2 * 2].reshape(-1, 2).sum(axis=1)
    negative = np.flatnonzero(pairs <= 0)
    last = negative[0] if negative.size else pairs.size
    return float(min(max(1.0, 2 * pairs[:last].sum() - 1), n / 4))


def covariance_of(solution: Solution) -> Covariance:
    """Return the covariance of the unknowns of a solution.

    Parameters
    ----------
    solution : Solution
        At its optimum.
    """
    problem = solution.problem
    split = problem.by_signal(solution.residual)
    times = np.array([[autocorrelation_time(s) for s in trial] for trial in split])
    jacobian = solution.jacobian.copy()
    at = 0
    for i, sailed in enumerate(problem.sailed):
        n = sailed.intervals.size
        for j in range(len(problem.signals)):
            jacobian[at : at + n] /= np.sqrt(times[i, j])
            at += n
    if problem.prior is not None:
        jacobian[at:] /= np.sqrt(problem.prior.strength)
    if not problem.size:
        return Covariance(np.zeros((0, 0)), 1.0, 1 / times)
    norms = np.linalg.norm(jacobian, axis=0)
    seen = norms > 0
    scaled = jacobian[:, seen] / norms[seen]
    _, singular, rows = np.linalg.svd(scaled, full_matrices=False)
    small = singular < 1e-8 * singular[0]
    inverse = np.where(small, 0.0, 1 / np.where(small, 1.0, singular))
    inner = (rows.T * inverse**2) @ rows
    matrix = np.zeros((problem.size, problem.size))
    index = np.flatnonzero(seen)
    matrix[np.ix_(index, index)] = inner / np.outer(norms[seen], norms[seen])
    # A direction the data do not see has no finite variance: neither has any unknown that takes part in it.
    lost = ~seen
    if small.any():
        lost[index] |= (np.abs(rows[small]) > 1e-3).any(axis=0)
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    return Covariance(matrix, _condition(matrix, len(problem.estimated)), 1 / times)


def _condition(matrix: np.ndarray, shared: int) -> float:
    """Condition number of the correlation matrix of the parameters: 1 when nothing trades off."""
    block = matrix[:shared, :shared]
    spread = np.sqrt(np.diag(block))
    if shared == 0:
        return 1.0
    if not np.isfinite(spread).all() or (spread <= 0).any():
        return float("inf")
    return float(np.linalg.cond(block / np.outer(spread, spread)))


def correlation_of(matrix: np.ndarray) -> np.ndarray:
    """Return the correlation matrix of a covariance; zero where a variance is not finite."""
    spread = np.sqrt(np.diag(matrix))
    good = np.isfinite(spread) & (spread > 0)
    out = np.eye(len(spread))
    index = np.ix_(good, good)
    out[index] = matrix[index] / np.outer(spread[good], spread[good])
    return out


def verdict(value: float, std: float, size: float, low: float, high: float, partners: str) -> str:
    """Return why the data do not determine a parameter, or an empty string.

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
    """
    trade = f" It trades off with {partners}." if partners else ""
    if not np.isfinite(std):
        return f"the trials hold no information about it alone.{trade}"
    span = high - low
    if np.isfinite(span) and min(value - low, high - value) < 1e-4 * span * min(1.0, abs(value) / span + 1e-3):
        return f"it ended at its bound.{trade}"
    if std > UNDETERMINED * max(abs(value), size):
        return f"its standard deviation is {std / max(abs(value), 1e-300):.0%} of its value.{trade}"
    return ""
