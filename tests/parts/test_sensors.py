"""What the standard sensors are said to be worth."""

import numpy as np
import pytest

from shipid import join
from shipid.declaration.model import Evaluation
from shipid.parts.sensors import AntennaFix, FaultyCompass, FaultyGyro, FaultyLog, standard_noise


def test_standard_noise() -> None:
    degree = np.pi / 180
    assert standard_noise() == pytest.approx({"psi": 0.2 * degree, "r": 0.02 * degree, "u": 0.1, "x": 10.0, "y": 10.0})


def test_an_antenna_ahead_swings_with_the_ship() -> None:
    """60 m ahead and 5 m to starboard: heading east, 60 m to the east and 5 m to the south."""
    lever = {"x": 100.0, "y": 200.0, "antenna_ahead": 60.0, "antenna_starboard": 5.0}
    found = Evaluation(join("antenna", AntennaFix), lever | {"psi": np.pi / 2})
    assert (found["fix_north"], found["fix_east"]) == pytest.approx((95.0, 260.0))


def test_a_gyro_and_a_log_that_are_wrong() -> None:
    gyro = Evaluation(join("gyro", FaultyGyro), {"r": 0.01, "r_wave": 0.002, "r_bias": -0.001, "r_scale": 1.1})
    assert gyro["gyro"] == pytest.approx(1.1 * 0.012 - 0.001)
    assert Evaluation(join("log", FaultyLog), {"u": 5.0, "u_scale": 0.9})["log"] == pytest.approx(4.5)


@pytest.mark.parametrize("turn", [0.0, 2 * np.pi, -2 * np.pi])
def test_a_late_compass_follows_the_short_way(turn: float) -> None:
    """A heading of 3 degrees and a card at 357: it moves 6 degrees to starboard, however the turns are counted."""
    degree = np.pi / 180
    given = {
        "psi": 3 * degree + turn,
        "psi_wave": 0.0,
        "psi_behind": 357 * degree,
        "tau_compass": 2.0,
        "psi_offset": degree,
    }
    found = Evaluation(join("compass", FaultyCompass), given)
    assert found.right_hand_sides("rate")["psi_behind"] == pytest.approx(3 * degree)
    assert found["compass"] == pytest.approx(358 * degree)
