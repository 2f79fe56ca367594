"""The bands on the page hold what the predictor knows of its own errors."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import shipid
from shipid.bridge.core.console import SteeringOrder
from shipid.bridge.core.forecast import Forecaster, Question
from shipid.bridge.own_ship.remembered import Remembered
from shipid.parameters.parameter_set import Value
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

from ..conftest import sail

STEERS = SteeringOrder("heading", 0.5, 0.2, 0.005, 0.0)


def test_the_predictions_along_the_voyage_are_looked_back_at(make_core, pilot):
    core = make_core()
    sail(core, 60)
    core.command({"command": "trial", "heading": 0.7})
    core.command({"command": "execute"})
    sail(core, 240)
    past = core.own_ship.remembered.past()
    assert len(past.situations) >= 5 and past.sailed[-1] == pytest.approx(9.5 * (past.t[-1] - past.t[0]), rel=0.1)
    known = core.own_ship.situation
    forecaster = Forecaster(TrackPredictor(pilot), 2.0)
    before = forecaster.answer(Question(core.t, known, STEERS)).trial
    right = forecaster.answer(Question(core.t, known, STEERS, past=past)).trial
    assert "as wide" not in right.message
    # As if the ship had turned the other way under the rudder that was laid.
    mirrored = dataclasses.replace(past, delta=-past.delta)
    wider = forecaster.answer(Question(core.t, known, STEERS, past=mirrored)).trial
    assert "times as wide as the model states" in wider.message
    assert wider.track.half_width[-1] > 1.5 * before.track.half_width[-1]
    # It stays until it is looked at again.
    assert forecaster.answer(Question(core.t, known, STEERS)).trial.message == wider.message


def test_an_identified_ship_has_the_error_of_her_model_in_the_band(pilot):
    sure = Value("K", 1.6, "1", "identified", std=0.05)
    ship = pilot.ship
    sections = {**ship.sections, "de-keizer": {**ship.sections["de-keizer"], "K": sure}}
    found = shipid.design_autopilot(pilot.model, dataclasses.replace(ship, sections=sections))
    known = Situation({"psi": 0.0, "u": 9.5, "r": 0.0}, ("psi",), np.array([[1e-6]]))
    stated, identified = (
        Forecaster(TrackPredictor(p), 2.0).answer(Question(0.0, known, STEERS)).trial.track for p in (pilot, found)
    )
    assert (identified.half_width[100:] > 2 * stated.half_width[100:]).all()


def test_what_is_remembered_is_bounded_and_forgotten():
    remembered = Remembered(100.0)
    values = {"x": 0.0, "y": 0.0, "psi": 0.0, "u": 10.0, "delta": 0.0}
    assert remembered.past() is None
    for k in range(20_000):
        remembered.add(Situation({**values, "x": k * 1.0}, t=0.1 * k))
    past = remembered.past()
    assert past.t.size == 530 and np.allclose(np.diff(past.t), 1.0) and past.t[-1] == pytest.approx(1999.0)
    assert len(past.situations) == 30 and past.situations[0].t >= past.t[0]
    assert np.allclose(np.diff([s.t for s in past.situations]), 15.0)
    remembered.forget()
    assert remembered.past() is None
    remembered.add(Situation({"psi": 0.0, "u": 10.0}))
    assert remembered.past() is None
