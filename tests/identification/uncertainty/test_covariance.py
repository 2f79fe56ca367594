"""What the data do not determine is said, and the counting of effective samples has closed forms."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter
from scipy.stats import linregress, multivariate_normal, norm

import shipid
from shipid import Component, given, parameter, state
from shipid.identification.problem.box import box_of
from shipid.identification.problem.output_error import make_problem
from shipid.identification.problem.prior import Prior, prior_of
from shipid.identification.problem.trial_data import prepare
from shipid.identification.search.least_squares import minimise
from shipid.identification.search.solution import Solution
from shipid.identification.search.trust_region import triangle
from shipid.identification.uncertainty.covariance import autocorrelation_time, correlation_of, covariance_of, verdict


@pytest.mark.parametrize("phi", [0.5, 0.9, 0.97])
def test_autocorrelation_time_of_a_first_order_process(phi):
    """(1 + phi) / (1 - phi) in closed form."""
    rng = np.random.default_rng(1)
    noise = rng.standard_normal(60_000)
    series = np.empty_like(noise)
    series[0] = noise[0]
    for i in range(1, noise.size):
        series[i] = phi * series[i - 1] + noise[i]
    # The estimate scatters by about sqrt(tau / N) of itself, times a few.
    assert autocorrelation_time(series) == pytest.approx((1 + phi) / (1 - phi), rel=0.15)


def test_autocorrelation_time_of_white_noise_is_one():
    rng = np.random.default_rng(2)
    times = [autocorrelation_time(rng.standard_normal(600)) for _ in range(300)]
    assert np.mean(np.array(times) > 1) < 0.02


@pytest.mark.parametrize("series", [np.zeros(100), np.ones(100), np.array([1.0, -1.0])])
def test_autocorrelation_time_at_the_edges(series):
    assert autocorrelation_time(series) == 1.0


def test_a_ramp_never_counts_as_fewer_than_four_samples():
    assert autocorrelation_time(np.arange(400.0)) <= 100


def test_the_condensed_problem_has_the_same_cost_gradient_and_curvature():
    rng = np.random.default_rng(3)
    residual, jacobian = rng.standard_normal(500), rng.standard_normal((500, 6))
    rows = triangle(residual, jacobian)
    r, j = rows[:, -1], rows[:, :-1]
    assert len(r) == 7
    assert r @ r == pytest.approx(residual @ residual)
    assert j.T @ r == pytest.approx(jacobian.T @ residual)
    assert j.T @ j == pytest.approx(jacobian.T @ jacobian)


def test_correlation_of_an_infinite_variance_is_zero():
    matrix = np.diag([4.0, np.inf, 9.0])
    matrix[0, 2] = matrix[2, 0] = 3.0
    assert correlation_of(matrix) == pytest.approx(np.array([[1, 0, 0.5], [0, 1, 0], [0.5, 0, 1]]))


def test_verdicts():
    assert verdict(1.0, 0.1, 1.0, 0.0, 10.0, "") == ("determined", "")
    cases = {
        (1.0, np.inf, 1.0, 0.0, 10.0, ""): ("not determined", "no information"),
        (0.0, 0.01, 1.0, 0.0, 10.0, ""): ("not determined", "bound"),
        (1.0, 0.9, 1.0, -10.0, 10.0, ""): ("not determined", "90 % of its value"),
        (1.0, 0.9, 1.0, -10.0, 10.0, "b (+0.99)"): ("not determined", "trades off with b (+0.99)"),
        (0.0, 0.1, 1.0, -10.0, 10.0, ""): ("not distinguishable from zero", "-0.2 to 0.2, holds zero"),
        (1.0, 4.3, 1.0, -10.0, 10.0, ""): ("not determined", "4.3 times its value: the data leave its size open"),
        (0.1, 0.09, 1.0, 0.01, 10.0, ""): ("not determined", "90 % of its value"),  # it must be positive
        (1.0, 0.095, 1.0, 0.0, 10.0, "", 0.1): ("not determined", "95 % of the one it started with"),
    }
    for case, (standing, words) in cases.items():
        found, why = verdict(*case)
        assert found == standing and words in why, (case, found, why)


@pytest.mark.parametrize("strength", [1.0, 7.0])
def test_without_data_the_uncertainty_is_that_of_the_belief(drift, drifting, strength):
    """The rudder rests amidships and shows no gain; how many samples outvote the belief does not make it surer."""
    trial, _ = drifting(np.deg2rad(0.5), 100, seed=1, rudder=0.0)
    data, sigma = prepare(drift, trial, ("psi",), None), np.array([np.deg2rad(0.5)])
    problem = make_problem(drift, [data], ("psi",), ("gain", "swing"), {}, sigma, ())
    prior = Prior({}, {}, {}, {}, parameters={"gain": (0.1, 0.02)}, strength=strength)
    box = box_of({"gain": (0.3, -10, 10), "swing": (0.0, -1, 1)})
    found = minimise(replace(problem, prior=prior), problem.first_guess(box.start), box, most=50)
    assert found.q[0] == pytest.approx(0.1)
    assert np.sqrt(covariance_of(found).matrix[0, 0]) == pytest.approx(0.02, rel=1e-6)


def test_weights_three_times_too_small_make_nothing_surer(drift, drifting):
    """One signal: its residuals say how large its noise is, whatever weight it was given, and how many samples count."""
    sigma, phi = np.deg2rad(0.5), 0.8
    trial, design = drifting(sigma, 400, seed=6)
    noise = lfilter([np.sqrt(1 - phi**2)], [1.0, -phi], np.random.default_rng(7).standard_normal(900))[500:]
    found = []
    for given_ in (sigma, 3 * sigma):
        problem = make_problem(
            drift, [prepare(drift, trial, ("psi",), None)], ("psi",), ("gain", "swing"), {}, np.array([given_]), ()
        )
        q = problem.first_guess(np.array([0.05, 1e-4]))
        solution = Solution(problem, q, sigma * noise / given_, design / given_, True, "", 1)
        found.append(covariance_of(solution))
    assert found[1].matrix == pytest.approx(found[0].matrix, rel=1e-9)
    assert found[1].effective == pytest.approx(found[0].effective, rel=1e-9)
    assert found[1].effective[0, 0] < 0.5


def test_a_belief_takes_no_noise_out_of_the_residuals(drift, drifting):
    """A belief of some weight adds its own spread to the covariance, and leaves the part of the noise as it is."""
    sigma, phi, count, strength = np.deg2rad(0.5), 0.9, 300, 100.0
    trial, design = drifting(sigma, count, seed=8)
    slopes = design / sigma
    # As sure as the record, if each of its samples were independent.
    beliefs = np.diag(np.linalg.norm(slopes, axis=0))
    jacobian = np.vstack([slopes, beliefs])
    flat = np.linalg.inv(jacobian.T @ jacobian)
    problem = make_problem(
        drift, [prepare(drift, trial, ("psi",), None)], ("psi",), ("gain", "swing"), {}, np.array([sigma]), ()
    )
    prior = Prior({}, {}, {}, {}, parameters={n: (0.0, 1.0) for n in ("gain", "swing")}, strength=strength)
    problem = replace(problem, prior=prior)
    q = problem.first_guess(np.array([0.05, 1e-4]))
    found = []
    for seed in range(40):
        drive = np.random.default_rng(seed).standard_normal(count + 500)
        noise = lfilter([np.sqrt(1 - phi**2)], [1.0, -phi], drive)[500:]
        step = flat @ slopes.T @ noise
        residual = np.concatenate([noise - slopes @ step, -beliefs @ step])
        found.append(covariance_of(Solution(problem, q, residual, jacobian, True, "", 1)).matrix)
    of_noise = slopes.T @ toeplitz(phi ** np.arange(count)) @ slopes
    of_beliefs = strength * beliefs.T @ beliefs
    by_noise = np.mean(found, axis=0) - flat @ of_beliefs @ flat
    # 40 spectra of 300 samples scatter by some 5 % in their mean.
    assert np.diag(by_noise) == pytest.approx(np.diag(flat @ of_noise @ flat), rel=0.15)


def test_the_first_guess_of_a_state_is_a_regression_on_the_first_samples(drift, drifting):
    trial, _ = drifting(np.deg2rad(0.5), 100, seed=2)
    data = prepare(drift, trial, ("psi",), None, unit_time=100.0)  # a quarter of L/U, at one sample a second
    line = linregress(trial["t"][:25], trial["psi"][:25])
    assert data.start["psi"] == pytest.approx(line.intercept, rel=1e-9)
    assert data.start_std["psi"] == pytest.approx(line.intercept_stderr, rel=1e-9)


class Steered(Component):
    """Yaw and surge with a disturbance that nobody measures; two coefficients in the prime system, one without a unit."""

    psi = state("rad", "heading", wraps=True)
    r = state("rad/s", "rate of turn")
    w = state("rad/s", "what waves add to the rate", nominal="0.2 deg/s")
    u = state("m/s", "forward speed")
    delta = given("rad", "rudder angle")
    cruise = given("m/s", "speed on a straight course")
    K = parameter("1/s", "gain", start=1.0, low=0.02, high=50.0, prime=True, spread=0.3)
    tau = parameter("s", "time constant", start=1.5, low=0.02, high=50.0, prime=True, spread=0.4)
    share = parameter("1", "time constant of yaw over that of surge", start=0.5, low=0.01, high=2.0, spread=0.1)

    @psi.rate
    def heading(self):
        """By definition."""
        return self.r + self.w

    @r.rate
    def yaw(self):
        """Nomoto's first order."""
        return (self.K * self.delta - self.r) / self.tau

    @w.rate
    def waves(self):
        """Made up: it dies out."""
        return -self.w / self.tau

    @u.rate
    def surge(self):
        """Made up: it goes back to the speed of the approach."""
        return self.share * (self.cruise - self.u) / self.tau


