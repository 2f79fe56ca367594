from __future__ import annotations

import numpy as np
import pytest

from shipid.foundation.errors import UsageError
from shipid.models import Wind
from shipid.prediction.following.planned_track import distance_from, planned_track
from shipid.prediction.following.track_pilot import TrackPilot
from shipid.prediction.sailing.simulated_ship import SimulatedShip
from shipid.prediction.situations.situation import Situation


def sailed(pilot, predictor, plan, current=(0.0, 0.0), wind=0.0):
    inputs = {"current_north": current[0], "current_east": current[1], "wind_speed": wind, "wind_direction": 2.0}
    ship = SimulatedShip(pilot, inputs=inputs, parts=(Wind,) if wind else ())
    steering = TrackPilot(predictor, plan, rudder_limit=np.deg2rad(12))
    rows, phases = [], []
    while ship.t < 4000 and steering.phase != "arrived":
        now = ship.now
        known = {n: now[n] for n in ("x", "y", "psi", "r", "u", "v", "delta")}
        order = steering.steer(
            Situation({**known, "cruise": 9.5, "current_north": current[0], "current_east": current[1]})
        )
        rows.append((now["x"], now["y"]))
        phases.append((order.phase, order.leg, order.to_wheel_over))
        ship.advance(2.0, order.heading, order.rudder_limit)
    x, y = np.array(rows).T
    return distance_from(plan.line, x, y), phases


@pytest.fixture(scope="module")
def plan():
    return planned_track([(0, 0), (4000, 0), (6000, 3400), (9500, 3400)], 1300.0)


def test_a_track_is_sailed_in_still_water(pilot, predictor, plan):
    off, phases = sailed(pilot, predictor, plan)
    assert phases[-1][0] == "arrived" and phases[-1][1] == 2
    assert np.sqrt((off**2).mean()) < 0.15 * 226
    assert {p for p, _, _ in phases} == {"keeping", "turning", "arrived"}
    # The wheel-over is told before it comes, and the time to it falls.
    told = [w for p, leg, w in phases if p == "keeping" and leg == 0 and w is not None]
    assert len(told) > 30 and np.all(np.diff(told) < 0)


def test_current_and_wind_cost_little(pilot, predictor, plan):
    off, phases = sailed(pilot, predictor, plan, current=(-0.9, 0.9), wind=10.0)
    assert phases[-1][0] == "arrived"
    assert np.sqrt((off**2).mean()) < 0.35 * 226
    # On the last leg, when it has been kept for a while.
    assert off[-30:].max() < 0.1 * 226


def test_the_rudder_limit_makes_up_for_a_late_turn(pilot, predictor, plan):
    steering = TrackPilot(predictor, plan, rudder_limit=np.deg2rad(12))
    steering.leg, steering.phase = 1, "turning"
    late = Situation({"x": 3700.0, "y": 0.0, "psi": 0.0, "u": 9.5, "r": 0.0})
    early = Situation({"x": 2900.0, "y": 0.0, "psi": 0.0, "u": 9.5, "r": 0.0})
    assert steering.steer(late).rudder_limit > np.deg2rad(15)
    steering.leg, steering.phase = 1, "turning"
    assert steering.steer(early).rudder_limit < np.deg2rad(10)


def test_a_rudder_limit_that_is_none(predictor, plan):
    with pytest.raises(UsageError, match="greater than zero"):
        TrackPilot(predictor, plan, rudder_limit=0.0)
