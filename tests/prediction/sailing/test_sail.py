from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import shipid
from shipid.foundation.errors import ParameterSetError, UnknownNameError, UsageError
from shipid.models import DeKeizer, PlanarMotion, VanLeeuwenSway, WaveMoment
from shipid.prediction.routes.route import Route, Waypoint
from shipid.prediction.sailing.sail import sail
from shipid.prediction.sailing.sail_route import sail_route
from shipid.prediction.situations.filtered_situation import situation_of
from shipid.prediction.situations.own_ship_filter import own_ship_filter
from shipid.prediction.tracks.track_predictor import TrackPredictor
from shipid.trials.manoeuvres.simulate import NotSailedError


def test_courses_are_reached_one_after_the_other(pilot):
    trial = sail(pilot, [("50 s", "60 deg"), ("500 s", "350 deg"), (1000, "350 deg")], heading="10 deg")
    t, psi = trial.table["t"].to_numpy(), np.rad2deg(trial.table["psi"].to_numpy())
    assert psi[t < 50] == pytest.approx(10, abs=1e-6)
    assert psi[t == 499] == pytest.approx(60, abs=0.5)
    # 350 degrees the shorter way round.
    assert psi[-1] == pytest.approx(-10, abs=0.2)
    assert trial.source.simulated and "ordered 60 deg at 50 s" in trial.source.comment


def test_a_trial_sailed_is_identified(pilot, tmp_path):
    trial = sail(pilot, [(50, "40 deg"), (300, "0 deg"), (550, "40 deg")], noise="standard", rudder_limit="20 deg")
    shipid.write_trial(trial, tmp_path / "voyage.csv")
    fit = shipid.identify("de-keizer", [shipid.read_trial(tmp_path / "voyage.csv")], ship="soesterberg")
    assert fit.parameters["K"].value == pytest.approx(1.6, rel=0.05)


def test_wind_on_a_ship_without_its_coefficients_says_what_to_state(pilot, tmp_path):
    bare = dataclasses.replace(pilot.ship, sections={k: v for k, v in pilot.ship.sections.items() if k != "wind"})
    own = dataclasses.replace(pilot, ships=(bare,))
    words = r"needs F_w \[1/m²\], N_w \[rad/m²\], which ship soesterberg does not hold. State them, as in --set"
    with pytest.raises(ParameterSetError, match=words):
        sail(own, "60 deg", duration=300, wind=("15 m/s", "135 deg"))
    (tmp_path / "plan.csv").write_text("x [m],y [m]\n0,0\n3000,0\n6000,2000\n", encoding="utf-8")
    route = shipid.read_route(tmp_path / "plan.csv")
    with pytest.raises(ParameterSetError, match=words):
        shipid.sail_route(own, route, wind=("15 m/s", "135 deg"))


def test_weather_acts(pilot):
    calm = sail(pilot, "60 deg", duration=300)
    drifted = sail(pilot, "60 deg", duration=300, current=("1 m/s", "90 deg"))
    np.testing.assert_allclose(drifted.table["y"] - calm.table["y"], calm.table["t"], atol=1e-6)
    windy = sail(pilot, "60 deg", duration=300, wind=("15 m/s", "135 deg"))
    np.testing.assert_allclose(windy["wind_speed"], 15.0)
    np.testing.assert_allclose(windy["wind_direction"], np.deg2rad(135))
    assert np.abs(windy.table["psi"] - calm.table["psi"]).max() > np.deg2rad(0.5)
    rough = sail(pilot, 0.0, duration=2000, waves=("0.5 deg", "120 deg"), seed=4)
    assert np.rad2deg(rough.table["psi"].std()) == pytest.approx(0.5, rel=0.35)


def test_another_ship_is_steered_by_the_same_gains(pilot):
    other = sail(pilot, "60 deg", model="van-leeuwen", ship="soesterberg")
    assert np.rad2deg(other.table["psi"].iloc[-1]) == pytest.approx(60, abs=0.5)
    harder = sail(pilot, "60 deg", values={"K": 3.0})
    assert "K 3.0" in harder.source.comment
    assert harder.table["r"].max() > 1.2 * sail(pilot, "60 deg").table["r"].max()


@pytest.mark.parametrize(
    ("courses", "more", "says"),
    [
        ([], {}, "needs a course"),
        ([(100, 1.0), (50, 0.0)], {}, "earlier than the one before"),
        ("60 deg", {"speed": "-3 kn"}, "does not steer"),
        ("60 deg", {"sampling": "1 h"}, "does not fit"),
        ("60 deg", {"inputs": {"shaft": 1.0}}, "reads no input 'shaft'"),
        ("60 deg", {"duration": 1e9, "sampling": 1.0}, "takes more than"),
    ],
)
def test_voyages_that_are_none(pilot, courses, more, says):
    with pytest.raises(UsageError, match=says):
        sail(pilot, courses, **more)


