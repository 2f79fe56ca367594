"""Every estimator returns the truth it was given: exactly without noise, within its own uncertainty with it."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.declaration.scale import Scale
from shipid.declaration.vocabulary import FIELDS
from shipid.identification.problem.box import box_of
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.ship_scale import guessed_unit_time
from shipid.identification.uncertainty.estimates import estimates_of

#: Model, ship, manoeuvres: what together determine all coefficients the model estimates by itself.
CASES = [
    ("nomoto", "zeefakkel", ("zigzag:20/20",)),
    ("nomoto-second-order", "mariner", ("zigzag:20/20", "telegraph:10")),
    ("norrbin", "zeefakkel", ("zigzag:20/20",)),
    ("bech", "kvlcc2", ("zigzag:20/20", "zigzag:10/10", "telegraph:10")),
    ("de-keizer", "soesterberg", ("zigzag:20/20",)),
    ("van-leeuwen", "soesterberg", ("zigzag:20/20",)),
]
#: A fortieth of the time in which the ship sails her length, or less.
FINE = {"zeefakkel": "0.2 s", "mariner": "0.5 s", "kvlcc2": "1 s", "soesterberg": "0.2 s"}


@pytest.mark.parametrize(("model", "ship", "manoeuvres"), CASES)
def test_without_noise_the_truth_comes_back(sail, truth_of, model, ship, manoeuvres):
    """To what the record leaves open: its rudder runs straight between samples, the simulated one turns corners."""
    trials = [sail(model, ship, m, noise=None, sampling=FINE[ship], name=m) for m in manoeuvres]
    truth = truth_of(model, ship)
    # The search may not start at the truth: the particulars are known, the coefficients are not.
    fit = shipid.identify(model, trials, ship=_particulars(ship), starts=3)
    assert fit.converged
    for name in fit.estimated:
        size = max(abs(truth[name]), 0.05 * abs(fit.model[name].number("start") or 1.0))
        assert fit.parameters[name].value == pytest.approx(truth[name], abs=0.01 * size), name


@pytest.mark.parametrize(("model", "ship", "manoeuvres"), CASES)
def test_with_noise_the_truth_is_within_its_uncertainty(sail, truth_of, model, ship, manoeuvres):
    trials = [sail(model, ship, m, sampling="1 s", seed=i, name=m) for i, m in enumerate(manoeuvres)]
    truth = truth_of(model, ship)
    fit = shipid.identify(model, trials, ship=ship, starts=1)
    assert fit.converged
    for name in fit.estimated:
        estimate = fit.parameters[name]
        assert estimate.std is not None, name
        # Four standard deviations: once in 16,000 by chance, and the seeds are fixed.
        assert abs(estimate.value - truth[name]) < 4 * estimate.std, name


def _particulars(ship: str) -> shipid.ParameterSet:
    known = shipid.find_ship(ship)
    return shipid.ParameterSet(ship, sections={"particulars": known.sections["particulars"]})


def test_a_ship_that_does_not_keep_its_course_is_found(sail, truth_of):
    """The regular form passes through b1 = 0; published K and tau follow with their sign."""
    values = {"a": "3e-4 1/s^2", "b1": "-4e-3 1/s", "b3": "300 s/rad^2"}
    trial = sail("norrbin", "kvlcc2", noise=None, values=values, sampling="0.5 s")
    fit = shipid.identify("norrbin", [trial], ship=_particulars("kvlcc2"), starts=3)
    assert fit.parameters["b1"].value == pytest.approx(-4e-3, rel=0.02)
    assert fit.parameters["tau"].value == pytest.approx(-250, rel=0.02)
    assert fit.parameters["K"].value == pytest.approx(-0.075, rel=0.02)
    assert fit.parameters["K"].follows and not fit.parameters["a"].follows


def test_noise_levels_are_found(sail):
    fit = shipid.identify("norrbin", [sail("norrbin", "zeefakkel", seed=5)], ship="zeefakkel", starts=2)
    # 1500 samples: the standard deviation is known to 2 %; five of those.
    assert np.rad2deg(fit.noise["psi"]) == pytest.approx(0.2, rel=0.1)
    assert np.rad2deg(fit.noise["r"]) == pytest.approx(0.02, rel=0.1)


def test_given_noise_levels_are_kept_and_chi_square_sees_wrong_ones(sail):
    trial = sail("norrbin", "zeefakkel", seed=5)
    right = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1, noise={"psi": "0.2 deg", "r": "0.02 deg/s"})
    low = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1, noise={"psi": "0.1 deg", "r": "0.01 deg/s"})
    assert right.noise["psi"] == pytest.approx(np.deg2rad(0.2))
    assert right.chi_square == pytest.approx(1.0, abs=0.15)
    assert low.chi_square == pytest.approx(4.0, abs=0.6)


def test_a_rudder_bias_is_found_in_each_trial(sail, truth_of):
    trials = []
    for i, bias in enumerate((1.5, -2.0)):
        frame = sail("norrbin", "zeefakkel", seed=i).table.copy()
        frame["delta"] -= np.deg2rad(bias)
        units = {n: FIELDS[n].unit for n in frame.columns}
        trials.append(shipid.Trial.from_frame(frame, name=f"t{i}", units=units))
    fit = shipid.identify("norrbin", trials, ship="zeefakkel", starts=1)
    assert [np.rad2deg(c.bias) for c in fit.fitted] == pytest.approx([1.5, -2.0], abs=0.05)
    blind = shipid.identify("norrbin", trials, ship="zeefakkel", starts=1, rudder_bias=False)
    assert all(c.bias == 0 for c in blind.fitted)
    assert blind.fitted[0].rmse["psi"] > 2 * fit.fitted[0].rmse["psi"]


def test_a_current_is_found_from_the_track(sail):
    trial = sail("de-keizer", "soesterberg", noise="standard", seed=1, current=("3 kn", "30 deg"))
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", starts=2)
    found = fit.fitted[0].biases
    # 10 m fixes over 700 s leave the current a few mm/s; the sway trades off with it.
    assert np.hypot(found["current_north"], found["current_east"]) == pytest.approx(1.543, abs=0.03)
    assert np.rad2deg(np.arctan2(found["current_east"], found["current_north"])) == pytest.approx(30, abs=1.0)
    assert abs(fit.parameters["gamma"].value - 0.573) < 4 * fit.parameters["gamma"].std


@pytest.mark.parametrize(
    ("wind", "signals"),
    [(None, "psi x y"), ("15 m/s from 60 deg", "psi x y"), ("15 m/s from 60 deg", "psi r u")],
)
def test_the_truth_comes_back_from_a_wind_that_simulate_adds(wind, signals):
    """From positions the cruising speed is known to a part of a percent only, and a wind slows the ship before the manoeuvre."""
    trials = [
        shipid.simulate("de-keizer", "soesterberg", manoeuvre, noise="standard", wind=wind, seed=k, name=manoeuvre)
        for k, manoeuvre in enumerate(("zigzag:20/20", "turn:20"))
    ]
    model = "de-keizer-wind" if wind else "de-keizer"
    fit = shipid.identify(model, trials, ship="soesterberg", signals=signals.split(), starts=1)
    blown = {"N_w": 3.3e-7, "F_w": 3.5e-7} if wind else {}
    for name, truth in {"K": 1.6, "tau": 1.7, "K_u": 0.35, **blown}.items():
        assert abs(fit.parameters[name].value - truth) < 3 * fit.parameters[name].std
    assert fit.parameters["K"].std < 0.01


def test_two_trials_are_surer_than_one(sail):
    one, two = (sail("norrbin", "zeefakkel", m, seed=i) for i, m in enumerate(("zigzag:20/20", "zigzag:10/10")))
    alone = shipid.identify("norrbin", [one], ship="zeefakkel", starts=1)
    both = shipid.identify("norrbin", [one, two], ship="zeefakkel", starts=1)
    assert all(both.parameters[n].std < alone.parameters[n].std for n in both.estimated)
    assert [c.trial.name for c in both.fitted] == [one.name, two.name]


def test_what_is_fixed_stays_and_published_names_can_be_fixed(sail):
    trial = sail("norrbin", "zeefakkel", speed="5 m/s")
    fit = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1, fixed={"n3": "0.4 s^2/deg^2"})
    assert fit.estimated == ("a", "b1")
    assert fit.fixed["n3"] == pytest.approx(0.4 * (180 / np.pi) ** 2)
    # The truth has this n3, so the other coefficients come back as well.
    assert fit.parameters["tau"].value == pytest.approx(31.0, rel=0.03)
    assert fit.parameters["K"].value == pytest.approx(0.5, rel=0.03)


def test_published_names_can_be_estimated(sail):
    trial = sail("norrbin", "zeefakkel", speed="5 m/s")
    fit = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1, estimate=["K", "tau"])
    assert fit.estimated == ("a", "b1")


def test_an_identified_ship_goes_on_as_a_ship(sail, tmp_path):
    trial = sail("norrbin", "zeefakkel", speed="5 m/s")
    fit = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1)
    shipid.write_parameter_set(fit.ship, tmp_path / "ship.toml")
    back = shipid.read_parameter_set(tmp_path / "ship.toml")
    again = back.values(shipid.find_model("norrbin"))
    assert {n: again[n] for n in fit.estimated} == {n: fit.parameters[n].value for n in fit.estimated}
    assert back.sections["norrbin"]["a"].std == pytest.approx(fit.parameters["a"].std)
    assert "identified" in back.sections["norrbin"]["a"].source
    assert back.particular("L", "m") == 45


def test_published_and_prime_coefficients_have_closed_forms():
    """Norrbin: K = a / b1 and tau = 1 / b1, with errors propagated to first order; K' = K L/U, tau' = tau U/L."""
    values, spread, correlation = np.array([0.012, 0.05]), np.array([0.0006, 0.004]), 0.8
    covariance = np.outer(spread, spread) * np.array([[1.0, correlation], [correlation, 1.0]])
    box = box_of({"a": (0.01, 0.0, 1.0), "b1": (0.05, -1.0, 1.0)})
    model, length, speed = shipid.find_model("norrbin"), 45.0, 5.0
    problem = make_problem(model, [], ("psi",), ("a", "b1"), {"b3": 10.0}, np.ones(1), ())
    found = estimates_of(problem, values, covariance, box, Scale(length, speed))
    relative = spread / values
    gain, constant = found["K"], found["tau"]
    assert (gain.value, constant.value) == pytest.approx((0.24, 20.0))
    assert gain.std == pytest.approx(0.24 * np.sqrt(relative @ relative - 2 * correlation * relative.prod()))
    assert constant.std == pytest.approx(20.0 * relative[1])
    prime = {n: found[n].prime for n in ("a", "b1", "K", "tau")}
    assert prime == pytest.approx({"a": 0.012 * 81, "b1": 0.05 * 9, "K": 0.24 * 9, "tau": 20.0 / 9})


def test_the_time_of_a_ship_of_unknown_length_is_a_ninth_of_the_rudder_s_period(drifting):
    trial, _ = drifting(0.001, 600, seed=1)
    assert guessed_unit_time([trial]) == pytest.approx(60 / 9, rel=0.01)


def test_the_same_trials_give_the_same_numbers(sail):
    trial = sail("norrbin", "zeefakkel")
    first, second = (shipid.identify("norrbin", [trial], ship="zeefakkel", starts=2, seed=3) for _ in range(2))
    assert first.to_dict() == second.to_dict()
