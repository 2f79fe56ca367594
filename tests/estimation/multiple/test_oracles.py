"""The multiple-model filter beside filters that we did not write, and beside the plain filter."""

import numpy as np
import pytest

from shipid import ExtendedKalmanFilter, InteractingMultipleModel
from shipid.models import constant_velocity

RATE = np.deg2rad(5.6)
STAY = [[0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]]
NOISE = {"ax": "1.8 m/s^2", "ay": "1.8 m/s^2"}
SENSORS = {"x": "85 m", "y": "85 m"}


def turn(rate):
    """The textbook transition matrix of [x, vx, y, vy] over one second."""
    if rate == 0:
        return np.kron(np.eye(2), [[1.0, 1.0], [0.0, 1.0]])
    s, c = np.sin(rate), np.cos(rate)
    return np.array(
        [
            [1, s / rate, 0, -(1 - c) / rate],
            [0, c, 0, -s],
            [0, (1 - c) / rate, 1, s / rate],
            [0, s, 0, c],
        ]
    )


def test_the_linear_filter_equals_that_of_filterpy(track, tracker):
    filterpy = pytest.importorskip("filterpy.kalman")
    record, first, _ = track
    z = np.column_stack([record["x"], record["y"]])
    gain = np.kron(np.eye(2), [[0.5], [1.0]])
    filters = []
    for rate in (-RATE, 0.0, RATE):
        kalman = filterpy.KalmanFilter(4, 2)
        kalman.F, kalman.H = turn(rate), np.kron(np.eye(2), [[1.0, 0.0]])
        kalman.Q, kalman.R = 1.8**2 * gain @ gain.T, 85.0**2 * np.eye(2)
        kalman.x, kalman.P = first.mean[:, None].copy(), first.covariance.copy()
        filters.append(kalman)
    other = filterpy.IMMEstimator(filters, np.array([0.1, 0.8, 0.1]), np.array(STAY))
    # No time passes before our first scan, so that no mode changes; theirs changes unless it is told otherwise.
    other.cbar = other.mu.copy()
    run = tracker().filter({n: c[1:] for n, c in record.items()}, first=first)
    ours = run.x[:, [run.states.index(n) for n in ("x", "vx", "y", "vy")]]
    theirs, chances = [], []
    for k in range(1, 400):
        if k > 1:
            other.predict()
        other.update(z[k][:, None])
        theirs.append(other.x.ravel().copy())
        chances.append(other.mu.copy())
    assert np.abs(ours - np.array(theirs)).max() < 1e-8
    assert np.abs(run.probabilities - np.array(chances)).max() < 1e-9


def test_one_mode_is_the_plain_filter(track):
    record, _, _ = track
    one = InteractingMultipleModel({"straight": constant_velocity}, [[1.0]], measured=SENSORS, noise=NOISE).filter(
        record
    )
    plain = ExtendedKalmanFilter(constant_velocity, measured=SENSORS, noise=NOISE, gate=None).filter(record)
    assert one.x == pytest.approx(plain.x, abs=1e-6)
    assert one.covariance == pytest.approx(plain.covariance, rel=1e-9, abs=1e-9)
    assert one.log_likelihood == pytest.approx(plain.log_likelihood, rel=1e-12)


@pytest.mark.parametrize("merging", ["interacting", "pseudo-bayesian"])
def test_equal_modes_are_the_plain_filter(track, merging):
    record, _, _ = track
    models = {"one": constant_velocity, "other": constant_velocity}
    both = InteractingMultipleModel(
        models, [[0.9, 0.1], [0.3, 0.7]], measured=SENSORS, noise=NOISE, merging=merging
    ).filter(record)
    plain = ExtendedKalmanFilter(constant_velocity, measured=SENSORS, noise=NOISE, gate=None).filter(record)
    assert both.x == pytest.approx(plain.x, abs=1e-6)
    assert both.log_likelihood == pytest.approx(plain.log_likelihood, rel=1e-12)
    # The chain alone: (0.5, 0.5) relaxes to the stationary (0.75, 0.25) by a factor of 0.6 a scan.
    assert both.probabilities[:, 0] == pytest.approx(0.75 - 0.25 * 0.6 ** np.arange(400), abs=1e-12)


def test_pseudo_bayesian_filter_by_hand(track, tracker):
    """GPB1: all modes start from the combined estimate."""
    record, first, _ = track
    run = tracker(merging="pseudo-bayesian").filter({n: c[1:] for n, c in record.items()}, first=first)
    order = [run.states.index(n) for n in ("x", "vx", "y", "vy")]
    x, P, mu = first.mean, first.covariance, np.array([0.1, 0.8, 0.1])
    gain = np.kron(np.eye(2), [[0.5], [1.0]])
    H, R = np.kron(np.eye(2), [[1.0, 0.0]]), 85.0**2 * np.eye(2)
    for k in range(30):
        z = np.array([record["x"][k + 1], record["y"][k + 1]])
        ahead = mu if k == 0 else np.array(STAY).T @ mu
        means, spreads, likely = [], [], []
        for rate in (-RATE, 0.0, RATE):
            F = np.eye(4) if k == 0 else turn(rate)
            Q = 0 if k == 0 else 1.8**2 * gain @ gain.T
            m, S = F @ x, F @ P @ F.T + Q
            inner = H @ S @ H.T + R
            K = S @ H.T @ np.linalg.inv(inner)
            e = z - H @ m
            means.append(m + K @ e)
            spreads.append(S - K @ inner @ K.T)
            likely.append(np.exp(-0.5 * e @ np.linalg.solve(inner, e)) / np.sqrt(np.linalg.det(2 * np.pi * inner)))
        mu = ahead * likely / (ahead @ likely)
        x = mu @ np.array(means)
        P = sum(w * (S + np.outer(m - x, m - x)) for w, m, S in zip(mu, means, spreads))
        assert run.x[k, order] == pytest.approx(x, abs=1e-6)
        assert run.covariance[k][np.ix_(order, order)] == pytest.approx(P, rel=1e-8, abs=1e-6)
        assert run.probabilities[k] == pytest.approx(mu, abs=1e-10)
