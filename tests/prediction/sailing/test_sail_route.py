"""Routes sailed under the track pilot."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.prediction.routes.route import Route, Waypoint, route_through
from shipid.prediction.sailing.sail_route import sail_route
from shipid.trials.manoeuvres.simulate import NotSailedError

PLACES = [(0.0, 0.0), (5000.0, 0.0), (8000.0, 6000.0), (3000.0, 9000.0)]


def tour(radius=1300.0, limit=50.0, speed=None, places=PLACES) -> Route:
    points = tuple(Waypoint(p, n, radius, limit, limit, speed=speed) for p, n in zip(places, "ABCD"))
    return Route("tour", points, geographic=False)


@pytest.fixture(scope="module")
def calm(pilot):
    """The tour in still water, by the ship that the pilot knows."""
    return sail_route(pilot, tour())


@pytest.mark.parametrize("radius", [900.0, 1800.0, 2500.0])
def test_turns_follow_their_arcs_whatever_their_radius(pilot, radius):
    voyage = sail_route(pilot, tour(radius))
    assert voyage.arrived and voyage.statistics["whole"][1] < 40
    assert len(voyage.wheel_overs) == 2 and [w.name for w in voyage.wheel_overs] == ["waypoint 2 'B'", "waypoint 3 'C'"]
    assert not voyage.left and "cross-track limits kept" in voyage.text()
    # A wide turn takes less rudder.
    low, high = {900.0: (8, 18), 1800.0: (3, 8), 2500.0: (1, 5)}[radius]
    assert low < np.rad2deg(voyage.wheel_overs[0].rudder_limit) < high


def test_current_wind_and_waves(pilot, calm):
    weather = {"current": ("1.2 m/s", "100 deg"), "wind": ("10 m/s", "30 deg"), "waves": ("0.3 deg", "30 deg")}
    voyage = sail_route(pilot, tour(), **weather, seed=3)
    assert voyage.arrived and voyage.statistics["legs"][0] < 25
    assert np.allclose(voyage.trial["wind_speed"], 10.0) and not calm.trial.has("wind_speed")
    assert voyage.trial["t"][-1] != pytest.approx(calm.trial["t"][-1], rel=1e-3)
    # The heading that is recorded has the waves in it, the order has not.
    ahead = slice(100, 250)
    assert np.std(np.diff(voyage.trial["psi"][ahead])) > 20 * np.std(np.diff(calm.trial["psi"][ahead]))
    one, same, other = (
        sail_route(pilot, tour(), **weather, seed=seed, duration="100 s").trial["psi"] for seed in (3, 3, 4)
    )
    assert np.array_equal(one, same) and not np.array_equal(one, other)


def test_what_is_recorded(pilot):
    voyage = sail_route(pilot, tour(limit=None), noise="standard")
    trial = voyage.trial
    assert trial.name == "tour" and trial.source.simulated and "route 'tour'" in trial.source.comment
    assert {"x", "y", "psi", "u", "r", "delta", "delta_order"} <= set(trial.table)
    assert np.unique(trial.table["waypoint"]).tolist() == [2, 3, 4]
    assert np.array_equal(trial.table["off_track"], voyage.off_track)
    # The pilot saw no noise: off the track is where she was.
    assert np.abs(np.diff(voyage.off_track)).max() < 10 and voyage.trial.source.origin is None


def test_limits_that_are_left_are_told(pilot):
    voyage = sail_route(pilot, tour(radius=200.0, limit=30.0))
    assert voyage.left and voyage.left[0].beyond > 10
    first = voyage.left[0]
    rows = (voyage.trial["t"] >= first.begin) & (voyage.trial["t"] <= first.end)
    side = voyage.off_track[rows] * (1 if first.side == "starboard" else -1)
    assert side.min() > 30 and side.max() - 30 == pytest.approx(first.beyond)
    plain = voyage.to_dict()
    assert plain["limits_left"][0]["side"] == first.side and plain["arrived"] is True


def test_the_speed_that_the_route_plans(pilot):
    assert sail_route(pilot, tour(speed=8.0), duration="60 s").trial["u"][0] == pytest.approx(8.0)
    given = sail_route(pilot, tour(speed=8.0), speed="9 m/s", duration="60 s")
    assert given.trial["u"][0] == pytest.approx(9.0) and "planned-speed" in [w.kind for w in given.warnings]


def test_a_voyage_that_ends_early_is_serious(pilot):
    voyage = sail_route(pilot, tour(), duration="300 s")
    assert not voyage.arrived and voyage.trial["t"][-1] == pytest.approx(300)
    assert [w.kind for w in voyage.warnings if w.serious] == ["not-arrived"] and "end not reached" in voyage.text()


def test_a_route_that_she_cannot_follow_is_told(pilot, calm):
    """Two turns of 90 degrees within two ship lengths."""
    assert "route-not-followed" not in [w.kind for w in calm.warnings]
    points = [(0.0, 0.0), (1500.0, 0.0), (1500.0, 400.0), (0.0, 400.0), (0.0, 2000.0)]
    voyage = sail_route(pilot, route_through(points, radius=60.0))
    (told,) = [w for w in voyage.warnings if w.kind == "route-not-followed"]
    worst = float(np.abs(voyage.off_track).max())
    assert (
        told.serious and worst > 2 * pilot.length and told.known["ship_lengths"] == pytest.approx(worst / pilot.length)
    )
    assert (
        f"up to {worst / pilot.length:.2g} ship lengths off the track, on the way to waypoint" in told
        and "closer together, than she sails them here" in told
    )
    behind = next(w for w in voyage.wheel_overs if w.before < 0)
    assert f"{-behind.before:.0f} m behind waypoint {behind.waypoint + 1}" in voyage.text()


def test_a_turn_for_which_the_leg_before_it_is_too_short_is_told(pilot, calm):
    assert not [w for w in calm.warnings if w.kind == "wheel-over-late"] and not any(w.late for w in calm.wheel_overs)
    short = sail_route(pilot, tour(300.0, places=[(0.0, 0.0), (400.0, 0.0), (400.0, 6000.0)]))
    (late,) = [w for w in short.warnings if w.kind == "wheel-over-late"]
    assert short.wheel_overs[0].t == 0 and short.wheel_overs[0].late and late.known["waypoint"] == 2
    assert "at the start, and that is late" in late


def test_another_ship_sails_than_the_pilot_knows(pilot, calm):
    other = sail_route(pilot, tour(), values={"K": "1.9 1"})
    assert other.arrived and other.statistics["turns"][0] != pytest.approx(calm.statistics["turns"][0], rel=0.01)


@pytest.mark.parametrize(
    ("more", "error", "says"),
    [
        ({"speed": 0.0}, UsageError, "does not steer a ship"),
        ({"radius": -5.0}, UsageError, "radius of a turn is greater than zero"),
        ({"sampling": "1000 h"}, UsageError, "does not fit a voyage"),
        ({"sampling": 0.0001}, UsageError, "too many samples"),
        ({"values": {"X": "1 1"}}, UnknownNameError, "coefficient of model"),
        ({"inputs": {"n": "3 rpm"}}, UsageError, "reads no input 'n'"),
        ({"rudder_limit": 0.0}, UsageError, "greater than zero"),
        ({"current": ("20 kn", "90 deg")}, UsageError, "the leg cannot be kept"),
        ({"values": {"K": "60 1", "cubic": "0 1"}}, (NotSailedError, UnknownNameError), "turns faster than any ship|coefficient"),
    ],
)  # fmt: skip
def test_what_cannot_be_sailed(pilot, more, error, says):
    with pytest.raises(error, match=says):
        sail_route(pilot, tour(radius=None if "radius" in more else 1300.0), **more)
