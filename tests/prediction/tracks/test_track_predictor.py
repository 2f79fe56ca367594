from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import shipid
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.parts.wind import Wind
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.predicted_track import COLUMNS
from shipid.prediction.tracks.track_predictor import TrackPredictor

STILL = Situation({"psi": 0.0, "u": 9.5})


def test_the_first_order_track_does_not_depend_on_the_speed():
    # A rudder that takes seconds to move does depend on it; gains so close that K_d is in proportion to L/u.
    speeds = list(np.geomspace(5, 12, 40))
    predictor = TrackPredictor(
        shipid.design_autopilot("van-leeuwen", "soesterberg", actuator=None, speeds=speeds), model="first-order"
    )
    tracks = [
        predictor.predict(Situation({"psi": 0.0, "u": u}), heading="120 deg", rudder_limit="20 deg", points=3000)
        for u in (6.0, 9.5, 11.0)
    ]
    for other in tracks[1:]:
        np.testing.assert_allclose(other.x, tracks[0].x, atol=0.002 * 226)
        np.testing.assert_allclose(other.y, tracks[0].y, atol=0.002 * 226)
    # In proportion to the time it takes, which does.
    assert tracks[0].t[-1] / tracks[2].t[-1] == pytest.approx(11 / 6, rel=1e-9)


def test_a_slow_ship_takes_more_steps_and_has_the_same_track(pilot):
    # De Keizer's ship under a held rudder, which is there at once, does not know her speed: her track is the same one.
    predictor = TrackPredictor(shipid.design_autopilot("de-keizer", "soesterberg", actuator=None))
    around = {u: Situation({"psi": 0.0, "u": u}, ("psi",), np.array([[1e-4]])) for u in (9.5, 0.3)}
    usual, slow = (predictor.predict(s, rudder="10 deg", horizon=6, points=60) for s in around.values())
    assert slow.s.size == usual.s.size == 61 and slow.s == pytest.approx(usual.s)
    assert slow.t[-1] / usual.t[-1] == pytest.approx(9.5 / 0.3, rel=2e-3)
    for name in ("x", "y", "half_width"):
        np.testing.assert_allclose(getattr(slow, name), getattr(usual, name), atol=0.005 * 226)
    rudders = np.full((1, 60), np.deg2rad(10.0))
    one, other = (predictor.along([s], rudders, horizon=6)[0] for s in around.values())
    assert other.s.size == one.s.size and other.y == pytest.approx(one.y, abs=0.005 * 226)
    with pytest.raises(UsageError, match=r"at u = 0\.001 m/s the ship sails too slowly for her rudder"):
        TrackPredictor(pilot).predict(Situation({"psi": 0.0, "u": 0.001}), heading="10 deg")


def test_a_held_rudder_is_the_solution_of_the_equations(pilot):
    predictor = TrackPredictor(pilot, values={"K_u": 0.9})
    # De Keizer (1977) by an integrator of SciPy's, the rudder at its angle from the beginning.
    K, tau, gamma, K_u, tau_u, L, U0, delta = 1.6, 1.7, 0.573, 0.9, 2.5, 226.0, 9.5, np.deg2rad(12)

    def rates(_t, z):
        _x, _y, psi, r, u, _s = z
        pace = u / L
        v = -gamma * L * r
        return [
            u * np.cos(psi) - v * np.sin(psi),
            u * np.sin(psi) + v * np.cos(psi),
            r,
            pace**2 * (K * delta - r * L / u) / tau,
            -U0 * pace * (K_u * (r * L / u) ** 2 - (U0 - u) / U0) / tau_u,
            u,
        ]

    start = [0, 0, 0, 0, U0, 0]
    exact = solve_ivp(rates, (0, 600), start, rtol=1e-10, atol=1e-10, dense_output=True)
    track = predictor.predict(
        replace(STILL, values={"psi": 0.0, "u": U0, "delta": delta}), rudder=delta, horizon=15, points=2000
    )
    there = exact.sol(track.t)
    np.testing.assert_allclose(track.s, there[5], atol=0.05)
    np.testing.assert_allclose(np.hypot(track.x - there[0], track.y - there[1]), 0, atol=0.001 * L)
    np.testing.assert_allclose(track.u, there[4], atol=1e-3)
    assert track.v[-1] == pytest.approx(-gamma * L * track.r[-1])
    assert track.s[-1] == pytest.approx(15 * L, rel=1e-3)


