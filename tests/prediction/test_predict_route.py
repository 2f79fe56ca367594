"""The next turn of a route: where the wheel goes over, and how the track keeps to the plan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from shipid.foundation.errors import UsageError
from shipid.prediction.following.planned_track import distance_from
from shipid.prediction.predict_route import predict_route
from shipid.prediction.routes.route import Route, Waypoint, route_through
from shipid.prediction.routes.route_plan import plan_of
from shipid.prediction.sailing.sail_route import sail_route
from shipid.prediction.situations.situation import Situation

PLACES = [(0.0, 0.0), (6000.0, 0.0), (9000.0, 6000.0), (9000.0, 12000.0)]


@pytest.fixture(scope="module")
def route():
    points = tuple(Waypoint(p, n, 1500.0, 60.0, 60.0) for p, n in zip(PLACES, "ABCD"))
    return Route("tour", points, geographic=False)


def test_the_wheel_goes_over_where_the_track_pilot_puts_it(pilot, route):
    voyage = sail_route(pilot, route, current=("1 m/s", "60 deg"))
    done = voyage.wheel_overs[0]
    at = 150
    row = voyage.trial.table.iloc[at]
    known = Situation(
        {
            **{n: float(row[n]) for n in ("x", "y", "psi", "r", "u", "v")},
            "current_north": 0.5,
            "current_east": np.sqrt(0.75),
        }
    )
    found = predict_route(pilot, known, route)
    turn = found.turn
    assert turn.waypoint == 1 and np.rad2deg(turn.change) == pytest.approx(63.4, abs=0.1)
    assert row["t"] + turn.wheel_over.time == pytest.approx(done.t, abs=3)
    assert 6000 - turn.wheel_over.x == pytest.approx(done.before, abs=30)
    assert turn.wheel_over.distance == pytest.approx(turn.wheel_over.x - row["x"], abs=1)
    assert turn.rudder_limit == pytest.approx(done.rudder_limit, rel=0.3)
    # What it says of the track is what the track does.
    off = distance_from(turn.plan.line, found.track.x, found.track.y)
    assert max(turn.overshoot, turn.inside) == pytest.approx(off.max(), abs=1)
    assert max(turn.overshoot, turn.inside) < 40 and turn.beyond == pytest.approx(off.max() - 60, abs=1)
    # On the way to it the ship is on the next leg's heading in the current.
    assert np.rad2deg(found.track.order.heading) == pytest.approx(63.4 + 0.35, abs=0.5)


def test_before_the_turn_and_far_from_it_the_ship_begins_on_her_leg(pilot, route):
    off = {"x": 500.0, "y": 120.0, "psi": np.deg2rad(-20), "u": 9.5, "r": 0.0}
    turn = predict_route(pilot, off, route, band="none").turn
    assert turn.off_track == pytest.approx(120) and turn.left == pytest.approx(5500)
    assert turn.wheel_over.y == pytest.approx(0, abs=1e-6) and turn.now == (500.0, 120.0)
    assert turn.wheel_over.distance + 500 == pytest.approx(turn.wheel_over.x)


def test_a_ship_that_does_not_sail_along_her_leg_is_told_so(pilot, route):
    away = {"x": 2000.0, "y": 0.0, "psi": np.pi, "u": 9.5, "r": 0.0}
    found = predict_route(pilot, away, route, band="none")
    (told,) = [w for w in found.warnings if w.kind == "off-heading"]
    assert told.serious and "heads 180.0 deg, 180 deg off her leg" in told
    along = predict_route(pilot, {**away, "psi": 0.6}, route, band="none")
    assert "off-heading" not in [w.kind for w in along.warnings]


def test_behind_the_end_of_the_route_nothing_is_left(pilot, route):
    found = predict_route(pilot, {"x": 9000.0, "y": 12400.0, "psi": np.pi / 2, "u": 9.5}, route, band="none")
    assert "last leg: the end is passed by 400 m" in found.text()
    (told,) = [w for w in found.warnings if w.kind == "route-ended"]
    assert told.serious and told == "the end of the route is passed by 400 m."


def test_a_warning_one_minute_before(pilot, route):
    start = predict_route(pilot, {"u": 9.5, "r": 0.0}, route, band="none")
    assert start.turn.now == (0.0, 0.0) and not start.turn.wheel_over.warning
    x = start.turn.wheel_over.x
    kinds = {}
    for seconds in (70, 50, -20):
        near = {"x": x - 9.5 * seconds, "y": 0.0, "psi": 0.0, "u": 9.5, "r": 0.0}
        found = predict_route(pilot, near, route, band="none")
        assert found.turn.wheel_over.time == pytest.approx(seconds, abs=1)
        kinds[seconds] = {w.kind: w.serious for w in found.warnings}
    assert "wheel-over-soon" in kinds[50] and "wheel-over-soon" not in kinds[70]
    assert kinds[-20]["wheel-over-passed"] is True


def test_a_ship_in_her_turn_is_not_late(pilot, route):
    voyage = sail_route(pilot, route)
    done = voyage.wheel_overs[0]
    row = voyage.trial.table.iloc[int(done.t) + 25]
    found = predict_route(
        pilot, {n: float(row[n]) for n in ("x", "y", "psi", "r", "u", "v", "delta")}, route, band="none"
    )
    assert [w.kind for w in found.warnings if w.kind in ("turning", "wheel-over-soon", "wheel-over-passed")] == [
        "turning"
    ]


def test_limits_are_left_where_the_ship_cannot_turn_so_short(pilot):
    tight = Route("t", tuple(Waypoint(p, "", 150.0, 30.0, 30.0) for p in PLACES), geographic=False)
    turn = predict_route(pilot, {"u": 9.5, "r": 0.0}, tight, band="none").turn
    assert turn.beyond > 0 and turn.to_dict()["limits_kept"] is False
    assert any("limit left by" in line for line in turn.words)


def test_the_band_may_leave_the_limits(pilot, route):
    known = Situation({"x": 3000.0, "y": 0.0, "psi": 0.0, "u": 9.5, "r": 0.0}, ("y",), np.array([[900.0]]))
    turn = predict_route(pilot, known, route).turn
    assert turn.beyond_band > turn.beyond and turn.beyond_band > 0
    assert any("95 % band leaves them" in line for line in turn.words)
    wide = replace(route, waypoints=tuple(replace(w, xtd_port=5000.0, xtd_starboard=5000.0) for w in route.waypoints))
    assert any("the 95 % band too" in line for line in predict_route(pilot, known, wide).turn.words)


def test_the_last_leg(pilot, route):
    found = predict_route(pilot, {"x": 9000.0, "y": 9000.0, "psi": np.pi / 2, "u": 9.5, "r": 0.0}, route, band="none")
    assert found.turn.waypoint is None and found.turn.left == pytest.approx(3000)
    assert found.turn.to_dict()["wheel_over"] is None and "last-leg" in [w.kind for w in found.warnings]
    # What lies beyond the end of the route is none of its limits.
    assert found.turn.beyond < -50


def test_a_leg_in_pieces_has_no_turns_between_its_waypoints(pilot):
    whole = Route(
        "far", tuple(Waypoint(tuple(np.deg2rad(p)), "", 1500.0) for p in [(60.0, 10.0), (60.0, 10.6), (60.1, 10.6)])
    )
    assert len(plan_of(whole).legs) > 3
    found = predict_route(pilot, {"u": 9.5, "r": 0.0}, whole, band="none")
    assert found.turn.waypoint == 1 and found.turn.left == pytest.approx(33.5e3, rel=0.01)
    lat, lon = np.rad2deg(found.turn.place)
    assert lat == pytest.approx(60.0, abs=1e-4) and 10.5 < lon < 10.6
    assert "60°00.00' N, 010°3" in found.turn.words[1]


def test_a_turn_without_a_radius_says_what_is_taken(pilot):
    found = predict_route(pilot, {"u": 9.5, "r": 0.0}, route_through(PLACES), band="none")
    assert found.warnings[0].kind == "turn-radius" and "1808 m" in found.warnings[0]


def test_a_ship_off_the_route(pilot, route):
    found = predict_route(pilot, {"x": 1000.0, "y": -9000.0, "psi": 0.0, "u": 9.5, "r": 0.0}, route, band="none")
    assert {w.kind: w.serious for w in found.warnings}["off-route"] is True


def test_what_cannot_be_predicted(pilot, route):
    with pytest.raises(UsageError, match="asks for the ship's position"):
        predict_route(pilot, Situation({"psi": 0.0, "u": 9.5}), route)
    with pytest.raises(UsageError, match="holds a rate of turn steers no route"):
        predict_route(replace(pilot, mode="rate"), {"u": 9.5}, route)
    with pytest.raises(UsageError, match="rate of turn steers no route"):
        sail_route(replace(pilot, mode="rate"), route)


def test_a_rudder_limit_that_does_not_turn_her_is_no_plan(pilot, route):
    """In a wind from port a little rudder keeps her on the leg she is on, and the track of that lies well on the plan."""
    windy = {"x": 500.0, "y": 0.0, "psi": 0.0, "u": 9.5, "r": 0.0, "r_disturbance": -3e-5}
    found = predict_route(pilot, windy, route, band="none")
    assert found.turn.wheel_over.distance > 3000 and found.turn.rudder_limit > np.deg2rad(5)
    assert np.rad2deg(found.track.psi[-1]) == pytest.approx(63.4, abs=1)
    with pytest.raises(UsageError, match="1 deg of rudder the ship does not come to the heading of the next leg"):
        predict_route(pilot, windy, route, rudder_limit="1 deg", band="none")


def test_a_track_that_begins_on_her_leg_says_so(pilot, route):
    away = {"x": 500.0, "y": 0.0, "psi": np.deg2rad(-170), "u": 9.5, "r": 0.0}
    text = predict_route(pilot, away, route, band="none", source="the state given").text()
    assert "from the state given, then along her leg: heading 000.0 deg" in text
    text = predict_route(pilot, {**away, "psi": 0.0}, route, band="none", source="the state given").text()
    assert "from the state given: heading 000.0 deg" in text