@pytest.fixture(scope="module")
def steered():
    """The model, and a trial whose first two thirds are its approach: the ship gathers speed, with noise on it."""
    model, t = shipid.join("steered", Steered), np.arange(600.0)

    def prepared(seed: int, noise: float = 0.1):
        speed = 5.0 + 5e-4 * t + noise * np.random.default_rng(seed).standard_normal(t.size)
        delta = np.where(t < 400, 0.0, np.deg2rad(20))
        table = {"t [s]": t, "psi [rad]": 1e-3 * t, "r [rad/s]": 1e-3 + 0 * t, "u [m/s]": speed, "delta [rad]": delta}
        return prepare(model, shipid.Trial.from_frame(pd.DataFrame(table), name=f"t{seed}"), ("psi", "r", "u"), None)

    return model, prepared


def test_the_speed_before_the_manoeuvre_is_as_sure_as_a_mean(steered):
    """The mean of 400 samples; that the ship gathers speed does not count as noise."""
    _, prepared = steered
    found = [prepared(seed).cruise_std for seed in range(20)]
    assert np.mean(found) == pytest.approx(0.1 / np.sqrt(400), rel=0.03)


def test_beliefs_scale_with_the_ship(steered):
    """A ship six times as long at twice the speed, in times three times as long: the same beliefs in the prime system."""
    model, prepared = steered
    one = prepared(1)
    other = replace(one, speed=2 * one.speed, intervals=3 * one.intervals)
    names, biases = ("psi", "r", "u"), ("delta", "cruise")
    first, second = (
        prior_of(model, names, biases, s, unit_time, model.parameters) for s, unit_time in ((one, 9.0), (other, 27.0))
    )
    assert second.strength == pytest.approx(first.strength) and first.strength > 2
    assert (second.biases, second.mean_biases) == (first.biases, first.mean_biases)
    assert second.own["cruise"] == pytest.approx(2 * first.own["cruise"])
    for state_, factor in {"psi": 1, "r": 1 / 3, "u": 2}.items():
        assert second.initial[state_] == pytest.approx(factor * first.initial[state_])
    for coefficient, factor in {"K": 1 / 3, "tau": 3, "share": 1}.items():
        assert second.parameters[coefficient] == pytest.approx(np.array(first.parameters[coefficient]) * factor)
    # By the declaration, with L = 9 s times the speed of about 5 m/s.
    assert first.parameters["tau"] == pytest.approx((1.5 * 9, 0.4 * 9))


