"""Modes of a tracker, and a target that turns."""

import numpy as np
import pytest

from shipid import InteractingMultipleModel, Mode
from shipid.estimation.multiple.first_state import FirstState
from shipid.models import constant_velocity, coordinated_turn

RATE = np.deg2rad(5.6)
STAY = [[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]


@pytest.fixture(scope="package")
def turning_modes():
    """Two turns at a fixed rate, and a straight course."""
    return {
        "port": Mode(coordinated_turn, inputs={"omega": (-RATE, "rad/s")}),
        "straight": Mode(constant_velocity),
        "starboard": Mode(coordinated_turn, inputs={"omega": (RATE, "rad/s")}),
    }


@pytest.fixture(scope="package")
def tracker(turning_modes):
    """Return the interacting filter over these modes, with settings."""
    given = {
        "measured": {"x": "85 m", "y": "85 m"},
        "noise": {"ax": "1.8 m/s^2", "ay": "1.8 m/s^2"},
        "probabilities": [0.1, 0.8, 0.1],
    }
    return lambda **settings: InteractingMultipleModel(turning_modes, STAY, **(given | settings))


@pytest.fixture(scope="package")
def track():
    """400 scans, straight and with turns to both sides, with the first state of the two-point start."""
    rng = np.random.default_rng(7)
    rate = np.zeros(400)
    rate[55:120], rate[180:240], rate[285:315] = 0.03, -0.05, RATE
    course = np.cumsum(rate)
    truth = np.cumsum(300 * np.column_stack([np.cos(course), np.sin(course)]), axis=0)
    z = truth + 85 * rng.standard_normal(truth.shape)
    record = {"t": np.arange(400.0), "x": z[:, 0], "y": z[:, 1]}
    first = FirstState(
        ("x", "vx", "y", "vy"),
        np.array([z[1, 0], z[1, 0] - z[0, 0], z[1, 1], z[1, 1] - z[0, 1]]),
        85.0**2 * np.kron(np.eye(2), [[1.0, 1.0], [1.0, 2.0]]),
    )
    return record, first, truth
