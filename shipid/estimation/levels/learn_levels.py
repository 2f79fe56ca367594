"""Noise levels from a record: those under which it is most probable, found together with the coefficients.

Sensors differ from ship to ship, and a model of low order is never exact: neither its sensors' noise nor what drives its states
is known beforehand. Both are in the innovations (Mehra 1970; Astrom 1980). The likelihood is maximised over the levels, over
the estimated coefficients as constants, with the filter's own first standard deviations as prior, and over constant biases of
rudder and speed, on a record without its wild samples.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from shipid.estimation.design import FilterDesign, FilterSettings
from shipid.estimation.levels.ascent import Summit, climb
from shipid.estimation.levels.bias_standings import bias_standings
from shipid.estimation.levels.record_levels import BiasStanding, Judged, RecordLevels
from shipid.estimation.levels.unknowns import Unknowns
from shipid.estimation.records.arrangement import FilterRecord

#: Share of its default at which noise of a state has no influence: what remains is output error.
_NOTHING = 1e-5
#: Steps after which the search for output error ends: where it has a clear maximum, it is there in a dozen.
_MOST = 50
#: Samples beyond a gate of so many standard deviations are left out where they are few, and the search goes on; so many times.
_GATE, _FEW, _ROUNDS = 5.0, 0.1, 3
#: A standard deviation that is a larger share of that of the prior comes from the prior.
_INFORMED = 0.9


def learn_levels(
    design: FilterDesign, settings: FilterSettings, record: FilterRecord, kept: Collection[str] = ()
) -> RecordLevels:
    """Return the noise levels of a filter under which a record is most probable.

    Parameters
    ----------
    design : FilterDesign
        The filter, with the levels to start from.
    settings : FilterSettings
        What it was made of.
    record : Trial or mapping of str to ndarray
        What is filtered.
    kept : collection of str
        ``sensor:NAME`` and ``noise:NAME`` that stay as they are, and ``bias:INPUT`` that is none.

    Returns
    -------
    RecordLevels
    """
    problem = Unknowns(design, settings, record, kept)
    stays = {*kept, *(f"noise:{n}" for n in design.instruments.lost)}
    learnt = tuple(k for k in problem.keys if k not in stays)
    low, high = problem.bounds(learnt)
    found = climb(problem, problem.start(), low, high)
    for _ in range(_ROUNDS):
        if not np.isfinite(found.value) or not problem.leave_out(found.at, _GATE, _FEW):
            break
        found = climb(problem, found.at, low, high)
    good = bool(np.isfinite(found.value))
    levels = problem.levels(found.at if good else problem.middle)
    biases = problem.bias(found.at) if good and learnt else {}
    coefficients: dict[str, Judged] = {}
    standings: dict[str, BiasStanding] = {}
    if good and (problem.still or biases):
        white, correlated = problem.deviations(found)
        count = len(problem.still)
        informed = bool((np.maximum(white, correlated)[:count] < _INFORMED * problem.prior[:count]).any()) or not count
        if biases:
            sizes = problem.bias_sizes
            known = np.maximum(white, correlated)[count:] * sizes
            standings = bias_standings(design.model, biases, known, sizes, steered=problem.steered, informed=informed)
    if good and problem.still:
        simulated = _simulated(problem, found)
        for i, name in enumerate(problem.still):
            ratio = float(correlated[i] / white[i]) if white[i] > 0 else 1.0
            widening = ratio if 1.0 < ratio < np.inf else 1.0
            coefficients[name] = Judged(
                design.base[name].unit,
                float(problem.coefficients(found.at)[i]),
                float(white[i] * problem.sizes(found.at)[i]),
                widening,
                *simulated.get(name, ()),
            )
    sensors = {n: levels[f"sensor:{n}"] for n in design.measured}
    noise = {s.name: levels[f"noise:{s.name}"] for s in design.sources}
    return RecordLevels(
        sensors, noise, learnt, biases, coefficients, found.converged, found.evaluations, problem.units(), standings
    )


def _simulated(problem: Unknowns, found: Summit) -> dict[str, tuple[float, float]]:
    """Value and standard deviation of each coefficient by output error: no noise drives the ship.

    Where the model itself is declared with noise, or coefficients change, there is no such estimate.
    """
    if problem.declared or len(problem.still) < len(problem.design.parameters):
        return {}
    ended = climb(problem, *problem.without_noise(found.at, _NOTHING), _MOST)
    # Where it is not quite at its maximum, it still tells a model that does not simulate the ship.
    if not np.isfinite(ended.value):
        return {}
    white, correlated = problem.deviations(ended)
    values, sizes, prior = problem.coefficients(ended.at), problem.sizes(ended.at), problem.prior
    # One of which the record says nothing has only its prior.
    return {
        n: (float(values[i]), float(max(white[i], correlated[i]) * sizes[i]))
        for i, n in enumerate(problem.still)
        if white[i] < _INFORMED * prior[i]
    }
