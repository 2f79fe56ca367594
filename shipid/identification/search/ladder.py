"""The ladder of methods, tried in order; every rung is kept in the result.

1. Equation error, by least squares and instrumental variables, where the states are measured: one more start.
2. Output error from several starts, on thinned records.
3. Multiple shooting, where no start reached a bounded model, or the best of them did not converge.

Costs of the rungs are those of output error on thinned records under the first weights, so that they compare.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.delays import refuse_delay, refuse_estimated_delay
from shipid.foundation.numbers import brief
from shipid.identification.errors import NotRegressableError
from shipid.identification.methods import Method
from shipid.identification.noise.lasting_sensors import lasting_sensors
from shipid.identification.problem.box import EMPTY, Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.search.equation_error import (
    EquationErrorResult,
    instrumental_variables,
    least_squares,
)
from shipid.identification.search.least_squares import (
    Progress,
    make_starts,
    minimise,
    minimise_robustly,
    refine,
    thinned,
)
from shipid.identification.search.multiple_shooting import shoot
from shipid.identification.search.prediction_error import fit_levels
from shipid.identification.search.regression import make_regression
from shipid.identification.search.rung import Rung
from shipid.identification.search.solution import Solution, residual_levels
from shipid.identification.uncertainty.covariance import covariance_of

_ROUGH = 1e-4
_BETTER = 0.999
"""A start is better than an earlier one where its cost is smaller by this factor: searches that rough end by chance at either of two
equal ones, and the first start is what is known of the ship."""
_ALIKE, _OTHERS = 4.5, 3
"""Half the squares of three standard deviations: what tells two ends of a search apart, in cost and in place; and how many are kept."""


@dataclass(frozen=True)
class SearchSettings:
    """Settings of a search, beside the problem.

    Attributes
    ----------
    starts, seed : int
        Number of starting points of output error, and of the random ones.
    weigh : bool
        Whether noise levels are estimated.
    unit_time : float
        L/U in s.
    tell : callable
        Called with a line of text after each stage.
    """

    starts: int
    seed: int
    weigh: bool
    unit_time: float
    tell: Progress


def climb(problem: Problem, box: Box, method: Method | None, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    """Search, by one method or from rung to rung.

    Parameters
    ----------
    problem : Problem
        With first weights.
    box : Box
        Bounds and start of the parameters.
    method : str or None
        A method by its name; by default output error with its starts and its rescue.
    how : SearchSettings
        The settings of the search.

    Returns
    -------
    solution : Solution
        The solution.
    rungs : tuple of Rung
        The methods that were tried, in order.

    Raises
    ------
    NotRegressableError
        If a method was requested that needs states which are not measured.
    UsageError
        If a method was requested that cannot carry, or estimate, a dead time of the model.
    """
    return _METHODS[method](problem, box, how)


def _by_output_error(problem: Problem, box: Box, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    best = _from_starts(thinned(problem, how.unit_time), make_starts(box, how.starts, how.seed), box, how)
    end = refine(problem, best, box, how.weigh, how.tell)
    rung = _rung("output-error", best, f"asked for; {_starts(how)}.", used=True, converged=end.converged)
    return _with_others(end, _refined(problem, best, end, box, how)), (rung,)


def _by_the_ladder(problem: Problem, box: Box, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    thin = thinned(problem, how.unit_time)
    rungs, starts = [], make_starts(box, how.starts, how.seed)
    first, rung = _regressed(thin, box, how)
    if rung is not None:
        rungs.append(rung)
    best = _from_starts(thin, starts, box, how)
    if first is not None:
        other = minimise(thin, first, box, most=30, tolerance=_ROUGH)
        how.tell(f"start by {rungs[-1].method}: cost {brief(other.cost, 4)}")
        better = other.cost < _BETTER * best.cost
        evaluations = best.evaluations + other.evaluations
        elsewhere = _alike([other, best, *best.elsewhere] if better else [best, other, *best.elsewhere])
        best = replace(other if better else best, evaluations=evaluations, elsewhere=elsewhere)
        came = "best from there" if better else "no better from there than from other starts"
        rungs[-1] = replace(rungs[-1], reason=f"{rungs[-1].reason} Output error came {came}.")
    if not best.finite:
        rungs.append(_rung("output-error", best, "the model runs away from every start."))
        return _rescued(problem, thin, best, box, how, rungs)
    end = refine(problem, best, box, how.weigh, how.tell)
    if end.converged:
        words = _starts(how) + (", and one by regression." if first is not None else ".")
        rungs.append(_rung("output-error", best, words, used=True, converged=True))
        return _with_others(end, _refined(problem, best, end, box, how)), tuple(rungs)
    rungs.append(_rung("output-error", best, f"did not converge under the first weights: {end.message}"))
    return _rescued(problem, thin, best, box, how, rungs, end)


def _rescued(
    problem: Problem,
    thin: Problem,
    best: Solution,
    box: Box,
    how: SearchSettings,
    rungs: list[Rung],
    before: Solution | None = None,
) -> tuple[Solution, tuple[Rung, ...]]:
    """Multiple shooting from the best start and the first one, finished by output error, where that succeeds."""
    # The first values themselves, too: a search may leave what is known of the ship for a place that the first weights hold no worse.
    q = thin.first_guess(box.start)
    residual, jacobian = problem.residuals(q)
    first = Solution(problem, q, residual, jacobian, False, "the first values.", 1)
    elsewhere = [first, *_refined(problem, best, before, box, how)]
    if problem.model.delays:
        # A segment does not hold the inputs before it, which a dead time reads.
        end = before or refine(problem, best, box, how.weigh, how.tell)
        return _with_others(end, elsewhere), (*rungs[:-1], replace(rungs[-1], used=True))
    starts = [best.q, thin.first_guess(box.start)]
    found = _shot(thin, starts[: 1 if np.allclose(starts[0], starts[1]) else 2], box, how)
    end = refine(problem, found, box, how.weigh, how.tell) if found.finite else found
    if not end.finite and before is None:
        before = refine(problem, best, box, how.weigh, how.tell)
    kept = before is None or (end.converged and not before.converged) or (end.finite and end.cost < before.cost)
    reason = f"the rescue; {found.message}"
    rungs.append(_rung("multiple-shooting", found, reason, used=kept, converged=end.converged))
    end = replace(end, end_of="multiple-shooting")
    others = [] if before is None else [replace(before, end_of="output-error"), *elsewhere]
    if not kept and before is not None:
        at = next(k for k, r in enumerate(rungs) if r.method == "output-error")
        rungs[at] = replace(rungs[at], used=True)
        end, others[0] = others[0], end
    return _with_others(replace(end, evaluations=sum(r.evaluations for r in rungs)), others), tuple(rungs)


def _with_others(end: Solution, others: Sequence[Solution]) -> Solution:
    """An end with the other places that noise may hold for better."""
    if not others:
        return end
    elsewhere = tuple(replace(o, evaluations=0, end_of=o.end_of or "output-error") for o in others if o.finite)
    return replace(end, end_of=end.end_of or "output-error", elsewhere=elsewhere)


def _refined(problem: Problem, best: Solution, end: Solution | None, box: Box, how: SearchSettings) -> list[Solution]:
    """The ends beside the best of the starts, gone on from as from that; those that come out where it did are left out."""
    found = [refine(problem, other, box, how.weigh, how.tell) for other in best.elsewhere]
    return found if end is None or not end.finite else list(_alike([end, *found]))


def _alike(ends: Sequence[Solution]) -> tuple[Solution, ...]:
    """The ends beside the first one that the weights hold for no worse, and whose place its slopes hold for worse: it is another minimum."""
    best, *others = ends
    found: list[Solution] = []
    for other in sorted(others, key=lambda s: s.cost):
        near = any(0.5 * float(np.sum((s.jacobian @ (other.q - s.q)) ** 2)) < _ALIKE for s in (best, *found))
        if other.finite and other.cost - best.cost < _ALIKE and not near:
            found.append(other)
    return tuple(found[:_OTHERS])


def _by_multiple_shooting(problem: Problem, box: Box, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    refuse_delay(problem.model, "Multiple shooting")
    thin = thinned(problem, how.unit_time)
    starts = [thin.first_guess(s) for s in make_starts(box, how.starts, how.seed)]
    found = _shot(thin, starts, box, how)
    end = refine(problem, found, box, how.weigh, how.tell)
    rung = _rung("multiple-shooting", found, f"asked for; {found.message}", used=True, converged=end.converged)
    return end, (rung,)


def _shot(thin: Problem, starts: list[np.ndarray], box: Box, how: SearchSettings) -> Solution:
    """Multiple shooting from the first start from which it reaches a bounded model, then single shooting."""
    tried: list[Solution] = []
    for i, start in enumerate(starts):
        if tried and tried[-1].converged:
            break
        joined = shoot(thin, start, box, how.unit_time)
        single = minimise_robustly(thin, joined.q, box, most=60, tolerance=_ROUGH)
        evaluations = joined.evaluations + single.evaluations
        tried.append(replace(single, evaluations=evaluations, message=joined.message))
        how.tell(f"multiple shooting, start {i + 1} of {len(starts)}: cost {brief(single.cost, 4)}")
    best = min(tried, key=lambda s: s.cost)
    return replace(best, evaluations=sum(s.evaluations for s in tried))


def _from_starts(thin: Problem, starts: list[np.ndarray], box: Box, how: SearchSettings) -> Solution:
    tried = []
    for i, start in enumerate(starts):
        tried.append(minimise(thin, thin.first_guess(start), box, most=30, tolerance=_ROUGH))
        how.tell(f"start {i + 1} of {len(starts)}: cost {brief(tried[-1].cost, 4)}")
    best = tried[0]
    for other in tried[1:]:
        if other.cost < _BETTER * best.cost:
            best = other
    elsewhere = _alike([best, *(s for s in tried if s is not best)])
    return replace(best, evaluations=sum(s.evaluations for s in tried), elsewhere=elsewhere)


def _regressed(thin: Problem, box: Box, how: SearchSettings) -> tuple[np.ndarray | None, Rung | None]:
    """A start by equation error, refined by instrumental variables where they converge, and its rung."""
    regression = make_regression(thin, how.unit_time)
    if not regression.covered:
        return None, None
    result = least_squares(regression, box, _ROUGH)
    method: Method = "equation-error"
    found = result
    if result.converged:
        refined = instrumental_variables(result, box)
        if refined.converged and _inside(refined, box):
            method, found = "instrumental-variables", refined
    start = thin.first_guess(found.parameters(box))
    residual, jacobian = thin.residuals(start)
    at = Solution(thin, start, residual, jacobian, found.converged, found.message, 1)
    lacking = f" Not reached: {', '.join(regression.lacking)}." if regression.lacking else ""
    return start, _rung(method, at, f"a start: {found.message}{lacking}")


def _inside(result: EquationErrorResult, box: Box) -> bool:
    values = result.parameters(box)
    at = [result.regression.problem.estimated.index(n) for n in result.regression.covered]
    return bool(np.array_equal(values[at], result.theta[: len(at)]))


def _by_equation_error(problem: Problem, box: Box, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    return _by_regression(problem, box, how, "equation-error")


def _by_instrumental_variables(problem: Problem, box: Box, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    return _by_regression(problem, box, how, "instrumental-variables")


def _by_regression(
    problem: Problem, box: Box, how: SearchSettings, method: Method
) -> tuple[Solution, tuple[Rung, ...]]:
    regression = make_regression(problem, how.unit_time)
    if regression.lacking:
        name, why = next(iter(regression.lacking.items()))
        raise NotRegressableError(
            f"method {method} cannot find '{name}' of model {problem.model.name}: {why}. Measure it, hold '{name}' fixed, "
            "or let output error find it (no --method)."
        )
    first = least_squares(regression, box)
    second = instrumental_variables(first, box) if first.converged else first
    result = first if method == "equation-error" else second
    reason = f"asked for; {result.message}"
    if second.converged and second is not first:
        spread = np.sqrt(np.clip(np.diag(first.covariance()), 0.0, None))
        away = np.abs(second.theta - first.theta)[: len(spread)] / np.maximum(spread, 1e-300)
        worst = int(np.argmax(away))
        reason += (
            f" Least squares and instrumental variables differ most in {regression.covered[worst]}, by "
            f"{away[worst]:.1f} standard deviations: noise in the regressors."
        )
    message = f"{result.message} Standard deviations count the scatter of the equations, not their bias."
    solution = with_own_unknowns(problem, result.parameters(box), result.covariance(), how.weigh)
    solution = replace(solution, converged=result.converged and solution.converged, message=message + solution.message)
    thin = thinned(problem, how.unit_time)
    at = replace(solution, problem=thin, residual=thin.residuals(solution.q)[0])
    return solution, (_rung(method, at, reason, used=True, converged=result.converged),)


def _by_prediction_error(problem: Problem, box: Box, how: SearchSettings) -> tuple[Solution, tuple[Rung, ...]]:
    """Output error for a start, then the likelihood through the filter; initial states and biases by output error again."""
    refuse_estimated_delay(problem.model, problem.estimated, "Prediction error")
    best = _from_starts(thinned(problem, how.unit_time), make_starts(box, how.starts, how.seed), box, how)
    start = refine(problem, best, box, how.weigh, how.tell)
    rungs = [_rung("output-error", best, f"a start: {start.message}", converged=start.converged)]
    if not start.finite:
        return start, (replace(rungs[0], used=True, reason="the model runs away from every start."),)
    seen = replace(problem, sigma=residual_levels(start))
    shared = len(problem.estimated)
    levels = fit_levels(seen, box, start.q[:shared], how.unit_time, how.tell)
    residuals = [np.array(trial) for trial in start.problem.by_signal(start.residual)]
    numbers = len(levels.sensors) + len(levels.process) + 3 * len(levels.gusts) + shared + levels.biases.size
    sigma, likely = start.problem.sigma, levels.log_likelihood
    levels = replace(levels, lasting=lasting_sensors(residuals, sigma, start.q.size, likely, numbers))
    reason = f"{levels.message} Log-likelihood {brief(levels.log_likelihood, 6)} after {levels.evaluations} passes."
    own = with_own_unknowns(problem, levels.parameters, levels.covariance, how.weigh)
    found = replace(
        own, converged=own.converged and levels.converged, message=f"{levels.message}{own.message}", levels=levels
    )
    thin = thinned(problem, how.unit_time)
    at = replace(found, problem=thin, residual=thin.residuals(found.q)[0])
    rungs.append(_rung("prediction-error", at, reason, used=True, converged=levels.converged))
    return found, tuple(rungs)


def with_own_unknowns(problem: Problem, values: np.ndarray, covariance: np.ndarray, weigh: bool) -> Solution:
    """Return coefficients of another method with initial states and biases of each trial by output error.

    Parameters
    ----------
    problem : Problem
        The problem.
    values : ndarray, shape (parameters,)
        The coefficients, SI.
    covariance : ndarray, shape (parameters, parameters)
        Their covariance.
    weigh : bool
        Whether noise levels are estimated from the residuals.

    Returns
    -------
    Solution
        With the covariance of all unknowns; it converged where the model does not run away with these coefficients.
    """
    shared = values.size
    held = replace(problem, estimated=(), fixed={**problem.fixed, **dict(zip(problem.estimated, values))})
    own = minimise_robustly(held, held.first_guess(np.zeros(0)), EMPTY, most=50)
    if weigh and own.finite:
        own = minimise_robustly(replace(own.problem, sigma=residual_levels(own)), own.q, EMPTY, most=50)
    q = np.concatenate([values, own.q])
    seen = replace(problem, sigma=own.problem.sigma, weights=own.problem.weights)
    residual, jacobian = seen.residuals(q)
    # The unknowns of each trial depend on the coefficients, and have a scatter of their own.
    follows = -np.linalg.pinv(jacobian[:, shared:]) @ jacobian[:, :shared]
    both = np.vstack([np.eye(shared), follows])
    known = np.isfinite(np.diag(covariance))
    matrix = both @ np.where(np.outer(known, known), covariance, 0.0) @ both.T
    lost = np.flatnonzero(~known)
    matrix[lost, :] = matrix[:, lost] = 0.0
    matrix[lost, lost] = np.inf
    matrix[shared:, shared:] += covariance_of(own).matrix
    message = "" if own.finite else " Run over a whole record, the model runs away with these coefficients."
    return Solution(seen, q, residual, jacobian, own.finite, message, own.evaluations, matrix)


def _starts(how: SearchSettings) -> str:
    return "one start" if how.starts == 1 else f"{how.starts} starts"


def _rung(method: Method, at: Solution, reason: str, *, used: bool = False, converged: bool | None = None) -> Rung:
    cost = at.cost if at.finite else None
    return Rung(method, cost, at.converged if converged is None else converged, used, reason, at.evaluations)


_METHODS: dict[Method | None, Callable[[Problem, Box, SearchSettings], tuple[Solution, tuple[Rung, ...]]]] = {
    None: _by_the_ladder,
    "output-error": _by_output_error,
    "equation-error": _by_equation_error,
    "instrumental-variables": _by_instrumental_variables,
    "multiple-shooting": _by_multiple_shooting,
    "prediction-error": _by_prediction_error,
}
