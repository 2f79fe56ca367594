"""The variance of a sum of correlated values: what an estimate is worth whose innovations are not white."""

from __future__ import annotations

import numpy as np

#: Largest order of the autoregression, and smallest number of values for each of its coefficients.
_ORDER, _VALUES = 30, 10
#: Longer series are summed in blocks, to so many: an autoregression then spans the slow part, which is the one that counts.
_BLOCKS = 400


def long_run_variance(values: np.ndarray) -> float:
    """Return the variance of the sum of a series, divided by its length.

    It is the spectrum at frequency zero of an autoregression (Yule-Walker by the recursion of Levinson and Durbin), of the order
    with the smallest criterion of Akaike (1974). For white values it is their variance.

    Parameters
    ----------
    values : ndarray, shape (N,)
        In the order of time; their mean counts as zero.
    """
    size = -(-values.size // _BLOCKS)
    if size > 1:
        whole = values[: values.size // size * size]
        return long_run_variance(whole.reshape(-1, size).sum(axis=1)) / size
    count = values.size
    power = float(values @ values) / count if count else 0.0
    if not 0 < power < np.inf:
        return power
    most = min(_ORDER, count // _VALUES)
    lags = np.array([values[k:] @ values[: count - k] for k in range(most + 1)]) / count
    steps, drive = np.zeros(0), power
    best = (count * np.log(drive), power)
    for order in range(1, most + 1):
        reflection = (lags[order] - steps @ lags[order - 1 : 0 : -1]) / drive if order > 1 else lags[1] / drive
        steps = np.append(steps - reflection * steps[::-1], reflection)
        drive *= 1 - reflection**2
        if not drive > 1e-12 * power:
            break
        criterion = count * np.log(drive) + 2 * order
        if criterion < best[0]:
            best = (criterion, drive / (1 - steps.sum()) ** 2)
    return float(best[1])


def long_run_deviations(scores: np.ndarray, inverse: np.ndarray) -> np.ndarray:
    """Return standard deviations of estimates from the scores of all samples (Huber 1967; White 1982), shape (unknowns,).

    Parameters
    ----------
    scores : ndarray, shape (N, unknowns)
        Derivative of the log-likelihood of each sample.
    inverse : ndarray, shape (unknowns, unknowns)
        Inverse of the information.
    """
    moves = scores @ inverse
    return np.array([np.sqrt(len(moves) * long_run_variance(column)) for column in moves.T])
