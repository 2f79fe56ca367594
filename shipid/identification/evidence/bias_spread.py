"""The spread of the rudder biases from trial to trial, and whether the biases of these trials agree with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import quantity

#: Probability below which the biases of the trials do not agree with their spread.
_UNLIKELY = 0.01
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
        Probability of free biases at least as far apart as these, were the structure of the model right.
    """

    value: float
    interval: tuple[float, float]
    alone: Mapping[str, tuple[float, float]]
    p_value: float

    @property
    def agree(self) -> bool:
        """Whether the biases that the trials ask for agree with the spread."""
        return self.p_value >= _UNLIKELY

    @property
    def words(self) -> str:
        """The spread in words."""
        low, high = np.rad2deg(self.interval)
        return f"spread from trial to trial {np.rad2deg(self.value):.2g} deg, 95 % from {low:.2g} to {high:.2g} deg"

    @property
    def notice(self) -> Notice | None:
        """What there is to say where the biases do not agree with their spread."""
        if self.agree:
            return None
        each = ", ".join(f"{np.rad2deg(b):+.2f} deg ({n})" for n, (b, _) in self.alone.items())
        return Notice(
            f"with a rudder bias of its own each trial asks for {each}: they disagree beyond their spread of "
            f"{np.rad2deg(self.value):.2g} deg. This is an error of the structure of the model, not of the rudder angle; another "
            "model may describe the trials better (compare).",
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
            "agree": self.agree,
        }
