"""Residuals of a trial against themselves and against the rudder: what a model leaves unexplained is correlated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.foundation.statistics import NORMAL_95, autocorrelation
from shipid.identification.validation.comparison import Comparison

#: Most lags, and the share of a record they may take.
_LAGS, _SHARE = 60, 0.2
#: Fewest samples with which a correlation says anything.
_FEWEST = 30


@dataclass(frozen=True, eq=False)
class ResidualCorrelation:
    """Correlation of the residuals of one signal.

    Attributes
    ----------
    signal : str
        The signal.
    interval : float
        Time between two lags in s.
    own : ndarray, shape (lags,)
        With themselves, at lags of 1, 2, ... intervals.
    own_bound : float
        95 % of the values of white residuals lie within plus and minus this.
    rudder : ndarray, shape (2 lags + 1,)
        With the rudder angle, at lags from ``-lags`` to ``lags``: at a positive lag the residual comes after the rudder. Empty
        where the rudder does not move or is not known.
    rudder_bound : float
        95 % of the values lie within plus and minus this where residual and rudder have nothing to do with each other, each
        with an autocorrelation of its own (Bartlett 1955; Box and Jenkins 1976, section 11.1).
    """

    signal: str
    interval: float
    own: np.ndarray
    own_bound: float
    rudder: np.ndarray
    rudder_bound: float


def residual_correlations(comparison: Comparison) -> tuple[ResidualCorrelation, ...]:
    """Return the correlation of the residuals, signal by signal; positions are left out, whose errors add up.

    Parameters
    ----------
    comparison : Comparison
        A trial beside its prediction; signals that run to infinity, or have too few samples, are left out.
    """
    trial = comparison.trial
    found = []
    for name in (s for s in comparison.rmse if s not in ("x", "y") and s in comparison.predicted and trial.has(s)):
        with np.errstate(invalid="ignore", over="ignore"):
            residual = trial[name] - comparison.predicted[name]
        # From one sample that is there to the next.
        there = np.isfinite(residual)
        lags = min(_LAGS, int(_SHARE * there.sum()))
        if there.sum() < _FEWEST or not np.isfinite(comparison.rmse[name]):
            continue
        own, interval = residual[there], float(np.median(np.diff(trial["t"][there])))
        rudder = trial["delta"][there] if trial.has("delta") else np.empty(0)
        known = rudder.size > 0 and bool(np.isfinite(rudder).all()) and float(np.ptp(rudder)) > 0
        found.append(
            ResidualCorrelation(
                name,
                interval,
                autocorrelation(own, lags),
                NORMAL_95 / own.size**0.5,
                _cross(own, rudder, lags) if known else np.empty(0),
                NORMAL_95 * _spread(own, rudder) if known else 0.0,
            )
        )
    return tuple(found)


def _cross(residual: np.ndarray, rudder: np.ndarray, lags: int) -> np.ndarray:
    """Correlation of the residual at a time with the rudder so many samples before it, from ``-lags`` to ``lags``."""
    a, b = residual - residual.mean(), rudder - rudder.mean()
    size = 1 << (2 * a.size - 1).bit_length()
    products = np.fft.irfft(np.fft.rfft(a, size) * np.fft.rfft(b, size).conj(), size)
    power = float(np.sqrt((a @ a) * (b @ b)))
    around = np.concatenate([products[-lags:], products[: lags + 1]]) if lags else products[:1]
    return around / power if power > 0 else np.zeros(2 * lags + 1)


def _spread(residual: np.ndarray, rudder: np.ndarray) -> float:
    """Standard deviation of a cross-correlation of two series that have nothing to do with each other."""
    n = residual.size
    lags = n // 4
    both = autocorrelation(residual, lags) * autocorrelation(rudder, lags)
    weights = 1.0 - np.arange(1, lags + 1) / n
    return float(np.sqrt(max(1.0 + 2.0 * (weights @ both), 1.0) / n))
