"""Size and whiteness of the residuals of an identification, signal by signal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import quantity
from shipid.foundation.result import ResultEntry
from shipid.foundation.statistics import WHITE, LjungBox, ljung_box, plain
from shipid.identification.identified import Identified
from shipid.identification.uncertainty.covariance import autocorrelation_time

#: Lags of the test.
_LAGS = 20


@dataclass(frozen=True, repr=False)
class Residuals(ResultEntry):
    """Residuals of one signal over all fitted trials.

    Attributes
    ----------
    samples : int
        Their number: samples that are missing do not count.
    effective : float
        As many white ones would hold as much information (`shipid.identification.uncertainty.covariance`).
    autocorrelation_time : float
        In samples, mean of the trials; 1 for white residuals.
    autocorrelation_time_s : float
        The same in s.
    ljung_box : float
        Ljung and Box's statistic (1978), summed over the trials.
    degrees : int
        Its degrees of freedom.
    p_value : float
        Probability of a larger one if the residuals were white.
    chi_square : float
        Mean squared weighted residual per degree of freedom; 1 by construction where the noise level was estimated.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"autocorrelation_time": "1"}

    samples: int
    effective: float
    autocorrelation_time: float
    autocorrelation_time_s: float
    ljung_box: float
    degrees: int
    p_value: float
    chi_square: float

    @property
    def white(self) -> bool:
        """Whether the test does not reject white residuals."""
        return self.p_value >= WHITE

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, None for what is not finite."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        found = {n: v if isinstance(v, int) else plain(v) for n, v in values.items()}
        seconds = quantity(found.pop("autocorrelation_time_s"), "s")
        samples = found.pop("autocorrelation_time")
        return found | {"autocorrelation_time": {**seconds, "samples": samples}, "white": self.white}


def residuals_of(identified: Identified) -> dict[str, Residuals]:
    """Return size and whiteness of the residuals, by signal.

    Parameters
    ----------
    identified : Identified
        What was identified.
    """
    problem, shares = identified.problem, identified.covariance.effective
    split = problem.by_signal(identified.solution.residual)
    spent = problem.size / max(len(problem.signals), 1)
    found = {}
    for j, signal in enumerate(problem.signals):
        # From one sample that is there to the next.
        series = [trial[j][np.isfinite(trial[j])] for trial in split]
        samples = sum(s.size for s in series)
        times = [autocorrelation_time(s) for s in series]
        seconds = [t * data.step_of(j) for t, data in zip(times, problem.trials)]
        test = sum((ljung_box(s, min(_LAGS, s.size // 5)) for s in series), LjungBox(0.0, 0))
        together = np.concatenate(series)
        with np.errstate(over="ignore"):
            together = together * (problem.sigma[j] / identified.noise[j])
            chi_square = float(together @ together / max(samples - spent, 1.0))
        found[signal] = Residuals(
            samples,
            float(sum(s.size * shares[i, j] for i, s in enumerate(series))),
            float(np.mean(times)),
            float(np.mean(seconds)),
            test.statistic,
            test.degrees,
            test.p_value,
            chi_square,
        )
    return found