def test_the_ship_comes_to_her_heading_the_shorter_way(predictor):
    port = predictor.predict(replace(STILL, values={"psi": np.deg2rad(10), "u": 9.5}), heading="300 deg")
    assert np.rad2deg(port.psi[-1]) == pytest.approx(-60, abs=0.2)
    half = predictor.predict(STILL, heading="180 deg", horizon=25)
    assert np.rad2deg(half.psi[-1]) == pytest.approx(180, abs=0.2)
    assert half.r.max() > -half.r.min()


def test_the_rudder_stays_within_its_limit(predictor):
    track = predictor.predict(STILL, heading="90 deg", rudder_limit="7 deg")
    assert np.abs(np.rad2deg(track.delta)).max() == pytest.approx(7, abs=0.01)
    held = predictor.predict(STILL, rudder="20 deg", rudder_limit="7 deg")
    assert np.rad2deg(held.delta[-1]) == pytest.approx(7, abs=0.01)


def test_a_rate_of_turn_is_held_and_ends_at_a_heading(predictor):
    held = predictor.predict(STILL, rate="20 deg/min")
    assert np.rad2deg(held.r[-1]) * 60 == pytest.approx(20, rel=0.01)
    turn = predictor.predict(STILL, rate="20 deg/min", heading="90 deg")
    assert np.rad2deg(turn.psi[-1]) == pytest.approx(90, abs=0.5)
    assert np.rad2deg(turn.r).max() * 60 == pytest.approx(20, rel=0.25)


def test_a_current_moves_the_track_by_its_time(predictor):
    in_current = Situation({"psi": 0.0, "u": 9.5, "current_north": 1.0, "current_east": -0.4})
    still = predictor.predict(STILL, heading="60 deg", horizon=40)
    moved = predictor.predict(in_current, heading="60 deg", horizon=40)
    np.testing.assert_allclose(moved.x - still.x, moved.t, atol=1e-6)
    np.testing.assert_allclose(moved.y - still.y, -0.4 * moved.t, atol=1e-6)
    assert moved.course[-1] == pytest.approx(np.arctan2(9.5 * np.sin(np.pi / 3) - 0.4, 9.5 * 0.5 + 1.0), abs=1e-3)


@pytest.mark.parametrize("order", [{"heading": "100 deg"}, {"rudder": "8 deg"}])
def test_the_band_is_that_of_the_derivatives(pilot, situation, order):
    # By differences of whole tracks: P = J C J' of what the situation is not sure of.
    predictor = TrackPredictor(pilot)
    track = predictor.predict(situation, **order, rudder_limit="15 deg")
    steps = 1e-3 * np.sqrt(np.diag(situation.covariance))
    columns = []
    for name, step in zip(situation.uncertain, steps):
        ends = [
            predictor.predict(
                Situation({**situation.values, name: situation.values[name] + sign * step, "cruise": 9.5}),
                **order,
                rudder_limit="15 deg",
            )
            for sign in (1, -1)
        ]
        columns.append([(getattr(ends[0], n) - getattr(ends[1], n)) / (2 * step) for n in ("x", "y", "psi", "t")])
    base = Situation({**situation.values, "cruise": 9.5}, situation.uncertain, situation.covariance)
    track = predictor.predict(base, **order, rudder_limit="15 deg")
    J = np.array(columns).transpose(2, 1, 0)
    P = J @ situation.covariance @ J.transpose(0, 2, 1)
    np.testing.assert_allclose(track.covariance, P[:, :2, :2], rtol=2e-3, atol=0.5)
    np.testing.assert_allclose(track.std["t"], np.sqrt(P[:, 3, 3]), rtol=5e-3, atol=1e-3)
    np.testing.assert_allclose(track.std["psi"], np.sqrt(P[:, 2, 2]), rtol=5e-3, atol=1e-5)


def test_samples_and_derivatives_give_one_band(pilot, situation):
    predictor = TrackPredictor(pilot)
    noisy = Situation(situation.values, situation.uncertain, 0.1 * situation.covariance, {"r": 2e-5})
    linear = predictor.predict(noisy, heading="100 deg")
    sampled = predictor.predict(noisy, heading="100 deg", band="samples", samples=1500, seed=3)
    np.testing.assert_allclose(sampled.half_width[1:], linear.half_width[1:], rtol=0.08)
    np.testing.assert_array_equal(sampled.x, predictor.predict(noisy, heading="100 deg", band="none").x)


