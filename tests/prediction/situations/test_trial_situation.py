"""What is known of a ship at an instant of a trial."""

from __future__ import annotations

import dataclasses

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.identification.problem.prior import STRUCTURE_ANGLE, STRUCTURE_SPEED
from shipid.parameters.correlation import Joint
from shipid.parameters.draws import draw_coefficients
from shipid.parameters.parameter_set import Value
from shipid.parameters.validity import BEYOND, range_of
from shipid.prediction.predict_track import predict_track
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.own_ship_filter import own_ship_model
from shipid.prediction.situations.ship_spread import structural_noise, with_coefficients
from shipid.prediction.situations.situation import Situation
from shipid.prediction.situations.trial_situation import known_before

SHIP = shipid.find_ship("esso-osaka-3m")
COEFFICIENTS = {"a": 1.2, "b1": 0.6, "b3": 2.2, "gamma": 0.46, "N_w": -1.7e-4, "N_w1": -1.1e-4}
#: A yaw acceleration that no wind explains, in rad/s^2: 4 degrees of rudder.
PUSH = 1.2 * np.deg2rad(4.0) * (0.35 / 3.0) ** 2


@pytest.fixture(scope="module")
def fitted():
    """The ship as a fit of a model writes it: coefficients with their spread and correlation under that model's name."""
    values = {
        n: Value(n, v, "rad/m^2" if n.startswith("N_") else "1", "assumed", std=0.05 * abs(v))
        for n, v in COEFFICIENTS.items()
    }
    names = tuple(COEFFICIENTS)
    joint = Joint(names, tuple(tuple(map(float, row)) for row in np.eye(len(names))), (0.2, 0.5))
    return dataclasses.replace(
        SHIP, sections={**SHIP.sections, "cubic-wind": values}, joint={**SHIP.joint, "cubic-wind": joint}
    )


@pytest.fixture(scope="module")
def pilot(fitted):
    return shipid.design_autopilot("cubic-wind", fitted)


@pytest.fixture(scope="module")
def trial(pilot):
    """A 3 m model changes her course, in wind with gusts and under a push that nobody measures."""
    made = sail(
        pilot, [(20.0, "20 deg"), (60.0, "-20 deg")], speed=0.35, duration=110.0, sampling=0.5,
        noise={"psi": "0.2 deg", "r": "0.05 deg/s", "u": "0.01 m/s", "x": "0.02 m", "y": "0.02 m"},
        inputs={"r_residual": PUSH, "wind_speed": 1.0, "wind_direction": np.pi / 2},
    )  # fmt: skip
    gusts = 1.0 + 0.6 * np.sin(0.9 * made.table["t"])
    return dataclasses.replace(made, table=made.table.assign(wind_speed=gusts, wind_direction=np.pi / 2))


def test_a_record_that_is_finer_than_a_filter_needs_is_read_more_coarsely(pilot, trial):
    t = np.arange(0.0, 60.05, 0.1)
    table = pd.DataFrame({n: t if n == "t" else np.interp(t, trial["t"], trial[n]) for n in trial.table.columns})
    fine = dataclasses.replace(trial, table=table)
    known, _, past = known_before(pilot.model, pilot.ship, fine)
    assert known.t == past.t[-1] == pytest.approx(60.0)
    assert np.diff(past.t) == pytest.approx(0.2)
    # What the record missed may stand in any row: none is left out.
    holes = dataclasses.replace(trial, table=table.assign(x=table["x"].where(table.index % 10 == 0)))
    _, _, whole = known_before(pilot.model, pilot.ship, holes)
    assert np.diff(whole.t) == pytest.approx(0.1)
    assert np.interp(past.t, whole.t, whole.psi) == pytest.approx(past.psi, abs=0.01)


def test_what_the_wind_does_not_explain_is_found_under_a_model_that_reads_the_wind(pilot, trial):
    found, _, _ = known_before(pilot.model, pilot.ship, trial)
    assert found.values["r_residual"] == pytest.approx(PUSH, abs=4 * found.std_of("r_residual"))
    assert found.std_of("r_residual") < 0.5 * PUSH
    # The mean wind goes on, not the gust of the last sample.
    assert found.values["wind_speed"] == pytest.approx(1.0, abs=0.12)
    assert abs(trial.table["wind_speed"].iloc[-1] - 1.0) > 0.4
    assert found.values["wind_direction"] == pytest.approx(np.pi / 2)


