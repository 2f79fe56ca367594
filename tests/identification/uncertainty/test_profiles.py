"""Profiles against their parabola, residuals against known colours, and null directions of known structure."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import chi2

import shipid
from shipid import Component, given, parameter, state
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.identification.uncertainty.directions import sparse_basis
from shipid.identification.uncertainty.residuals import residuals_of

SIGMA = np.deg2rad(0.5)


@pytest.fixture(scope="module")
def fit(sail):
    return shipid.identify(
        "norrbin", [sail("norrbin", "zeefakkel", "zigzag:10/10", seed=1)], ship="zeefakkel", starts=1
    )


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", ["a", "b3", "K"])
def test_a_well_determined_coefficient_has_a_parabola(sail, name, seed):
    """K follows from two: the errors of the rudder's corners are in it by another share than in either of them."""
    trial = sail("norrbin", "zeefakkel", "zigzag:10/10", seed=seed, noise="psi=0.05 deg,r=0.005 deg/s")
    fit = shipid.identify("norrbin", [trial], ship="zeefakkel", starts=1)
    profile, estimate = fit.profile(name), fit.parameters[name]
    assert profile.ci95 == pytest.approx(estimate.ci95, rel=5e-3)
    parabola = 0.5 * ((profile.values - estimate.value) / estimate.std) ** 2
    assert profile.cost == pytest.approx(parabola, abs=0.35)
    assert profile.cost.min() == 0
    json.dumps(profile.to_dict(), allow_nan=False)
    assert list(profile.to_frame().columns) == [name, "cost"]
    assert "95 % from" in profile.text()


def test_samples_that_repeat_each_other_widen_the_parabola(drift, drifting):
    """Of a linear model under lasting residuals: the parabola of the standard deviation that allows for them, exactly."""
    trial, design = drifting(SIGMA, 600, seed=8, correlation=0.8)
    noise = {"psi": (SIGMA, "rad")}
    fit = shipid.identify(drift, [trial], noise=noise, rudder_bias=False, signals=["psi"], starts=1)
    profile, estimate = fit.profile("gain"), fit.parameters["gain"]
    white = SIGMA * np.sqrt(np.linalg.inv(design.T @ design)[0, 0])
    assert estimate.std > 1.3 * white
    parabola = 0.5 * ((profile.values - estimate.value) / estimate.std) ** 2
    assert profile.cost == pytest.approx(parabola, rel=1e-3, abs=1e-6)
    assert profile.excess == pytest.approx((estimate.std / white) ** 2, rel=1e-3)


def test_the_residuals_of_a_linear_regression(drift, drifting):
    """The sum of squares over the samples less the three unknowns, as the reduced chi-square is defined."""
    trial, design = drifting(SIGMA, 40, seed=9)
    noise = {"psi": (SIGMA, "rad")}
    fit = shipid.identify(drift, [trial], noise=noise, rudder_bias=False, signals=["psi"], starts=1)
    (squares,) = np.linalg.lstsq(design, trial["psi"], rcond=None)[1]
    assert shipid.assess(fit, bands=False, findings=False).assessment.residuals["psi"].chi_square == pytest.approx(
        squares / SIGMA**2 / (40 - 3), rel=1e-6
    )
    assert fit.chi_square == pytest.approx(squares / SIGMA**2 / (40 - 3), rel=1e-6)


def test_the_statistic_of_ljung_and_box_for_residuals_that_alternate(drift, drifting):
    """Their autocorrelation is (-1)^k (N - k) / N: N (N + 2) sum of it squared over N - k, for 20 lags."""
    count = 200
    trial, design = drifting(SIGMA, count, seed=1)
    noise = {"psi": (SIGMA, "rad")}
    fit = shipid.identify(drift, [trial], noise=noise, rudder_bias=False, signals=["psi"], starts=1)
    alternating = replace(fit.identified.solution, residual=(-1.0) ** np.arange(count), jacobian=design / SIGMA)
    found = residuals_of(replace(fit.identified, solution=alternating))["psi"]
    assert found.degrees == 20
    assert found.ljung_box == pytest.approx((count + 2) / count * (20 * count - 210), rel=1e-9)
    assert found.p_value == pytest.approx(chi2.sf(found.ljung_box, 20), abs=1e-12)


def test_a_coefficient_that_no_data_have_seen_has_an_open_interval(sail):
    trial = sail("de-keizer", "soesterberg")
    fit = shipid.identify("de-keizer", [trial], ship="soesterberg", signals=["psi", "r", "u"], starts=1)
    profile = fit.profile("gamma", points=9)
    assert profile.ci95 == (None, None)
    assert "open" in profile.text()
    (direction,) = shipid.assess(fit, bands=False, findings=False).assessment.directions
    assert direction.parameters == {"gamma": 1.0} and direction.relative_std is None
    assert "has no effect" in direction.words and "sway speed" in direction.words


def test_what_cannot_be_profiled_is_said(fit, sail):
    with pytest.raises(UnknownNameError, match="b4"):
        fit.profile("b4")
    held = shipid.identify("norrbin", [sail("norrbin", "zeefakkel")], ship="zeefakkel", estimate=["a", "b1"], starts=1)
    with pytest.raises(UsageError, match="held fixed"):
        held.profile("b3")


