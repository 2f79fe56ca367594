from __future__ import annotations

import numpy as np
import pytest

from shipid.foundation.errors import UsageError
from shipid.prediction.following.wheel_over import TrackLeg, heading_on, wheel_over
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import HORIZON, POINTS


@pytest.mark.parametrize("course", [np.deg2rad(40), np.deg2rad(-95)])
@pytest.mark.parametrize("current", [(0.0, 0.0), (0.9, -0.7)])
@pytest.mark.parametrize("steering", ["predictor", "placed"])
def test_the_turn_from_the_wheel_over_point_ends_on_the_leg(request, steering, course, current):
    """An integral in the autopilot takes its time: the ship comes onto the leg far beyond the horizon of the search."""
    predictor = request.getfixturevalue(steering)
    leg = TrackLeg(4000.0, 300.0, course)
    # A ship that keeps a course over the ground to the north.
    psi = heading_on(TrackLeg(0.0, 0.0, 0.0), current, 9.5)
    values = {"x": 0.0, "y": 0.0, "psi": psi, "u": 9.5, "current_north": current[0], "current_east": current[1]}
    found = wheel_over(predictor, Situation(values), leg, rudder_limit="10 deg")
    assert not found.due and not found.warning
    there = Situation({**values, "x": found.x, "y": found.y})
    settled = {"horizon": 4 * HORIZON, "points": 4 * POINTS}
    track = predictor.predict(there, heading=found.heading, rudder_limit="10 deg", **settled, band="none")
    end = slice(-50, None)
    np.testing.assert_allclose(leg.across(track.x[end], track.y[end]), 0, atol=0.5)
    assert np.sin(track.course[-1] - course) == pytest.approx(0, abs=1e-3)
    assert found.track.s_star[-1] == pytest.approx(HORIZON, rel=1e-3)
    assert found.distance == pytest.approx(np.hypot(found.x, found.y))
    assert found.time == pytest.approx(found.distance / np.hypot(*Situation(values).ground_velocity))


def test_a_ship_that_a_moment_keeps_beside_her_order_comes_onto_the_leg(placed):
    """Without an integral she never reaches the ordered heading: the leg is kept by an order beside it."""
    leg = TrackLeg(4000.0, 300.0, np.deg2rad(75))
    values = {"x": 0.0, "y": 0.0, "psi": 0.0, "u": 9.5, "r_disturbance": 2e-5}
    found = wheel_over(placed, Situation(values), leg, rudder_limit="10 deg")
    assert 0.005 < abs(found.heading - leg.course) < 0.1
    there = Situation({**values, "x": found.x, "y": found.y})
    track = placed.predict(
        there, heading=found.heading, rudder_limit="10 deg", horizon=4 * HORIZON, points=4 * POINTS, band="none"
    )
    np.testing.assert_allclose(leg.across(track.x[-50:], track.y[-50:]), 0, atol=0.5)


def test_a_point_that_is_passed_is_due(predictor):
    found = wheel_over(predictor, Situation({"psi": 0.0, "u": 9.5, "x": 0.0}), TrackLeg(100.0, 0.0, np.deg2rad(60)))
    assert found.due and found.warning and found.distance < 0
    assert "passed by" in found.text() and set(found.to_dict()) == {"heading", "distance", "time", "x", "y"}


def test_the_distance_grows_with_the_turn(predictor):
    ship = Situation({"psi": 0.0, "u": 9.5})
    ahead = [
        5000 - wheel_over(predictor, ship, TrackLeg(5000.0, 0.0, np.deg2rad(c)), rudder_limit="10 deg").distance
        for c in (15, 45, 75, 105)
    ]
    assert ahead == sorted(ahead) and ahead[0] > 0


def test_the_drift_angle_keeps_the_leg():
    assert heading_on(TrackLeg(0, 0, 0.0), (0.0, 1.0), 5.0) == pytest.approx(-np.arcsin(0.2))
    assert heading_on(TrackLeg(0, 0, 1.0), (0.0, 0.0), 5.0, 0.5) == pytest.approx(1.0 - np.arctan2(0.5, 5.0))


def test_legs_that_cannot_be_reached_or_kept(predictor):
    ship = Situation({"psi": 0.0, "u": 9.5})
    with pytest.raises(UsageError, match="parallel"):
        wheel_over(predictor, ship, TrackLeg(5000.0, 100.0, np.deg2rad(1)))
    with pytest.raises(UsageError, match="cannot be kept"):
        wheel_over(
            predictor, Situation({"psi": 0.0, "u": 9.5, "current_east": 12.0}), TrackLeg(0.0, 0.0, np.deg2rad(20))
        )


def test_the_sides_of_a_leg():
    leg = TrackLeg(10.0, 20.0, np.deg2rad(90))
    assert leg.across(5.0, 50.0) == pytest.approx(5.0)  # south of a leg to the east is to starboard
    assert leg.along(5.0, 50.0) == pytest.approx(30.0)


def test_a_current_against_which_no_way_is_made_keeps_no_leg():
    assert heading_on(TrackLeg(0, 0, 0.0), (-4.0, 1.0), 5.0) == pytest.approx(-np.arcsin(0.2))
    for current, how in (((-5.0, 0.0), "against"), ((-4.95, 1.0), "against"), ((0.0, 5.0), "across")):
        with pytest.raises(UsageError, match=f"sets {how} the leg faster than the ship sails"):
            heading_on(TrackLeg(0, 0, 0.0), current, 5.0)
