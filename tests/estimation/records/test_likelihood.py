"""The likelihood, its gradient and its information, against differences and dense formulas."""

from typing import Any

import numpy as np
import pytest

from shipid.foundation.errors import UnknownNameError

SENSORS = {"psi": 0.01, "r": 5e-4}


def record_of(hand: Any, swing: Any, uneven: Any, **first: float) -> dict[str, np.ndarray]:
    t = uneven(80)
    levels = hand.kalman.design.r
    x0 = np.array([first.get(s, 0.0) for s in hand.states])
    inputs = {"delta": swing(t), "cruise": np.full(t.size, 9.5), "thrust": 0.3 + swing(t)}
    record = hand.sail(t, inputs, x0, levels, np.random.default_rng(6))[0]
    rng = np.random.default_rng(7)
    for n in hand.kalman.measured:
        record[n] = np.where((rng.random(t.size) < 0.1) & (t > t[0]), np.nan, record[n])
    return record


CASES: dict[str, tuple[str, dict[str, float], dict[str, Any], list[str], dict[str, float]]] = {
    "yaw": (
        "yaw",
        SENSORS,
        {"density": {"r": 1e-4}, "lasting": {"delta": 0.02}},
        ["K", "tau", "b", "noise:r", "noise:delta", "sensor:psi", "sensor:r", "x0:psi", "x0:r", "bias:delta"],
        {"r": 0.004},
    ),
    "waves": (
        "waved",
        {"compass": 0.002, "r": 5e-4},
        {"driving": {"w": 0.02}, "density": {"r": 1e-4}},
        ["pace", "noise:w", "noise:r", "sensor:compass", "x0:v", "bias:w", "bias:delta"],
        {"r": 0.004},
    ),
    "augmented": (
        "yaw",
        SENSORS,
        {"density": {"r": 1e-4}, "sample": {"K": 2e-3}, "estimated": ["K"], "log": ()},
        ["tau", "noise:K", "noise:r", "x0:K"],
        {"K": 0.07},
    ),
    "curved": ("surge", {"log": 0.1}, {"density": {"u": 0.02}}, ["c", "one", "noise:u", "sensor:log", "x0:u", "bias:thrust"], {"u": 5.0}),
    "de keizer": (
        "de-keizer",
        {"psi": 0.005, "r": 5e-4, "u": 0.1, "x": 10.0},
        {"density": {"r": 1e-5, "u": 0.01}, "driving": {"delta": 0.01}},
        ["K", "noise:delta", "sensor:x", "x0:u", "bias:cruise"],
        {"u": 9.5},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_gradients_are_exact(setup: Any, swing: Any, uneven: Any, case: str) -> None:
    """Every kind of unknown against central differences, to 1e-6 of what the record tells (its expected curvature)."""
    name, sensors, options, unknowns, first = CASES[case]
    hand = setup(name, sensors, **options)
    likelihood = hand.kalman.likelihood(record_of(hand, swing, uneven, **first), unknowns)
    q = likelihood.start + 0.0
    value, gradient, information = likelihood(q)
    assert np.isfinite(value) and information == pytest.approx(information.T)
    assert np.linalg.eigvalsh(information / np.sqrt(np.outer(*[np.diag(information)] * 2)))[0] > -1e-9
    for j, unknown in enumerate(unknowns):
        # Steps in the size that matters to the record; Richardson's rule takes the error of the difference away.
        h = 1e-2 / np.sqrt(information[j, j])

        def slope(h: float, j: int = j) -> float:
            up, down = q.copy(), q.copy()
            up[j] += h
            down[j] -= h
            return (likelihood(up)[0] - likelihood(down)[0]) / (2 * h)

        wanted = (4 * slope(h / 2) - slope(h)) / 3
        assert abs(gradient[j] - wanted) <= 1e-6 * max(abs(wanted), np.sqrt(information[j, j])), unknown


def test_value_is_the_filter_s_own(setup: Any, swing: Any, uneven: Any) -> None:
    name, sensors, options, unknowns, first = CASES["yaw"]
    # The first state is as uncertain whatever the sensors: otherwise their noise would set it when the filter is made.
    options = options | {"initial": {"psi": "0.1 rad", "r": "0.01 rad/s"}}
    hand = setup(name, sensors, **options)
    record = record_of(hand, swing, uneven, **first)
    likelihood = hand.kalman.likelihood(record, unknowns)
    assert likelihood(likelihood.start)[0] == pytest.approx(hand.kalman.filter(record).log_likelihood, rel=1e-12)
    # And at other levels the filter that is made with them.
    other = likelihood.start.copy()
    other[unknowns.index("sensor:psi")] = np.log(0.02)
    other[unknowns.index("noise:r")] = np.log(3e-4)
    other[unknowns.index("K")] = 0.05
    changed = setup(name, {"psi": 0.02, "r": 5e-4}, **options | {"density": {"r": 3e-4}, "values": {"K": 0.05}}).kalman
    again = changed.likelihood(record, ())
    assert likelihood(other)[0] == pytest.approx(again(np.zeros(0))[0], rel=1e-12)


def test_information_is_what_the_scatter_shows(setup: Any, swing: Any, uneven: Any) -> None:
    """Fisher's information is the variance of the score: over 300 simulated records, of every unknown."""
    name, sensors, options, _, _ = CASES["yaw"]
    unknowns = ["K", "tau", "noise:r", "sensor:psi", "sensor:r"]
    hand = setup(name, sensors, initial={"psi": "0.03 rad", "r": "0.002 rad/s"}, start={"psi": "0 rad", "r": "0 rad/s"},
                 **options | {"lasting": {}})  # fmt: skip
    t = np.arange(60.0)
    rng = np.random.default_rng(3)
    steps = hand.transition(np.zeros(2), np.zeros(1), np.zeros(1), 1.0)
    count = 300
    delta = swing(t)
    half = np.sqrt(hand.halves(1.0))
    scores, expected = [], []
    deviation = np.sqrt(np.array([0.03, 0.002]) ** 2 + np.array([0.01, 5e-4]) ** 2)
    x = rng.standard_normal((count, 2)) * deviation
    psi, r = np.empty((count, t.size)), np.empty((count, t.size))
    for k in range(t.size):
        if k:
            mean = hand.advance(np.zeros(2), delta[k - 1 : k], delta[k : k + 1], 1.0)
            x = (x + half * rng.standard_normal(x.shape)) @ steps.T + mean + half * rng.standard_normal(x.shape)
        psi[:, k] = x[:, 0] + 0.01 * rng.standard_normal(count)
        r[:, k] = x[:, 1] + 5e-4 * rng.standard_normal(count)
    for i in range(count):
        likelihood = hand.kalman.likelihood({"t": t, "delta": delta, "psi": psi[i], "r": r[i]}, unknowns)
        _, gradient, information = likelihood(likelihood.start)
        scores.append(gradient)
        expected.append(information)
    information = np.mean(expected, axis=0)
    scaled = np.array(scores) / np.sqrt(np.diag(information))
    # Mean zero and variance one, within three standard errors of 300.
    assert np.all(np.abs(scaled.mean(axis=0)) < 3 / np.sqrt(count))
    assert np.all(np.abs(scaled.var(axis=0) - 1) < 3 * np.sqrt(2 / count))


def test_held_parameters_in_the_likelihood(setup: Any, swing: Any, uneven: Any) -> None:
    """A filter that can be switched has the likelihood of one that cannot."""
    name, sensors, options, unknowns, first = CASES["augmented"]
    hand, other = setup(name, sensors, **options), setup(name, sensors, switchable=True, **options)
    record = record_of(hand, swing, uneven, **first)
    a, b = (h.kalman.likelihood(record, unknowns) for h in (hand, other))
    for x, y in zip(a(a.start), b(b.start)):
        assert y == pytest.approx(x, rel=1e-8, abs=1e-8 * np.abs(x).max())


def test_running_away_is_minus_infinity(setup: Any, swing: Any, uneven: Any) -> None:
    name, sensors, options, unknowns, first = CASES["curved"]
    hand = setup(name, sensors, **options)
    likelihood = hand.kalman.likelihood(record_of(hand, swing, uneven, **first), unknowns)
    q = likelihood.start.copy()
    q[unknowns.index("c")] = -100.0
    value, gradient, information = likelihood(q)
    assert value == -np.inf and not gradient.any() and not information.any()


@pytest.mark.parametrize("unknown", ["Kay", "noise:psi", "sensor:v", "x0:K", "bias:w", "noise", "foo:r", ":"])
def test_unknowns_that_are_not_there(setup: Any, swing: Any, uneven: Any, unknown: str) -> None:
    hand = setup("yaw", SENSORS, density={"r": 1e-4})
    record = record_of(hand, swing, uneven)
    with pytest.raises(UnknownNameError, match=r"no unknown of the likelihood called '"):
        hand.kalman.likelihood(record, ["K", unknown])


def test_innovations_are_those_of_the_filter_and_their_slopes_exact(setup: Any, swing: Any, uneven: Any) -> None:
    """Of unknowns that leave the variances alone, the slopes are those of the innovations in standard deviations."""
    hand = setup("yaw", SENSORS, **{"density": {"r": 1e-4}})
    record = record_of(hand, swing, uneven)
    unknowns = ["x0:psi", "x0:r", "bias:delta"]
    likelihood = hand.kalman.likelihood(record, unknowns)
    ((series, slopes),) = likelihood.innovations(likelihood.start)
    run = hand.kalman.filter(record)
    for k, name in enumerate(hand.kalman.measured):
        seen = np.isfinite(series[k])
        assert np.array_equal(seen, np.isfinite(record[name]))
        assert series[k][seen] == pytest.approx(run.innovations[name].normalised, rel=1e-6, abs=1e-9)
    for j, step in enumerate((1e-3, 1e-5, 1e-3)):
        moved = np.zeros(3)
        moved[j] = step
        ((after, _),) = likelihood.innovations(likelihood.start + moved)
        ((before, _),) = likelihood.innovations(likelihood.start - moved)
        found = np.nan_to_num((after - before) / (2 * step))
        assert slopes[:, :, j] == pytest.approx(found, rel=1e-5, abs=1e-6 * np.abs(found).max())
