"""What holds for any record: covariances, the order of sensors, splitting a record anywhere, whatever is in it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as some

from shipid.estimation.records.clock import FilterClock
from shipid.estimation.records.consistency import whiteness
from shipid.estimation.records.smoother import smooth

SENSORS = {"psi": 0.01, "r": 5e-4}
OPTIONS: dict[str, Any] = {"density": {"r": 1e-4}, "estimated": ["K", "tau"]}
FEW = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(scope="module")
def filters(setup: Any) -> dict[str, Any]:
    """Made once: with and without a gate, with the sensors the other way round, and as a square root."""
    turned = dict(reversed(SENSORS.items()))
    return {
        "gated": setup("yaw", SENSORS, gate=5.0, **OPTIONS).kalman,
        "open": setup("yaw", SENSORS, **OPTIONS).kalman,
        "turned": setup("yaw", turned, **OPTIONS).kalman,
        "root": setup("yaw", SENSORS, gate=5.0, form="square-root", **OPTIONS).kalman,
    }


@some.composite
def records(draw: Any, wild: bool = True) -> dict[str, np.ndarray]:
    """A record of 2 to 60 samples: any intervals, holes, outliers, stuck sensors; plausible where it is not wild."""
    count = draw(some.integers(2, 60))
    rng = np.random.default_rng(draw(some.integers(0, 2**32 - 1)))
    t = np.cumsum(rng.choice([0.1, 0.7, 1.0, 3.0, 45.0], count) * rng.uniform(0.5, 1.5, count))
    delta = 0.3 * np.sin(t / rng.uniform(5, 50))
    psi, r = 0.01 * rng.standard_normal(count), 5e-4 * rng.standard_normal(count)
    if wild:
        psi += rng.choice([0.0, 0.3, -20.0, 400.0], count, p=[0.8, 0.1, 0.05, 0.05])
        r += rng.choice([0.0, 0.01, 5.0], count, p=[0.9, 0.05, 0.05])
        psi[rng.random(count) < 0.2] = np.nan
        r[rng.random(count) < 0.2] = np.nan
        psi[count // 2 : count // 2 + int(rng.integers(0, 15))] = psi[count // 2]
        # One position of the rudder is known: a record without any is refused.
        delta[1:][rng.random(count - 1) < 0.1] = np.nan
    return {"t": t, "psi": psi, "r": r, "delta": delta}


def rounding(run: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return what rounding may leave in a standard deviation and in a normalised innovation, shapes (N,), up to each sample.

    ``P - K H P`` takes numbers of the size of the innovation variance S from each other and leaves one of the size of the
    sensor's R: the relative error of the covariance, and of the gain, is the rounding of one number times S/R. The gain
    multiplies the innovation. Later samples carry both errors on. Of 12000 records the worst left 0.2 and 0.5 of these.
    """
    spread = np.max([run.innovations[n].variances / level**2 for n, level in SENSORS.items()], axis=0)
    beyond = np.max([np.abs(run.innovations[n].normalised) for n in SENSORS], axis=0)
    covariance = np.finfo(float).eps * np.maximum.accumulate(spread)
    return covariance, covariance * np.maximum.accumulate(np.maximum(beyond, 1.0))


@FEW
@given(record=records(), which=some.sampled_from(["gated", "root"]))
def test_covariances_are_symmetric_and_positive(
    filters: dict[str, Any], record: dict[str, np.ndarray], which: str
) -> None:
    run = filters[which].filter(record)
    P = run.covariance
    assert np.array_equal(P, P.transpose(0, 2, 1)) and np.isfinite(run.x).all()
    # A root is positive in any case. A difference of covariances is so as far as digits are left of it (`rounding`).
    spread = [np.max(run.innovations[n].variances, initial=0.0) / level**2 for n, level in SENSORS.items()]
    lost = 0.0 if which == "root" else 10 * np.finfo(float).eps * max(spread)
    assume(lost < 1e-2)
    scale = np.sqrt(np.diagonal(P, axis1=1, axis2=2))
    assert np.all(scale > 0) and scale == pytest.approx(run.std)
    assert np.linalg.eigvalsh(P / (scale[:, :, None] * scale[:, None, :])).min() > -1e-9 - lost
    # What was taken in never makes a state less sure than the prediction, unless it leapt.
    smoothed = smooth(run)
    assert np.isfinite(smoothed.x).all() and np.all(smoothed.std >= 0)


@FEW
@given(record=records(wild=False))
def test_the_order_of_sensors_does_not_matter(filters: dict[str, Any], record: dict[str, np.ndarray]) -> None:
    """All are linearised at the same point, so sequential updates are the joint one, in any order."""
    a, b = filters["open"].filter(record), filters["turned"].filter(record)
    of_std, of_state = (10 * np.maximum(*both) for both in zip(rounding(a), rounding(b)))
    assert np.isfinite(a.x).all() and np.isfinite(b.x).all()
    # Where a prediction is some million times as wide as its sensor, no digits are left to compare.
    assume(of_state[-1] < 1e-2)
    assert np.all(np.abs(a.x - b.x) <= of_state[:, None] * a.std)
    assert np.all(np.abs(a.std - b.std) <= of_std[:, None] * a.std)
    assert np.all(np.abs(a.nis - b.nis) <= of_state * np.maximum(a.nis, 1.0))
    assert abs(a.log_likelihood - b.log_likelihood) <= of_state[-1] * max(a.nis.sum(), a.t.size)