def test_beliefs_cost_what_normal_densities_say(steered):
    """Rudder biases of three trials share a mean; the second begins in the middle of a manoeuvre, the third has no approach."""
    model, prepared = steered
    trials = [prepared(seed) for seed in range(3)]
    trials = [
        replace(
            s, start_std=dict(zip(model.states, 1e-3 * (1 + i + np.arange(4.0)))), settled=i != 1, approached=i != 2
        )
        for i, s in enumerate(trials)
    ]
    parameters = {"K": (0.1, 0.03), "tau": (20.0, 4.0)}
    prior = Prior(
        {"delta": 0.002}, {"delta": 0.05}, {"cruise": 0.03}, {"r": 0.001, "w": 0.004}, parameters, strength=9.0
    )
    problem = make_problem(
        model, trials, ("psi", "r", "u"), ("K", "tau"), {"share": 0.5}, np.ones(3), ("delta", "cruise")
    )
    problem = replace(problem, prior=prior)
    mean = problem.first_guess(np.array([0.1, 20.0]))
    moved = mean + 0.01 * np.random.default_rng(4).standard_normal(mean.size)
    offset = moved - mean
    own = np.array([offset[problem.own(i)] for i in range(3)])
    initial = {name: own[:, k] for k, name in enumerate(problem.initial)}
    delta, cruise = own[:, len(problem.initial)], own[:, len(problem.initial) + 1]

    common = 0.05**2 * np.ones((3, 3)) + 0.002**2 * (np.eye(3) - np.ones((3, 3)) / 3)
    density = multivariate_normal(np.zeros(3), common)
    logarithm = density.logpdf(delta) - density.logpdf(np.zeros(3))
    for i, s in enumerate(trials):
        # Of a trial without a steady beginning twenty times less is believed, but of what is measured there.
        far, at = 1.0 if s.settled else 20.0, s.start_std
        for deviation, believed, noise in (
            (cruise[i], 0.03 * (1.0 if s.approached else 20.0), s.cruise_std),
            (initial["r"][i], 0.001, at["r"]),
            (initial["w"][i], 0.004 * far, at["w"]),
        ):
            # Beliefs count ninefold, sensor noise once.
            spread = np.hypot(believed, 3.0 * noise)
            logarithm += norm.logpdf(deviation, 0.0, spread) - norm.logpdf(0.0, 0.0, spread)
    for k, (_, spread) in enumerate(parameters.values()):
        logarithm += norm.logpdf(offset[k], 0.0, spread) - norm.logpdf(0.0, 0.0, spread)

    residual, slope = problem.prior_residuals(moved, prior)
    assert 0.5 * residual @ residual == pytest.approx(-9.0 * logarithm, rel=1e-9)
    least, _ = problem.prior_residuals(mean, prior)
    assert least == pytest.approx(np.zeros_like(least), abs=1e-9)
    assert slope @ offset == pytest.approx(residual - least, rel=1e-9, abs=1e-9)


