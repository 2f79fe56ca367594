"""The error of a structure: pooled from what was left out, wider beyond the amplitudes that were fitted."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

import shipid
from shipid.identification.validation.left_out import left_out, records_of
from shipid.identification.validation.structure_error import USUAL, StructureError, growth_of, structure_error


def missed(by: float, count: int = 2) -> SimpleNamespace:
    """A left-out zig-zag whose overshoots are missed by so much."""
    measured = (0.2,) * count
    comparison = SimpleNamespace(overshoots=measured, predicted_overshoots=tuple(m + by for m in measured))
    return SimpleNamespace(comparison=comparison, swings=SimpleNamespace(overshoots=(0.2 + 2 * by,) * count))


def test_errors_of_left_out_trials_are_pooled_with_what_is_usual():
    found = structure_error([missed(0.05), missed(0.05)])
    assert found.degrees == 8.0 and found.trials == 2
    assert found.open_loop == pytest.approx(np.sqrt((4 * USUAL**2 + 4 * 0.05**2) / 8))
    assert found.closed_loop == pytest.approx(np.sqrt((4 * USUAL**2 + 4 * 0.1**2) / 8))
    assert structure_error([]) == StructureError()
    # Student's quantile with four degrees of freedom is 2.776.
    assert StructureError().half_width(False, 2.0) == pytest.approx(2.776 * 2 * USUAL, rel=1e-3)


def test_a_swing_that_is_not_reached_is_missed_whole():
    lost = missed(0.0)
    lost.swings.overshoots = (None, None)
    assert structure_error([lost]).closed_loop == pytest.approx(np.sqrt((4 * USUAL**2 + 2 * 0.2**2) / 6))


@pytest.fixture(scope="module")
def fit(sail):
    trials = [sail("norrbin", "zeefakkel", m, seed=i, name=m) for i, m in enumerate(("zigzag:10/10", "zigzag:-10/10"))]
    hard = sail("norrbin", "zeefakkel", "turn:35", seed=3, name="hard")
    return shipid.identify("norrbin", trials, ship="zeefakkel", starts=1, validate=[hard])


def test_bands_grow_beyond_the_amplitudes_that_were_fitted(fit):
    growths = [growth_of(fit.model, fit.ship, c) for c in (*fit.fitted, *fit.validation)]
    assert growths[:2] == [1.0, 1.0] and growths[2] == pytest.approx(3.0, rel=0.1)
    assessed = shipid.assess(fit, findings=False)
    manoeuvre = assessed.assessment.manoeuvres["hard"]
    assert manoeuvre.growth == pytest.approx(growths[2])
    assert manoeuvre.to_dict()["times_beyond_fitted"] == pytest.approx(growths[2], abs=1e-3)
    value = manoeuvre.turn["tactical_diameter"]
    # 5 % of structure, as many times as the rudder goes beyond, either side.
    assert value.band95[1] - value.predicted >= 1.96 * 0.05 * growths[2] * value.predicted
    assert f"hard: {growths[2]:.1f} times" in assessed.text() and assessed.assessment.structure.trials == 2


def test_each_record_is_left_out_and_predicted_by_the_others(fit):
    records = records_of(fit.fitted)
    assert records == ((0,), (1,))
    found = left_out(fit.identified, fit.fitted, records)
    for (one,), c in zip(found, fit.fitted):
        assert one.comparison.trial is c.trial and len(one.swings.overshoots) == len(c.overshoots)
        # The model is right: what is left is noise, and the prediction is as good as the fit within a few times of it.
        assert one.comparison.rmse["r"] < 3 * c.rmse["r"]
    # What a trial holds does not reach the fit that predicts it.
    spoilt = [
        dataclasses.replace(d, measured=d.measured * (2.0 if i == 0 else 1.0))
        for i, d in enumerate(fit.identified.problem.trials)
    ]
    problem = dataclasses.replace(fit.identified.problem, trials=tuple(spoilt))
    solution = dataclasses.replace(fit.identified.solution, problem=problem)
    again = left_out(dataclasses.replace(fit.identified, solution=solution), fit.fitted, records[:1])
    assert again[0][0].comparison.rmse["r"] == pytest.approx(found[0][0].comparison.rmse["r"], rel=1e-3)