@FEW
@given(record=records(), at=some.floats(0, 1))
def test_a_record_can_be_split_anywhere(
    filters: dict[str, Any], tmp_path: Path, record: dict[str, np.ndarray], at: float
) -> None:
    """Through a file, to the bit."""
    kalman = filters["gated"]
    rows = [{n: float(c[k]) for n, c in record.items()} for k in range(record["t"].size)]
    rows[0]["delta"] = 0.0
    split = 1 + int(at * (len(rows) - 2))
    whole, first = kalman.start(), kalman.start()
    wanted = [whole.update(s) for s in rows]
    for s in rows[:split]:
        first.update(s)
    first.save(tmp_path / "state.json")
    second = kalman.restore(tmp_path / "state.json")
    for s, w in zip(rows[split:], wanted[split:]):
        got = second.update(s)
        assert np.array_equal(got.x, w.x) and np.array_equal(got.std, w.std) and got.rejected == w.rejected
    assert second.rejected == whole.rejected


STAMPS = some.one_of(some.integers(-50, 50), some.sampled_from([np.nan, np.inf, 1e300, 5000.0, 1e-9]))


@FEW
@given(record=records(), stamps=some.lists(STAMPS, min_size=2, max_size=60))
def test_any_clock_is_survived(filters: dict[str, Any], record: dict[str, np.ndarray], stamps: list[float]) -> None:
    """Whatever the stamps: both ways of running agree on which are left out, or the record says that it has no times."""
    from shipid.foundation.errors import UsageError

    kalman, count = filters["gated"], min(len(stamps), record["t"].size)
    spoilt = {n: c[:count] for n, c in record.items()} | {"t": np.array(stamps[:count], dtype=float)}
    spoilt["delta"] = np.nan_to_num(spoilt["delta"])  # a record without any rudder angle is refused for that
    try:
        run = kalman.filter(spoilt)
    except UsageError as error:
        assert "do not increase" in str(error)
        return
    assert np.isfinite(run.x).all() and np.all(np.diff(run.t) > 0) and run.t.size + run.arranged.back == count
    clock = FilterClock()
    assert [clock.elapsed(float(t)) is not None for t in stamps[:count]] == list(run.arranged.forward)


def test_results_as_plain_values(filters: dict[str, Any]) -> None:
    """JSON without NaN, a table with units, a text; also where a sensor never showed anything."""
    t = np.arange(40) * 0.7
    record = {"t": t, "psi": np.full(40, np.nan), "r": 1e-4 * np.sin(t), "delta": 0.1 * np.sin(t / 9)}
    run = filters["gated"].filter(record)
    plain = json.loads(json.dumps(run.to_dict(), allow_nan=False))
    assert plain["model"] == "yaw" and plain["samples"] == 40 and plain["clock_went_back"] == 0
    assert set(plain["parameters"]) == {"K", "tau"} and set(plain["states"]) == {"psi", "r"}
    assert plain["innovations"]["psi"] == {
        "nis_mean": None, "nis_interval_95": None, "white_p": None, "rejected": 0, "out_of_range": 0, "samples": 0,
    }  # fmt: skip
    low, high = plain["innovations"]["r"]["nis_interval_95"]
    assert low < 1 < high and 0 <= plain["innovations"]["r"]["white_p"] <= 1
    K = run.parameters["K"]
    assert plain["parameters"]["K"]["interval_95"] == list(K.ci95) and K.ci95[0] < K.value < K.ci95[1]
    assert K.value == run["K"][-1] and K.std == pytest.approx(run.std_of("K")[-1])
    # Of a parameter estimated by its logarithm: exactly, so not symmetric.
    assert K.ci95[0] * K.ci95[1] == pytest.approx(K.value**2)
    frame = run.to_frame()
    assert list(frame.columns) == ["t [s]", "psi [rad]", "std_psi [rad]", "r [rad/s]", "std_r [rad/s]", "K [1/s]",
                                   "std_K [1/s]", "tau [s]", "std_tau [s]"]  # fmt: skip
    assert frame["K [1/s]"].to_numpy() == pytest.approx(run["K"]) and len(frame) == 40
    text = run.text()
    assert "extended Kalman filter of 'yaw'" in text and "record record: 40 samples" in text
    assert "innovations of psi        NIS - (1 is right), whiteness p -, rejected 0" in text
    assert run.nis.shape == (40,) and np.isfinite(run.nis).all()


def test_whiteness() -> None:
    """Ljung and Box's number against statsmodels' formula written out, and what it is for."""
    from scipy.stats import chi2

    rng = np.random.default_rng(1)
    e = rng.standard_normal(500)
    centred = e - e.mean()
    r = np.array([np.sum(centred[k:] * centred[: 500 - k]) for k in range(1, 21)]) / np.sum(centred**2)
    q = 500 * 502 * sum(r[k - 1] ** 2 / (500 - k) for k in range(1, 21))
    assert whiteness(e) == pytest.approx(chi2.sf(q, 20))
    coloured = np.convolve(rng.standard_normal(520), np.ones(5) / 5, "valid")
    assert whiteness(coloured) < 1e-6
    assert whiteness(e[:29]) is None and whiteness(np.ones(40)) == 1.0
    # Of many white records one in twenty falls below 0.05.
    few = np.mean([whiteness(rng.standard_normal(200)) < 0.05 for _ in range(400)])
    assert 0.02 < few < 0.09
