from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

UNCERTAIN = ("x", "y", "psi", "r", "u", "K", "current_north")
STD = np.array([10.0, 8.0, 0.01, 2e-4, 0.1, 0.02, 0.1])


@pytest.fixture(scope="session")
def pilot():
    """The autopilot of the container ship as the commands design it, by De Keizer's model."""
    return shipid.design_autopilot("de-keizer", "soesterberg")


@pytest.fixture(scope="session")
def predictor(pilot):
    return TrackPredictor(pilot)


@pytest.fixture(scope="session")
def placed():
    """Under the course changer of the thesis, whose poles are placed and which has no integral."""
    return TrackPredictor(shipid.design_autopilot("de-keizer", "soesterberg", design="pole", damping=0.85))


@pytest.fixture(scope="session")
def first_order(pilot):
    return TrackPredictor(pilot, model="first-order")


@pytest.fixture
def situation():
    """A straight course to the north-east in a current, not quite known."""
    values = {
        "x": 100.0,
        "y": -50.0,
        "psi": 0.7,
        "u": 9.5,
        "r": 0.0,
        "K": 1.6,
        "current_north": 0.5,
        "current_east": -0.2,
    }
    mixed = np.diag(STD) @ (np.eye(7) + 0.3 * np.eye(7, k=1) + 0.3 * np.eye(7, k=-1)) @ np.diag(STD)
    return Situation(values, UNCERTAIN, mixed)
