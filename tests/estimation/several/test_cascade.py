"""Filters in a row: each at its own rate, fed by those before it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

import shipid
from shipid.estimation.errors import SensorRateError
from shipid.estimation.kalman import ExtendedKalmanFilter
from shipid.estimation.several.adaptive_noise import AdaptiveFilter
from shipid.estimation.several.cascade import Cascade
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.parameters.catalogue import find_model

FIXES = {"log": "0.1 m/s", "fix_north": "20 m", "fix_east": "20 m"}
PASSED = {"psi": "1 deg", "r": "0.01 deg/s"}


@pytest.fixture(scope="module")
def yaw() -> ExtendedKalmanFilter:
    return ExtendedKalmanFilter(find_model("yaw-filter"), "soesterberg")


def position(**options: Any) -> ExtendedKalmanFilter:
    return ExtendedKalmanFilter(find_model("position-filter"), "soesterberg", measured=FIXES, **options)


@pytest.fixture(scope="module")
def plain() -> ExtendedKalmanFilter:
    return position()


@pytest.fixture(scope="module")
def pair(yaw: ExtendedKalmanFilter, plain: ExtendedKalmanFilter) -> Cascade:
    return Cascade({"yaw": yaw, "position": plain}, every={"position": "2 s"})


@pytest.fixture(scope="module")
def record() -> dict[str, np.ndarray]:
    noise = {"psi": "0.2 deg", "r": "0.1 deg/s", "u": "0.1 m/s", "x": "20 m", "y": "20 m"}
    trial = shipid.simulate(
        find_model("de-keizer-minimal"),
        "soesterberg",
        "zigzag:15/15",
        duration="400 s",
        sampling="0.4 s",
        noise=noise,
        current=("1 m/s", "30 deg"),
    )
    return {n: trial[n] for n in ("t", "delta", "u", "psi", "r", "x", "y")} | {"cruise": np.full(len(trial), 9.5)}


def test_what_one_estimates_is_an_input_of_the_next(pair: Cascade, record: dict[str, np.ndarray]) -> None:
    assert pair.passed == {"yaw": {}, "position": {"psi": "yaw", "r": "yaw"}}
    run = pair.filter(record)
    assert list(run) == ["yaw", "position"]
    alone = pair.filters["yaw"].filter(record)
    np.testing.assert_array_equal(run["yaw"].x, alone.x)
    thinned = {n: c[::5] for n, c in (record | {"psi": alone["psi"], "r": alone["r"]}).items()}
    by_hand = pair.filters["position"].filter(thinned)
    np.testing.assert_array_equal(run["position"].t, record["t"][::5])
    np.testing.assert_array_equal(run["position"].x, by_hand.x)
    late = run["position"].t > 250
    assert np.mean(run["position"]["current_north"][late]) == pytest.approx(np.cos(np.pi / 6), abs=0.25)


def test_samples_one_by_one_give_the_same(pair: Cascade, record: dict[str, np.ndarray]) -> None:
    run, online = pair.filter(record), pair.start()
    seen = []
    for k in range(record["t"].size):
        ran = online.update({n: float(c[k]) for n, c in record.items()})
        assert ("position" in ran) == (k % 5 == 0)
        if "position" in ran:
            seen.append(ran["position"].x)
    np.testing.assert_allclose(seen, run["position"].x, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(online.latest["yaw"].x, run["yaw"].x[-1], rtol=1e-9, atol=1e-12)


def test_a_clock_that_goes_back_stops_no_filter(pair: Cascade, record: dict[str, np.ndarray]) -> None:
    rows = np.r_[0:20, 10, 20:40]
    jumbled = {n: c[rows] for n, c in record.items()}
    sorted_out = pair.filter({n: c[:40] for n, c in record.items()})
    np.testing.assert_array_equal(pair.filter(jumbled)["position"].x, sorted_out["position"].x)
    online = pair.start()
    for k in rows:
        online.update({n: float(c[k]) for n, c in record.items()})
    np.testing.assert_allclose(online.latest["position"].x, sorted_out["position"].x[-1], rtol=1e-9, atol=1e-9)


def test_a_later_filter_may_run_more_often(yaw: ExtendedKalmanFilter, record: dict[str, np.ndarray]) -> None:
    """It then holds the last estimate, as a wire would."""
    run = Cascade({"yaw": yaw, "position": position()}, every={"yaw": "2 s"}).filter(record)
    held = np.repeat(run["yaw"]["psi"], 5)[: record["t"].size]
    np.testing.assert_array_equal(run["position"].arranged.inputs[:, 0], held)


def test_uncertainty_passed_on_widens_what_depends_on_it(
    yaw: ExtendedKalmanFilter, pair: Cascade, record: dict[str, np.ndarray]
) -> None:
    told = position(noise=PASSED)
    passing = Cascade({"yaw": yaw, "position": told}, every={"position": "2 s"}, uncertain=["psi", "r"])
    run = passing.filter(record)
    assert (run["position"].std_of("y")[5:] > pair.filter(record)["position"].std_of("y")[5:]).all()
    # Whatever level the filter was made with, the estimate's own stands in its place.
    other = position(noise={"psi": "3 deg", "r": "0.2 deg/s"})
    again = Cascade({"yaw": yaw, "position": other}, every={"position": "2 s"}, uncertain=["psi", "r"]).filter(record)
    np.testing.assert_allclose(again["position"].std, run["position"].std, rtol=1e-9)
    online = passing.start()
    for k in range(50):
        online.update({n: float(c[k]) for n, c in record.items()})
    np.testing.assert_allclose(online.latest["position"].std, run["position"].std[9], rtol=1e-9)


def test_an_adaptive_filter_stands_in_a_row(
    yaw: ExtendedKalmanFilter, plain: ExtendedKalmanFilter, record: dict[str, np.ndarray]
) -> None:
    adaptive = AdaptiveFilter(plain, ("current_north", "current_east"))
    cascade = Cascade({"yaw": yaw, "position": adaptive}, every={"position": "2 s"})
    run, online = cascade.filter(record), cascade.start()
    for k in range(101):
        online.update({n: float(c[k]) for n, c in record.items()})
    np.testing.assert_allclose(online.latest["position"].x, run["position"].x[20], rtol=1e-9, atol=1e-9)
    assert cascade.covariance_elements == 28 + 2 * 21


def test_factors_reach_their_filter(pair: Cascade, record: dict[str, np.ndarray]) -> None:
    loud = pair.filter(record, scale={"position": {"current_north": 10.0}})
    quiet = pair.filter(record)
    assert loud["position"].std_of("current_north")[-1] > 1.5 * quiet["position"].std_of("current_north")[-1]
    np.testing.assert_array_equal(loud["yaw"].x, quiet["yaw"].x)


def test_results(pair: Cascade, record: dict[str, np.ndarray]) -> None:
    run = pair.filter(record)
    table = run.to_frame()
    assert len(table) == record["t"].size
    # Estimates of the slower filter stand until the next.
    np.testing.assert_array_equal(table["x [m]"], np.repeat(run["position"]["x"], 5)[: len(table)])
    told = json.loads(json.dumps(run.to_dict(), allow_nan=False))
    assert set(told["filters"]) == {"yaw", "position"}
    assert {"K", "tau"} <= set(told["filters"]["yaw"]["parameters"])
    assert run.text().startswith("yaw: ") and "\nposition: " in run.text()
    assert "position every 2 s, psi from yaw, r from yaw" in repr(pair)
    # The noise of the waves is carried beside the six states of the yaw filter.
    assert pair.covariance_elements == 28 + 21


def test_what_does_not_fit_is_said(yaw: ExtendedKalmanFilter, pair: Cascade, record: dict[str, np.ndarray]) -> None:
    plain = pair.filters["position"]
    with pytest.raises(UsageError, match="at least one filter"):
        Cascade({})
    with pytest.raises(UnknownNameError, match=r"'postion'.*position"):
        Cascade({"yaw": yaw, "position": plain}, every={"postion": "2 s"})
    with pytest.raises(SensorRateError, match="'position' is to run every 0 s"):
        Cascade({"yaw": yaw, "position": plain}, every={"position": "0 s"})
    with pytest.raises(UsageError, match="'psi' is to be passed on to 'position', which has no noise on it"):
        Cascade({"yaw": yaw, "position": plain}, uncertain=["psi"])
    with pytest.raises(UsageError, match="'u' is to be passed on to no filter"):
        Cascade({"yaw": yaw, "position": plain}, uncertain=["u"])
    with pytest.raises(SensorRateError, match=r"'position' is to be read every 0\.1 s"):
        Cascade({"yaw": yaw, "position": plain}, every={"position": "0.1 s"}).filter(record)
    with pytest.raises(UnknownNameError, match="'speed'"):
        pair.filter(record)["speed"]
