"""Solving: trust-region least squares from several starts, with bounds, logarithms of positive parameters and weights.

The starts are tried on thinned records, where a step costs little; the best goes on over every sample.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from shipid.identification.problem import RUNAWAY, Problem

#: Samples of a trial that are enough to tell a good start from a bad one.
_THIN = 400
_SPREAD = 1.0
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Box:
    """Bounds and first value of each estimated parameter, SI, shapes (parameters,)."""

    start: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def in_log(self) -> np.ndarray:
        """Which are searched by their logarithm: those that are positive."""
        return self.low > 0


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
        What the search said.
    evaluations : int
        Runs of all trials, over all starts.
    """

    problem: Problem
    q: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    converged: bool
    message: str
    evaluations: int

    @property
    def cost(self) -> float:
        """Half the sum of the squared weighted residuals."""
        return float(0.5 * self.residual @ self.residual)


def make_starts(box: Box, count: int, seed: int) -> list[np.ndarray]:
    """Return the first value and random others: log-normal around it where positive, normal where the sign is free."""
    rng = np.random.default_rng([seed, 2])
    starts = [box.start]
    for _ in range(count - 1):
        draw = rng.standard_normal(box.start.size) * _SPREAD
        size = np.maximum(np.abs(box.start), 0.1 * np.minimum(np.abs(box.low), np.abs(box.high)))
        moved = np.where(box.in_log, box.start * np.exp(draw), box.start + draw * size)
        starts.append(np.clip(moved, box.low, box.high))
    return starts


