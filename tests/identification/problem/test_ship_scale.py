"""The scale of a ship in one trial: her length, and the speed before the manoeuvre."""

import numpy as np
import pandas as pd
import pytest

from shipid import Trial, find_ship
from shipid.identification.problem.ship_scale import scale_before, scale_of

T = np.arange(0.0, 1500.0, 0.5)


def hard_turn(execute: float, **columns: np.ndarray) -> Trial:
    """A tanker of 8 m/s that loses two thirds of her speed in a turn, as KVLCC2 with the rudder hard over."""
    later = np.maximum(T - execute, 0.0)
    speed = 8.0 - 5.3 * (1 - np.exp(-((later / 130.0) ** 2)))
    delta = np.where(execute <= T, np.deg2rad(35.0), 0.0)
    return Trial("turn", pd.DataFrame({"t": T, "delta": delta, "u": speed, "psi": 0.0 * T, **columns}))


@pytest.mark.parametrize("execute", [5.0, 12.0, 60.0])
def test_a_ship_that_loses_her_speed_in_a_turn_is_scaled_with_that_before_it(execute):
    ship, trial = find_ship("kvlcc2"), hard_turn(execute)
    assert scale_of(ship, [trial]).speed < 3.0
    scale = scale_before(ship, trial)
    assert scale.length == 320.0
    assert scale.speed == pytest.approx(8.0, rel=0.01)


def test_a_trial_without_a_speed_has_that_of_the_ship():
    ship = find_ship("kvlcc2")
    assert scale_before(ship, hard_turn(5.0, u=np.full(T.size, np.nan))) == scale_of(ship, [])
