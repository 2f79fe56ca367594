"""The filter over a record against filterpy, which we did not write, and against dense formulas."""

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from filterpy.kalman import ExtendedKalmanFilter as Oracle

from shipid import Component, ExtendedKalmanFilter, find_model, find_ship, join, parameter, state
from shipid.declaration.scale import Scale
from shipid.estimation.errors import FilterDivergedError
from shipid.estimation.settings.initial import state_bounds
from shipid.parameters.parameter_set import ParameterSet, Value
from shipid.trials.source import Source
from shipid.trials.trial import Trial


class _Moved(Oracle):
    """Filterpy's filter with a state that moves by the model instead of by F."""

    ahead: Any

    def predict_x(self, u: Any = 0) -> None:
        self.x = self.ahead


def oracle(hand: Any, record: dict[str, np.ndarray], x0: np.ndarray, p0: np.ndarray, there: Any = None) -> Any:
    """Run filterpy over a record: joint updates, Joseph's form. Return estimates, covariances, likelihood, NIS."""
    intervals, u, z = hand.rows(record)
    there = np.isfinite(z) if there is None else there
    kf = _Moved(x0.size, z.shape[1])
    kf.x, kf.P = x0.copy(), p0.copy()
    R = np.diag(hand.kalman.design.r**2)
    xs, ps, ll, nis = [], [], 0.0, []
    for k, T in enumerate(intervals):
        if k:
            kf.F = hand.transition(kf.x, u[k - 1], u[k], T)
            kf.Q = hand.noise(kf.x, u[k - 1], u[k], T, kf.F)
            kf.ahead = hand.advance(kf.x, u[k - 1], u[k], T)
            kf.predict()
        m, at = there[k], u[k]
        squares = 0.0
        if m.any():
            one = copy.copy(kf)
            one.dim_z = int(m.sum())
            kf.update(
                z[k][m],
                lambda x, at=at, m=m: hand.sensitivity(x, at)[m],
                lambda x, at=at, m=m: hand.shown(x, at)[m],
                R=R[np.ix_(m, m)],
            )
            squares = kf.y @ kf.SI @ kf.y
            # Its own density goes through eigenvalues of S, which loses digits where sensors differ in size.
            ll -= 0.5 * (np.linalg.slogdet(2 * np.pi * kf.S)[1] + squares)
        nis.append(squares)
        xs.append(kf.x.copy())
        ps.append(kf.P.copy())
    return np.array(xs), np.array(ps), ll, np.array(nis)


CASES: dict[str, tuple[str, dict[str, float], dict[str, Any], dict[str, float]]] = {
    # model, sensors, options, true first state
    "linear": ("yaw", {"psi": 0.01, "r": 5e-4}, {"density": {"r": 1e-4}}, {"psi": 0.2, "r": 0.004}),
    "one sensor, rudder noise": ("yaw", {"psi": 0.01}, {"lasting": {"delta": 0.02}, "sample": {"r": 1e-4}}, {"r": 0.004}),
    "logarithms": (
        "yaw",
        {"psi": 0.01, "r": 5e-4},
        {"density": {"r": 1e-4}, "estimated": ["K", "tau"], "initial": {"K": "0.02 1/s", "tau": "10 s"}},
        {"log_K": np.log(0.07), "log_tau": np.log(40.0)},
    ),
    "bounded parameters, walking": (
        "yaw",
        {"psi": 0.01, "r": 5e-4},
        {"sample": {"b": 1e-4}, "density": {"r": 1e-4}, "estimated": ["b"]},
        {"b": 0.02},
    ),
    "sampled state": (
        "counted",
        {"psi": 0.01, "held": 5e-4},
        {"sample": {"held": 1e-4}, "density": {"r": 1e-4}},
        {"r": 0.004},
    ),
    "curved sensor": ("surge", {"log": 0.1}, {"density": {"u": 0.02}}, {"u": 5.0}),
    "de keizer": (
        "de-keizer",
        {"psi": 0.005, "r": 5e-4, "v": 0.2, "x": 10.0, "y": 10.0},
        {
            "density": {"r": 1e-5, "u": 0.01},
            "driving": {"delta": 0.01},
            "estimated": ["K", "tau"],
            "initial": {"K": "0.4", "tau": "0.4"},
            "inputs": {"cruise": "9.5 m/s"},
        },
        {"u": 9.5, "log_K": np.log(1.6), "log_tau": np.log(1.7)},
    ),
}  # fmt: skip