def test_a_model_that_is_extended_is_still_the_ship_that_was_fitted(fitted):
    """The filter's model has the current and more joined to it: coefficients, spread and range are those of the fitted model."""
    model = own_ship_model("cubic-wind")
    assert model.name != "cubic-wind" and {"r_residual", "current_north"} <= set(model.states)
    assert fitted.values(model)["a"] == 1.2
    drawn = draw_coefficients(model, fitted, 2000)
    assert drawn.names == draw_coefficients(shipid.find_model("cubic-wind"), fitted, 10).names
    assert drawn.source.startswith("the covariance of")
    assert range_of(fitted, model)[0] == "cubic-wind"


def test_an_identified_model_is_not_the_ship(pilot, fitted):
    """Its turning and its drift are off as by its structure; a ship whose set states no spread gets nothing of that."""
    known = Situation({"psi": 0.0, "u": 0.35}, noise={"psi": 1e-3})
    found = with_coefficients(known, pilot)
    assert set(COEFFICIENTS) == set(found.uncertain)
    lasts = np.sqrt(3 * 3.0 / 0.35)
    assert found.noise["psi"] == pytest.approx(np.hypot(1e-3, STRUCTURE_ANGLE * 0.35 / 3.0 * lasts), rel=1e-3)
    assert found.noise["x"] == found.noise["y"] == pytest.approx(STRUCTURE_ANGLE * 0.35 * lasts)
    assert found.noise["track_t"] == pytest.approx(STRUCTURE_SPEED * lasts)
    assured = shipid.design_autopilot("de-keizer", "soesterberg")
    same = Situation({"psi": 0.0, "u": 9.5})
    assert with_coefficients(same, assured) is same


def test_a_filter_that_estimates_all_coefficients_does_not_make_the_model_the_ship(pilot):
    known = Situation({"psi": 0.0, "u": 0.35, **COEFFICIENTS}, ("a",), np.array([[0.01]]))
    found = with_coefficients(known, pilot)
    assert found.uncertain == ("a",) and found.covariance.tolist() == [[0.01]]
    assert found.noise == pytest.approx(structural_noise(0.35, 3.0))


def test_the_band_of_a_straight_track_is_that_of_the_structure(pilot):
    """With the rudder amidships the error of the turning is integrated twice, and that of the drift once."""
    track = predict_track(pilot, {"psi": 0.0, "u": 0.35, "r_residual": 0.0}, rudder=0.0, horizon=4).track
    turning, drift = STRUCTURE_ANGLE * 0.35 / 3.0, STRUCTURE_ANGLE * 0.35
    lasts, t = 3 * 3.0 / 0.35, track.t[1:]
    expected = 1.96 * np.sqrt(lasts * (turning**2 * 0.35**2 * t**3 / 3 + drift**2 * t))
    assert track.half_width[1:] == pytest.approx(expected, rel=0.02)
    assert track.std["t"][-1] == pytest.approx(STRUCTURE_SPEED * np.sqrt(lasts * t[-1]), rel=0.01)


def test_bands_grow_beyond_the_amplitudes_that_were_fitted(fitted):
    """A ship identified with 10 degrees of rudder, predicted with 35: the error of the model counts as many times, and it is said."""
    joint = dataclasses.replace(fitted.joint["cubic-wind"], rudder=np.deg2rad(10.0))
    known = dataclasses.replace(fitted, joint={"cubic-wind": joint})
    wide, within = (shipid.design_autopilot("cubic-wind", s) for s in (known, fitted))
    start = {"psi": 0.0, "u": 0.35, "r_residual": 0.0}
    for band, growth in (("linear", 3.5), ("samples", 3.5)):
        found = predict_track(wide, start, rudder="35 deg", horizon=3, band=band)
        usual = predict_track(within, start, rudder="35 deg", horizon=3, band=band)
        assert found.track.grown == pytest.approx(growth) and usual.track.grown == 1.0
        assert found.to_dict()["prediction"]["grown"] == found.track.grown
        # At the beginning of the turn the coefficients hardly count.
        assert (found.track.half_width[1:] > usual.track.half_width[1:]).all()
        assert found.track.half_width[20] == pytest.approx(growth * usual.track.half_width[20], rel=0.1)
        (said,) = (n for n in found.warnings if n.kind == BEYOND)
        assert "35 deg" in said and "the band takes its error as 3.5 times as large" in said
    again = predict_track(wide, start, rudder="8 deg", horizon=3)
    usual = predict_track(within, start, rudder="8 deg", horizon=3)
    np.testing.assert_array_equal(again.track.half_width, usual.track.half_width)
    bare = predict_track(wide, start, rudder="35 deg", horizon=3, band="none")
    assert any("no band contains that error" in n for n in bare.warnings)
