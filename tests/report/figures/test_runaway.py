"""A prediction runs away where it leaves ten spans of the record, or all numbers."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.identification.validation.comparison import Comparison
from shipid.identification.validation.trial_measures import TrialMeasures
from shipid.report.figures.runaway import good_samples, runaway


@pytest.fixture
def compared():
    """Compare a record of twenty seconds whose rate of turn is a line from zero to `reach` with a prediction of it."""

    def make(reach: float, change: dict[int, float]) -> Comparison:
        t = np.arange(21.0)
        columns = {"t [s]": t, "psi [rad]": 0.0 * t, "r [rad/s]": reach * t / 20, "delta [rad]": 0.1 + 0.0 * t}
        predicted = columns["r [rad/s]"].copy()
        for k, value in change.items():
            predicted[k] = value
        trial = shipid.Trial.from_frame(pd.DataFrame(columns))
        return Comparison(trial, {"r": predicted}, {}, TrialMeasures("", None, None))

    return make


def test_a_signal_that_does_not_move_is_met_exactly(compared):
    same = compared(0.0, {})
    assert runaway(same) is None and good_samples(same) == 21


@pytest.mark.parametrize(
    ("value", "lost"), [(0.0035 + 0.099, False), (0.0035 + 0.101, True), (0.2, True), (-0.2, True), (np.nan, True)]
)
def test_ten_spans_away(compared, value, lost):
    """The record spans 0.01 rad/s."""
    found = compared(0.01, {7: value})
    assert runaway(found) == (7.0 if lost else None)
    assert good_samples(found) == (7 if lost else 21)
