"""The execute is the order: logged, or read back from the ramp of the rudder."""

import numpy as np
import pandas as pd
import pytest

from shipid.foundation.notices import notice_of
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


@pytest.mark.parametrize("interval", [0.1, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("rudder_rate", [1.0, 3.0])
@pytest.mark.parametrize("order", [False, True])
def test_order_read_back_from_the_ramp(logged, interval, rudder_rate, order):
    """With the order logged beside it, the ramp says when within its interval."""
    trial, orders, overshoots = logged(interval, order=order, rudder_rate=rudder_rate, duration=300.0)
    found = measure(trial)
    n = len(found.executes)
    assert n >= 3 and found.execute == "order"
    assert np.degrees(found.rudder_rate) == pytest.approx(rudder_rate, rel=1e-6)
    assert found.first_execute == pytest.approx(orders[0], abs=0.02)
    # The model is sailed in steps of 0.01 s.
    np.testing.assert_allclose(found.executes, orders[1 : n + 1], atol=0.02)
    known = found.leading_overshoots
    np.testing.assert_allclose(np.degrees(known), overshoots[: len(known)], atol=0.05)
    assert len(known) >= n - 1


def test_slow_rudder_by_default_is_not_read_too_small(logged):
    """At 1 deg/s the rudder takes 3 s for 15 % of its plate, in which this ship turns by 3.5 deg."""
    trial, _, overshoots = logged(1.0, rudder_rate=1.0, duration=300.0, course=90.0)
    np.testing.assert_allclose(overshoots[:2], [27.2, 30.0], atol=0.1)
    found = measure(trial)
    assert overshoots[0] - np.degrees(found.overshoots_moved[0]) == pytest.approx(3.5, abs=0.3)
    assert measure(trial, execute="moved").overshoots[0] == pytest.approx(found.overshoots_moved[0], abs=1e-3)
    assert "ramp of the rudder (1 deg/s)" in found.text() and "the order is not logged" in found.text()


@pytest.mark.parametrize("interval", [0.5, 1.0, 2.0])
def test_logged_order_is_in_the_middle_of_its_interval(logged, interval):
    trial, orders, overshoots = logged(interval, order=True, rudder=False)
    found = measure(trial)
    n = len(found.executes)
    assert found.execute_within == pytest.approx(interval / 2)
    assert np.all(np.abs(np.array(found.executes) - orders[1 : n + 1]) <= interval / 2 + 0.01)
    error = np.abs(np.degrees(found.overshoots) - overshoots[:n])
    # 95 % of a uniform interval is stated, so the worst case lies 5 % beyond.
    assert np.all(error <= 1.1 * np.degrees(found.overshoot_uncertainties))
    assert "middle of the interval" in found.read_from


def test_overshoots_of_a_logged_order_are_not_small_on_average(logged):
    """Over many phases of the sampling the mean error vanishes: 12 zig-zags of four reversals, +-0.64 deg each."""
    errors = []
    for k in range(12):
        trial, _, overshoots = logged(1.0, order=True, rudder=False, start=10.0 + 0.08 * k)
        found = measure(trial)
        errors += list(np.degrees(found.overshoots) - overshoots[: len(found.overshoots)])
    assert abs(np.mean(errors)) < 3 * 0.45 / np.sqrt(len(errors))


def test_order_written_on_change_says_when(logged):
    """Its stamps are the orders: nothing is halved."""
    trial, orders, overshoots = logged(1.0)
    stamps = np.union1d(trial["t"], orders)
    frame = pd.DataFrame({"t [s]": stamps})
    for name, unit, scale in (("psi", "deg", 57.29577951), ("u", "m/s", 1.0)):
        column = np.full(len(stamps), np.nan)
        column[np.searchsorted(stamps, trial["t"])] = trial[name] * scale
        frame[f"{name} [{unit}]"] = column
    order = np.full(len(stamps), np.nan)
    order[0] = 0.0
    order[np.searchsorted(stamps, orders)] = 20.0 * (-1.0) ** np.arange(len(orders))
    frame["delta_order [deg]"] = order
    found = measure(Trial.from_frame(frame))
    assert found.execute_within == 0.0 and "written when it changes" in found.read_from
    np.testing.assert_allclose(found.executes, orders[1 : 1 + len(found.executes)], atol=1e-9)
    assert np.degrees(found.overshoots[0]) == pytest.approx(overshoots[0], abs=0.05)


@pytest.mark.parametrize("where", [0, 100, -1])
def test_one_wild_sample_of_the_rudder_changes_nothing(logged, where):
    trial, orders, _ = logged(0.5)
    frame = trial.to_frame()
    frame.loc[frame.index[where], "delta [deg]"] = 400.0 if where != 100 else -80.0
    found = measure(Trial.from_frame(frame))
    np.testing.assert_allclose(found.executes, orders[1 : 1 + len(found.executes)], atol=0.02)


def test_a_helm_that_wanders_before_the_first_execute(logged):
    trial, orders, _ = logged(0.1, start=40.0)
    frame = trial.to_frame()
    t = trial["t"]
    frame.loc[t < 40.0, "delta [deg]"] = (4 * np.sin(t / 5))[t < 40.0]
    found = measure(Trial.from_frame(frame))
    # It leaves 3.96 deg of rudder there, and the ramp of the model starts from 0.
    assert found.first_execute == pytest.approx(orders[0], abs=1.5)
    np.testing.assert_allclose(found.executes, orders[1 : 1 + len(found.executes)], atol=0.02)


def test_a_helm_that_is_ordered_about_before_the_first_order(logged):
    trial, orders, _ = logged(0.5, start=40.0, order=True)
    frame = trial.to_frame()
    t = trial["t"]
    # It leaves more rudder than what counts as off midships, at any time.
    helm = np.where(t < 39.9, 5 * np.sin(t / 5), frame["delta_order [deg]"])
    found = measure(Trial.from_frame(frame.assign(**{"delta_order [deg]": helm})))
    assert found.first_execute == pytest.approx(orders[0], abs=0.3)


def test_stated_uncertainty_holds_the_scatter_of_the_rudder(sailed):
    """Eight records of a rudder of 1 deg/s that scatters by 0.5 deg: the plate it leaves is as uncertain as its ramp."""
    t, psi, delta, _, orders, overshoots = sailed(rudder_rate=1.0, duration=300.0)
    every, within, errors = slice(0, None, 100), [], []
    for seed in range(8):
        scatter = 0.5 * np.random.default_rng(seed).standard_normal(t[every].size)
        frame = pd.DataFrame({"t [s]": t[every], "psi [deg]": psi[every], "delta [deg]": delta[every] + scatter})
        found = measure(Trial.from_frame(frame))
        away = np.abs(np.degrees(found.overshoots[:2]) - overshoots[:2])
        errors += list(away)
        within += list(away <= np.degrees(found.overshoot_uncertainties[:2]))
        np.testing.assert_allclose(found.executes[:2], orders[1:3], atol=1.2)
    assert np.mean(within) > 0.8 and np.sqrt(np.mean(np.square(errors))) < 0.5


def test_rudder_with_a_bias_that_is_short_of_the_other_end(sailed):
    """Plates of 11.5 and 8.5 deg: the ramp ends before the other plate does, not with the way back."""
    t, psi, delta, _, orders, overshoots = sailed(rudder_rate=0.7, rudder=10.0, switch=10.0, duration=300.0, side=-1)
    scatter = 0.1 * np.random.default_rng(5).standard_normal(t[::100].size)
    frame = pd.DataFrame({"t [s]": t[::100], "psi [deg]": psi[::100], "delta [deg]": delta[::100] + 1.5 + scatter})
    found = measure(Trial.from_frame(frame))
    np.testing.assert_allclose(found.executes[:3], orders[1:4], atol=0.5)
    np.testing.assert_allclose(np.degrees(found.overshoots[:2]), overshoots[:2], atol=0.4)


def test_slow_sensor_of_the_rudder_whose_value_is_written_again_in_every_row(sailed):
    """At 5 Hz the rows repeat what a sensor of 1 Hz says: read as its own, the execute would come 0.4 s late."""
    t, psi, delta, _, orders, overshoots = sailed(rudder_rate=1.0, duration=300.0)
    scatter = 0.1 * np.random.default_rng(6).standard_normal(t[::100].size)
    held = np.repeat(delta[::100] + scatter, 5)[: t[::20].size]
    found = measure(Trial.from_frame(pd.DataFrame({"t [s]": t[::20], "psi [deg]": psi[::20], "delta [deg]": held})))
    np.testing.assert_allclose(found.executes[:3], orders[1:4], atol=0.3)
    np.testing.assert_allclose(np.degrees(found.overshoots[:2]), overshoots[:2], atol=0.3)


@pytest.mark.parametrize("order", [False, True])
def test_rudder_that_is_reversed_before_it_reaches_its_plate(sailed, order):
    """Ordered to 35 deg at 1 deg/s, this ship has turned by 20 deg before: the rudder leaves the point where its ramps meet."""
    t, psi, delta, ordered, orders, overshoots = sailed(rudder_rate=1.0, rudder=35.0, duration=400.0)
    frame = pd.DataFrame({"t [s]": t[::100], "psi [deg]": psi[::100], "delta [deg]": delta[::100]})
    if order:
        frame["delta_order [deg]"] = ordered[::100]
    found = measure(Trial.from_frame(frame), "zig-zag")
    assert abs(delta[np.searchsorted(t, orders[1])]) < 34
    np.testing.assert_allclose(found.executes[:2], orders[1:3], atol=0.2)
    np.testing.assert_allclose(np.degrees(found.overshoots[:2]), overshoots[:2], atol=0.3)


def test_single_zeros_of_the_rudder_on_its_ramp_are_no_execute(sailed):
    """A zero in the first second of the ramp put the execute 6 s early, where the zero began."""
    t, psi, delta, _, orders, overshoots = sailed(duration=300.0)
    rudder = delta[::100] + 0.1 * np.random.default_rng(1).standard_normal(t[::100].size)
    rudder[int(orders[1]) + 2] = rudder[int(orders[2]) + 4] = 0.0
    found = measure(Trial.from_frame(pd.DataFrame({"t [s]": t[::100], "psi [deg]": psi[::100], "delta [deg]": rudder})))
    np.testing.assert_allclose(found.executes[:3], orders[1:4], atol=0.3)
    np.testing.assert_allclose(np.degrees(found.overshoots[:3]), overshoots[:3], atol=0.3)


@pytest.mark.parametrize(
    ("interval", "rate", "noise", "before", "lasts"),
    [(0.5, 1.0, 0.0, 2.0, 8.0), (1.0, 6.0, 0.0, 0.5, 8.0), (0.1, 1.0, 0.05, 5.0, 20.0), (0.1, 3.0, 0.05, 0.5, 12.0)],
)
def test_a_rudder_that_stands_still_over_an_execute(logged, interval, rate, noise, before, lasts):
    """What was read as the execute was where the rudder leapt: 18 deg of overshoot for 30, within 0.4."""
    trial, orders, overshoots = logged(interval, rudder_rate=rate)
    frame = trial.to_frame()
    delta = frame["delta [deg]"].to_numpy() + np.random.default_rng(1).normal(0, noise, len(frame))
    inside = (trial["t"] >= orders[2] - before) & (trial["t"] < orders[2] - before + lasts)
    delta[inside] = delta[np.argmax(inside)]
    found = measure(Trial.from_frame(frame.assign(**{"delta [deg]": delta})))
    stated = found.overshoots[1]
    assert (
        stated is None or abs(np.degrees(stated) - overshoots[1]) < np.degrees(found.overshoot_uncertainties[1]) + 0.05
    )
    assert np.degrees(found.overshoots[0]) == pytest.approx(overshoots[0], abs=0.2)


@pytest.mark.parametrize(("limit", "said"), [(14.0, True), (30.0, False)])
def test_a_rudder_sensor_at_the_end_of_its_range_is_told(logged, limit, said):
    """It scatters amidships and repeats 14 deg on the plates of 20 deg: the orders are 2 s earlier than its ramps say."""
    trial, orders, _ = logged(0.2)
    rudder = np.degrees(trial["delta"]) + np.random.default_rng(3).normal(0, 0.05, len(trial))
    frame = trial.to_frame().assign(**{"delta [deg]": np.clip(rudder, -limit, limit)})
    found = measure(Trial.from_frame(frame, name="clipped"))
    assert any(n.kind == "clipped" and n.serious for n in map(notice_of, found.notes)) == said
    assert (abs(found.executes[1] - orders[2]) > 1.0) == said
