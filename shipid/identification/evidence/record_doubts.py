"""What makes records no evidence: one that stands twice among the trials, one that is predicted after it was fitted, one of another ship."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from shipid.foundation.notices import Notice
from shipid.identification.validation.comparison import Comparison
from shipid.trials.signals.ship_length import length_notice
from shipid.trials.trial import Trial

#: Kinds of the notices.
TRIAL_TWICE, SEEN_BEFORE = "trial-twice", "validated-on-itself"


def record_notices(
    comparisons: Sequence[Comparison], predictions: Sequence[Comparison], length: float | None
) -> list[Notice]:
    """Return notices on records that are one, and on records that no ship of this length makes.

    Parameters
    ----------
    comparisons, predictions : sequence of Comparison
        Of the trials that were fitted, and of those that were not.
    length : float or None
        Of the ship, m.
    """
    fitted, predicted = ([c.trial for c in group] for group in (comparisons, predictions))
    found = [
        Notice(
            f"trials {one.name} and {other.name} hold the same samples: they count twice, and the intervals are narrower than one record "
            "makes them. Leave one of them out.",
            TRIAL_TWICE,
            serious=True,
            trial=other.name,
        )
        for one, other in combinations(fitted, 2)
        if same_samples(one, other)
    ]
    found += [
        Notice(
            f"trial {other.name} holds the samples of {one.name}, which was fitted: that it is predicted shows nothing. Validate with "
            "another record.",
            SEEN_BEFORE,
            trial=other.name,
        )
        for one in fitted
        for other in predicted
        if same_samples(one, other)
    ]
    doubts = (length_notice(trial, length) for trial in (*fitted, *predicted))
    return found + [notice for notice in doubts if notice is not None]


def same_samples(one: Trial, other: Trial) -> bool:
    """Return whether two trials are one record, under whatever names.

    Parameters
    ----------
    one, other : Trial
        The trials.
    """
    if len(one) != len(other) or set(one.table) != set(other.table):
        return False
    return all(
        np.array_equal(
            one[n] - (one[n][0] if n == "t" else 0.0), other[n] - (other[n][0] if n == "t" else 0.0), equal_nan=True
        )
        for n in one.table
    )
