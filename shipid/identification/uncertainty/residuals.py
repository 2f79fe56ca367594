"""What the residuals of a fit say: how large they are, and whether they are white, signal by signal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from shipid.identification.search.least_squares import Solution
from shipid.identification.uncertainty.covariance import autocorrelation_time, covariance_of

#: Lags of the test, and the probability below which residuals are not called white.
_LAGS = 20
WHITE = 0.01


@dataclass(frozen=True)
class Residuals:
    """Residuals of one signal over all fitted trials.

    Attributes
    ----------
    samples : int
        Their number.
    effective : float
        As many white ones would tell as much of the coefficients (`shipid.identification.uncertainty.covariance`).
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
        """Whether nothing speaks against white residuals."""
        return self.p_value >= WHITE

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, None for what is not finite."""
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        plain = {n: v if isinstance(v, int) or np.isfinite(v) else None for n, v in values.items()}
        return plain | {"white": self.white}


def residuals_of(solution: Solution) -> dict[str, Residuals]:
    """Return what the residuals of a solution say, by signal.

    Parameters
    ----------
    solution : Solution
        At its optimum.
    """
    from scipy.special import chdtrc

    problem = solution.problem
    split = problem.by_signal(solution.residual)
    shares = covariance_of(solution).effective
    spent = problem.size / max(len(problem.signals), 1)
    found = {}
    for j, signal in enumerate(problem.signals):
        series = [trial[j] for trial in split]
        samples = sum(s.size for s in series)
        times = [autocorrelation_time(s) for s in series]
        seconds = [t * float(np.median(s.intervals[:-1])) for t, s in zip(times, problem.sailed)]
        tests = [_ljung_box(s) for s in series]
        statistic, degrees = sum(q for q, _ in tests), sum(h for _, h in tests)
        together = np.concatenate(series)
        with np.errstate(over="ignore"):
            chi_square = float(together @ together / max(samples - spent, 1.0))
        found[signal] = Residuals(
            samples,
            float(sum(s.size * shares[i, j] for i, s in enumerate(series))),
            float(np.mean(times)),
            float(np.mean(seconds)),
            float(statistic),
            degrees,
            float(chdtrc(degrees, statistic)) if degrees and np.isfinite(statistic) else 0.0,
            chi_square,
        )
    return found


def _ljung_box(series: np.ndarray) -> tuple[float, int]:
    """Ljung and Box's statistic of one series, and the number of its lags."""
    count = series.size
    lags = min(_LAGS, count // 5)
    centred = series - series.mean()
    power = float(centred @ centred)
    if lags < 1 or not 0 < power < np.inf:
        return 0.0, 0
    correlation = np.array([centred[k:] @ centred[: count - k] for k in range(1, lags + 1)]) / power
    return float(count * (count + 2) * np.sum(correlation**2 / (count - np.arange(1, lags + 1)))), lags
