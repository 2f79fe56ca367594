"""The maximum of the likelihood through the filter: coefficients, process noise and sensor noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain


@dataclass(frozen=True, eq=False)
class NoiseLevels:
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
        Of the coefficients, from the expected information.
    log_likelihood : float
        At the maximum.
    converged : bool
        Whether the search met its tolerances.
    message : str
        The message of the search.
    evaluations : int
        Passes over all trials.
    """

    parameters: np.ndarray
    biases: np.ndarray
    process: Mapping[str, float]
    sensors: Mapping[str, float]
    covariance: np.ndarray
    log_likelihood: float
    converged: bool
    message: str
    evaluations: int

    def to_dict(self, model: Model) -> dict[str, Plain]:
        """Return plain values: densities per root second, and standard deviations of one sample, with their units.

        Parameters
        ----------
        model : Model
            For the units.
        """
        return {
            "process": {n: {"density": v, "unit": f"{model[n].unit}/s^0.5"} for n, v in self.process.items()},
            "sensors": {n: {"std": v, "unit": model[n].unit} for n, v in self.sensors.items()},
            "log_likelihood": self.log_likelihood,
        }
