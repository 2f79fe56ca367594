"""Samples one by one against the whole record, and the state in a file."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from shipid.estimation.errors import FilterDivergedError, SavedStateError
from shipid.estimation.recursion.gate import TAKEN
from shipid.foundation.errors import UsageError
from shipid.generation.simulator import UnstatedInputError

SENSORS = {"psi": 0.01, "r": 5e-4}
OPTIONS: dict[str, Any] = {"density": {"r": 1e-4}, "estimated": ["K", "tau"], "gate": 5.0}


def rows_of(record: dict[str, np.ndarray]) -> list[dict[str, float]]:
    return [{n: float(c[k]) for n, c in record.items()} for k in range(record["t"].size)]


def sailed(hand: Any, t: np.ndarray, swing: Any, seed: int = 4) -> dict[str, np.ndarray]:
    first = {"log_K": np.log(0.07), "log_tau": np.log(40.0), "psi": 0.4}
    levels = hand.kalman.design.r
    x0 = np.array([first.get(s, 0.0) for s in hand.states])
    return hand.sail(t, {"delta": swing(t)}, x0, levels, np.random.default_rng(seed))[0]


def same(kalman: Any, record: dict[str, np.ndarray], stamps: Any = None) -> tuple[Any, Any]:
    """Run both ways; every estimate, standard deviation and verdict has to agree, to 1e-12."""
    run = kalman.filter(record)
    online = kalman.start()
    estimates = [online.update(s) for s in rows_of(record)]
    kept = [e for e in estimates if not e.refused]
    assert len(kept) == run.t.size
    assert len(estimates) - len(kept) == run.arranged.back == online.refused
    x, std = np.array([e.x for e in kept]), np.array([e.std for e in kept])
    assert np.all(np.abs(x - run.x) <= 1e-12 * (np.abs(run.x) + run.std))
    assert std == pytest.approx(run.std, rel=1e-12)
    fate = run.rows("fate")
    for k, e in enumerate(kept):
        assert e.taken == tuple(n for n, f in zip(kalman.measured, fate[k]) if f == TAKEN)
    counted = {n: run.innovations[n].rejected + run.innovations[n].limited for n in kalman.measured}
    assert online.rejected == counted
    return run, online


def test_whatever_happens_in_a_record(setup: Any, swing: Any) -> None:
    """Gaps, missing samples, outliers, a stuck sensor, values out of range, a sensor read less often."""
    hand = setup("yaw", SENSORS, rates={"psi": "2.1 s"}, ranges={"r": ("-2 deg/s", "2 deg/s")}, **OPTIONS)
    t = np.arange(200) * 0.7
    t[90:] += 30.0
    t[150:] += 5.6  # eight whole intervals
    record = sailed(hand, t, swing)
    rng = np.random.default_rng(1)
    for n in SENSORS:
        record[n] = np.where((rng.random(t.size) < 0.1) & (t > 0), np.nan, record[n])
    record["psi"][30:120:13] += 0.5
    record["r"][60:80] = record["r"][60]
    record["r"][[100, 101]] = [0.2, -3.0]
    run, _ = same(hand.kalman, record)
    seen = {n: i.t.size for n, i in run.innovations.items()}
    assert seen["psi"] < 0.4 * seen["r"]
    assert run.innovations["psi"].rejected > 1 and run.innovations["r"].limited == 2
    # A pause of more than four intervals is bridged in steps.
    assert run.arranged.t.size > 200 and np.count_nonzero(run.arranged.shown) == 200
    assert run.arranged.intervals.max() < 4.01 * 0.7


def test_a_slow_sensor_is_read_when_it_shows_something(setup: Any, swing: Any) -> None:
    """A position fix comes every third sample, and not just when its turn is: it is not lost for that."""
    hand = setup("yaw", SENSORS, rates={"psi": "2.1 s"}, **OPTIONS)
    record = sailed(hand, np.arange(90) * 0.7, swing)
    shows = (np.arange(90) % 3 == 1) & (np.arange(90) > 3) | (np.arange(90) == 0)
    record["psi"] = np.where(shows, record["psi"], np.nan)
    run, _ = same(hand.kalman, record)
    assert run.innovations["psi"].t == pytest.approx(record["t"][shows])


def test_a_rate_is_a_frequency_too(setup: Any) -> None:
    a = setup("yaw", SENSORS, rates={"psi": "0.5 Hz"}, **OPTIONS).kalman
    assert a.design.instruments.rates == {"psi": pytest.approx(2.0)}


def test_a_lost_input(setup: Any, swing: Any) -> None:
    """Its last value stands in with the uncertainty that was said, over gaps as well."""
    hand = setup("yaw", SENSORS, lost={"delta": "10 deg"}, **OPTIONS)
    t = np.arange(120) * 0.7
    t[70:] += 8.0
    record = sailed(hand, t, swing)
    whole = hand.kalman.filter(record)
    record["delta"] = np.where((np.arange(120) > 60) & (np.arange(120) < 90), np.nan, record["delta"])
    run, _ = same(hand.kalman, record)
    places, control = hand.kalman.design.layout.control, run.control
    assert control[run.arranged.shown][61:90, places["u"]] == pytest.approx(record["delta"][60])
    assert set(control[:, places["scale"]][:, -1]) == {0.0, 1.0}
    # With the rudder unknown the rate is less sure, and where it is known both are the same filter.
    assert np.all(run.x[:61] == whole.x[:61]) and run.std_of("r")[75] > 1.2 * whole.std_of("r")[75]


@pytest.mark.parametrize(
    "case", ["one ahead", "one behind", "set back", "set forward", "twice", "not a number", "long pause"]
)
def test_time_stamps(setup: Any, swing: Any, case: str) -> None:
    """One wrong stamp is left out; a clock that was set is followed from its third stamp."""
    hand = setup("yaw", SENSORS, **OPTIONS)
    t = np.arange(100) * 0.7
    record = sailed(hand, t, swing)
    stamps = t.copy()
    change = {
        "one ahead": (slice(50, 51), 5000.0, 1),
        "one behind": (slice(50, 51), -20.0, 1),
        "set back": (slice(50, None), -3600.0, 2),
        "set forward": (slice(50, None), 1e5, 2),
        "twice": (slice(50, 51), -0.7, 1),
        "not a number": (slice(50, 51), np.nan, 1),
        "long pause": (slice(50, None), 599.0, 0),
    }
    where, by, lost = change[case]
    stamps[where] += by
    run, online = same(hand.kalman, record | {"t": stamps})
    assert online.refused == lost
    assert np.all(np.diff(run.t) > 0)
    assert online.t == stamps[-1]
    if case in ("one ahead", "one behind", "set back", "twice", "not a number"):
        # No time is made up: the rest is as it would have been without the samples that were left out.
        whole = hand.kalman.filter(record)
        assert run.x[-1] == pytest.approx(whole.x[-1], abs=1.0 * whole.std[-1].max())
        assert run.t[-1] == pytest.approx(t[-1])
    if case == "set forward":
        # A pause is a pause of ten minutes at most.
        assert run.arranged.intervals.sum() == pytest.approx(600.0 + 97 * 0.7, abs=0.8)
    # The heading is one, whatever turns a pause made up.
    assert abs(np.sin(run["psi"][-1] - record["psi"][-1])) < 0.05 and np.cos(run["psi"][-1] - record["psi"][-1]) > 0


def test_a_clock_that_never_runs_is_an_error(setup: Any) -> None:
    kalman = setup("yaw", SENSORS, **OPTIONS).kalman
    column = np.zeros(4)
    with pytest.raises(UsageError, match=r"do not increase: of 4 stamps 1 can be used\. They must be in s, increase"):
        kalman.filter({"t": np.array([5.0, 5.0, 5.0, 5.0]), "psi": column, "r": column, "delta": column})


def test_adaptation_and_sea_state_sample_by_sample(setup: Any, swing: Any) -> None:
    hand = setup("yaw", SENSORS, switchable=True, **OPTIONS)
    record = sailed(hand, np.arange(100) * 0.7, swing)
    adapt = np.arange(100) % 30 < 15
    factor = 1 + np.arange(100) / 50
    run = hand.kalman.filter(record, adapt=adapt, scale={"r": factor})
    online = hand.kalman.start()
    estimates = [online.update(s, adapt=bool(a), scale={"r": f}) for s, a, f in zip(rows_of(record), adapt, factor)]
    assert np.array([e.x for e in estimates]) == pytest.approx(run.x, rel=1e-12, abs=1e-15)
    held = np.diff(run["K"])[~adapt[1:]]
    assert np.all(held == 0) and np.any(np.diff(run["K"]) != 0)


def test_names_and_plain_values(setup: Any, swing: Any) -> None:
    hand = setup("yaw", SENSORS, **OPTIONS)
    record = sailed(hand, np.arange(10) * 0.7, swing)
    online = hand.kalman.start()
    assert online.t is None
    estimate = [online.update(s) for s in rows_of(record)][-1]
    run = hand.kalman.filter(record)
    assert estimate["K"] == pytest.approx(run["K"][-1]) and estimate.std_of("K") == pytest.approx(run.std_of("K")[-1])
    assert estimate["psi"] == run["psi"][-1] and estimate.std_of("psi") == run.std_of("psi")[-1]
    plain = json.loads(json.dumps(estimate.to_dict(), allow_nan=False))
    assert set(plain["estimates"]) == {"psi", "r", "K", "tau"} and plain["taken"] == ["psi", "r"]
    assert plain["t"] == {"value": online.t, "unit": "s"} and online.t == record["t"][-1]


@pytest.mark.parametrize("single", [False, True])
def test_saved_and_restored_to_the_bit(setup: Any, swing: Any, tmp_path: Path, single: bool) -> None:
    """Split anywhere, also while a sensor is refused, slow or doubted: no bit of what follows changes."""
    options = OPTIONS | {"rates": {"psi": "2.1 s"}, "single": single}
    if single:
        options["form"] = "square-root"
    hand = setup("yaw", SENSORS, **options)
    record = sailed(hand, np.arange(80) * 0.7, swing)
    record["r"][30:40] += 0.05
    record["psi"][50:60] = record["psi"][50]
    record["t"][20:22] -= 100.0
    record["t"][60:] -= 100.0
    whole, rows = hand.kalman.start(), rows_of(record)
    wanted = [whole.update(s) for s in rows]
    parts = hand.kalman.start()
    for k, s in enumerate(rows):
        if k in (1, 21, 35, 55, 61):
            parts.save(tmp_path / "state.json")
            parts = setup("yaw", SENSORS, **options).kalman.restore(tmp_path / "state.json")
        got = parts.update(s)
        assert np.array_equal(got.x, wanted[k].x) and np.array_equal(got.std, wanted[k].std)
        assert (got.taken, got.rejected, got.refused, got.t) == (
            wanted[k].taken,
            wanted[k].rejected,
            wanted[k].refused,
            wanted[k].t,
        )
    assert parts.rejected == whole.rejected and parts.refused == whole.refused and parts.t == whole.t
    assert list(tmp_path.iterdir()) == [tmp_path / "state.json"]


def test_a_restored_filter_says_what_it_knew(setup: Any, swing: Any, tmp_path: Path) -> None:
    """A refused sample right after restoring still gets the estimate."""
    hand = setup("yaw", SENSORS, **OPTIONS)
    online = hand.kalman.start()
    before = [online.update(s) for s in rows_of(sailed(hand, np.arange(10) * 0.7, swing))][-1]
    online.save(tmp_path / "state.json")
    again = hand.kalman.restore(tmp_path / "state.json").update({"t": 1.0, "psi": 0.0, "r": 0.0, "delta": 0.0})
    assert again.refused == "its time 1 s does not follow the last one, 6.3 s"
    assert np.array_equal(again.x, before.x) and np.array_equal(again.std, before.std)


def test_saved_states_that_do_not_fit(setup: Any, swing: Any, tmp_path: Path) -> None:
    hand = setup("yaw", SENSORS, **OPTIONS)
    path = tmp_path / "state.json"
    with pytest.raises(UsageError, match="without a sample has no state to save"):
        hand.kalman.start().save(path)
    with pytest.raises(SavedStateError, match=r"state\.json cannot be read: No such file"):
        hand.kalman.restore(path)
    for text in ("{", "[]", '{"schema": 2}', '{"carried": ["x"]}', "null"):
        path.write_text(text)
        with pytest.raises(SavedStateError, match=r"is not the saved state of a filter: start a new one"):
            hand.kalman.restore(path)
    online = hand.kalman.start()
    online.update({"t": 0.0, "psi": 0.1, "r": 0.0, "delta": 0.0})
    online.save(path)
    for other in ({"gate": 4.0}, {"density": {"r": 2e-4}}, {"estimated": ["K"]}, {"method": "heun"}, {"hold": "zero"},
                  {"ranges": {"r": ("-1 deg/s", "1 deg/s")}}, {"shared_noise": False}, {"single": True},
                  {"lost": {"delta": "3 deg"}}):  # fmt: skip
        with pytest.raises(SavedStateError, match=r"saved by another filter \(of model yaw\)"):
            setup("yaw", SENSORS, **OPTIONS | other).kalman.restore(path)


def test_what_a_sample_needs(setup: Any) -> None:
    online = setup("yaw", SENSORS, **OPTIONS).kalman.start()
    for sample in ({"psi": 0.1}, {"t": np.nan, "psi": 0.1}):
        with pytest.raises(UsageError, match="a sample needs its time 't' in s, a finite number"):
            online.update(sample)
    with pytest.raises(
        UnstatedInputError, match=r"model yaw reads 'delta' \(rudder angle\), that the first sample does"
    ):
        online.update({"t": 0.0, "psi": 0.1})
    # Nothing has begun: the next sample is the first.
    assert online.update({"t": 7.0, "psi": 0.1, "delta": 0.0}).t == 7.0
    # From now on an input that is missing keeps its value, and a sensor shows nothing.
    estimate = online.update({"t": 8.0, "psi": None, "r": np.nan})
    assert estimate.taken == () and np.isfinite(estimate.x).all()
    estimate = online.update({"t": np.nan, "psi": 0.2, "r": 0.0})
    assert estimate.refused.startswith("its time nan s") and estimate.t == 8.0
    with pytest.raises(UsageError, match="made without switchable=True"):
        online.update({"t": 9.0}, adapt=False)


def test_a_lag_is_longer_than_zero(setup: Any) -> None:
    kalman = setup("yaw", SENSORS, **OPTIONS).kalman
    for lag in ("0 s", "-3 s"):
        with pytest.raises(UsageError, match="is too short; give one greater than zero"):
            kalman.start(lag=lag)


def test_running_away_online_is_an_error(setup: Any) -> None:
    online = setup("surge", {"log": 50.0}, density={"u": 1e-6}).kalman.start()
    with pytest.raises(FilterDivergedError, match=r"model surge diverges at \d+ s\. Restore an earlier state"):
        for k in range(400):
            online.update({"t": float(k), "thrust": -5.0, "log": -1.0 if k < 1 else np.nan})


def test_a_heading_that_comes_late_is_where_it_says(setup: Any) -> None:
    """No sensor showed it before: it is not judged by the zero it was taken for."""
    online = setup("yaw", SENSORS, **OPTIONS).kalman.start()
    for k in range(5):
        online.update({"t": float(k), "r": 0.0, "delta": 0.0})
    estimate = online.update({"t": 5.0, "psi": 2.5, "r": 0.0, "delta": 0.0})
    assert estimate.taken == ("psi", "r") and estimate["psi"] == pytest.approx(2.5, abs=1e-3)


def test_none_is_a_sample_that_is_missing(setup: Any, swing: Any) -> None:
    """A live reader has None where a sensor shows nothing, a table NaN, and a message leaves it out: all are the same."""
    kalman = setup("yaw", SENSORS, **OPTIONS).kalman
    rows = rows_of(sailed(setup("yaw", SENSORS, **OPTIONS), np.arange(20) * 0.7, swing))
    ends = []
    for missing in (None, float("nan"), "left out"):
        online = kalman.start()
        for k, row in enumerate(rows):
            sample: dict[str, Any] = dict(row)
            for name in ("psi",) if k % 3 == 1 else ("r", "delta") if k % 5 == 2 else ():
                sample[name] = missing
                if missing == "left out":
                    del sample[name]
            estimate = online.update(sample)
        ends.append(np.concatenate([estimate.x, estimate.std]))
    np.testing.assert_array_equal(ends[0], ends[1])
    np.testing.assert_array_equal(ends[0], ends[2])


def test_a_filter_prints_where_it_is(setup: Any) -> None:
    online = setup("yaw", SENSORS, **OPTIONS).kalman.start()
    assert "before its first sample" in repr(online) and "object at" not in repr(online)
    online.update({"t": 12.5, "psi": 0.4, "r": 0.0, "delta": 0.0})
    assert repr(online).endswith("at 12.5 s>") and "at 12.5 s" in online._repr_html_()
