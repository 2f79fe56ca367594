"""What a model misses of the sway is not read as a current, and a current is found."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import shipid
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.own_ship_filter import BRIDGE, bridge_levels
from shipid.prediction.situations.trial_situation import known_before

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


def off(known):
    """How far the current is off, in standard deviations of a component as the filter states them, and as they are told."""
    away = float(np.hypot(*(np.array(known.current) - CURRENT)))
    return away / np.linalg.norm([known.std_of(n) for n in NAMES]) * np.sqrt(2), away / known.current_std


def test_a_current_is_found_and_a_wrong_sway_constant_is_not_taken_for_one(pilot, trial):
    instants = (160.0, 200.0, 400.0, 440.0, 780.0)

    def at_each(ship):
        return [known_before(pilot.model, ship, trial, t)[0] for t in instants]

    right = at_each(pilot.ship)
    assert max(off(known)[1] for known in right) < 2.45
    assert np.hypot(*(np.array(right[-1].current) - CURRENT)) < 0.25
    gamma = pilot.ship.sections["de-keizer"]["gamma"]
    section = {**pilot.ship.sections["de-keizer"], "gamma": dataclasses.replace(gamma, value=gamma.value + 0.3)}
    other = dataclasses.replace(pilot.ship, sections={**pilot.ship.sections, "de-keizer": section})
    wrong = at_each(other)
    assert max(off(known)[0] for known in wrong) > 3.5
    assert max(off(known)[1] for known in wrong) < 2.45


def test_instruments_suit_the_ship():
    assert bridge_levels(226.0, 9.5) == BRIDGE
    small = bridge_levels(3.0, 0.4)
    assert small["x"] == "0.75 m" and small["u"] == "0.02 m/s" and small["psi"] == BRIDGE["psi"]
    assert bridge_levels(None, None) == BRIDGE
