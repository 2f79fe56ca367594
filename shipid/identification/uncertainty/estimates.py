"""From the end of the search to named estimates, with published coefficients computed from the fitted ones."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np
from scipy.special import stdtrit

from shipid.declaration.model import Entry, Model, reads_of
from shipid.declaration.scale import Scale, prime_exponents
from shipid.estimation.estimate import Estimate, estimate_of
from shipid.estimation.standing import AT_BOUND, DETERMINED, UNKNOWN, Standing, standing_of
from shipid.foundation.errors import UnitError
from shipid.foundation.statistics import plain
from shipid.generation.simulator import coefficient_vector
from shipid.generation.system import generate
from shipid.identification.problem.box import Box
from shipid.identification.problem.output_error import Problem
from shipid.identification.uncertainty.covariance import correlation_of, verdict

#: A larger correlation says that two coefficients trade off.
_TRADED = 0.9


def estimates_of(
    problem: Problem,
    q: np.ndarray,
    covariance: np.ndarray,
    box: Box,
    scale: Scale,
    unseen: Mapping[str, str] | None = None,
    degrees: np.ndarray | None = None,
    elsewhere: Collection[str] = (),
) -> dict[str, Estimate]:
    """Return the fitted coefficients and the published ones that follow from them.

    Parameters
    ----------
    problem : Problem
        What was solved.
    q : ndarray, shape (unknowns,)
        The unknowns.
    covariance : ndarray, shape (parameters, parameters)
        Covariance of the fitted coefficients.
    box : Box
        Their bounds and first values.
    scale : Scale
        L and U, for the prime system.
    unseen : mapping of str to str, optional
        Coefficients about which the trials hold no information, and what was done with their values, in words.
    degrees : ndarray, shape (parameters,), optional
        Degrees of freedom of each variance, for Student's quantile; the normal one by default.
    elsewhere : collection of str
        Of these, the ones that have other values where the trials are fitted as well: what follows from them has, too.

    Returns
    -------
    dict of str to Estimate
    """
    correlation, names = correlation_of(covariance), problem.estimated
    result = {}
    for i, name in enumerate(names):
        entry, value = problem.model[name], float(q[i])
        std = float(np.sqrt(covariance[i, i]))
        order = np.argsort(-np.abs(correlation[i]))
        strong = [
            f"{names[j]} ({correlation[i, j]:+.2f})" for j in order if j != i and abs(correlation[i, j]) > _TRADED
        ]
        size = max(abs(float(box.start[i])), abs(scale.start_of(entry) or 0.0))
        _, before = (None if problem.prior is None else problem.prior.parameters.get(name)) or (0.0, np.inf)
        standing = verdict(value, std, size, box.low[i], box.high[i], " and ".join(strong), before)
        if name in (unseen or {}):
            standing = UNKNOWN, (unseen or {})[name]
        found = _estimate(entry, value, std, standing, False, scale)
        if degrees is not None and found.ci95 is not None:
            half = float(stdtrit(degrees[i], 0.975)) * std
            found = replace(found, ci95=(value - half, value + half))
        result[name] = found
    at_bound = [i for i, n in enumerate(names) if result[n].why.startswith(AT_BOUND)]
    for i, name in enumerate(names):
        if i not in at_bound:
            result[name] = _as_bounded(result[name], {names[j]: correlation[i, j] for j in at_bound})
    return result | _published(problem, q, covariance, scale, at_bound, elsewhere)


def _as_bounded(found: Estimate, at_bound: Mapping[str, float]) -> Estimate:
    """The same, not determined where it trades off with a coefficient that ended at its bound: at another bound it is another.

    What is given is its correlation with each of these.
    """
    strong = [n for n, c in at_bound.items() if abs(c) > _TRADED]
    if not strong or found.standing != DETERMINED:
        return found
    which = "which ended at its bound" if len(strong) == 1 else "which ended at their bounds"
    return replace(found, standing=UNKNOWN, why=f"it trades off with {' and '.join(strong)}, {which}.")


def without_values(parameters: Mapping[str, Estimate], why: str) -> dict[str, Estimate]:
    """Return estimates of which none is determined, without a number that could be taken for one.

    Parameters
    ----------
    parameters : mapping of str to Estimate
        The estimates.
    why : str
        Why none is determined, a sentence.
    """
    return {
        n: replace(e, value=None, std=None, ci95=None, prime=None, standing=UNKNOWN, why=why, withheld=True)
        for n, e in parameters.items()
    }


def published_names(model: Model) -> list[str]:
    """Return the coefficients of the literature that follow from the declared ones of a model.

    Parameters
    ----------
    model : Model
        The model.
    """
    read = set().union(*(reads_of(model, model[p]) for p in model.parameters if model[p].equation is not None), set())
    return [n for n in model.derived if n in read]


def unseen_words(values: Mapping[str, float], stated: Mapping[str, tuple[float, float | None]]) -> dict[str, str]:
    """Return what is done with coefficients about which the trials hold no information, in words, by name.

    Parameters
    ----------
    values : mapping of str to float
        Those coefficients, SI.
    stated : mapping of str to (float, float or None)
        What was known of coefficients beforehand: value and standard deviation, SI.
    """
    words = {}
    for name, value in values.items():
        known, std = stated.get(name, (None, None))
        if known is None:
            kept = "the identified ship leaves it out"
        elif not is_as_stated(value, known):
            kept = "with the others it is the nearest to what was known beforehand"
        else:
            kept = "it keeps the value known beforehand" + (" and its standard deviation" if std is not None else "")
        words[name] = f"the trials hold no information about it alone; {kept}."
    return words


def is_as_stated(value: float, stated: float) -> bool:
    """Return whether a coefficient is where it was before the trials, but for rounding.

    Parameters
    ----------
    value, stated : float
        After and before, SI.
    """
    return abs(value - stated) <= 1e-6 * abs(stated)


def _estimate(
    entry: Entry, value: float, std: float, standing: tuple[Standing, str], follows: bool, scale: Scale
) -> Estimate:
    """An estimate by the verdict on it, with its other form."""
    found = estimate_of(entry, value, std, standing=standing, follows=follows)
    prime, prime_unit = _other_form(entry, value, scale)
    return replace(found, prime=plain(prime), prime_unit=prime_unit)


def _other_form(entry: Entry, value: float, scale: Scale) -> tuple[float | None, str]:
    """The prime form of a dimensional coefficient, or the dimensional form of a dimensionless one."""
    dimensional = entry.quantity.dimensional
    if dimensional:
        return value * scale.factor(dimensional), dimensional
    try:
        exponents = prime_exponents(entry.unit)
    except UnitError:  # a unit with mass in it has no prime form in L and U
        return None, ""
    return (value / scale.factor(entry.unit), "1") if any(exponents) else (None, "")


def _published(
    problem: Problem,
    q: np.ndarray,
    covariance: np.ndarray,
    scale: Scale,
    at_bound: Sequence[int],
    elsewhere: Collection[str],
) -> dict[str, Estimate]:
    """Coefficients of the literature that follow from fitted ones, with the standard deviation by first order."""
    model = problem.model
    system = generate(model)
    # At the loading of the ship a coefficient is no number (`shipid.identification.validation.loadings`).
    wanted = [n for n in published_names(model) if not system.inputs_behind([n])]
    if not wanted:
        return {}
    expression = system.expression(wanted)
    function = ca.Function("published", [system.p], [expression, ca.jacobian(expression, system.p)])
    numbers, slopes = function(coefficient_vector(model, problem.values(q)))
    slope = slopes.full()[:, [system.coefficients.index(n) for n in problem.estimated]]
    result = {}
    for i, name in enumerate(wanted):
        value = float(numbers[i])
        by = np.flatnonzero(slope[i])
        block = covariance[np.ix_(by, by)]
        variance = float(slope[i, by] @ block @ slope[i, by]) if np.isfinite(block).all() else float("inf")
        std = float(np.sqrt(variance)) if np.isfinite(variance) and variance >= 0 else float("inf")
        standing = standing_of(value, std, size=abs(scale.start_of(model[name]) or 0.0))
        if not np.isfinite(value):
            standing = UNKNOWN, "it does not exist for these coefficients."
        elif standing[0] == UNKNOWN:
            standing = UNKNOWN, "the fitted coefficients it follows from do not determine it."
        with_bounds = {
            problem.estimated[j]: float(slope[i, by] @ covariance[by, j]) / (std * np.sqrt(covariance[j, j]))
            for j in at_bound
            if 0 < std * covariance[j, j] < np.inf
        }
        found = _as_bounded(_estimate(model[name], value, std, standing, True, scale), with_bounds)
        open_ones = [problem.estimated[j] for j in by if problem.estimated[j] in elsewhere]
        if open_ones and found.standing != UNKNOWN:
            why = f"it follows from {' and '.join(open_ones)}, of which other values fit the trials as well."
            found = replace(found, standing=UNKNOWN, why=why)
        result[name] = found
    return result