def minimise(problem: Problem, q0: np.ndarray, box: Box, most: int, tolerance: float = 1e-8) -> Solution:
    """Minimise the squared weighted residuals from one start.

    Parameters
    ----------
    problem : Problem
        What to solve.
    q0 : ndarray, shape (unknowns,)
        Start.
    box : Box
        Bounds of the parameters.
    most : int
        Largest number of runs.
    tolerance : float
        Relative change of cost and unknowns at which the search ends.
    """
    from scipy.optimize import least_squares

    shared = len(problem.estimated)
    logs = np.zeros(problem.size, dtype=bool)
    logs[:shared] = box.in_log
    low, high = _bounds(problem, box, q0)
    z_low, z_high = (
        np.where(logs, np.log(np.where(logs, low, 1)), low),
        np.where(logs, np.log(np.where(logs, high, 1)), high),
    )

    def to_q(z: np.ndarray) -> np.ndarray:
        return np.where(logs, np.exp(np.where(logs, z, 0)), z)

    last: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def evaluate(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = z.tobytes()
        if key not in last:
            last.clear()
            q = to_q(z)
            residual, jacobian = problem.residuals(q)
            last[key] = _condensed(residual, jacobian * np.where(logs, q, 1.0))
        return last[key]

    z0 = np.where(logs, np.log(np.where(logs, np.maximum(q0, 1e-300), 1)), q0)
    margin = 1e-6 * (1 + np.where(np.isfinite(z_high - z_low), z_high - z_low, 0))
    z0 = np.clip(z0, z_low + margin, z_high - margin)
    if not problem.size:
        residual, jacobian = problem.residuals(q0)
        return Solution(problem, q0, residual, jacobian, True, "nothing to estimate", 1)
    found = least_squares(
        lambda z: evaluate(z)[0],
        z0,
        jac=lambda z: evaluate(z)[1],
        bounds=(z_low, z_high),
        x_scale="jac",
        method="trf",
        ftol=tolerance,
        xtol=tolerance,
        gtol=1e-12,
        max_nfev=most,
    )
    q = to_q(found.x)
    residual, jacobian = problem.residuals(q)
    finite = bool((np.abs(residual) < RUNAWAY).all())
    message = found.message if finite else "the model runs away in every neighbourhood of the best point."
    return Solution(problem, q, residual, jacobian, found.status > 0 and finite, message, found.nfev)


def _condensed(residual: np.ndarray, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residual and Jacobian of at most unknowns + 1 rows with the same cost, gradient and Gauss-Newton matrix.

    With [J r] = Q R the triangle holds all that the search reads of thousands of samples, and its singular value
    decomposition at every step costs next to nothing.
    """
    triangle = np.asarray(np.linalg.qr(np.column_stack([jacobian, residual]), mode="r"))
    return triangle[:, -1], triangle[:, :-1]


def _bounds(problem: Problem, box: Box, q0: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    low, high = np.full(problem.size, -np.inf), np.full(problem.size, np.inf)
    low[: len(box.low)], high[: len(box.high)] = box.low, box.high
    for i, sailed in enumerate(problem.sailed):
        begin = problem.own(i).start + len(problem.initial)
        for j, name in enumerate(problem.biases):
            # A rudder bias beyond 10 degrees, or half the speed, is another fault than a bias.
            reach = np.deg2rad(10) if name == "delta" else 0.5 * sailed.speed
            low[begin + j], high[begin + j] = -reach, reach
    return low, high


def solve(
    problem: Problem,
    box: Box,
    *,
    starts: int = 5,
    seed: int = 0,
    weigh: bool = True,
    unit_time: float | None = None,
    progress: Progress | None = None,
) -> Solution:
    """Solve an output-error problem from several starts.

    Parameters
    ----------
    problem : Problem
        With first weights.
    box : Box
        Bounds and start of the parameters.
    starts : int
        Number of starts.
    seed : int
        Of the random starts.
    weigh : bool
        Whether the standard deviations are estimated from the residuals (in turns with the parameters: the maximum
        of the likelihood with unknown noise levels), or stay as given.
    unit_time : float, optional
        L/U in s: no thinned record is coarser than a tenth of it.
    progress : callable, optional
        Called with a line of text after each stage.

    Returns
    -------
    Solution
    """
    tell = progress or (lambda _: None)
    samples = [_thin(s.trial.duration, unit_time) for s in problem.sailed]
    thin = thinned(problem, samples)
    tried = []
    for i, start in enumerate(make_starts(box, starts, seed)):
        tried.append(minimise(thin, thin.first_guess(start), box, most=30, tolerance=1e-4))
        tell(f"start {i + 1} of {starts}: cost {tried[-1].cost:.4g}")
    best = min(tried, key=lambda s: s.cost)
    evaluations = sum(s.evaluations for s in tried)
    if weigh:
        for turn in range(4):
            sigma = noise_levels(best)
            change = np.abs(np.log(sigma / best.problem.sigma)).max()
            best = minimise(replace(best.problem, sigma=sigma), best.q, box, most=40, tolerance=1e-6)
            evaluations += best.evaluations
            tell(f"weights, turn {turn + 1}: cost {best.cost:.4g}")
            if change < 0.05:
                break
    best = minimise(replace(problem, sigma=best.problem.sigma), best.q, box, most=200)
    evaluations += best.evaluations
    tell(f"all samples: cost {best.cost:.4g}")
    if weigh:
        final = replace(problem, sigma=noise_levels(best))
        best = minimise(final, best.q, box, most=100)
        evaluations += best.evaluations
    return replace(best, evaluations=evaluations)


def thinned(problem: Problem, samples: list[int]) -> Problem:
    """Return the same problem on fewer samples, its beliefs weakened as much as its data.

    Parameters
    ----------
    problem : Problem
        On every sample.
    samples : list of int
        How many to keep of each trial, about.
    """
    sailed = tuple(s.thinned(n) for s, n in zip(problem.sailed, samples))
    kept = sum(s.intervals.size for s in sailed) / sum(s.intervals.size for s in problem.sailed)
    prior = problem.prior and replace(problem.prior, strength=max(1.0, problem.prior.strength * kept))
    return replace(problem, sailed=sailed, prior=prior)


def _thin(duration: float, unit_time: float | None) -> int:
    return _THIN if not unit_time else max(_THIN, int(10 * duration / unit_time))


def noise_levels(solution: Solution) -> np.ndarray:
    """Return the standard deviation of each signal's residuals, SI, with the degrees of freedom of the fit.

    Parameters
    ----------
    solution : Solution
        A solution under any weights.
    """
    problem = solution.problem
    split = problem.by_signal(solution.residual)
    spent = problem.size / len(problem.signals)
    levels = np.empty(len(problem.signals))
    for j in range(len(problem.signals)):
        together = np.concatenate([trial[j] for trial in split]) * problem.sigma[j]
        levels[j] = np.sqrt(together @ together / max(together.size - spent, 1.0))
        scale = max(float(np.abs(s.measured[j]).max()) for s in problem.sailed)
        levels[j] = max(levels[j], 1e-9 * max(scale, 1e-9))
    return levels


def seen_with_own_noise(solution: Solution) -> Solution:
    """Return the same unknowns with residuals in units of their own standard deviation, for the uncertainty.

    Parameters
    ----------
    solution : Solution
        Found under weights that are not the noise levels.
    """
    problem = replace(solution.problem, sigma=noise_levels(solution))
    residual, jacobian = problem.residuals(solution.q)
    return replace(solution, problem=problem, residual=residual, jacobian=jacobian)


def box_of(bounds: Mapping[str, tuple[float, float, float]]) -> Box:
    """Return a box from ``{name: (start, low, high)}``."""
    start, low, high = (np.array(c, dtype=float) for c in zip(*bounds.values())) if bounds else (np.zeros(0),) * 3
    return Box(np.clip(start, low, high), low, high)
