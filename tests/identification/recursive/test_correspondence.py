"""Each method as a special case of the extended Kalman filter: Passenier (1989), section 4.5.3, exactly where it is exact.

The filter is written here by formula, (4.111)-(4.119), for y = a y + b v; what a method leaves out is set to zero after each
sample, and nothing else is changed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import shipid
from shipid.identification.recursive.identifier import RecursiveIdentifier, identify_recursively
from shipid.identification.recursive.methods import METHODS
from shipid.identification.recursive.recursion import LARGEST_POLE

SIGMA, FIRST = 0.1, np.array([0.03, 0.02])
GIVEN = {
    "measured": {"y": SIGMA},
    "initial": {"a": FIRST[0], "b": FIRST[1], "y": 0.6},
    "start": {"a": 0.9, "b": 0.1, "y": 0.2},
    "hold": "zero",
}
Leaves = Callable[[np.ndarray], np.ndarray]


def everything(p: np.ndarray) -> np.ndarray:
    return p


def no_cross_terms(p: np.ndarray) -> np.ndarray:
    """P_y,theta = 0: what (4.121)-(4.125) assume."""
    kept = p.copy()
    kept[0, 1:] = kept[1:, 0] = 0.0
    return kept


def parameters_only(p: np.ndarray) -> np.ndarray:
    """P_yy = P_y,theta = 0: what (4.134)-(4.139) assume."""
    kept = np.zeros_like(p)
    kept[1:, 1:] = p[1:, 1:]
    return kept


def extended_kalman_filter(
    record: dict[str, np.ndarray],
    leaves: Leaves = everything,
    gain: float | None = None,
    r: float = SIGMA**2,
    first: np.ndarray = FIRST**2,
    q: np.ndarray | None = None,
) -> np.ndarray:
    """Estimates of y, a, b after each sample; `gain` takes the place of K_y where it is given."""
    x, p = np.array([0.2, 0.9, 0.1]), leaves(np.diag([0.6**2, *first]))
    rows = []
    for k, z in enumerate(record["y"]):
        if k:
            psi = np.array([x[0], record["v"][k - 1]])
            f = np.vstack([np.concatenate([[x[1]], psi]), [[0, 1, 0], [0, 0, 1]]])
            x = np.array([psi @ x[1:], x[1], x[2]])
            p = f @ p @ f.T + np.diag(np.zeros(3) if q is None else q)
        k_all = p[:, 0] / (p[0, 0] + r)
        e = z - x[0]
        # (4.119): K_y is that of the covariance, whatever then is done with the output.
        p = leaves(p - np.outer(k_all, p[0]))
        if gain is not None:
            k_all[0] = gain
        x = x + k_all * e
        rows.append(x)
    return np.array(rows)


def run(model: shipid.Model, record: dict[str, np.ndarray], method: str, **options) -> np.ndarray:
    result = identify_recursively(model, record, method=method, **{**GIVEN, **options})
    return np.column_stack([result.y, result.theta])


CASES: dict[str, tuple[Leaves, float | None]] = {
    "ekf": (everything, None),
    "combined": (no_cross_terms, None),
    "minimum-variance": (parameters_only, 1.0),
    "rls": (parameters_only, 1.0),
    "series-parallel": (parameters_only, 1.0),
    "mras-parallel": (parameters_only, 0.0),
}


@pytest.mark.parametrize("method", CASES)
def test_a_method_is_the_filter_with_something_left_out(method, first_order, noisy):
    record = noisy(SIGMA, count=300)
    leaves, gain = CASES[method]
    wanted = extended_kalman_filter(record, leaves, gain, first=METHODS[method].first_factor * FIRST**2)
    # The projection of the parallel scheme is no part of the correspondence, and has nothing to do here.
    assert np.abs(wanted[:, 1]).max() < LARGEST_POLE
    np.testing.assert_allclose(run(first_order, record, method), wanted, rtol=1e-12, atol=1e-12)


def test_system_noise_enters_as_in_the_filter(first_order, noisy):
    record = noisy(SIGMA, count=200)
    q = np.array([0.01, 0.02, 0.03])
    noise = {"y": q[0], "a": q[1], "b": q[2]}
    for method, leaves in (("ekf", everything), ("combined", no_cross_terms)):
        wanted = extended_kalman_filter(record, leaves, q=q**2)
        np.testing.assert_allclose(run(first_order, record, method, noise=noise), wanted, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("method", "gain"), [("rls", 1.0), ("mras-parallel", 0.0)])
def test_only_the_ratio_of_first_uncertainty_and_noise_counts_without_knowledge_of_the_noise(
    method, gain, first_order, noisy
):
    """R = 1 in (4.138) is the least squares of (4.57)-(4.60) with F(0) = P(0)/R, P(0) being a multiple of what was given for least squares."""
    record, f0 = noisy(SIGMA, count=300), METHODS[method].first_factor * FIRST**2 / SIGMA**2
    wanted = extended_kalman_filter(record, parameters_only, gain, r=1.0, first=f0)
    np.testing.assert_allclose(run(first_order, record, method), wanted, rtol=1e-12, atol=1e-12)


def printed(record: dict[str, np.ndarray], gain: float, forgetting: float, first: np.ndarray) -> np.ndarray:
    """(4.57)-(4.64) as printed: F(k) first, then theta(k) = theta(k-1) + F(k) psi e."""
    theta, f, y, rows = np.array([0.9, 0.1]), np.diag(first / SIGMA**2), 0.2, []
    for k, z in enumerate(record["y"]):
        psi = np.array([y, record["v"][k - 1]]) if k else np.zeros(2)
        ahead = psi @ theta if k else y
        if k:
            f = (f - np.outer(f @ psi, psi @ f) / (forgetting + psi @ f @ psi)) / forgetting
        theta = theta + f @ psi * (z - ahead)
        y = ahead + gain * (z - ahead)
        rows.append([y, *theta])
    return np.array(rows)


@pytest.mark.parametrize(("method", "gain"), [("series-parallel", 1.0), ("mras-parallel", 0.0)])
@pytest.mark.parametrize("forgetting", [1.0, 0.98])
def test_the_mras_of_section_4_4_1_as_printed(method, gain, forgetting, first_order, noisy):
    record = noisy(SIGMA, count=300)
    got = run(first_order, record, method, forgetting=forgetting)
    np.testing.assert_allclose(
        got, printed(record, gain, forgetting, METHODS[method].first_factor * FIRST**2), rtol=1e-11, atol=1e-11
    )


def test_the_combined_scheme_of_section_4_4_4(first_order, noisy):
    """(4.83)-(4.94) and (4.74)-(4.76), R in the place of 1; it is not that of 4.5.3, whatever (4.133) says."""
    record, rows = noisy(SIGMA, count=300), []
    theta, f, y, p_y, r = np.array([0.9, 0.1]), np.diag(FIRST**2), 0.2, 0.6**2, SIGMA**2
    for k, z in enumerate(record["y"]):
        psi = np.array([y, record["v"][k - 1]]) if k else np.zeros(2)
        ahead = psi @ theta if k else y
        m_y = psi @ f @ psi + (theta[0] ** 2 if k else 1.0) * p_y
        gain = f @ psi / (psi @ f @ psi + r)
        k_y = m_y / (m_y + r)
        theta, y = theta + gain * (z - ahead), ahead + k_y * (z - ahead)
        f, p_y = f - np.outer(gain, psi @ f), (1 - k_y) * m_y
        rows.append([y, *theta])
    got = run(first_order, record, "combined-heuristic")
    np.testing.assert_allclose(got, rows, rtol=1e-11, atol=1e-11)
    other = run(first_order, record, "combined")
    assert np.abs(got - other).max() > 1e-3


def test_the_combined_scheme_is_the_filter_while_nothing_is_known_of_the_output(first_order, noisy):
    """In the first step after a start without correlation nothing is left out yet; in the second it is."""
    record = noisy(SIGMA, count=4)
    ekf, combined = (run(first_order, record, m) for m in ("ekf", "combined"))
    np.testing.assert_allclose(combined[:2], ekf[:2], rtol=1e-14)
    assert np.abs(combined[2] - ekf[2]).max() > 1e-6


def test_least_squares_is_the_batch_solution(first_order, noisy):
    """With a first uncertainty F(0), the solution of (Psi'Psi + F(0)^-1) theta = Psi' y + F(0)^-1 theta(0)."""
    record = noisy(SIGMA)
    y, v = record["y"], record["v"]
    result = identify_recursively(
        first_order,
        record,
        method="rls",
        measured={"y": SIGMA},
        initial={"a": FIRST[0], "b": FIRST[1]},
        start={"a": 0.9, "b": 0.1},
        hold="zero",
    )
    psi, prior = np.column_stack([y[:-1], v[:-1]]), np.diag(SIGMA**2 / (METHODS["rls"].first_factor * FIRST**2))
    wanted = np.linalg.solve(psi.T @ psi + prior, psi.T @ y[1:] + prior @ [0.9, 0.1])
    np.testing.assert_allclose(result.theta[-1], wanted, rtol=1e-11)


def test_the_extended_kalman_filter_of_the_toolbox_is_the_same(first_order, noisy):
    record = noisy(SIGMA, count=300)
    kalman = shipid.ExtendedKalmanFilter(
        first_order,
        measured={"y": SIGMA},
        estimated=["a", "b"],
        initial=GIVEN["initial"],
        start=GIVEN["start"],
        log=(),
        gate=None,
        hold="zero",
    )
    filtered = kalman.filter(record)
    result = RecursiveIdentifier(first_order, method="ekf", **GIVEN).identify(record)
    np.testing.assert_allclose(result.theta, np.column_stack([filtered["a"], filtered["b"]]), rtol=1e-11)
    np.testing.assert_allclose(result.std[:, 0], filtered.std_of("a"), rtol=1e-9)
    np.testing.assert_allclose(result.y, filtered["y"], rtol=1e-10, atol=1e-12)


def test_the_extended_kalman_filter_of_a_ship_is_the_same():
    model = shipid.find_model("yaw-filter")
    trial = shipid.simulate(
        shipid.find_model("de-keizer"), "soesterberg", "zigzag:15/15", noise={"r": "0.02 deg/s", "u": "0.05 m/s"}
    )
    first = {"b1": "0.5", "a": "0.5", "r": "0.1 deg/s"}
    start = {"b1": "2", "a": "2", "r": "0 deg/s"}
    options = {"measured": {"r": "0.02 deg/s"}, "initial": first, "start": start}
    # The recursion has the record's speed as an input, the filter as a state that follows a sensor it believes.
    yaw = shipid.join("yaw", shipid.find_model("yaw-filter").components[0])
    filtered = shipid.ExtendedKalmanFilter(
        yaw, "soesterberg", estimated=["b1", "a"], log=(), gate=None, model_noise=False, **options
    ).filter(trial)
    result = identify_recursively(model, trial, method="ekf", ship="soesterberg", **options)
    for name in ("b1", "a"):
        np.testing.assert_allclose(result[name], filtered[name], rtol=1e-9)
        np.testing.assert_allclose(result.std_of(name), filtered.std_of(name), rtol=1e-7)