def test_noise_on_a_straight_course_widens_the_band_as_its_integral(first_order):
    # A heading that is a random walk of density q: the variance across the track is u^2 q^2 t^3 / 3.
    density = 1e-4
    straight = Situation({"psi": 0.3, "u": 9.5, "delta_order": 0.0}, ("psi",), np.zeros((1, 1)), {"psi": density})
    track = first_order.predict(straight, rudder=0.0)
    expected = 1.959964 * 9.5 * density * np.sqrt(track.t**3 / 3)
    np.testing.assert_allclose(track.half_width[100:], expected[100:], rtol=0.01)


def test_a_fan_is_its_single_tracks(predictor):
    headings = np.deg2rad(np.linspace(-120, 120, 7))
    for one, heading in zip(predictor.fan(STILL, list(headings)), headings):
        alone = predictor.predict(STILL, heading=float(heading))
        for name in COLUMNS:
            np.testing.assert_array_equal(getattr(one, name), getattr(alone, name))
    assert predictor.fan(STILL, []) == []


def test_a_model_with_other_states_starts_from_the_same_ship():
    # Van Leeuwen's states are the dimensionless rate and the loss of speed.
    pilot = shipid.design_autopilot("van-leeuwen", "soesterberg")
    turning = Situation(
        {"psi": 0.0, "u": 8.0, "r": 0.008, "cruise": 9.5, "delta": 0.15}, ("r", "u"), np.diag([1e-8, 0.04])
    )
    track = TrackPredictor(pilot).predict(turning, heading="90 deg")
    assert (track.u[0], track.r[0], track.delta[0]) == pytest.approx((8.0, 0.008, 0.15))
    assert track.std["t"][1] == pytest.approx(0.2 / 8.0 * track.t[1], rel=0.02)


def test_coefficients_of_the_situation_go_before_the_ships(predictor):
    slow = predictor.predict(Situation({"psi": 0.0, "u": 9.5, "K": 0.8}), rudder="10 deg")
    assert slow.r[-1] * 226 / slow.u[-1] == pytest.approx(0.8 * np.deg2rad(10), rel=1e-3)


def test_a_ship_that_loses_her_way_ends_the_track(pilot):
    # Beyond 28 degrees of rudder De Keizer's model has no steady turn with this loss of speed.
    track = TrackPredictor(pilot, values={"K_u": 0.9}).predict(STILL, rudder="35 deg", horizon=40)
    assert "not sailed by this model" in track.ended and "not sailed" in track.text()
    assert np.isfinite(track.x).all() and track.u[-1] >= 0.2 * 9.5


def test_a_model_that_runs_away_ends_the_track():
    pilot = shipid.design_autopilot("norrbin", "soesterberg", rudder_limit="30 deg")
    track = TrackPredictor(pilot, values={"b3": -100.0}).predict(STILL, rudder="30 deg", horizon=40)
    assert "turns faster than any ship" in track.ended
    assert all(np.isfinite(getattr(track, n)).all() for n in COLUMNS)


@pytest.mark.parametrize(
    ("order", "says"),
    [
        ({}, "an order is a heading"),
        ({"heading": 1.0, "rudder": 0.1}, "not heading with a rudder"),
        ({"heading": np.nan}, "number with a unit"),
        ({"heading": 1.0, "rudder_limit": 0.0}, "greater than zero"),
        ({"heading": 1.0, "rate": -0.1}, "greater than zero"),
        ({"heading": 1.0, "horizon": 0.0}, "ship lengths"),
        ({"heading": 1.0, "points": 0}, "steps is none"),
    ],
)
def test_orders_that_are_none(predictor, order, says):
    with pytest.raises(UsageError, match=says):
        predictor.predict(STILL, **order)


def test_a_ship_without_a_length_has_no_track(pilot):
    known = pilot.ship.sections
    short = {**known, "particulars": {n: v for n, v in known["particulars"].items() if n != "L"}}
    with pytest.raises(ParameterSetError, match="no length L"):
        TrackPredictor(replace(pilot, ships=(replace(pilot.ship, sections=short),)))


