"""The smoother against a dense least-squares solution over the whole record, on linear cases."""

from typing import Any

import numpy as np
import pytest

from shipid.estimation.records.smoother import smooth
from shipid.estimation.recursion.gate import TAKEN


def dense(hand: Any, record: dict[str, np.ndarray], start: Any, taken: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Best linear estimates of every state of a record, and their covariances, given every sample that was taken in.

    Every state is written as a sum over independent random numbers (first errors, noises); what they are given the samples
    is one least-squares problem, which needs no covariance to be regular.
    """
    n, names = len(hand.states), hand.kalman.design.base.inputs
    intervals, u, z = hand.rows(record)
    x0, p0 = start
    driving = np.array([hand.driving.get(i, 0.0) for i in names])
    lasting = np.array([hand.lasting.get(i, 0.0) for i in names])
    sizes = [n, *(2 * n + n + 2 * len(names) for _ in intervals)]
    total, at = sum(sizes), sizes[0]
    mean, by = np.array(x0, dtype=float), np.zeros((n, total))
    by[:, :n] = np.linalg.cholesky(p0 + 1e-300 * np.eye(n))
    means, maps, rows, rest, weights = [], [], [], [], []
    w_before = np.zeros((len(names), total))
    levels = hand.kalman.design.r
    for k, T in enumerate(intervals):
        if k:
            F = hand.transition(mean, u[k - 1], u[k], T)
            G = hand.effect(mean, u[k - 1], u[k], T)
            half = np.diag(np.sqrt(hand.halves(T)))
            by[:, at : at + n] += half
            by = F @ by + G @ w_before
            mean = hand.advance(mean, u[k - 1], u[k], T)
            by[:, at + n : at + 2 * n] += half
            by[:, at + 2 * n : at + 3 * n] += np.diag([hand.sample.get(s, 0.0) for s in hand.states])
            lasted = np.zeros((len(names), total))
            lasted[:, at + 3 * n : at + 3 * n + len(names)] = np.diag(lasting / np.sqrt(T))
            by = by + G @ lasted
        w_before = np.zeros((len(names), total))
        w_before[:, at + 3 * n + len(names) : at + 3 * n + 2 * len(names)] = np.diag(driving)
        at += sizes[k + 1]
        H = hand.sensitivity(mean, u[k])
        D = hand.slope(lambda w, mean=mean, k=k: hand.shown(mean, u[k] + w), np.zeros(len(names)))
        for j in np.flatnonzero(taken[k]):
            rows.append(H[j] @ by + D[j] @ w_before)
            rest.append(z[k, j] - hand.shown(mean, u[k])[j])
            weights.append(levels[j])
        means.append(mean)
        maps.append(by.copy())
    # Most of the random numbers drive nothing in a model with noise on one state.
    live = np.any([np.abs(b).any(axis=0) for b in maps], axis=0) | np.abs(np.array(rows)).any(axis=0)
    maps, total = [b[:, live] for b in maps], int(live.sum())
    A = np.array(rows)[:, live] / np.array(weights)[:, None]
    y = np.array(rest) / np.array(weights)
    # Independent unit random numbers: min |q|^2 + |y - A q|^2.
    solved = np.linalg.lstsq(np.vstack([A, np.eye(total)]), np.concatenate([y, np.zeros(total)]), rcond=None)[0]
    spread = np.linalg.inv(np.eye(total) + A.T @ A)
    x = np.array([m + b @ solved for m, b in zip(means, maps)])
    return x, np.array([b @ spread @ b.T for b in maps])


def check(hand: Any, record: dict[str, np.ndarray], **options: Any) -> Any:
    run = hand.kalman.filter(record, **options)
    n = hand.kalman.design.layout.n
    carried = hand.kalman.design.layout.carried
    packed = run.start[carried["P"]]
    p0 = np.diag(packed[np.cumsum(np.arange(1, hand.kalman.design.layout.joint + 1)) - 1][:n])
    taken = run.rows("fate") == TAKEN
    x, covariance = dense(hand, record, (run.start[carried["x"]], p0), taken)
    smoothed = smooth(run)
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    assert np.all(np.abs(smoothed.x - x) <= 1e-8 * std)
    assert np.all(np.abs(smoothed.covariance - covariance) <= 1e-8 * std[:, :, None] * std[:, None, :])
    assert smoothed.std == pytest.approx(std, rel=1e-8)
    # The last moment is the filter's own.
    assert smoothed.x[-1] == pytest.approx(run.x[-1], rel=1e-12)
    assert np.all(smoothed.std <= run.std * (1 + 1e-9))
    return run


SENSORS = {"psi": 0.01, "r": 5e-4}
#: First standard deviations no vaguer than a sailor's: of a difference of covariances more digits would be lost.
FIRST = {"psi": "0.05 rad", "r": "0.01 rad/s"}


def sailed(hand: Any, t: np.ndarray, swing: Any, rng: Any, **first: float) -> dict[str, np.ndarray]:
    levels = hand.kalman.design.r
    return hand.sail(t, {"delta": swing(t)}, np.array([first.get(s, 0.0) for s in hand.states]), levels, rng)[0]


def test_equals_least_squares(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    """Irregular samples, one in five missing, noise on a state and on the rudder."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, lasting={"delta": 0.03})
    t = uneven(60)
    record = sailed(hand, t, swing, rng, r=0.004)
    for n in SENSORS:
        record[n] = np.where(rng.random(t.size) < 0.2, np.nan, record[n])
    check(hand, record)


def test_a_parameter_without_noise(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    """The covariance of the whole record has a direction that nothing drives; nothing is inverted but numbers."""
    hand = setup("yaw", SENSORS, estimated=["K"], log=(), density={"r": 1e-4})
    record = sailed(hand, uneven(60), swing, rng, K=0.07)
    run = check(hand, record)
    smoothed = smooth(run)
    # It is a constant, so every moment knows it as well as the last.
    i = run.states.index("K")
    assert smoothed.x[:, i] == pytest.approx(np.full(60, run.x[-1, i]), rel=1e-8)
    assert smoothed.std[:, i] == pytest.approx(np.full(60, run.std[-1, i]), rel=1e-7)


def test_a_singular_covariance(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    """No noise at all, two parameters with one rudder angle: P loses all but rounding in a direction, and is not inverted."""
    hand = setup("yaw", SENSORS, estimated=["K"], log=(), initial=FIRST | {"K": "0.05 1/s"})
    record = sailed(hand, uneven(60), swing, rng, r=0.004, K=0.07)
    run = check(hand, record)
    correlation = run.covariance[-1] / np.outer(run.std[-1], run.std[-1])
    assert np.linalg.eigvalsh(correlation)[0] > 0


def test_rejected_samples_tell_nothing(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    hand = setup("yaw", SENSORS, density={"r": 1e-4}, gate=4.0)
    record = sailed(hand, uneven(60), swing, rng)
    record["psi"][[20, 33]] += 1.0
    record["r"][41] -= 0.1
    run = check(hand, record)
    assert [run.innovations[n].rejected for n in SENSORS] == [2, 1]


def test_noise_that_a_sensor_shows(setup: Any, swing: Any, rng: Any) -> None:
    """One noise moves the waves and is seen by the compass: an unknown of its own, from the sample into the step."""
    hand = setup("waved", {"compass": 0.002, "r": 5e-4}, driving={"w": 0.02}, density={"r": 1e-4},
                 initial=FIRST | {"v": "0.05 rad"})  # fmt: skip
    record = sailed(hand, np.arange(60) * 0.7, swing, rng)
    record["compass"][10:14] = np.nan
    check(hand, record)


def test_a_sampled_state(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    hand = setup("counted", {"psi": 0.01, "held": 5e-4}, density={"r": 1e-4}, sample={"held": 1e-4},
                 initial=FIRST | {"held": "0.01 rad/s"})  # fmt: skip
    check(hand, sailed(hand, uneven(60), swing, rng))


def test_square_root_form_smooths_the_same(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    options = {"density": {"r": 1e-4}, "estimated": ["K", "tau"]}
    hand = setup("yaw", SENSORS, **options)
    record = sailed(hand, uneven(60), swing, rng, log_K=np.log(0.07), log_tau=np.log(40.0))
    a = smooth(hand.kalman.filter(record))
    b = smooth(setup("yaw", SENSORS, form="square-root", **options).kalman.filter(record))
    assert np.all(np.abs(a.x - b.x) <= 1e-7 * a.std)
    assert a.std == pytest.approx(b.std, rel=1e-7)


def test_switched_off_samples_count_for_the_smoother(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    """Where parameters held still, the smoothed estimate is still that of all samples together."""
    options = {"estimated": ["K"], "log": (), "density": {"r": 1e-4}, "initial": FIRST}
    hand = setup("yaw", SENSORS, switchable=True, **options)
    record = sailed(hand, uneven(60), swing, rng, K=0.07)
    adapt = np.arange(60) % 20 < 8
    run = hand.kalman.filter(record, adapt=adapt)
    free = setup("yaw", SENSORS, **options).kalman.filter(record)
    assert np.all(np.abs(smooth(run).x - smooth(free).x) <= 1e-8 * smooth(free).std)
    assert smooth(run).std == pytest.approx(smooth(free).std, rel=1e-8)
    check(hand, record)


def test_smoothing_is_worth_it(setup: Any, swing: Any, uneven: Any, rng: Any) -> None:
    """The error over the middle of a record is smaller than the filter's, as both say."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4})
    t = uneven(300)
    levels = np.array(list(SENSORS.values()))
    record, truth = hand.sail(t, {"delta": swing(t)}, np.zeros(2), levels, rng)
    run = hand.kalman.filter(record)
    smoothed = smooth(run)
    middle = slice(20, 280)
    for i, name in enumerate(run.states):
        gained = np.mean((smoothed[name] - truth[:, i])[middle] ** 2)
        assert gained < np.mean((run[name] - truth[:, i])[middle] ** 2)
        assert np.mean(smoothed.std[middle, i]) < 0.8 * np.mean(run.std[middle, i])


@pytest.mark.parametrize("gated", [True, False])
def test_fixed_lag_is_the_smoother_up_to_then(setup: Any, swing: Any, gated: bool) -> None:
    """The smoother of the record that ends with the sample, at the moment one lag before, to 1e-9."""
    rng = np.random.default_rng(2)
    hand = setup("waved", {"compass": 0.002, "r": 5e-4}, driving={"w": 0.02}, density={"r": 1e-4},
                 gate=5.0 if gated else None)  # fmt: skip
    t = np.arange(80) * 0.7
    record = sailed(hand, t, swing, rng)
    record["compass"][30] += 2.0
    record["r"][40:44] = np.nan
    online = hand.kalman.start(lag="7 s")
    for k in range(80):
        lagged = online.update({n: c[k] for n, c in record.items()}).lagged
        if k < 10:
            assert lagged is None
            continue
        assert lagged is not None
        if k % 13 and k != 79:
            continue
        so_far = hand.kalman.filter({n: c[: k + 1] for n, c in record.items()})
        smoothed = smooth(so_far)
        assert lagged[0] == t[k - 10]
        assert np.all(np.abs(lagged[1] - smoothed.x[k - 10]) <= 1e-9 * smoothed.std[k - 10])
        assert lagged[2] == pytest.approx(smoothed.std[k - 10], rel=1e-9)


def test_a_lag_across_a_gap(setup: Any, swing: Any) -> None:
    """After a gap longer than the lag the oldest moment still held is the one before it."""
    hand = setup("yaw", SENSORS, density={"r": 1e-4})
    t = np.concatenate([np.arange(20.0), np.arange(20.0) + 40.0])
    record = sailed(hand, t, swing, np.random.default_rng(2))
    online = hand.kalman.start(lag="5 s")
    found = [online.update({n: c[k] for n, c in record.items()}).lagged for k in range(40)]
    assert [f[0] for f in found[5:20]] == list(t[:15])
    for k in (20, 26, 39):
        so_far = smooth(hand.kalman.filter({n: c[: k + 1] for n, c in record.items()}))
        at = int(np.searchsorted(t, found[k][0]))
        assert t[at] == found[k][0] and t[k] - t[at] >= 5.0 - 1e-9
        assert np.all(np.abs(found[k][1] - so_far.x[at]) <= 1e-9 * so_far.std[at])
