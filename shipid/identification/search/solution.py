"""The end of a search: the unknowns, their residuals and Jacobian, and the noise levels of the residuals."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from shipid.foundation.notices import Notice
from shipid.identification.problem.losses import robust_scale, unweighted
from shipid.identification.problem.output_error import RUNAWAY, Problem
from shipid.identification.search.noise_levels import NoiseLevels


@dataclass(frozen=True, eq=False)
class SolutionAtSpread:
    """A solution of the same trials at another spread of the rudder biases.

    Attributes
    ----------
    probability : float
        Of that spread.
    problem : Problem
        With that spread in its prior.
    q : ndarray, shape (unknowns,)
        The unknowns.
    """

    probability: float
    problem: Problem = field(repr=False)
    q: np.ndarray = field(repr=False)


@dataclass(frozen=True, eq=False)
class Solution:
    """Where the search ended.

    Attributes
    ----------
    problem : Problem
        With the weights it ended with.
    q : ndarray, shape (unknowns,)
        The unknowns.
    residual : ndarray, shape (M,)
        Weighted residuals.
    jacobian : ndarray, shape (M, unknowns)
        Of the weighted residuals by the unknowns.
    converged : bool
        Whether the search met its tolerances, on finite residuals.
    message : str
        The message of the search.
    evaluations : int
        Runs of all trials, over all starts.
    covariance : ndarray or None
        Of the unknowns, where they are not the minimum of these residuals but come from another method.
    levels : NoiseLevels or None
        Noise that drives the states and noise of the sensors, where the likelihood through the filter found them
        (`shipid.identification.search.prediction_error`).
    others : tuple of SolutionAtSpread
        Solutions at other spreads of the biases, where their spread is estimated: the covariance is the mean over them
        (`shipid.identification.evidence.marginal_likelihood`). Their probabilities sum to 1.
    whitened : bool
        Whether the unknowns minimise what an autoregression leaves of the residuals (`shipid.identification.noise.whitened`).
    notices : tuple of Notice
        What there is to say of the search.
    end_of : str or None
        The method that ended here, where there is more than one end.
    elsewhere : tuple of Solution
        Other places where the search ended, which its weights hold for no worse (`shipid.identification.evidence.several_ends`).
    """

    problem: Problem
    q: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    converged: bool
    message: str
    evaluations: int
    covariance: np.ndarray | None = None
    levels: NoiseLevels | None = None
    others: tuple[SolutionAtSpread, ...] = ()
    whitened: bool = False
    notices: tuple[Notice, ...] = ()
    end_of: str | None = None
    elsewhere: tuple[Solution, ...] = field(default=(), repr=False)

    @property
    def finite(self) -> bool:
        """Whether the model runs away nowhere."""
        return bool((np.abs(self.residual) < RUNAWAY).all())

    @property
    def cost(self) -> float:
        """Half the sum of the squared weighted residuals."""
        return float(0.5 * self.residual @ self.residual)

    @property
    def parameters(self) -> np.ndarray:
        """Values of the estimated parameters, SI, shape (parameters,)."""
        return self.q[: len(self.problem.estimated)]


def residual_levels(solution: Solution) -> np.ndarray:
    """Return the standard deviation of each signal's residuals, SI, with the degrees of freedom of the fit, shape (signals,).

    Parameters
    ----------
    solution : Solution
        A solution under any weights.
    """
    problem = solution.problem
    split = unweighted(problem, solution.residual)
    spent = problem.size / len(problem.signals)
    levels = np.empty(len(problem.signals))
    for j in range(len(problem.signals)):
        together = np.concatenate([trial[j] for trial in split]) * problem.sigma[j]
        together = together[np.isfinite(together)]
        if not together.size:
            levels[j] = problem.sigma[j]
            continue
        mean = together @ together / together.size if problem.loss == "linear" else robust_scale(together) ** 2
        levels[j] = np.sqrt(mean * together.size / max(together.size - spent, 1.0))
        scale = max(float(np.nanmax(np.abs(data.measured[j]), initial=0.0)) for data in problem.trials)
        levels[j] = max(levels[j], 1e-9 * max(scale, 1e-9))
    return levels
