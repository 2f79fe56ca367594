"""Profile likelihood: the best cost for each value of one parameter, and the interval the likelihood ratio gives.

Where the cost is not quadratic (a gain without an upper limit, a ship on the edge of course stability) the interval is
not symmetric, and an end of it may be missing. Correlated samples are not counted twice: differences of the cost
are divided by the factor by which the variance of that parameter exceeds the one of white residuals.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.foundation.statistics import NORMAL_95, plain
from shipid.identification.identified import Identified
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import RUNAWAY, Problem
from shipid.identification.search.least_squares import minimise

if TYPE_CHECKING:
    import pandas as pd

#: Half of the 95 % point of chi-square with one degree of freedom: the rise of the cost at the ends of the interval.
_RISE = 0.5 * NORMAL_95**2
_REACH = 4.0
#: Standard deviations from the estimate at which the parabola of a published coefficient is measured.
_NEAR = 0.5


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Result):
    """The profile of one parameter.

    Attributes
    ----------
    name, unit : str
        The parameter; SI.
    values : ndarray, shape (n,)
        Its values.
    cost : ndarray, shape (n,)
        Least half sum of squares with the parameter held there, less that of the fit, in effective samples: the negative
        logarithm of the likelihood ratio.
    ci95 : tuple of float or None
        95 % interval; None for an end that was not reached within the bounds.
    excess : float
        Samples for each effective one.
    """

    name: str
    unit: str
    values: np.ndarray
    cost: np.ndarray
    ci95: tuple[float | None, float | None]
    excess: float

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values; None where the model runs away."""
        return {
            "name": self.name,
            "unit": self.unit,
            "values": self.values.tolist(),
            "cost": [plain(c) for c in self.cost],
            "interval_95": list(self.ci95),
            "samples_per_effective_sample": self.excess,
        }

    def to_frame(self) -> pd.DataFrame:
        """Return values and costs as a pandas table."""
        import pandas as pd

        return pd.DataFrame({self.name: self.values, "cost": self.cost})

    def text(self) -> str:
        """Return the result in lines of text."""
        low, high = ("open" if end is None else brief(end, 6) for end in self.ci95)
        return f"Profile of {self.name}: 95 % from {low} to {high} {self.unit}, {self.values.size} points"


def profile_of(identified: Identified, name: str, points: int = 17) -> Profile:
    """Return the profile of a fitted parameter, or of a published coefficient that can take the place of one.

    Parameters
    ----------
    identified : Identified
        What was identified.
    name : str
        The coefficient.
    points : int
        Number of values, half of them to either side of the estimate.

    Returns
    -------
    Profile

    Raises
    ------
    UnknownNameError
        If there is no such coefficient.
    UsageError
        If it is held fixed, or cannot be held.
    """
    problem, solution, box = identified.problem, identified.solution, identified.box
    if name not in identified.parameters:
        if name in problem.fixed:
            raise UsageError(f"'{name}' was held fixed in this fit; a profile needs a coefficient that is free.")
        raise UnknownNameError("coefficient of this fit called", name, identified.parameters)
    if solution.covariance is not None:
        raise UsageError(f"a profile needs the maximum of a likelihood, and this fit is by {identified.method}.")
    estimate = identified.parameters[name]
    if estimate.value is None:
        if estimate.withheld:
            raise UsageError(f"'{name}' has no value in this fit: {estimate.why}")
        raise UsageError(f"'{name}' runs to infinity in this fit; profile the coefficients it follows from.")
    gone = name if name in problem.estimated else _partner(problem, name)
    at = problem.estimated.index(gone)
    keep = np.delete(np.arange(problem.size), at)
    others = Box(*(np.delete(part, at) for part in (box.start, box.low, box.high)))
    model = problem.model if gone == name else problem.model.impose([name])
    reduced = replace(problem, model=model, estimated=tuple(n for n in problem.estimated if n != gone))
    low, high = (float(box.low[at]), float(box.high[at])) if gone == name else (-np.inf, np.inf)

    def rise_at(value: float, start: np.ndarray) -> tuple[float, np.ndarray]:
        held = replace(reduced, fixed={**problem.fixed, name: value})
        found = minimise(held, start, others, most=40, tolerance=1e-6)
        lost = not (np.abs(found.residual) < RUNAWAY).all()
        return np.inf if lost else max(0.0, found.cost - solution.cost), found.q

    excess = float(identified.covariance.excess[at])
    if gone != name and estimate.std and np.isfinite(estimate.std):
        # What follows from several has an excess of its own: near the estimate its profile is the parabola of its standard deviation.
        near = [rise_at(estimate.value + side * _NEAR * estimate.std, solution.q[keep])[0] for side in (-1, 1)]
        own = float(np.mean(near)) / (0.5 * _NEAR**2)
        # Where the model runs away so near, that of the coefficient it takes the place of has to do.
        excess = own if np.isfinite(own) and own > 0 else excess
    excess = excess if np.isfinite(excess) and excess > 0 else 1.0

    def cost_at(value: float, start: np.ndarray) -> tuple[float, np.ndarray]:
        rise, there = rise_at(value, start)
        return rise / excess, there

    size = abs(estimate.value) or 1.0
    step = min(estimate.std, 2 * size) if estimate.std else 0.5 * size
    results, ends = {estimate.value: 0.0}, []
    in_log = low > 0
    for side in (-1, 1):
        start, end, stride, value = solution.q[keep], None, step, estimate.value
        previous = (value, 0.0)
        for _ in range(max(2, points // 2)):
            nearer = value * np.exp(side * stride / size / 2) if in_log else value + side * stride / 2
            value = float(np.clip(nearer, low, high))
            if value == previous[0]:
                break
            cost, start = cost_at(value, start)
            results[value] = cost
            if end is None and cost >= _RISE:
                end = _crossing(previous, (value, cost))
            # The values end outside the interval; inside it, steps are larger where the cost hardly rises.
            if cost > _REACH or not np.isfinite(cost):
                break
            stride *= 2.0 if cost - previous[1] < 0.05 else 1.0
            previous = (value, cost)
        ends.append(end)
    values = np.array(sorted(results))
    return Profile(name, estimate.unit, values, np.array([results[v] for v in values]), (ends[0], ends[1]), excess)


def _crossing(inside: tuple[float, float], outside: tuple[float, float]) -> float:
    """Where the cost rises to the level of the interval, along its root, which is nearly straight."""
    if not np.isfinite(outside[1]):
        return inside[0]
    roots = np.sqrt([inside[1], outside[1]])
    return float(np.interp(np.sqrt(_RISE), roots, [inside[0], outside[0]]))


def _partner(problem: Problem, name: str) -> str:
    """The fitted coefficient that a published one can take the place of."""
    partner = problem.model.partner(name)
    if partner is None or partner not in problem.estimated:
        raise UsageError(f"'{name}' follows from the fitted coefficients and cannot be held in place of one of them.")
    return partner
