"""What follows from the estimates: published coefficients and other quantities, with first-order standard deviations."""

from __future__ import annotations

import json

import numpy as np
import pytest

import shipid
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.records.run import FilterRun
from shipid.foundation.errors import UnknownNameError
from shipid.parameters.catalogue import find_model


@pytest.fixture(scope="module")
def run() -> FilterRun:
    rng = np.random.default_rng(1)
    t = np.arange(200) * 0.4
    record = {"t": t, "u": 9 + 0 * t, "delta": 0.2 * np.sign(np.sin(t / 8)), "cruise": 9 + 0 * t}
    record |= {"psi": 0.01 * rng.standard_normal(t.size), "r": 0.004 * rng.standard_normal(t.size)}
    return ExtendedKalmanFilter(find_model("yaw-filter"), "soesterberg").filter(record)


def test_a_declared_walk_is_estimated_unless_told_otherwise(run: FilterRun) -> None:
    assert tuple(run.design.parameters) == ("a", "b1")
    assert ExtendedKalmanFilter(find_model("nomoto"), "soesterberg", measured={"r": "0.1 deg/s"}).parameters == {}
    with pytest.raises(shipid.ShipidError, match="a "):
        ExtendedKalmanFilter(find_model("yaw-filter"), "soesterberg", estimated=())


def test_published_coefficients_by_hand(run: FilterRun) -> None:
    i, j = (run.states.index(n) for n in ("a", "b1"))
    a, b = run.x[:, i], run.x[:, j]
    cov = run.covariance[:, [i, j]][:, :, [i, j]]
    gain, spread = run.quantity("K")
    np.testing.assert_allclose(gain, a / b, rtol=1e-13)
    slopes = np.column_stack([1 / b, -a / b**2])
    np.testing.assert_allclose(spread**2, np.einsum("ni,nij,nj->n", slopes, cov, slopes), rtol=1e-9)
    np.testing.assert_allclose(run["tau"], 1 / b, rtol=1e-13)
    np.testing.assert_allclose(run.std_of("tau"), np.sqrt(cov[:, 1, 1]) / b**2, rtol=1e-9)


def test_noise_that_sensors_share_counts_in_what_follows(run: FilterRun) -> None:
    """r_wave = w - v_f: the noise w of the sample is an unknown beside the states."""
    w, i = run.rows("w")[:, 0], run.states.index("v_f")
    joint = run.joint_covariance
    value, spread = run.quantity("r_wave")
    np.testing.assert_allclose(value, w - run["v_f"], atol=1e-15)
    expected = joint[:, -1, -1] - 2 * joint[:, i, -1] + joint[:, i, i]
    np.testing.assert_allclose(spread**2, expected, rtol=1e-8, atol=1e-18)
    assert joint.shape[1] == len(run.states) + 1 == run.covariance.shape[1] + 1


def test_a_state_is_as_it_is_estimated(run: FilterRun) -> None:
    value, spread = run.quantity("r")
    np.testing.assert_array_equal(value, run["r"])
    np.testing.assert_array_equal(spread, run.std_of("r"))


def test_results_hold_the_published_coefficients(run: FilterRun) -> None:
    assert list(run.parameters) == ["a", "b1", "K", "tau"]
    assert [p.follows for p in run.parameters.values()] == [False, False, True, True]
    gain = run.parameters["K"]
    assert gain.ci95 == pytest.approx((gain.value - 1.959964 * gain.std, gain.value + 1.959964 * gain.std), rel=1e-6)
    table = run.to_frame()
    np.testing.assert_array_equal(table["K [1]"], run["K"])
    np.testing.assert_array_equal(table["std_tau [1]"], run.std_of("tau"))
    assert set(json.loads(json.dumps(run.to_dict(), allow_nan=False))["parameters"]) == {"a", "b1", "K", "tau"}
    assert "yaw gain K*" in run.text()


def test_a_gain_that_does_not_exist_is_left_out() -> None:
    """A course-unstable ship on the edge: 1/tau* is zero, and K* is no number."""
    kalman = ExtendedKalmanFilter(
        find_model("yaw-filter"),
        "soesterberg",
        start={"b1": "0"},
        initial={"b1": "1e-12"},
        noise={"b1": "1e-15"},
    )
    t = np.zeros(1)
    run = kalman.filter({"t": t, "u": t + 9, "delta": t, "psi": t, "r": t, "cruise": t + 9})
    assert run["b1"][-1] == 0.0
    assert list(run.parameters) == ["a", "b1"]
    json.dumps(run.to_dict(), allow_nan=False)


def test_an_unknown_quantity_is_named(run: FilterRun) -> None:
    with pytest.raises(UnknownNameError, match="'gain'"):
        run.quantity("gain")