def test_a_coefficient_that_is_none_is_told(pilot):
    with pytest.raises(UnknownNameError, match="K_star"):
        sail(pilot, "60 deg", values={"K_star": 1.0})


def test_a_ship_that_runs_away_is_told():
    pilot = shipid.design_autopilot("norrbin", "soesterberg", rudder_limit="30 deg")
    with pytest.raises(NotSailedError, match="smaller rudder limit"):
        sail(pilot, "170 deg", values={"b3": -100.0})


def test_a_situation_holds_what_the_filter_knows_and_nothing_later(pilot):
    trial = sail(pilot, [(200, "60 deg")], noise="standard", current=("1 m/s", "90 deg"), duration=500)
    own = own_ship_filter("de-keizer", "soesterberg", estimated=["K"], noise={"K": "0.01 1/s^0.5"})
    run = own.filter(trial)
    found = situation_of(run, 300.2)
    assert found.t == 300.0
    assert found.values["psi"] == pytest.approx(np.interp(300, trial.table["t"], trial.table["psi"]), abs=0.02)
    assert found.values["current_east"] == pytest.approx(1.0, abs=4 * found.std_of("current_east"))
    # K is estimated by its logarithm: its spread here is that of K itself.
    k = int(np.searchsorted(run.t, 300.0))
    assert found.values["K"] == pytest.approx(run["K"][k]) and found.std_of("K") == pytest.approx(run.std_of("K")[k])
    assert found.values["delta"] == pytest.approx(trial.table["delta"][k])
    cut = own.filter({n: trial.table[n].to_numpy()[: k + 1] for n in trial.table.columns})
    again = situation_of(cut)
    assert again.values["x"] == pytest.approx(found.values["x"], abs=1e-9)
    np.testing.assert_allclose(again.covariance, found.covariance, atol=1e-12)
    assert found.noise["r"] > 0 and found.noise["K"] == pytest.approx(0.01, rel=0.1)
    fewer = situation_of(run, 300.2, coefficients=False)
    assert "K" not in fewer.values and "K" not in fewer.uncertain
    with pytest.raises(UsageError, match="nothing is known"):
        situation_of(run, -5.0)


def test_the_track_from_a_filter_is_inside_its_band(pilot):
    predictor = TrackPredictor(pilot)
    inside = []
    for seed in range(12):
        trial = sail(pilot, [(300, "80 deg")], noise="standard", current=("1 m/s", "90 deg"), seed=seed, duration=700)
        run = own_ship_filter("de-keizer", "soesterberg").filter(trial)
        clean = sail(pilot, [(300, "80 deg")], current=("1 m/s", "90 deg"), duration=700)
        track = predictor.predict(situation_of(run, 300.0), heading="80 deg", horizon=12)
        t = clean.table["t"].to_numpy()
        rows = (t >= 300) & (t < 300 + track.t[-1])
        across, node = track.distance_to(clean.table["x"][rows].to_numpy(), clean.table["y"][rows].to_numpy())
        inside.append(np.mean(np.abs(across) <= np.interp(node, np.arange(track.s.size), track.half_width)))
    assert np.mean(inside) > 0.85


def test_waves_with_a_moment_move_the_ship_that_is_steered(pilot):
    """Their size is a height; the rudder answers a yaw that the path has, on courses and on a route."""
    model = shipid.join("in a sea", DeKeizer, VanLeeuwenSway, PlanarMotion, WaveMoment)
    values = {"H_g": "1e-4 rad/m/s^2"}
    moved = sail(pilot, "0 deg", model=model, waves="2 m from 45 deg", values=values, duration="300 s")
    assert moved.source.comment.endswith("9.5 m/s, noise none, seed 0; H_g 1e-4 rad/m/s^2; waves 2 m from 45 deg")
    assert np.std(moved["delta"]) > np.deg2rad(0.02) and np.std(moved["r"]) > np.deg2rad(0.002)
    places = (Waypoint((0.0, 0.0), "A"), Waypoint((6000.0, 0.0), "B"))
    route = Route("straight", places, geographic=False)
    voyage = sail_route(pilot, route, model=model, waves="2 m from 45 deg", values=values, duration="200 s")
    assert np.std(voyage.trial["r"]) > np.deg2rad(0.002)
    assert "noise none, seed 0; H_g 1e-4 rad/m/s^2; waves 2 m from 45 deg" in voyage.trial.source.comment
