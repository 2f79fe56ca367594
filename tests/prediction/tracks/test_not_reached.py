"""Orders that a ship does not reach are told, and no others."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.prediction.predict_track import predict_track

SITUATION = {"psi": 0.0, "u": 9.5}


@pytest.fixture(scope="module")
def pilot():
    return shipid.design_autopilot("de-keizer", "soesterberg")


def kinds(pilot, **order):
    found = predict_track(pilot, SITUATION, band="none", **order)
    return {w.kind: w.serious for w in found.warnings}, found


def test_a_turn_that_stops_short_is_told(pilot):
    told, found = kinds(pilot, heading="60 deg", rate="100 deg/min")
    assert told["rate-not-reached"] and np.rad2deg(found.track.psi[-1]) < 20
    assert any("the turn ends" in w and "order a slower turn" in w for w in found.warnings)
    assert "rate-not-reached" not in kinds(pilot, heading="60 deg", rate="20 deg/min")[0]


def test_a_rate_that_is_not_reached_is_told(pilot):
    told, found = kinds(pilot, rate="500 deg/min")
    assert told["rate-not-reached"] and any("8.333 deg/s is not reached, but" in w for w in found.warnings)
    assert "rate-not-reached" not in kinds(pilot, rate="-20 deg/min")[0]


def test_more_rudder_than_the_ship_has_is_told(pilot):
    told, found = kinds(pilot, rudder="50 deg")
    assert told["beyond-the-rudder"] and np.abs(found.track.delta).max() == pytest.approx(np.deg2rad(35))
    assert not kinds(pilot, heading="60 deg", rudder_limit="50 deg")[0]["beyond-the-rudder"]
    assert "beyond-the-rudder" not in kinds(pilot, rudder="35 deg")[0]
