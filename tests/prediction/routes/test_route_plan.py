"""Routes as planned tracks: lines on the earth against geographiclib, and routes that no plane holds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geographiclib.geodesic import Geodesic
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import UsageError
from shipid.prediction.following.planned_track import distance_from
from shipid.prediction.routes.errors import RoutePlaneError
from shipid.prediction.routes.route import Route, Waypoint, route_through
from shipid.prediction.routes.route_plan import leg_lengths, plan_of
from shipid.prediction.routes.sailings import along_rhumb_line
from shipid.trials.logs.geodesy import to_local


def route(*places, radius=500.0, geometry="loxodrome", **more) -> Route:
    return Route(
        "r", tuple(Waypoint(tuple(map(math.radians, p)), "", radius, geometry=geometry, **more) for p in places)
    )


def test_a_great_circle_becomes_points_on_the_way():
    whole = route((59.0, 18.0), (59.1, 19.5), geometry="great circle")
    # Through the origin it is nearly straight in the plane; from an origin aside it is not.
    origin = tuple(np.deg2rad([57.3, 18.0]))
    plan = plan_of(whole, origin=origin)
    assert len(plan_of(whole).legs) == 1 and len(plan.legs) > 1 and set(plan.waypoints) == {1}
    shortest = Geodesic.WGS84.Inverse(59.0, 18.0, 59.1, 19.5)
    line = Geodesic.WGS84.InverseLine(59.0, 18.0, 59.1, 19.5)
    assert leg_lengths(whole)[0] == pytest.approx(shortest["s12"], abs=1e-3)
    assert math.degrees(plan.legs[0].course) == pytest.approx(shortest["azi1"], abs=0.1)
    on = [line.Position(s) for s in np.linspace(0, shortest["s12"], 200)]
    x, y = to_local(*np.deg2rad([[p["lat2"], p["lon2"]] for p in on]).T, origin)
    assert distance_from(plan.line, x, y).max() < 1.5


def test_a_loxodrome_is_not_straight_in_the_plane_either():
    plan = plan_of(route((60.0, 10.0), (60.0, 11.0)))
    lat, lon = along_rhumb_line(*np.deg2rad([60.0, 10.0, 60.0, 11.0]), np.linspace(0, 1, 300))
    x, y = to_local(lat, lon, tuple(np.deg2rad([60.0, 10.0])))
    assert distance_from(plan.line, x, y).max() < 1.5
    # A single chord would be 100 m off.
    assert distance_from(plan.line[[0, -1]], x, y).max() > 100
    assert np.rad2deg(plan.legs[0].course) == pytest.approx(90, abs=0.2)


@settings(max_examples=40, deadline=None)
@given(
    st.floats(-75, 75),
    st.floats(-180, 180),
    st.floats(0, 2 * np.pi),
    st.floats(-2.6, 2.6),
    st.sampled_from(["loxodrome", "great circle"]),
)
def test_tracks_lead_from_waypoint_to_waypoint_everywhere(lat, lon, course, turn, geometry):
    places = [(lat, lon)]
    for azimuth, size in ((course, 12e3), (course + turn, 15e3)):
        found = Geodesic.WGS84.Direct(*places[-1], np.rad2deg(azimuth), size)
        places.append((found["lat2"], found["lon2"]))
    plan = plan_of(route(*places, geometry=geometry, radius=400.0, xtd_port=100.0))
    assert np.hypot(*(plan.line[-1] - plan.line[0])) <= 27.1e3
    assert plan.waypoints[0] == 1 and plan.waypoints[-1] == 2 and set(plan.waypoints) == {1, 2}
    corner = to_local(*np.deg2rad(places[1]), tuple(np.deg2rad(places[0])))
    arcs = np.flatnonzero(np.diff(plan.waypoints)) + 1
    assert [plan.legs[k].x for k in arcs] == pytest.approx([corner[0]], abs=1e-6)
    assert plan.radii[arcs].tolist() == [400.0] and np.all(plan.limits == [100.0, np.inf])
    # Steps of the line stay on the way: nowhere does it turn back on itself.
    steps = np.diff(plan.line, axis=0)
    steps = steps[np.hypot(*steps.T) > 1e-3]
    bend = np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))
    assert bend.max(initial=0.0) < np.deg2rad(2.5)


def test_the_dateline_is_no_edge():
    plan = plan_of(route((10.0, 179.9), (10.0, -179.9), (10.2, -179.9)))
    assert plan.line[-1, 1] == pytest.approx(21.9e3, rel=0.01)


def test_an_origin_that_is_given():
    whole = route((53.5, 8.1), (53.6, 8.1))
    origin = tuple(np.deg2rad([53.4, 8.0]))
    assert plan_of(whole, origin=origin).line[0] == pytest.approx(whole.local(origin)[0])
    assert whole.local()[0] == pytest.approx([0, 0]) and route_through([(0, 0), (1, 2)]).local().tolist() == [
        [0, 0],
        [1, 2],
    ]


def test_local_metres_go_onto_the_earth_and_back():
    local = route_through([(0, 0), (3000, 4000)], radius=100.0)
    there = local.on_earth(tuple(np.deg2rad([53.5, 180.0])))
    assert there.geographic and there.local() == pytest.approx(local.local(), abs=1e-6)
    assert there.on_earth((0.0, 0.0)) is there


@pytest.mark.parametrize(
    ("whole", "error", "says"),
    [
        (route((0.0, 0.0), (4.0, 0.0)), RoutePlaneError, "is 445 km from the origin"),
        (route((0.0, 0.0), (1.0, 170.0)), RoutePlaneError, "km from the origin"),
        (route((80.0, 0.0), (80.0, 5.0)), RoutePlaneError, "north is 4.9 deg off north"),
        (route((89.4, 0.0), (89.7, 0.0)), RoutePlaneError, "so near to a pole"),
        (route((90.0, 0.0), (89.7, 0.0)), RoutePlaneError, "so near to a pole"),
        (route((53.5, 8.1), (53.6, 8.1), (53.6, 8.3), radius=None), UsageError, "waypoint 2 of route 'r' states no turn radius"),
        (route((53.5, 8.1), (53.51, 8.1), (53.51, 8.2), radius=2000.0), UsageError, "from waypoint 1 to waypoint 2 take"),
    ],
)  # fmt: skip
def test_routes_that_no_plane_holds(whole, error, says):
    with pytest.raises(error, match=says):
        plan_of(whole)


def test_a_route_as_plain_values():
    plain = route((53.5, 8.1), (53.6, 8.1), radius=None, xtd_port=100.0).to_dict()
    assert plain["waypoints"][1]["lat"] == {"value": pytest.approx(53.6), "unit": "deg"}
    assert plain["waypoints"][1]["radius"] is None and plain["waypoints"][1]["xtd_port"] == {
        "value": 100.0,
        "unit": "m",
    }
