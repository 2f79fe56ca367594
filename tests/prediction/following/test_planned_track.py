from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import UsageError
from shipid.prediction.following.planned_track import PlannedTrack, distance_from, planned_track
from shipid.prediction.following.wheel_over import TrackLeg


def test_a_turn_is_an_arc_that_touches_both_legs():
    plan = planned_track([(0, 0), (4000, 0), (4000, 3000)], 800.0)
    assert [leg.course for leg in plan.legs] == pytest.approx([0.0, np.pi / 2])
    # A quarter of a circle about (3200, 800).
    arc = plan.line[1:-1]
    np.testing.assert_allclose(np.hypot(arc[:, 0] - 3200, arc[:, 1] - 800), 800, atol=1e-6)
    np.testing.assert_allclose(arc[0], [3200, 0], atol=1e-6)
    np.testing.assert_allclose(arc[-1], [4000, 800], atol=1e-6)
    assert plan.end == pytest.approx(3000)


@settings(deadline=None, max_examples=80)
@given(st.floats(-2.4, 2.4), st.floats(50, 900))
def test_any_turn_touches_both_legs(turn, radius):
    second = (5000 + 5000 * np.cos(turn), 5000 * np.sin(turn))
    plan = planned_track([(0, 0), (5000, 0), second], radius)
    across = np.abs(plan.legs[1].across(plan.line[-2, 0], plan.line[-2, 1]))
    assert across == pytest.approx(0, abs=1e-6)
    assert abs(plan.line[1, 1]) < 1e-9
    steps = np.hypot(*np.diff(plan.line[1:-1], axis=0).T)
    assert steps.sum() == pytest.approx(radius * abs(turn), rel=1e-3, abs=1e-6)


def test_the_distance_from_a_line():
    line = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0]])
    found = distance_from(line, np.array([[50.0, 130.0], [-30.0, 100.0]]), np.array([[7.0, 20.0], [40.0, 90.0]]))
    np.testing.assert_allclose(found, [[7.0, 30.0], [50.0, 40.0]])


def test_the_line_around_a_waypoint():
    plan = planned_track([(0, 0), (4000, 0), (4000, 3000)], 800.0)
    near = plan.around(1, 900.0)
    assert len(plan.line) >= len(near) >= 40
    np.testing.assert_array_equal(plan.around(1, 1.0), plan.line)


@pytest.mark.parametrize(
    ("points", "radius", "says"),
    [
        ([(0, 0)], 1.0, "two waypoints at least"),
        ([(0, 0), (np.nan, 1)], 1.0, "two waypoints at least"),
        ([(0, 0), (1, 1), (1, 1)], 0.0, "waypoint 2 and waypoint 3 are one place"),
        ([(0, 0), (1000, 0), (1000, 1000)], 1500.0, "state smaller turn radii in the route"),
        ([(0, 0), (1000, 0), (1000, 1000), (0, 1000)], 600.0, "from waypoint 2 to waypoint 3 take"),
        ([(0, 0), (1000, 0), (0, 10)], 1.0, "from waypoint 2 turns back by 179 deg"),
    ],
)
def test_tracks_that_cannot_be_sailed(points, radius, says):
    with pytest.raises(UsageError, match=says):
        planned_track(points, radius)


def test_off_the_track_to_starboard_and_beyond_its_limits():
    plan = planned_track([(0, 0), (1000, 0), (1000, 1000), (-500, 1000), (-500, 500), (500, 500)], [100, 100, 100, 50])
    plan = replace(plan, limits=np.array([[50, 20], [50, 20], [np.inf, np.inf], [10, 10], [10, 10]]))
    x, y = np.array([500, 500, 971, 1010, 900]), np.array([30, -30, 29, 500, 1005])
    distance, leg = plan.off_track(x, y)
    # The middle of the first arc is 100 (sqrt 2 - 1) m inside the corner.
    assert distance == pytest.approx([30, -30, 100 - np.hypot(71, 71), -10, -5], abs=0.05)
    assert leg[[0, 1, 3, 4]].tolist() == [0, 0, 1, 2]
    assert plan.beyond_limits(distance, leg)[[0, 1, 3]] == pytest.approx([10, -20, -10 - 20], abs=0.05)
    assert plan.beyond_limits(distance, leg)[4] == -np.inf
    # Where the last leg crosses the first, the leg that is sailed decides.
    near, on = plan.off_track(0.0, 490.0, leg=0)
    assert near == pytest.approx(490) and on.tolist() == [0]
    assert plan.off_track(0.0, 490.0)[0] == pytest.approx(-10, abs=0.05)
    # A ship that has just passed the end of the route is as far off the track as before.
    assert plan.off_track(508.0, 497.0, leg=4)[0] == pytest.approx(-3)
    assert plan.off_track(508.0, 500.0)[0] == pytest.approx(8)


def test_a_line_drawn_in_another_way_has_a_distance_too():
    plan = PlannedTrack((TrackLeg(0.0, 0.0, 0.0),), np.array([[0.0, 0.0], [1000.0, 0.0]]))
    distance, leg = plan.off_track(np.array([100.0, 200.0]), np.array([5.0, -5.0]))
    assert distance.tolist() == [5.0, -5.0] and leg.tolist() == [-1, -1]
    assert np.all(plan.beyond_limits(distance, leg) < 0)
