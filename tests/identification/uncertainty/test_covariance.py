"""What the data do not determine is said, and the counting of effective samples has closed forms."""

from __future__ import annotations

import json

import numpy as np
import pytest

import shipid
from shipid.identification.search.trust_region import triangle
from shipid.identification.uncertainty.covariance import autocorrelation_time, correlation_of, verdict


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
    assert verdict(1.0, 0.1, 1.0, 0.0, 10.0, "") == ""
    assert "no information" in verdict(1.0, np.inf, 1.0, 0.0, 10.0, "")
    assert "bound" in verdict(0.0, 0.01, 1.0, 0.0, 10.0, "")
    assert "90% of its value" in verdict(1.0, 0.9, 1.0, -10.0, 10.0, "")
    assert "trades off with b (+0.99)" in verdict(1.0, 0.9, 1.0, -10.0, 10.0, "b (+0.99)")
    assert verdict(0.0, 0.1, 1.0, -10.0, 10.0, "") == "", "a zero that is known to a tenth of a typical size is known"
    assert "90% of its value" in verdict(0.1, 0.09, 1.0, 0.01, 10.0, ""), "one that must be positive has no zero"


def test_a_coefficient_without_influence_is_not_determined(sail):
    """The sway constant shows in nothing but sway and track."""
    trial = sail("de-keizer", "soesterberg")
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", signals=["psi", "r", "u"], starts=1)
    gamma = fit.parameters["gamma"]
    assert gamma.std is None and gamma.ci95 is None and not gamma.identifiable
    assert fit.unidentifiable == ("gamma",)
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
    assert "NOT CONVERGED" in repr(fit)
    json.dumps(fit.to_dict(), allow_nan=False)
