from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import UsageError
from shipid.prediction.following.track_adaptation import TrackFollower, adapted, counter_rudder, node_at_heading
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.situation import Situation

STILL = Situation({"psi": 0.0, "u": 9.5})


@pytest.fixture(scope="module")
def track(first_order):
    return first_order.predict(STILL, heading="120 deg", rudder_limit="15 deg", band="none")


def circle(first_order, gain):
    """A steady turn of the first-order ship."""
    rudder = np.deg2rad(10)
    there = Situation({"psi": 0.0, "u": 9.5, "delta": rudder, "r": gain * rudder * 9.5 / 226, "K": gain})
    return first_order.predict(there, rudder=rudder, horizon=15, band="none")


def test_a_steady_turn_is_scaled_exactly(first_order):
    # (5.102) and (5.108): the circle of a ship that turns 1.25 times as fast, her sway part included.
    slow, fast = circle(first_order, 1.28), circle(first_order, 1.6)
    found = adapted(slow, 0.0, 0.0, 0.0, K_rho=1.25)
    inside = found.s < fast.s[-1]
    np.testing.assert_allclose(found.x[inside], np.interp(found.s[inside], fast.s, fast.x), atol=0.1)
    np.testing.assert_allclose(found.y[inside], np.interp(found.s[inside], fast.s, fast.y), atol=0.1)
    np.testing.assert_allclose(found.t[inside], np.interp(found.s[inside], fast.s, fast.t), atol=0.1)


def test_the_current_drifts_for_the_scaled_time(first_order):
    slow, fast = circle(first_order, 1.28), circle(first_order, 1.6)
    found = adapted(slow, 0.0, 0.0, 0.0, K_rho=1.25, current=(0.3, -0.8))
    still = adapted(slow, 0.0, 0.0, 0.0, K_rho=1.25)
    np.testing.assert_allclose(found.x - still.x, 0.3 * found.t, atol=1e-9)
    np.testing.assert_allclose(found.y - still.y, -0.8 * found.t, atol=1e-9)
    literal = adapted(slow, 0.0, 0.0, 0.0, K_rho=1.25, current=(0.3, -0.8), literal=True)
    assert literal.t[-1] == pytest.approx(slow.t[-1]) and literal.t[-1] == pytest.approx(1.25 * found.t[-1])
    assert fast.t[-1] == pytest.approx(slow.t[-1])


def test_the_literal_form_scales_the_whole_track(track):
    found = adapted(track, 0.0, 10.0, -20.0, K_rho=0.8, literal=True)
    np.testing.assert_allclose(found.x - 10.0, track.x / 0.8, atol=1e-6)
    np.testing.assert_allclose(found.y + 20.0, track.y / 0.8, atol=1e-6)


def test_counter_rudder_keeps_its_shape(track):
    begin = counter_rudder(track)
    assert 0 < begin < track.s.size and np.abs(track.delta[begin]) < np.deg2rad(15)
    found = adapted(track, float(begin), 0.0, 0.0, K_rho=0.7)
    np.testing.assert_allclose(found.x, track.x[begin:] - track.x[begin], atol=1e-6)
    np.testing.assert_allclose(found.t, track.t[begin:] - track.t[begin], atol=1e-9)


def test_until_the_counter_rudder_all_that_is_ahead_is_scaled(track):
    node = counter_rudder(track) - 1
    found = adapted(track, float(node), 0.0, 0.0, K_rho=0.7)
    np.testing.assert_allclose(found.s, (track.s[node:] - track.s[node]) / 0.7, atol=1e-6)
    np.testing.assert_allclose(found.t, (track.t[node:] - track.t[node]) / 0.7, atol=1e-6)


def test_without_counter_rudder_the_whole_turn_is_scaled(first_order):
    assert counter_rudder(circle(first_order, 1.6)) == 601


@settings(deadline=None, max_examples=60)
@given(st.floats(0.0, 1.0))
def test_the_node_of_a_heading_has_that_heading(share):
    psi = np.concatenate([np.linspace(0, 2, 200) ** 2 / 2, [2.01, 2.0, 1.99]])

    class Track:
        pass

    track = Track()
    for side in (1.0, -1.0):
        track.psi = side * psi
        wanted = side * share * 2.0
        node = node_at_heading(track, wanted)
        assert np.interp(node, np.arange(psi.size), track.psi) == pytest.approx(wanted, abs=1e-9)
        assert node_at_heading(track, wanted, node + 3) == node + 3
    assert node_at_heading(track, 0.5) == 0.0
    assert node_at_heading(track, -9.0) == 200.0


@pytest.mark.parametrize("gain", [0.8, 1.0, 1.2])
def test_the_follower_finds_how_fast_the_ship_turns(pilot, gain):
    from shipid.prediction.tracks.track_predictor import TrackPredictor

    predicted = TrackPredictor(pilot, model="first-order", values={"K": 1.6 * gain, "tau": 1.7, "gamma": 0.573})
    track = predicted.predict(STILL, heading="120 deg", rudder_limit="15 deg", band="none")
    truth = sail(pilot, [(100, "120 deg")], rudder_limit="15 deg", values={"K_u": 0.05}, sampling=1.0)
    follower = TrackFollower(track)
    for row in truth.table.itertuples():
        if row.t >= 100 and row.psi < np.deg2rad(70):
            follower.update(row.t, row.psi, row.r, row.u)
    assert pytest.approx(1 / gain, rel=0.05) == follower.K_rho
    # After the counter-rudder has begun the estimate stays as it is.
    kept = follower.K_rho
    follower.update(1e4, 2.0, 0.05, 9.5)
    assert follower.K_rho == kept


def test_a_ship_that_is_another_one_is_told(track):
    follower = TrackFollower(track)
    assert not follower.limited
    for t in range(1, 60):
        follower.update(float(t), 0.01 * t, 0.05, 9.5)
    assert follower.limited and follower.K_rho == 2.0


def test_the_rest_of_the_track_is_what_is_sailed(pilot, first_order):
    track = first_order.predict(STILL, heading="120 deg", rudder_limit="15 deg", band="none", horizon=25)
    truth = sail(pilot, [(100, "120 deg")], rudder_limit="15 deg", current=("3 kn", "30 deg"), sampling=0.5)
    t, x, y, psi = (truth.table[n].to_numpy() for n in ("t", "x", "y", "psi"))
    now = int(np.argmax(psi >= np.deg2rad(40)))
    drift = 3 * 1852 / 3600 * np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
    follower = TrackFollower(track)
    rest = follower.remaining(x[now], y[now], psi[now], tuple(drift), scaled=False)
    across, node = rest.distance_to(x[now:], y[now:])
    assert np.abs(across[node < rest.s.size - 1]).max() < 0.15 * 226
    assert t[now] > 100 and rest.psi[0] == pytest.approx(psi[now])


def test_a_track_in_a_current_is_not_followed(first_order):
    moved = first_order.predict(Situation({"psi": 0.0, "u": 9.5, "current_north": 0.5}), heading="60 deg", band="none")
    with pytest.raises(UsageError, match="still water"):
        TrackFollower(moved)
