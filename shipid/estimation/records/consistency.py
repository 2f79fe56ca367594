"""Whether innovations are what the filter says they are: white, and as large as expected."""

from __future__ import annotations

import numpy as np

#: Lags of the whiteness test: enough for a swing of a ship sampled a few times a second, few enough for a short record.
_LAGS = 20


def autocorrelation(values: np.ndarray, lags: int) -> np.ndarray:
    """Return the autocorrelation at lags 1 to `lags`, shape (lags,).

    Parameters
    ----------
    values : ndarray, shape (N,)
        In the order of time.
    lags : int
        Fewer than N.
    """
    centred = values - values.mean()
    power = float(centred @ centred)
    if power == 0:
        return np.zeros(lags)
    return np.array([centred[k:] @ centred[:-k] for k in range(1, lags + 1)]) / power


def whiteness(values: np.ndarray, lags: int = _LAGS) -> float | None:
    """Return the probability of autocorrelations as large as these if the values were white; None for fewer than 30.

    Ljung and Box (1978): ``Q = N (N + 2) sum r_k^2 / (N - k)`` is chi-square with as many degrees of freedom as lags.

    Parameters
    ----------
    values : ndarray, shape (N,)
        Normalised innovations in the order of time.
    lags : int
        How many lags to look at.
    """
    n = values.size
    if n < 30:
        return None
    from scipy.special import chdtrc

    lags = min(lags, n // 3)
    r = autocorrelation(values, lags)
    q = n * (n + 2) * float(np.sum(r**2 / (n - np.arange(1, lags + 1))))
    return float(chdtrc(lags, q))
