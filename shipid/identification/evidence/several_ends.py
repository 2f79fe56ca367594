"""Several ends of one search: under the weights it begins with, minima that are far apart may be alike, and only noise tells them apart.

A minimum is chosen among them when each is found under the weights of its own residuals, by the likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shipid.estimation.levels.judge_filter import unit_text
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import brief
from shipid.identification.evidence.bias_spread import BiasSpread
from shipid.identification.evidence.marginal_likelihood import Weighing, conclude
from shipid.identification.problem.box import Box
from shipid.identification.problem.losses import unweighted
from shipid.identification.problem.output_error import Problem
from shipid.identification.search.least_squares import minimise_robustly
from shipid.identification.search.rung import Rung
from shipid.identification.search.solution import Solution, residual_levels
from shipid.identification.uncertainty.covariance import covariance_of

#: Kind of the notice.
ANOTHER_MINIMUM = "another-minimum"
#: Standard deviations from which two minima are two, and loss of log-likelihood up to which one is as good: three of them.
_APART, _ALIKE = 3.0, 4.5
#: Loss of log-likelihood for which the first end is taken before others, and one that converged before one that did not.
_SLIGHT = 0.5
#: Runs of the search from each of the others.
_MOST = 200


def conclude_likeliest(
    found: Solution, rungs: tuple[Rung, ...], problem: Problem, box: Box, weighing: Weighing
) -> tuple[Solution, BiasSpread | None, tuple[Rung, ...]]:
    """Return the likeliest of the ends of a search, on every sample, with the spread of the biases estimated.

    Parameters
    ----------
    found : Solution
        The end of a search, with the other places where it ended (`Solution.elsewhere`).
    rungs : tuple of Rung
        The methods that were tried.
    problem, box, weighing
        See `shipid.identification.evidence.marginal_likelihood.conclude`.

    Returns
    -------
    solution : Solution
        With a notice where another end is as likely, and has other coefficients.
    spread : BiasSpread or None
        Of the biases.
    rungs : tuple of Rung
        Of which the one is used that the solution comes from.
    """
    first, spread = conclude(found, problem, box, weighing)
    if not found.elsewhere or not first.finite:
        return first, spread, rungs
    # Under the weights of the first one, which are those of noise as far as it explains the record, and then under their own.
    searched = [(minimise_robustly(first.problem, e.q, box, most=_MOST), e.end_of) for e in found.elsewhere]
    weighed = [(weighing.again(other, box), method) for other, method in searched if other.finite]
    ends = [(first, found.end_of), *((other, method) for other, method in weighed if other.finite)]
    likely = [_log_likelihood(end) + _SLIGHT * (end.converged + (end is first)) for end, _ in ends]
    likeliest, method = ends[int(np.argmax(likely))]
    solution = likeliest
    if solution is not first:
        solution, spread = conclude(solution, problem, box, weighing)
    notices = [n for end, _ in ends if (n := _another(solution, end)) is not None]
    evaluations = solution.evaluations + sum(end.evaluations for end, _ in ends if end is not likeliest)
    solution = replace(solution, evaluations=evaluations, notices=(*solution.notices, *notices[:1]))
    return solution, spread, tuple(replace(r, used=r.method == method) for r in rungs)


def _log_likelihood(end: Solution) -> float:
    """Of white residuals of their own size, up to a constant: each end has its own weights, whose costs do not compare."""
    levels = residual_levels(end)
    split = unweighted(end.problem, end.residual)
    samples = np.array([sum(int(np.isfinite(trial[j]).sum()) for trial in split) for j in range(levels.size)])
    return float(-(samples @ np.log(levels)))


def _another(solution: Solution, other: Solution) -> Notice | None:
    """What there is to say of another end: nothing where it is the same, or less likely by white noise and under the weights of the solution."""
    at = solution.problem.residuals(other.q)[0]
    lost = 0.5 * float(at @ at) - solution.cost, _log_likelihood(solution) - _log_likelihood(other)
    if not np.isfinite(lost).all() or min(lost) > _ALIKE:
        return None
    names, model = solution.problem.estimated, solution.problem.model
    spreads = [np.sqrt(np.diag(covariance_of(s).matrix)[: len(names)]) for s in (solution, other)]
    away = np.abs(other.parameters - solution.parameters) / np.maximum(np.hypot(*spreads), 1e-300)
    apart = [k for k in np.argsort(-away) if away[k] > _APART]
    if not apart:
        return None
    words = ", ".join(
        f"{names[k]} {brief(other.parameters[k], 3)} for {brief(solution.parameters[k], 3)}{unit_text(model[names[k]].unit)}"
        for k in apart
    )
    return Notice(
        f"other coefficients fit the trials as well: {words}. The trials do not decide between them, and the intervals are those of the one "
        "set. Add a trial of another kind, fit more signals, or hold a coefficient fixed.",
        ANOTHER_MINIMUM,
        serious=True,
        coefficients=tuple(names[k] for k in apart),
        values=tuple(float(other.parameters[k]) for k in apart),
    )


def undecided(notices: Sequence[Notice]) -> dict[str, str]:
    """Return why coefficients are not determined that have other values at another end as likely, by name.

    Parameters
    ----------
    notices : sequence of Notice
        What there is to say of a search.
    """
    pairs = [p for n in notices if n.kind == ANOTHER_MINIMUM for p in zip(n.known["coefficients"], n.known["values"])]
    return {name: f"{brief(value, 3)} fits the trials as well, with other coefficients." for name, value in pairs}
