"""From the end of the search to named estimates, with published coefficients worked out of the fitted ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from shipid.declaration.model import Entry, Model, reads_of
from shipid.declaration.scale import prime_exponents, prime_factor
from shipid.generation.system import generate
from shipid.identification.fit import Estimate
from shipid.identification.search.least_squares import Box
from shipid.identification.uncertainty.covariance import correlation_of, verdict

#: Half width of a 95 % interval in standard deviations.
_Z95 = 1.959963984540054


def estimates_of(
    model: Model,
    names: Sequence[str],
    fixed: Mapping[str, float],
    values: np.ndarray,
    covariance: np.ndarray,
    box: Box,
    length: float,
    speed: float,
) -> dict[str, Estimate]:
    """Return the fitted coefficients and the published ones that follow from them.

    Parameters
    ----------
    model : Model
        The fitted model.
    names : sequence of str
        Fitted coefficients.
    fixed : mapping of str to float
        All others, SI.
    values : ndarray, shape (names,)
        Their estimates, SI.
    covariance : ndarray, shape (names, names)
        Their covariance.
    box : Box
        Their bounds and first values.
    length, speed : float
        L in m and U in m/s, for the prime system.

    Returns
    -------
    dict of str to Estimate
    """
    correlation = correlation_of(covariance)
    result = {}
    for i, name in enumerate(names):
        entry = model[name]
        spread = float(np.sqrt(covariance[i, i]))
        order = np.argsort(-np.abs(correlation[i]))
        strong = [f"{names[j]} ({correlation[i, j]:+.2f})" for j in order if j != i and abs(correlation[i, j]) > 0.9]
        size = max(abs(float(box.start[i])), _declared_size(entry, length, speed))
        why = verdict(float(values[i]), spread, size, box.low[i], box.high[i], " and ".join(strong))
        result[name] = _estimate(entry, float(values[i]), spread, why, False, length, speed)
    result |= _published(model, names, fixed, values, covariance, length, speed)
    return result


def _declared_size(entry: Entry, length: float, speed: float) -> float:
    """The declared start in SI: a typical size of the coefficient."""
    start = abs(entry.number("start") or 0.0)
    return start * prime_factor(entry.unit, length, speed) if entry.quantity.prime else start


def _estimate(
    entry: Entry, value: float, spread: float, why: str, follows: bool, length: float, speed: float
) -> Estimate:
    finite = np.isfinite(spread)
    prime, prime_unit = _other_form(entry, value, length, speed)
    return Estimate(
        entry.name,
        entry.unit,
        entry.quantity.meaning,
        value if np.isfinite(value) else None,
        spread if finite else None,
        (value - _Z95 * spread, value + _Z95 * spread) if finite and np.isfinite(value) else None,
        not why,
        why,
        follows,
        prime if prime is not None and np.isfinite(prime) else None,
        prime_unit,
    )


def _other_form(entry: Entry, value: float, length: float, speed: float) -> tuple[float | None, str]:
    """The prime form of a dimensional coefficient, or the dimensional form of a dimensionless one."""
    dimensional = entry.quantity.dimensional
    if dimensional:
        return value * prime_factor(dimensional, length, speed), dimensional
    try:
        exponents = prime_exponents(entry.unit)
    except Exception:  # a unit with mass in it has no prime form in L and U
        return None, ""
    return (value / prime_factor(entry.unit, length, speed), "1") if any(exponents) else (None, "")


def _published(
    model: Model,
    names: Sequence[str],
    fixed: Mapping[str, float],
    values: np.ndarray,
    covariance: np.ndarray,
    length: float,
    speed: float,
) -> dict[str, Estimate]:
    """Coefficients of the literature that follow from fitted ones, with the standard deviation by first order."""
    read = set().union(*(reads_of(model, model[p]) for p in model.parameters if model[p].equation is not None), set())
    wanted = [n for n in model.derived if n in read]
    if not wanted:
        return {}
    system = generate(model)
    expression = system.expression(wanted)
    function = ca.Function("published", [system.p], [expression, ca.jacobian(expression, system.p)])
    numbers, slopes = function(system.vector(system.coefficients, {**fixed, **dict(zip(names, values))}))
    columns = [system.coefficients.index(n) for n in names]
    slope = slopes.full()[:, columns]
    result = {}
    for i, name in enumerate(wanted):
        value = float(numbers[i])
        variance = float(slope[i] @ covariance @ slope[i]) if np.isfinite(covariance).all() else float("inf")
        spread = float(np.sqrt(variance)) if np.isfinite(variance) and variance >= 0 else float("inf")
        why = ""
        if not np.isfinite(value):
            why = "it does not exist for these coefficients."
        elif not np.isfinite(spread) or spread > 0.5 * abs(value):
            why = "the fitted coefficients it follows from leave it open."
        result[name] = _estimate(model[name], value, spread, why, True, length, speed)
    return result
