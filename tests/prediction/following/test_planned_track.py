from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import UsageError
from shipid.prediction.following.planned_track import distance_from, planned_track


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
        ([(0, 0), (1, 1), (1, 1)], 0.0, "2 and 3 are one place"),
        ([(0, 0), (1000, 0), (1000, 1000)], 1500.0, "take smaller radii"),
        ([(0, 0), (1000, 0), (1000, 1000), (0, 1000)], 600.0, "leg 2 take"),
    ],
)
def test_tracks_that_cannot_be_sailed(points, radius, says):
    with pytest.raises(UsageError, match=says):
        planned_track(points, radius)
