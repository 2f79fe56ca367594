"""Trials left out in turn: the others are fitted again from where the search ended, and predict them.

The search begins at the coefficients of all trials, so that a fit costs a few steps. The weights of the signals and the
spread of the rudder biases stay those of all trials.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.identification.identified import Identified
from shipid.identification.problem.output_error import Problem
from shipid.identification.search.least_squares import minimise_robustly
from shipid.identification.search.prediction_weights import independent_samples
from shipid.identification.validation.closed_loop import Swings
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.predictions import predict
from shipid.identification.validation.runs import swings_of
from shipid.trials.stretches import is_split

#: Runs of the trials that a fit from there may take, and the change at which it ends.
_MOST, _TOLERANCE = 60, 1e-5


@dataclass(frozen=True, eq=False)
class LeftOut:
    """A trial beside the prediction of a fit to the others.

    Attributes
    ----------
    comparison : Comparison
        The trial and its prediction with the recorded rudder.
    swings : Swings or None
        Its zig-zag in closed loop; None where it is none.
    """

    comparison: Comparison
    swings: Swings | None


def can_be_left_out(identified: Identified) -> bool:
    """Return whether a fit has trials to leave out, and a cost that can be minimised without them.

    Parameters
    ----------
    identified : Identified
        The fit.
    """
    return len(identified.problem.trials) > 1 and identified.solution.covariance is None


def records_of(comparisons: Sequence[Comparison]) -> tuple[tuple[int, ...], ...]:
    """Return the places of the trials of a fit, those that are stretches of one record together.

    Parameters
    ----------
    comparisons : sequence of Comparison
        The trials of the fit; the stretches of a record have the note that lists them in common.
    """
    found: dict[object, list[int]] = {}
    for i, c in enumerate(comparisons):
        found.setdefault(c.notes if any(is_split(n) for n in c.notes) else i, []).append(i)
    return tuple(tuple(places) for places in found.values())


def left_out(
    identified: Identified, comparisons: Sequence[Comparison], groups: Sequence[Sequence[int]]
) -> tuple[tuple[LeftOut, ...] | None, ...]:
    """Return the trials of a fit as fits to the others predict them.

    Parameters
    ----------
    identified : Identified
        The fit to all trials.
    comparisons : sequence of Comparison
        Its trials, measured, in the order of the fit.
    groups : sequence of sequence of int
        What is left out together, by the places of its trials: the stretches of one record.

    Returns
    -------
    tuple of tuple of LeftOut
        One for each group; None where the others give no finite fit.
    """
    found: list[tuple[LeftOut, ...] | None] = []
    for group in groups:
        without = _without(identified, group)
        found.append(None if without is None else tuple(_predicted(without, comparisons[i]) for i in group))
    return tuple(found)


def _without(identified: Identified, gone: Sequence[int]) -> Identified | None:
    """The same identification of the other trials."""
    whole, q = identified.problem, identified.solution.q
    kept = [i for i in range(len(whole.trials)) if i not in gone]
    if not kept:
        return None
    weights = None if whole.weights is None else tuple(whole.weights[i] for i in kept)
    problem: Problem = replace(whole, trials=tuple(whole.trials[i] for i in kept), weights=weights)
    q0 = np.concatenate([q[: len(whole.estimated)], *(q[whole.own(i)] for i in kept)])
    if weights is None:
        problem = independent_samples(problem, identified.scale.unit_time)
    solution = minimise_robustly(problem, q0, identified.box, _MOST, _TOLERANCE)
    return replace(identified, solution=solution) if solution.finite else None


def _predicted(identified: Identified, comparison: Comparison) -> LeftOut:
    found = predict(identified, comparison.trial, comparison.measures)
    return LeftOut(found, swings_of(identified, found))