def test_bands_and_models_that_are_not_known(pilot, predictor, situation):
    with pytest.raises(UnknownNameError, match="band"):
        predictor.predict(STILL, heading=1.0, band="wide")
    with pytest.raises(UnknownNameError, match="prediction model"):
        TrackPredictor(pilot, model="second-order")
    with pytest.raises(UnknownNameError, match="n3"):
        TrackPredictor(pilot, values={"n3": 1.0}).predict(STILL, heading=1.0)
    with pytest.raises(UsageError, match="band by 1 samples"):
        predictor.predict(situation, heading=1.0, band="samples", samples=1)


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"psi": 0.0}, "nothing says 'u'"),
        ({"u": 9.0}, "nothing says 'psi'"),
        ({"psi": 0.0, "u": np.nan}, "'u' is none"),
        ({"psi": 0.0, "u": 0.0}, "makes none"),
        ({"psi": 0.0, "u": -3.0}, "makes none"),
        ({"psi": 0.0, "u": 5.0, "v": -100.0}, "v = -100 m/s beside u = 5 m/s the ship drifts by more than 45 degrees"),
    ],
)
def test_situations_that_are_none(values, says):
    with pytest.raises(UsageError, match=says):
        Situation(values)


def test_a_covariance_has_a_row_for_each_name():
    with pytest.raises(UsageError, match="covariance of 2"):
        Situation({"psi": 0.0, "u": 9.0}, ("psi", "u"), np.zeros((1, 1)))


def test_a_track_is_plain_data(predictor, situation):
    track = predictor.predict(situation, heading="60 deg")
    frame, plain = track.to_frame(), track.to_dict()
    assert len(frame) == track.s.size and "half width of the 95 % band [m]" in frame
    assert frame["psi [deg]"].iloc[-1] == pytest.approx(60, abs=0.5)
    assert plain["order"]["heading"]["value"] == pytest.approx(np.deg2rad(60))
    assert "95 % band" in track.text()
    part = track.part(10, 20)
    assert part.s.size == part.covariance.shape[0] == part.std["t"].size == 10


def test_the_distance_to_a_track_has_a_side(predictor):
    track = predictor.predict(STILL, rudder=0.0, horizon=10, points=100)
    across, node = track.distance_to(np.array([500.0, 1000.0, -5.0]), np.array([7.0, -3.0, 0.0]))
    np.testing.assert_allclose(across, [7.0, -3.0, 5.0], atol=1e-6)
    assert node[0] == pytest.approx(500 / 22.6, rel=1e-3) and node[2] == 0
    assert track.at_time(10.0)["x"] == pytest.approx(95.0, rel=1e-6)
    assert np.isnan(track.at_time(1e6)["x"])


def test_the_wind_is_in_the_first_order_track_as_it_is_in_the_ships_own(pilot):
    """A moment of the wind acts as so much rudder does: K*/tau* of it, with the ship's own coefficient of the wind."""
    first = TrackPredictor(pilot, model="first-order", parts=(Wind,))
    known = {"psi": 0.0, "u": 9.5, "wind_speed": 15.0, "wind_direction": 2.0}
    turned = {}
    for name, predictor in (("first", first), ("own", TrackPredictor(pilot, parts=(Wind,)))):
        calm = predictor.predict(Situation({"psi": 0.0, "u": 9.5}), rudder=0.0, horizon=2)
        windy = predictor.predict(Situation(known), rudder=0.0, horizon=2)
        assert abs(calm.psi[-1]) < 1e-9
        turned[name] = windy.psi[-1]
    assert abs(turned["own"]) > 0.01
    assert turned["first"] == pytest.approx(turned["own"], rel=0.1)
    found = shipid.predict_track(pilot, known, rudder=0.0, horizon=2, model="first-order")
    assert found.track.psi[-1] == pytest.approx(turned["first"], abs=1e-9)


def test_a_ship_without_coefficients_of_the_wind_is_told(pilot):
    ship = replace(pilot.ship, sections={n: s for n, s in pilot.ship.sections.items() if n != "wind"})
    known = {"psi": 0.0, "u": 9.5, "wind_speed": 15.0, "wind_direction": 2.0}
    with pytest.raises(ParameterSetError, match="needs F_w"):
        shipid.predict_track(replace(pilot, ships=(ship,)), known, rudder=0.0, model="first-order")


def test_a_situation_may_be_values_by_name(pilot):
    predictor = TrackPredictor(pilot)
    one, other = (predictor.predict(s, heading="20 deg") for s in ({"psi": "0 deg", "u": 9.5}, STILL))
    np.testing.assert_array_equal(one.x, other.x)
    for wrong in ([0.0, 9.5], {"psi": 0.0, "u": None}):
        with pytest.raises(UsageError, match="values by name"):
            predictor.predict(wrong, heading="20 deg")
