"""The few statistics that several rooms share: the normal quantile of 95 %, whiteness, plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import fft
from scipy.special import chdtrc

#: Two-sided 95 % quantile of the normal distribution.
NORMAL_95 = 1.959963984540054
#: Probability below which innovations or residuals are not white.
WHITE = 0.01


def interval_95(value: float, std: float) -> tuple[float, float]:
    """Return the 95 % interval of a normal estimate.

    Parameters
    ----------
    value, std : float
        Estimate and standard deviation.
    """
    return value - NORMAL_95 * std, value + NORMAL_95 * std


def plain(number: float | None) -> float | None:
    """Return a number as JSON can hold it: None for NaN and infinity.

    Parameters
    ----------
    number : float or None
        Any number.
    """
    return None if number is None or not np.isfinite(number) else float(number)


def autocorrelation(values: np.ndarray, lags: int) -> np.ndarray:
    """Return the autocorrelation at lags 1 to `lags`, shape (lags,).

    Parameters
    ----------
    values : ndarray, shape (N,)
        In the order of time.
    lags : int
        Fewer than N.

    Returns
    -------
    ndarray, shape (lags,)
        Zero where the values do not vary.
    """
    centred = values - values.mean()
    power = float(centred @ centred)
    if not 0 < power < np.inf:
        return np.zeros(lags)
    # By Wiener and Khinchin; zeros behind the series keep its end from its beginning.
    size = fft.next_fast_len(centred.size + lags, real=True)
    found: np.ndarray = fft.irfft(np.abs(fft.rfft(centred / np.sqrt(power), size)) ** 2, size)[1 : lags + 1]
    return found


@dataclass(frozen=True)
class LjungBox:
    """The test of Ljung and Box (1978) that a series is white.

    Attributes
    ----------
    statistic : float
        ``Q = N (N + 2) sum r_k^2 / (N - k)``.
    degrees : int
        Its degrees of freedom: the number of lags. Tests of several series add up.
    """

    statistic: float
    degrees: int

    @property
    def p_value(self) -> float:
        """Probability of a larger statistic if the series were white; 0 where the statistic is not finite."""
        if not self.degrees or not np.isfinite(self.statistic):
            return 0.0
        return float(chdtrc(self.degrees, self.statistic))

    def __add__(self, other: LjungBox) -> LjungBox:
        """Return the test of two independent series together."""
        return LjungBox(self.statistic + other.statistic, self.degrees + other.degrees)


def ljung_box(values: np.ndarray, lags: int) -> LjungBox:
    """Return the test of Ljung and Box of one series.

    Parameters
    ----------
    values : ndarray, shape (N,)
        In the order of time.
    lags : int
        How many lags to look at; below one, or for values that do not vary, the test has no degree of freedom.
    """
    count = values.size
    power = float(np.sum((values - values.mean()) ** 2)) if count else 0.0
    if lags < 1 or not 0 < power < np.inf:
        return LjungBox(0.0, 0)
    r = autocorrelation(values, lags)
    return LjungBox(float(count * (count + 2) * np.sum(r**2 / (count - np.arange(1, lags + 1)))), lags)
