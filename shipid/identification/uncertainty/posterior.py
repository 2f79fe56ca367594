"""A sampled posterior: draws of all unknowns by an ensemble sampler, where the log-likelihood is not quadratic.

The sampler is emcee's (Foreman-Mackey et al. 2013; affine-invariant, Goodman and Weare 2010), an extra of the
installation; the likelihood of all its walkers is one call of the compiled record. Correlated samples count as
the fit counts them: each signal of each trial by its effective samples. Parameters have a flat prior within their declared
bounds, beside the prior the declaration gives them; biases and initial states have the prior of the fit, or a flat one.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from shipid.declaration.units import pretty
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError, UsageError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.generation.ensemble import run_many
from shipid.generation.record import make_record
from shipid.generation.simulator import coefficient_vector, initial_state
from shipid.identification.errors import PosteriorError
from shipid.identification.identified import Identified
from shipid.identification.problem.losses import bends
from shipid.identification.search.least_squares import bounds_of
from shipid.identification.uncertainty.draws import draws_of

if TYPE_CHECKING:
    import pandas as pd

QUANTILES = (0.025, 0.16, 0.5, 0.84, 0.975)
#: Largest number of unknowns that an ensemble sampler mixes.
_MOST_UNKNOWNS = 30
#: Burn-in in steps: so many times the longest autocorrelation time of a first stretch, at least so many.
_BURNT, _LEAST_BURNT = 5, 200
#: Steps in autocorrelation times below which neither the quantiles nor that time are reliable.
_LONG = 20


@dataclass(frozen=True, eq=False, repr=False)
class Posterior(Result):
    """Draws from the posterior density of a fit.

    Attributes
    ----------
    names, units : tuple of str
        The parameters; SI.
    draws : ndarray, shape (draws, parameters)
        Their values; draws of one walker follow each other by `len(draws) // walkers` steps.
    quantiles : ndarray, shape (5, parameters)
        At 2.5, 16, 50, 84 and 97.5 %.
    autocorrelation : ndarray, shape (parameters,)
        Integrated autocorrelation time in steps.
    walkers : int
        Number of walkers.
    acceptance : float
        Share of the steps that were accepted.
    gaussian : tuple of (float, float) or None
        The 95 % interval of the fit, for each parameter.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    draws: np.ndarray
    quantiles: np.ndarray
    autocorrelation: np.ndarray
    walkers: int
    acceptance: float
    gaussian: tuple[tuple[float, float] | None, ...]

    @property
    def independent(self) -> np.ndarray:
        """Number of independent draws that those of each parameter count as."""
        return np.asarray(len(self.draws) / self.autocorrelation)

    @property
    def mixed(self) -> bool:
        """Whether the chains are long enough for reliable quantiles."""
        return bool(len(self.draws) / self.walkers >= _LONG * self.autocorrelation.max())

    def to_frame(self) -> pd.DataFrame:
        """Return the draws as a pandas table, a column for each parameter."""
        import pandas as pd

        return pd.DataFrame(self.draws, columns=list(self.names))

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, free of NaN; the draws themselves are in `to_frame`."""
        rows = {}
        for k, name in enumerate(self.names):
            q = [float(v) for v in self.quantiles[:, k]]
            rows[name] = {
                "unit": self.units[k],
                "mean": float(self.draws[:, k].mean()),
                "std": float(self.draws[:, k].std()),
                "quantiles": {f"{100 * level:g}": v for level, v in zip(QUANTILES, q)},
                "interval_95": [q[0], q[-1]],
                "gaussian_interval_95": None if self.gaussian[k] is None else list(self.gaussian[k] or ()),
                "width_over_gaussian": self.width_over_gaussian(k),
                "autocorrelation_steps": float(self.autocorrelation[k]),
                "independent_draws": float(self.independent[k]),
            }
        return {
            "draws": len(self.draws),
            "walkers": self.walkers,
            "acceptance": self.acceptance,
            "mixed": self.mixed,
            "parameters": rows,
        }

    def width_over_gaussian(self, index: int) -> float | None:
        """Return the width of the sampled 95 % interval over that of the fit; None where the fit has none.

        Parameters
        ----------
        index : int
            Which parameter.
        """
        ends = self.gaussian[index]
        if ends is None or ends[1] <= ends[0]:
            return None
        return float((self.quantiles[-1, index] - self.quantiles[0, index]) / (ends[1] - ends[0]))

    def text(self) -> str:
        """Return the result in lines of text."""
        worst = self.independent.min()
        head = f"posterior, {len(self.draws)} draws of {self.walkers} walkers, worth {worst:.0f} independent ones at the least"
        lines = [head if self.mixed else f"{head}: TOO FEW, ask for more draws"]
        for k, name in enumerate(self.names):
            ratio = self.width_over_gaussian(k)
            beside = "" if ratio is None else f"   {ratio:.2f} times as wide as the fit's"
            unit = "" if pretty(self.units[k]) == "1" else f" {pretty(self.units[k])}"
            lines.append(
                f"  {name:<10s} {brief(self.quantiles[2, k], 5)}, 95 % from {brief(self.quantiles[0, k], 5)} to "
                f"{brief(self.quantiles[-1, k], 5)}{unit}{beside}"
            )
        return "\n".join(lines)


class _Density:
    """The logarithm of the posterior density of many points in one call."""

    def __init__(self, identified: Identified) -> None:
        problem = identified.problem
        self.problem = problem
        self.record = make_record(problem.model, problem.shown)
        self.low, self.high = bounds_of(problem, identified.box)
        self.noise = identified.noise
        self.shares = identified.covariance.effective * _pulled(identified)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        problem = self.problem
        within: np.ndarray = (points >= self.low) & (points <= self.high)
        inside = np.asarray(within.all(axis=1))
        out = np.full(len(points), -np.inf)
        if inside.any():
            squares = [self._squares(points[inside], i) for i in range(len(problem.trials))]
            out[inside] = -0.5 * np.sum(squares, axis=0)
            if problem.prior is not None:
                constant, slope = problem.prior_residuals(np.zeros(problem.size), problem.prior)
                terms = points[inside] @ slope.T + constant
                # Counted sample by sample in the fit, where they must outweigh correlated samples.
                out[inside] -= 0.5 * np.sum(terms**2, axis=1) / problem.prior.strength
        return np.where(np.isfinite(out), out, -np.inf)

    def _squares(self, points: np.ndarray, i: int) -> np.ndarray:
        """Sum of the weighted squares of one trial at each point, shape (points,)."""
        problem, data = self.problem, self.problem.trials[i]
        own = points[:, problem.own(i)]
        start = {**data.start, **dict(zip(problem.initial, own.T))}
        values = {**problem.fixed, **dict(zip(problem.estimated, points.T))}
        bias = np.array([problem.bias_vector(row) for row in own])
        x0, p = initial_state(problem.model, start), coefficient_vector(problem.model, values)
        x0, p = (np.broadcast_to(columns.T, (len(points), len(columns))) for columns in (x0, p))
        y, _ = run_many(self.record, x0, data.inputs, data.intervals, p, bias)
        with np.errstate(over="ignore", invalid="ignore"):
            squares = ((y - data.measured) / self.noise[:, None]) ** 2
            if problem.weights is not None:
                squares = squares * problem.weights[i]
            squares = np.where(data.there, squares, 0.0)
            return np.asarray(np.nan_to_num(squares.sum(axis=2) @ self.shares[i], nan=np.inf))


def _pulled(identified: Identified) -> np.ndarray:
    """Factor on the weighted squares of each signal under a robust loss that makes their curvature the information."""
    problem = identified.problem
    if problem.weights is None:
        return np.ones(len(problem.signals))
    split = problem.by_signal(identified.solution.residual)
    out = []
    for j, bend in enumerate(bends(problem)):
        weights = np.concatenate([w[j] for w in problem.weights])
        power = float(np.nanmean(weights * np.concatenate([trial[j] for trial in split]) ** 2))
        power *= float(problem.sigma[j] / identified.noise[j]) ** 2
        out.append(bend**4 / (power * weights.mean()))
    return np.array(out)


def posterior_of(identified: Identified, draws: int, seed: int = 0) -> Posterior:
    """Sample the posterior density of an identification.

    Parameters
    ----------
    identified : Identified
        What was identified; its search converged, by output error.
    draws : int
        How many, over all walkers, after the burn-in.
    seed : int
        Of the sampler.

    Returns
    -------
    Posterior

    Raises
    ------
    UsageError
        If the fit has no likelihood to sample, or the number of draws is too small.
    MissingExtraError
        If the sampler is not installed.
    PosteriorError
        If the unknowns are too many, or the density is improper.
    """
    emcee = _sampler()
    problem, parameters = identified.problem, identified.parameters
    size, walkers = problem.size, max(32, 2 * (problem.size + 1))
    if identified.solution.covariance is not None:
        raise UsageError(f"a posterior needs the likelihood of output error, and this fit is by {identified.method}.")
    if draws < 10 * walkers:
        raise UsageError(f"{draws} draws are {draws / walkers:.1f} steps of {walkers} walkers; ask for {50 * walkers}.")
    if size > _MOST_UNKNOWNS:
        raise PosteriorError(
            f"the fit has {size} unknowns ({len(problem.estimated)} coefficients, {problem.per_trial} in each trial), and an "
            f"ensemble sampler mixes up to {_MOST_UNKNOWNS}. Fit fewer trials or hold coefficients, or ask for profiles."
        )
    density = _Density(identified)
    unseen = [n for n in problem.estimated if not parameters[n].std]
    open_ = [n for n, lo, hi in zip(problem.estimated, density.low, density.high) if not np.isfinite([lo, hi]).all()]
    if set(unseen) & set(open_):
        raise PosteriorError(
            f"the trials hold no information about {', '.join(unseen)} alone, and the declaration has no bounds for it: its "
            "posterior is improper. Hold it fixed, or give it bounds."
        )
    start = _walkers(identified, density, walkers, seed)
    moves = [(emcee.moves.DEMove(), 0.8), (emcee.moves.DESnookerMove(), 0.2)]
    sampler = emcee.EnsembleSampler(walkers, size, density, moves=moves, vectorize=True)
    sampler.random_state = np.random.RandomState(seed).get_state()
    state = sampler.run_mcmc(start, _LEAST_BURNT, progress=False)
    first = float(np.nanmax(sampler.get_autocorr_time(tol=0)))
    more = int(min(_BURNT * first, 20 * _LEAST_BURNT)) - _LEAST_BURNT if np.isfinite(first) else 0
    state = sampler.run_mcmc(state, more, progress=False) if more > 0 else state
    sampler.reset()
    sampler.run_mcmc(state, -(-draws // walkers), progress=False)
    shared = len(problem.estimated)
    times = np.maximum(1.0, np.nan_to_num(sampler.get_autocorr_time(tol=0)[:shared], nan=sampler.iteration))
    flat = sampler.get_chain(flat=True)[:, :shared]
    return Posterior(
        problem.estimated,
        tuple(problem.model[n].unit for n in problem.estimated),
        flat,
        np.quantile(flat, QUANTILES, axis=0),
        times,
        walkers,
        float(np.mean(sampler.acceptance_fraction)),
        tuple(parameters[n].ci95 for n in problem.estimated),
    )


def _walkers(identified: Identified, density: _Density, count: int, seed: int) -> np.ndarray:
    """Where the walkers begin: draws of the Gaussian approximation at which the model stays bounded."""
    found = draws_of(identified, 4 * count, seed).unknowns
    rng = np.random.default_rng([seed, 5])
    # Unknowns without spread in the approximation get a little, or the walkers would lie in a plane.
    spread = found.std(axis=0)
    little = 1e-6 + 1e-3 * np.abs(identified.solution.q)
    found = found + rng.standard_normal(found.shape) * np.where(spread > 0, 0.0, little)
    found = np.clip(found, density.low, density.high)
    good = found[np.isfinite(density(found))]
    if len(good) < count:
        raise PosteriorError(
            "the model runs away at most of the coefficients the fit allows, and the sampler finds no starting points. Hold the "
            "coefficients that are not determined, or add trials that determine them."
        )
    return np.asarray(good[:count])


def _sampler() -> ModuleType:
    try:
        return importlib.import_module("emcee")
    except ImportError:
        raise MissingExtraError("a sampled posterior", "emcee", "posterior") from None