def test_a_determined_fit_has_no_direction_to_speak_of(fit):
    assert fit.to_dict()["diagnostics"]["directions"] is None
    assessed = shipid.assess(fit, bands=False, findings=False)
    assert assessed.assessment.directions == ()
    assert assessed.to_dict()["diagnostics"]["directions"] == []


class TwoGains(Component):
    """A yaw model whose two gains show in their product alone."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    rudder_gain = parameter("1", "of the rudder", start=1.0, low=0.05, high=20.0)
    hull_gain = parameter("1/s", "of the hull", start=0.3, low=0.01, high=5.0)
    tau = parameter("s", "time constant", start=20.0, low=0.5, high=500.0)

    @r.rate
    def yaw(self):
        """Nobody's."""
        return (self.rudder_gain * self.hull_gain * self.delta - self.r) / self.tau


def test_a_structure_that_hides_a_coefficient_is_seen_through(sail):
    trial = sail("nomoto", "zeefakkel")
    fit = shipid.identify(TwoGains, [trial], ship=shipid.find_ship("zeefakkel"), starts=1)
    (direction,) = shipid.assess(fit, bands=False, findings=False).assessment.directions
    assert direction.parameters == {
        "rudder_gain": pytest.approx(1, abs=0.02),
        "hull_gain": pytest.approx(-1, abs=0.02),
    } or (direction.parameters == {"hull_gain": pytest.approx(1, abs=0.02), "rudder_gain": pytest.approx(-1, abs=0.02)})
    assert direction.relative_std is None
    assert "cannot be separated from one 20/20 zig-zag" in direction.words
    assert "No other manoeuvre" in direction.words and "Hold one of them" in direction.words
    assert fit.parameters["tau"].identifiable


def test_sway_and_yaw_derivatives_leave_two_directions_open(sail):
    """Four numbers of the transfer function from rudder to heading, six derivatives: two combinations are free.

    One of them moves the sway at the beginning, which is believed to be small: it is known to ten times its size.
    """
    trial = sail("davidson-schiff", "mariner", "zigzag:10/10", sampling="1 s", noise="psi=0.2 deg,r=0.02 deg/s")
    fit = shipid.identify("davidson-schiff", [trial], ship="mariner", signals=["psi", "r"], starts=1)
    directions = shipid.assess(fit, bands=False, findings=False).assessment.directions
    free = [d for d in directions if d.relative_std is None or d.relative_std > 10]
    assert len(free) == 2 and free[0].relative_std is None
    assert all("Measure the sway speed" in d.words for d in free)


def test_a_small_zigzag_does_not_show_the_cubic(sail):
    trial = sail("norrbin", "zeefakkel", "zigzag:2/2", noise="psi=0.2 deg,r=0.05 deg/s")
    fit = shipid.identify("norrbin", [trial], ship="zeefakkel", signals=["psi"], starts=1)
    weakest = shipid.assess(fit, bands=False, findings=False).assessment.directions[0]
    assert next(iter(weakest.parameters)) == "b3"
    assert weakest.relative_std > 0.1
    assert "Sail a" in weakest.words and "zig-zag as well" in weakest.words


def test_sparse_directions_span_the_same_space():
    rng = np.random.default_rng(4)
    wanted = np.array([[1.0, -1, 0, 0, 0], [0, 0, 0, 2, 1]])
    basis = np.linalg.qr((rng.standard_normal((2, 2)) @ wanted).T)[0].T
    found = sparse_basis(basis)
    assert sorted(int(np.sum(np.abs(v) > 1e-9)) for v in found) == [2, 2]
    assert np.linalg.matrix_rank(np.vstack([wanted, *found]), tol=1e-9) == 2


def test_white_residuals_pass_and_coloured_ones_do_not(fit, sail):
    residuals = shipid.assess(fit, bands=False, findings=False).assessment.residuals
    assert all(r.white for r in residuals.values())
    assert all(r.chi_square == pytest.approx(1, abs=0.01) for r in residuals.values())
    assert all(r.effective == r.samples for r in residuals.values())
    trial = sail("norrbin", "zeefakkel", "zigzag:10/10", noise="none")
    rng, table = np.random.default_rng(5), trial.table.copy()
    for name, level in (("psi", 0.003), ("r", 0.0003)):
        table[name] += level * lfilter([np.sqrt(1 - 0.9**2)], [1, -0.9], rng.standard_normal(len(table)))
    coloured = shipid.identify("norrbin", [replace(trial, table=table)], ship="zeefakkel", starts=1)
    coloured = shipid.assess(coloured, bands=False, findings=False)
    for r in coloured.assessment.residuals.values():
        assert not r.white and r.p_value < 1e-6
        assert r.autocorrelation_time > 5
        assert r.effective < 0.5 * r.samples
    plain = json.loads(json.dumps(coloured.to_dict(), allow_nan=False))["diagnostics"]["residuals"]
    assert set(plain["psi"]) >= {"p_value", "ljung_box", "autocorrelation_time", "chi_square", "effective", "white"}