@pytest.fixture(scope="module", params=CASES)
def case(request: Any, setup: Any, swing: Any, uneven: Any) -> Any:
    """A filter, the one by hand, and a record with gaps in what the sensors show."""
    name, sensors, options, first = CASES[request.param]
    hand = setup(name, sensors, **options)
    t = uneven(150)
    inputs = {"delta": swing(t), "thrust": 0.3 + swing(t, 0.2), "cruise": np.full(t.size, 9.5), "current_north": 0.3}
    x0 = np.array([first.get(s, 0.0) for s in hand.states])
    record, truth = hand.sail(t, inputs, x0, np.array(list(sensors.values())), np.random.default_rng(5))
    rng = np.random.default_rng(6)
    for sensor in sensors:
        record[sensor] = np.where(rng.random(t.size) < 0.2, np.nan, record[sensor])
    record[next(iter(sensors))][0] = 0.1
    return hand, record, truth


def test_equals_filterpy(case: Any) -> None:
    """Several sensors, irregular and missing samples, every kind of noise: to 1e-9 of the standard deviation."""
    hand, record, _ = case
    run = hand.kalman.filter(record)
    start = run.start
    n = hand.kalman.design.layout.n
    x0 = start[hand.kalman.design.layout.carried["x"]]
    packed = start[hand.kalman.design.layout.carried["P"]]
    p0 = np.diag(packed[np.cumsum(np.arange(1, n + 1)) - 1])
    xs, ps, ll, nis = oracle(hand, record, x0, p0)
    std = np.sqrt(np.diagonal(ps, axis1=1, axis2=2))
    assert np.all(np.abs(run.x - xs) <= 1e-9 * std)
    scale = std[:, :, None] * std[:, None, :]
    assert np.all(np.abs(run.covariance - ps) <= 1e-9 * scale)
    assert run.std == pytest.approx(std, rel=1e-9)
    assert run.nis == pytest.approx(nis, rel=1e-8, abs=1e-8)
    assert run.log_likelihood == pytest.approx(ll, rel=1e-9)


def test_square_root_form_is_the_same_filter(case: Any, setup: Any) -> None:
    hand, record, _ = case
    name = hand.kalman.design.base.name
    options = next(c[2] for k, c in CASES.items() if c[0] == name and c[1].keys() == set(hand.kalman.measured) and
                   tuple(c[2].get("estimated", ())) == tuple(hand.kalman.parameters))  # fmt: skip
    sensors = dict(zip(hand.kalman.measured, hand.kalman.design.r))
    other = setup(name, sensors, form="square-root", **options).kalman.filter(record)
    run = hand.kalman.filter(record)
    assert np.all(np.abs(other.x - run.x) <= 1e-8 * run.std)
    assert other.std == pytest.approx(run.std, rel=1e-8)
    assert other.log_likelihood == pytest.approx(run.log_likelihood, rel=1e-9)


def test_uncompiled_is_the_same_filter(case: Any, monkeypatch: pytest.MonkeyPatch, setup: Any) -> None:
    hand, record, _ = case
    run = hand.kalman.filter(record)
    kalman = copy.copy(hand.kalman)
    # The same design, of which nothing has been generated yet.
    kalman.design = replace(hand.kalman.design, _loops={}, _quantities={})
    monkeypatch.setenv("SHIPID_COMPILE", "0")
    slow = kalman.filter(record)
    assert not kalman.design.loop(full=True).compiled and hand.kalman.design.loop(full=True).compiled
    assert np.all(np.abs(slow.x - run.x) <= 1e-10 * run.std)
    assert slow.log_likelihood == pytest.approx(run.log_likelihood, rel=1e-11)
    assert np.all(np.abs(kalman.smooth(slow).x - hand.kalman.smooth(run).x) <= 1e-9 * run.std)


