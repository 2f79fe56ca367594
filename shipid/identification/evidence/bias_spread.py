"""The spread of the rudder biases from trial to trial, and whether the biases of these trials agree with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief, quantity

#: Scale of the half-Cauchy distribution that the spread has beforehand (Gelman 2006): rudders are set to a part of a tenth of a
#: degree, and its long tail leaves a bias at sea to the trials.
EXPECTED = np.deg2rad(0.05)
#: Probability below which biases do not agree.
_UNLIKELY = 0.05
#: Points at which the distribution of the spread is summed.
_POINTS = 400
#: Kind of the notice.
DISAGREE = "biases-disagree"


@dataclass(frozen=True, eq=False)
class BiasSpread:
    """Rudder biases as random effects: each trial's is drawn about a mean that all share, with a spread that is estimated.

    Attributes
    ----------
    value : float
        The spread: standard deviation of a trial's bias about the mean, in rad.
    interval : tuple of float
        It lies between these with a probability of 95 %, in rad.
    alone : mapping of str to tuple of float
        Bias that each trial asks for where its bias is free, and its standard deviation, in rad, by trial.
    p_value : float
        Probability of free biases at least as far apart as these, were they drawn about one mean with a spread as it is expected
        before the trials (`probability_of_common`).
    structural : bool
        Whether what the model leaves of the trials lasts, and is as large as the error of a structure.
    """

    value: float
    interval: tuple[float, float]
    alone: Mapping[str, tuple[float, float]]
    p_value: float
    structural: bool = False

    @property
    def agree(self) -> bool:
        """Whether the biases that the trials ask for can be those of a rudder.

        The spread alone cannot tell: two trials determine it by one difference, and it takes any. Where a model is right, biases
        that are far apart leave nothing but noise. Where it leaves an error of its structure, they have absorbed a part of it.
        """
        return not self.structural or self.p_value >= _UNLIKELY

    @property
    def words(self) -> str:
        """The spread in words."""
        low, high = np.rad2deg(self.interval)
        return f"spread from trial to trial {brief(np.rad2deg(self.value), 2)} deg, 95 % from {brief(low, 2)} to {brief(high, 2)} deg"

    @property
    def notice(self) -> Notice | None:
        """What there is to say where the biases do not agree with their spread."""
        if self.agree:
            return None
        each = ", ".join(f"{np.rad2deg(b):+.2f} deg ({n})" for n, (b, _) in self.alone.items())
        return Notice(
            f"With a rudder bias of its own each trial asks for {each}: rudders are so far apart with a probability of "
            f"{brief(self.p_value, 2)}, and the model leaves more of the trials than noise. This is an error of the structure of the "
            "model, or of wind and current that it does not know, and not of the rudder angle; another model may describe the "
            "trials better (compare).",
            DISAGREE,
            biases={n: quantity(float(b), "rad") for n, (b, _) in self.alone.items()},
            p_value=self.p_value,
        )

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {
            "value": self.value,
            "interval_95": list(self.interval),
            "unit": "rad",
            "free": {n: {"value": b, "std": s, "unit": "rad"} for n, (b, s) in self.alone.items()},
            "p_value": self.p_value,
            "structural": self.structural,
            "agree": self.agree,
        }


def probability_of_common(bias: np.ndarray, covariance: np.ndarray) -> float:
    """Return the probability of biases at least as far apart as these, were they drawn about one mean.

    It is the mean, over the half-Cauchy distribution of the spread, of the probability that chi-square exceeds the squared
    distance of the biases from their mean, in the scatter by their own errors and the spread.

    Parameters
    ----------
    bias : ndarray, shape (trials,)
        Bias that each trial asks for, in rad.
    covariance : ndarray, shape (trials, trials)
        Covariance of their errors, in rad^2.
    """
    count = bias.size
    apart = np.eye(count) - 1 / count
    spreads = EXPECTED * np.tan(0.5 * np.pi * (np.arange(_POINTS) + 0.5) / _POINTS)
    scatter = apart @ (covariance + spreads[:, None, None] ** 2 * np.eye(count)) @ apart
    away = apart @ bias
    squares = away @ np.linalg.pinv(scatter, rcond=1e-9, hermitian=True) @ away
    return float(chdtrc(count - 1, squares).mean())