def test_a_coefficient_without_influence_is_not_determined(sail):
    """The sway constant shows in nothing but sway and track."""
    trial = sail("de-keizer", "soesterberg")
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", signals=["psi", "r", "u"], starts=1)
    gamma = fit.parameters["gamma"]
    assert gamma.std is None and gamma.ci95 is None and not gamma.identifiable
    assert gamma.standing == "not determined" and fit.unidentifiable == ("alpha3", "gamma")
    assert fit.parameters["alpha3"].standing == "not distinguishable from zero"  # the ship has none
    assert "not distinguishable from zero: its 95 % interval" in fit.text()
    assert fit.condition_number is None
    assert all(fit.parameters[n].identifiable for n in ("K", "tau", "K_u", "tau_u"))


def test_coefficients_that_trade_off_are_not_determined(sail):
    """Sway and yaw derivatives together, from heading and rate alone: no data can tell them apart."""
    trial = sail("davidson-schiff", "mariner", "zigzag:10/10", sampling="1 s", noise="psi=0.2 deg,r=0.02 deg/s")
    fit = shipid.identify("davidson-schiff", [trial], ship="mariner", signals=["psi", "r"], starts=1)
    assert len(fit.unidentifiable) >= 2
    assert all(fit.parameters[n].why for n in fit.unidentifiable)
    json.dumps(fit.to_dict(), allow_nan=False)


def test_intervals_widen_when_the_model_is_wrong(sail):
    """Nomoto on a cubic ship: residuals are not white, and an interval that counts every sample would be too narrow."""
    trial = sail("norrbin", "zeefakkel", seed=4)
    wrong = shipid.identify("nomoto", [trial], ship="zeefakkel", starts=2)
    jacobian = wrong.identified.solution.jacobian
    naive = np.sqrt(np.linalg.inv(jacobian.T @ jacobian)[0, 0])
    assert wrong.parameters["K"].std > 3 * naive


def test_a_search_that_is_cut_short_is_a_result(sail, monkeypatch):
    import shipid.identification.search.least_squares as solving

    honest = solving.minimise
    monkeypatch.setattr(solving, "minimise", lambda p, q, b, most, tolerance=0: honest(p, q, b, 1, 1e-15))
    fit = shipid.identify("norrbin", [sail("norrbin", "zeefakkel")], ship="kvlcc2-7m", starts=1)
    assert not fit.converged
    assert "NOT CONVERGED" in fit.text()
    json.dumps(fit.to_dict(), allow_nan=False)
