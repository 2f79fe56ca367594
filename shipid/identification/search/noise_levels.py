"""The maximum of the likelihood through the filter: coefficients, process noise and sensor noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import quantity
from shipid.foundation.result import Result
from shipid.foundation.statistics import WHITE
from shipid.identification.noise.coefficients_apart import CoefficientApart
from shipid.identification.noise.gusts import Gust
from shipid.identification.noise.lasting_sensors import LastingSensors

#: Kind of the notice that the coefficients are not those that simulate the ship; a filter of a record tells it by the same name.
APART = "coefficients-differ"
#: Kind of the notice that the coefficients are biased by noise of the sensors that lasts.
LASTING = "lasting-sensors"


@dataclass(frozen=True, eq=False, repr=False)
class NoiseLevels(Result):
    """Where the search for coefficients and noise levels ended.

    Attributes
    ----------
    parameters : ndarray, shape (parameters,)
        Coefficients, SI.
    biases : ndarray, shape (trials, biases)
        Constant biases of each trial's inputs.
    process : mapping of str to float
        Density of the white noise that drives each state, SI per root second.
    sensors : mapping of str to float
        Standard deviation of one sample of each signal, SI.
    covariance : ndarray, shape (parameters, parameters)
        Of the coefficients: from the expected information where the innovations are white, else the sandwich about their
        spectrum (`shipid.identification.noise.innovations`).
    log_likelihood : float
        At the maximum.
    converged : bool
        Whether the search met its tolerances.
    message : str
        The message of the search.
    evaluations : int
        Passes over all trials.
    gusts : mapping of str to Gust
        Disturbances that last, by the state they drive; empty where white noise explains the record as well.
    degrees : ndarray, shape (parameters,), or None
        Degrees of freedom of each variance (`shipid.identification.noise.small_sample`).
    whiteness : mapping of str to float
        For each signal the probability of innovations as correlated as these, were they white (Ljung and Box 1978).
    lasting : LastingSensors or None
        Where noise of the sensors that lasts explains the record better: the likelihoods of both.
    apart : tuple of CoefficientApart
        Coefficients that output error finds elsewhere: the model is not exact.
    """

    UNITS: ClassVar[Mapping[str, str]] = {
        "parameters": "SI",
        "biases": "SI",
        "covariance": "SI",
        "log_likelihood": "1",
        "degrees": "1",
    }

    parameters: np.ndarray
    biases: np.ndarray
    process: Mapping[str, float]
    sensors: Mapping[str, float]
    covariance: np.ndarray
    log_likelihood: float
    converged: bool
    message: str
    evaluations: int
    gusts: Mapping[str, Gust] = field(default_factory=dict)
    degrees: np.ndarray | None = None
    whiteness: Mapping[str, float] = field(default_factory=dict)
    lasting: LastingSensors | None = None
    apart: tuple[CoefficientApart, ...] = ()

    @property
    def notices(self) -> tuple[Notice, ...]:
        """What is wrong with coefficients that come with these levels."""
        told = []
        if self.lasting is not None:
            words = f"{self.lasting.words}: it biases the coefficients of prediction error. Output error is not biased by it"
            told.append(Notice(words, LASTING, serious=True))
        if self.apart:
            words = (
                "the model is not exact, and what it leaves out counts here as noise that drives the ship: "
                f"{', '.join(a.words for a in self.apart)}. The intervals do not hold that error; for "
                "predictions take the coefficients that identify finds without --for filter"
            )
            told.append(Notice(words, APART, serious=True, coefficients=[a.to_dict() for a in self.apart]))
        return tuple(told)

    def to_dict(self, model: Model) -> dict[str, Plain]:
        """Return plain values: densities per root second, and standard deviations of one sample, with their units.

        Parameters
        ----------
        model : Model
            For the units.
        """
        return {
            "process": {n: quantity(v, f"{model[n].unit}/s^0.5") for n, v in self.process.items()},
            "sensors": {n: quantity(v, model[n].unit) for n, v in self.sensors.items()},
            "gusts": {
                n: {"size": quantity(g.size, f"({model[n].unit})/s"), "time": quantity(g.time, "s")}
                for n, g in self.gusts.items()
            },
            "whiteness": {n: {"p_value": p, "white": p >= WHITE} for n, p in self.whiteness.items()},
            "log_likelihood": self.log_likelihood,
            "lasting_sensors": None if self.lasting is None else self.lasting.to_dict(),
        }


def mean_over(likelier: NoiseLevels, other: NoiseLevels, share: float) -> NoiseLevels:
    """Return the likelier noise with the mean covariance over both, about its coefficients: what drives a ship is not known for certain.

    Parameters
    ----------
    likelier, other : NoiseLevels
        Found for two kinds of noise that drives the states.
    share : float
        Probability of the likelier one.

    Returns
    -------
    NoiseLevels
        The likelier one as it is, where a covariance is not finite.
    """
    away = other.parameters - likelier.parameters
    covariance = share * likelier.covariance + (1 - share) * (other.covariance + np.outer(away, away))
    if not np.isfinite(covariance).all() or likelier.degrees is None or other.degrees is None:
        return likelier
    return replace(likelier, covariance=covariance, degrees=share * likelier.degrees + (1 - share) * other.degrees)
