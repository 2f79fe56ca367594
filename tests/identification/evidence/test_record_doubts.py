"""Records that are no evidence: one that stands twice, one that was fitted and is predicted, one of a ship of another length."""

from __future__ import annotations

from dataclasses import replace

import pytest

import shipid
from shipid.identification.evidence.record_doubts import SEEN_BEFORE, TRIAL_TWICE
from shipid.parameters.catalogue import find_ship
from shipid.parameters.replaced import with_values
from shipid.trials.signals.ship_length import SHIP_LENGTH


@pytest.fixture(scope="module")
def trials():
    one, other = (
        shipid.simulate("nomoto", ship="zeefakkel", manoeuvre="zigzag:20/20", noise="standard", seed=k) for k in (1, 2)
    )
    return one, replace(other, name="other")


def kinds(result):
    return {n.kind: n for n in result.warnings}


def test_a_trial_that_stands_twice_is_told(trials):
    one, other = trials
    twice = kinds(shipid.identify("nomoto", [one, replace(one, name="copy")], ship="zeefakkel", starts=1))
    assert twice[TRIAL_TWICE].serious and "and copy hold the same samples" in twice[TRIAL_TWICE]
    assert not {TRIAL_TWICE, SEEN_BEFORE, SHIP_LENGTH} & set(
        kinds(shipid.identify("nomoto", [one, other], ship="zeefakkel", starts=1))
    )


def test_a_prediction_of_a_fitted_trial_shows_nothing(trials):
    one, other = trials
    fit = shipid.identify("nomoto", [one], ship="zeefakkel", starts=1, validate=[one])
    assert "which was fitted: that it is predicted shows nothing" in kinds(fit)[SEEN_BEFORE]
    assert "that it is predicted shows nothing" in fit.text()
    assert SEEN_BEFORE not in kinds(shipid.identify("nomoto", [one], ship="zeefakkel", starts=1, validate=[other]))


def test_a_ship_of_another_length_is_told(trials):
    longer = with_values(find_ship("zeefakkel"), {"L": "450 m"})
    found = kinds(shipid.identify("nomoto", list(trials), ship=longer, starts=1))
    assert found[SHIP_LENGTH].serious


def test_a_comparison_does_not_leave_out_what_it_has_fitted(trials):
    one = trials[0]
    ranking = shipid.compare_models(["nomoto"], [one, replace(one, name="copy")], ship="zeefakkel", starts=1, workers=1)
    assert kinds(ranking)[TRIAL_TWICE].serious