def test_the_estimate_is_as_far_off_as_it_says(case: Any) -> None:
    """Normalised errors of one record, all states: far from nothing, and not beyond five standard deviations."""
    hand, record, truth = case
    run = hand.kalman.filter(record)
    off = (run.x - truth) / run.std
    # Half of the record, where the first guess has been overcome.
    assert 0.1 < np.sqrt(np.mean(off[75:] ** 2)) < 2.0 and np.abs(off[75:]).max() < 5.0


def test_runs_away_is_an_error(setup: Any) -> None:
    """A speed that grows without end because it runs backwards."""
    hand = setup("surge", {"log": 50.0}, density={"u": 1e-6})
    t = np.arange(400.0)
    record = {"t": t, "thrust": np.full(400, -5.0), "log": np.where(t < 1, -1.0, np.nan)}
    with pytest.raises(FilterDivergedError, match=r"model surge diverges .* s into the record\. Start closer"):
        hand.kalman.filter(record)
    trial = Trial("backwards", pd.DataFrame(record), Source(), units={"thrust": "m/s^2", "log": "m/s"})
    with pytest.raises(FilterDivergedError, match=r"^trial 'backwards': the filter of model surge diverges"):
        hand.kalman.filter(trial)


def test_noise_of_a_parameter_in_its_own_unit(setup: Any) -> None:
    """K = 0.07 1/s, estimated by its logarithm: a walk of 0.0014 1/s in a root second is one of 0.02 of the logarithm."""
    kalman = setup("yaw", {"psi": 0.01}, estimated=["K"], density={"K": 0.0014}).kalman
    assert {s.name: s.level for s in kalman.design.sources} == {"log_K": pytest.approx(0.02)}
    t = np.array([0.0, 100.0])
    run = kalman.filter({"t": t, "psi": np.array([0.0, np.nan]), "delta": np.zeros(2)})
    first, last = run.std[:, run.states.index("log_K")]
    assert last**2 - first**2 == pytest.approx(0.02**2 * 100)


def test_a_first_sample_hardly_counts_twice() -> None:
    """A coarse sensor, and nothing else known of the heading: after its first sample the estimate is as sure as that sample."""
    kalman = ExtendedKalmanFilter(find_model("de-keizer"), find_ship("soesterberg"), measured={"psi": "60 deg"})
    run = kalman.filter({"t": np.arange(3.0), "psi": np.zeros(3), "delta": np.zeros(3), "cruise": np.full(3, 9.5)})
    assert run.std[0, run.states.index("psi")] == pytest.approx(np.pi / 3, rel=0.01)


def test_bounds_follow_the_prime_system() -> None:
    """L = 100 m and U = 5 m/s: a coefficient in 1/s within -2 and 3 in the prime system lies within -0.1 and 0.15 1/s."""

    class Damped(Component):
        r = state("rad/s", "rate of turn")
        damping = parameter("1/s", "damping", start=0.5, low=-2.0, high=3.0, prime=True)

        @r.rate
        def yaw(self) -> Any:
            """A first-order lag."""
            return -self.damping * self.r

    base = join("damped", Damped)
    particulars = {"L": Value("L", 100.0, "m", "assumed"), "speed": Value("speed", 5.0, "m/s", "assumed")}
    known = ParameterSet("ship", sections={"particulars": particulars})
    kalman = ExtendedKalmanFilter(
        base, known, measured={"r": "0.001 rad/s"}, estimated=["damping"], log=[], noise={"damping": "0.05 1/s/s^0.5"}
    )
    low, high = state_bounds(base, kalman.model, {"damping": "damping"}, Scale(100.0, 5.0))
    place = kalman.model.states.index("damping")
    assert (low[place], high[place]) == pytest.approx((-0.1, 0.15))
    # A rate that dies away faster than the upper bound allows, and one that grows faster than the lower one does.
    t = np.arange(0.0, 40.0, 0.5)
    for sign, bound in ((-1.0, 0.15), (1.0, -0.1)):
        run = kalman.filter({"t": t, "r": 0.01 * np.exp(sign * 0.3 * t)})
        assert np.abs(run["damping"] - bound).min() == pytest.approx(0.0, abs=1e-12)
        assert run["damping"].min() >= -0.1 - 1e-12 and run["damping"].max() <= 0.15 + 1e-12
