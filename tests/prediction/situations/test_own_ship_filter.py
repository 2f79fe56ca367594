"""What a model misses of the sway is not read as a current, and a current is found."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.filtered_situation import situation_of
from shipid.prediction.situations.own_ship_filter import BRIDGE, bridge_levels, own_ship_filter

CURRENT = (0.6, -0.9)
NAMES = ("current_north", "current_east")


@pytest.fixture(scope="module")
def pilot():
    return shipid.design_autopilot("de-keizer", "soesterberg")


@pytest.fixture(scope="module")
def trial(pilot):
    """Turns of 90 degrees to both sides, in a current; fixes are right to a metre."""
    noise = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "x": "1 m", "y": "1 m"}
    flow = (float(np.hypot(*CURRENT)), float(np.arctan2(CURRENT[1], CURRENT[0])))
    courses = [(100.0, 1.57), (350.0, 0.0), (600.0, 1.57)]
    return sail(pilot, courses, duration=800.0, sampling=1.0, noise=noise, seed=3, current=flow)


def off(run, at):
    """How far the current is off, in standard deviations of both components together."""
    known = situation_of(run, at)
    places = [known.uncertain.index(n) for n in NAMES]
    away = np.array(known.current) - CURRENT
    return float(np.sqrt(away @ np.linalg.solve(known.covariance[np.ix_(places, places)], away)))


def test_a_current_is_found_and_a_wrong_sway_constant_is_not_taken_for_one(pilot, trial):
    instants = (160.0, 200.0, 400.0, 440.0, 780.0)
    right = own_ship_filter("de-keizer", "soesterberg", structure=True).filter(trial)
    assert max(off(right, t) for t in instants) < 2.45
    assert np.hypot(*(np.array(situation_of(right, 780.0).current) - CURRENT)) < 0.25
    gamma = pilot.ship.sections["de-keizer"]["gamma"].value
    wrong = {"gamma": gamma + 0.3}
    plain = own_ship_filter("de-keizer", "soesterberg", values=wrong).filter(trial)
    structured = own_ship_filter("de-keizer", "soesterberg", values=wrong, structure=True).filter(trial)
    assert max(off(plain, t) for t in instants) > 3.5
    assert max(off(structured, t) for t in instants) < 2.45
    known = situation_of(structured, 780.0)
    assert not {"drift_error", "sway_error", "log_error"} & {*known.values, *known.uncertain}


def test_instruments_suit_the_ship():
    assert bridge_levels(226.0, 9.5) == BRIDGE
    small = bridge_levels(3.0, 0.4)
    assert small["x"] == "0.75 m" and small["u"] == "0.02 m/s" and small["psi"] == BRIDGE["psi"]
    assert bridge_levels(None, None) == BRIDGE
