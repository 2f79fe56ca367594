"""Whether the residuals of output error are noise of the sensors that lasts, such as waves or a slow drift.

A Kalman filter takes the noise of its sensors for white, so what lasts in them passes for a force that drives the ship, and the
coefficients change with it. Residuals about the run of output error have no such force: an autoregression of them is noise of the
sensors of any colour. Two descriptions of the same samples compare by their likelihoods, less a price for their numbers (Schwarz
1978).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.identification.noise.autoregression import autoregression_of

#: Difference of the logarithms of two likelihoods that is strong evidence (Kass and Raftery 1995: twice it is 10).
_STRONG = 5.0
#: Series of fewer samples show no colour.
_FEWEST = 50


@dataclass(frozen=True)
class LastingSensors:
    """Two descriptions of a record: sensors whose noise lasts, and noise that drives the ship.

    Attributes
    ----------
    sensors : float
        Logarithm of the likelihood of the residuals of output error under noise of the sensors that lasts, less the price of its
        numbers.
    ship : float
        The same of the filter, in which noise drives the ship and the sensors are white.
    """

    sensors: float
    ship: float

    @property
    def words(self) -> str:
        """Both in words."""
        return (
            "noise of the sensors that lasts, such as waves or drift, explains the record better than noise that drives the ship "
            f"(logarithm of the likelihood higher by {self.sensors - self.ship:.0f})"
        )

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return {"log_likelihood_sensors": self.sensors, "log_likelihood_ship": self.ship}


def lasting_sensors(
    residuals: Sequence[np.ndarray], sigma: np.ndarray, unknowns: int, log_likelihood: float, levels: int
) -> LastingSensors | None:
    """Return the comparison where the noise of the sensors lasts; None where the filter describes the record as well.

    Parameters
    ----------
    residuals : sequence of ndarray, shape (signals, N)
        Residuals of output error by trial, in units of `sigma`; NaN where a sample is missing.
    sigma : ndarray, shape (signals,)
        That unit, SI.
    unknowns : int
        Coefficients, biases and first states of output error.
    log_likelihood : float
        Of the filter at its maximum.
    levels : int
        Coefficients, biases and noise levels of the filter.
    """
    there = [np.isfinite(e) for e in residuals]
    white, count = 0.0, sum(int(t.any(axis=0).sum()) for t in there)
    for k, unit in enumerate(sigma):
        each = np.concatenate([e[k][t[k]] for e, t in zip(residuals, there)])
        if each.any():
            white -= 0.5 * each.size * float(np.log(2 * np.pi * np.mean(each**2) * unit**2) + 1)
    series = [e[:, t.all(axis=0)] for e, t in zip(residuals, there)]
    series = [e for e in series if e.shape[1] >= _FEWEST and e.any(axis=1).all()]
    if not series or not np.isfinite(log_likelihood):
        return None
    price = 0.5 * np.log(count)
    # The signals together, as waves move heading and rate, or each with a drift of its own.
    signals = len(sigma)
    together, alone = _gain(series, price), sum(_gain([e[k : k + 1] for e in series], price) for k in range(signals))
    gain = max(together, alone)
    found = LastingSensors(white + gain - price * (unknowns + signals), log_likelihood - price * levels)
    return found if gain > 0 and np.inf > found.sensors > found.ship + _STRONG else None


def _gain(series: Sequence[np.ndarray], price: float) -> float:
    """What an autoregression adds to the logarithm of the likelihood of white noise, less the price of its numbers."""
    model, signals = autoregression_of(*series), len(series[0])
    if not model.order:
        return 0.0
    samples = sum(e.shape[1] for e in series)
    power = np.log(sum((e**2).sum(axis=1) for e in series) / samples).sum()
    numbers = model.order * signals**2 + signals * (signals - 1) / 2
    return float(0.5 * samples * (power - np.linalg.slogdet(model.drive)[1]) - price * numbers)
