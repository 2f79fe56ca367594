import json

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.measure import measure
from shipid.trials.measuring.zigzags.swings import overshoots_of
from shipid.trials.trial import Trial


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("interval", [0.1, 0.5, 1.0])
def test_sine_in_closed_form(sine, side, interval):
    trial, executes, check = sine(side=side, interval=interval, course=57.0)
    found = measure(trial, length="50 m")
    assert found.execute == "order"
    assert found.nominal == "20/20"
    assert found.first_side == ("starboard" if side > 0 else "port")
    # The order falls between two samples, half an interval off at most, at 1.9 deg/s * cos(asin(2/3)) = 1.4 deg/s.
    late = 0.5 * interval
    assert found.execute_within == pytest.approx(late)
    np.testing.assert_allclose(found.executes, executes[: len(found.executes)], atol=late)
    assert len(found.overshoots) == 4
    np.testing.assert_allclose(np.degrees(found.overshoots), 10.0, atol=0.05 + 1.41 * late)
    # What is stated as the uncertainty covers it (95 % of a uniform interval is what the margin of 1.1 stands for).
    assert np.all(np.abs(np.degrees(found.overshoots) - 10.0) <= 1.1 * np.degrees(found.overshoot_uncertainties) + 0.02)
    # The extreme does not depend on when the execute was read.
    np.testing.assert_allclose(np.abs(np.degrees(found.extreme_headings)), 30, atol=0.03)
    np.testing.assert_allclose(found.times_to_check_yaw, check, atol=0.3 + late)
    assert found.period == pytest.approx(100, abs=late)
    assert found.first_execute == pytest.approx(20, abs=late)
    assert found.reach == pytest.approx(50, abs=late)
    assert found.initial_turning_time == pytest.approx(executes[0] - 20, abs=2 * late)
    assert found.initial_turning_distance == pytest.approx(5 * found.initial_turning_time, abs=10 * late)
    assert found.initial_turning_ratio == pytest.approx(found.initial_turning_distance / 50)
    assert found.approach_speed == pytest.approx(5)
    assert np.degrees(found.course) == pytest.approx(57, abs=0.1 + 2 * late)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("interval", [0.1, 0.5, 1.0])
def test_noise_of_a_fifth_of_a_degree(sine, seed, interval):
    quiet = measure(sine(interval=interval)[0])
    noisy = measure(sine(interval=interval, noise=0.2, seed=seed)[0])
    # Two or three samples at the execute for 1 s of sampling: the noise there hardly averages; 2.5 sigma.
    tolerance = 0.5 if interval == 1.0 else 0.35
    np.testing.assert_allclose(np.degrees(noisy.overshoots), np.degrees(quiet.overshoots), atol=tolerance)
    assert noisy.period == quiet.period


@given(
    switch=st.floats(5, 30), beyond=st.floats(1.5, 25), rudder=st.floats(5, 35), period=st.floats(30, 600),
    side=st.sampled_from([1, -1]), course=st.floats(-700, 700),
)  # fmt: skip
@settings(max_examples=40, deadline=None)
def test_overshoots_of_any_sine(sine, switch, beyond, rudder, period, side, course):
    interval = period / 400
    trial, executes, _ = sine(
        amplitude=switch + beyond, switch=switch, rudder=rudder, period=period, start=0.2 * period,
        interval=interval, side=side, course=course,
    )  # fmt: skip
    # Given the exact executes there is no sample to be late by: only the fit of the extreme is left.
    exact = executes[:4]
    found = overshoots_of(trial["t"], trial["psi"], exact, side=side)
    np.testing.assert_allclose(np.degrees(found), beyond, atol=0.02 * beyond + 0.05)
    assert overshoots_of(trial["t"], trial["psi"], exact) == found
    measured = measure(trial)
    assert len(measured.executes) == 4
    np.testing.assert_allclose(measured.executes, exact, atol=1.01 * interval)


def ramped(rate=2.5, interval=0.1):
    """A zig-zag whose rudder is only recorded as it moves, at a finite rate: the sine of 30 deg, reversed at 20."""
    t = np.arange(0, 260, interval)
    psi = 30 * np.sin(2 * np.pi / 100 * np.clip(t - 20, 0, None))
    first = np.arcsin(20 / 30) * 100 / (2 * np.pi)
    times = np.concatenate(([20], 20 + first + 50 * np.arange(5)))
    sides = np.concatenate(([1], (-1.0) ** (1 + np.arange(5))))
    delta = np.zeros_like(t)
    for when, side in zip(times, sides):
        start = np.interp(when, t, delta)
        ramp = start + side * rate * (t - when)
        delta = np.where(t >= when, np.clip(ramp, -20, 20), delta)
    frame = pd.DataFrame({"t [s]": t, "psi [deg]": psi, "delta [deg]": delta})
    return Trial.from_frame(frame, name="ramped"), times


def test_rudder_feedback_gives_the_order_back():
    trial, times = ramped()
    found = measure(trial)
    assert found.execute == "order" and "ramp of the rudder (2.5 deg/s)" in found.text()
    assert np.degrees(found.rudder_rate) == pytest.approx(2.5, rel=1e-6)
    assert found.first_execute == pytest.approx(times[0], abs=0.05)
    np.testing.assert_allclose(found.executes, times[1:], atol=0.05)
    np.testing.assert_allclose(np.degrees(found.overshoots[:4]), 10, atol=0.1)
    # The other reading stands beside it.
    moved = measure(trial, execute="moved")
    np.testing.assert_allclose(found.overshoots_moved[:4], moved.overshoots[:4], atol=1e-3)


def test_rudder_that_has_left_its_plate():
    trial, times = ramped()
    found = measure(trial, execute="moved")
    assert found.execute == "moved"
    # 15 % of 20 deg at 2.5 deg/s are 1.2 s, in which the heading runs on by 1.41 deg/s.
    np.testing.assert_allclose(found.executes, times[1:] + 1.2, atol=0.11)
    np.testing.assert_allclose(np.degrees(found.overshoots[:4]), 10 - 1.2 * 1.4, atol=0.2)


def test_order_is_preferred_where_it_is_recorded():
    trial, times = ramped()
    frame = trial.to_frame()
    ordered = np.zeros(len(trial))
    for k, when in enumerate(times):
        ordered[trial["t"] >= when] = 20 * (-1) ** k
    frame["delta_order [deg]"] = ordered
    both = Trial.from_frame(frame, name="both")
    assert measure(both).execute == "order"
    np.testing.assert_allclose(measure(both).executes, times[1:], atol=0.11)
    assert measure(both, execute="moved").executes == measure(trial, execute="moved").executes


def test_rudder_noise_does_not_move_the_executes():
    trial, _ = ramped()
    frame = trial.to_frame()
    frame["delta [deg]"] += np.random.default_rng(3).normal(0, 0.2, len(frame))
    np.testing.assert_allclose(measure(Trial.from_frame(frame)).executes, measure(trial).executes, atol=0.3)


def test_modified_zigzag_is_named_by_rudder_and_heading(sine):
    assert measure(sine(amplitude=18, switch=10, rudder=20)[0]).nominal == "20/10"
    assert measure(sine(amplitude=9, switch=5, rudder=35)[0]).nominal == "35/5"


@pytest.mark.parametrize("interval", [0.5, 2.0])
def test_distance_until_the_second_execute(sine, interval):
    """A ship that loses speed evenly: the mean of the speeds at both executes, times the time between."""
    trial, *_ = sine(interval=interval)
    frame = trial.to_frame()
    frame["u [m/s]"] = 5.0 - 0.04 * trial["t"]
    found = measure(Trial.from_frame(frame))
    mean = 5.0 - 0.04 * 0.5 * (found.first_execute + found.executes[0])
    assert found.initial_turning_distance == pytest.approx(mean * found.initial_turning_time, rel=1e-12)


@pytest.mark.parametrize(("off", "course"), [(2.0, 2.0), (6.0, 0.0), (-6.0, 0.0)])
def test_the_course_where_the_ship_begins_off_it(off, course):
    """Steered between +20 and -20 deg: a start at 2 deg is the course, one at 6 deg is not, and the middle is taken."""
    w, begin, first = 2 * np.pi / 100, np.arcsin(off / 30), np.arcsin(20 / 30)
    t = np.arange(0, 230, 0.1)
    psi = 30 * np.sin(begin + w * np.clip(t - 20, 0, None))
    executes = 20 + (first - begin + np.pi * np.arange(5)) / w
    delta = np.where(t < 20, 0.0, 20 * (-1.0) ** np.searchsorted(executes, t, side="right"))
    found = measure(Trial.from_frame(pd.DataFrame({"t [s]": t, "psi [deg]": psi, "delta_order [deg]": delta})))
    assert np.degrees(found.course) == pytest.approx(course, abs=0.15)
    np.testing.assert_allclose(np.degrees(found.execute_headings)[:2], [20 - course, -20 - course], atol=0.3)
    np.testing.assert_allclose(np.degrees(found.overshoots[:2]), 10, atol=0.2)


def test_hand_steering_before_the_zigzag_is_left_out(sine):
    trial, executes, _ = sine(start=60)
    frame = trial.to_frame()
    t = trial["t"]
    hand = (t > 10) & (t < 50)
    frame.loc[hand, "delta_order [deg]"] = 17 * np.sin(t[hand] / 3)
    found = measure(Trial.from_frame(frame))
    np.testing.assert_allclose(found.executes, executes[: len(found.executes)], atol=0.51)
    assert len(found.overshoots) == 4


def test_what_the_record_does_not_reach_is_none(sine):
    trial, executes, _ = sine()
    cut = trial.window(0, executes[1] + 3)
    found = measure(cut)
    assert len(found.executes) == 2
    assert np.degrees(found.overshoots[0]) == pytest.approx(10, abs=1)
    assert found.overshoots[1] is None and found.times_to_check_yaw[1] is None
    assert found.period is None
    started = measure(trial.window(25, 200))  # begins in the first plate
    assert started.first_execute is None and started.initial_turning_time is None and started.reach is None


def test_results_are_plain_and_readable(sine):
    trial, executes, _ = sine()
    found = measure(trial.window(0, executes[1] + 3))
    content = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert content["kind"] == "zig-zag" and content["nominal"] == "20/20"
    assert content["overshoots"]["unit"] == "deg"
    assert content["overshoots"]["value"][1] is None
    assert content["overshoots"]["value"][0] == pytest.approx(np.degrees(found.overshoots[0]))
    frame = found.to_frame()
    assert list(frame.columns) == ["quantity", "value", "unit", "meaning"]
    assert (
        frame.set_index("quantity").loc["overshoots[2]", "value"] != frame.set_index("quantity").loc["rudder", "value"]
    )
    assert np.isnan(frame.set_index("quantity").loc["overshoots[2]", "value"])
    text = found.text()
    assert "zig-zag 20/20" in text and "not reached" in text and "nan" not in text
    with pytest.raises(AttributeError):
        found.period = 1.0


def test_what_cannot_be_measured_is_refused(sine):
    trial, *_ = sine()
    with pytest.raises(UsageError, match="'moved'"):
        measure(trial, execute="ordered")
    with pytest.raises(UnknownNameError, match="Did you mean zig-zag"):
        measure(trial, "zigzag")
    with pytest.raises(e.NotAManoeuvreError, match="neither"):
        measure(trial.window(0, 18))
    with pytest.raises(e.NotAManoeuvreError, match="no zig-zag"):
        measure(trial.window(0, 18), "zig-zag")
    with pytest.raises(e.UnknownColumnError, match="heading"):
        measure(Trial.from_frame(trial.to_frame().drop(columns="psi [deg]")))
    with pytest.raises(e.UnknownColumnError, match="neither 'delta' nor 'delta_order'"):
        measure(Trial.from_frame(trial.to_frame().drop(columns="delta_order [deg]")))


def test_overshoots_of_edges():
    t = np.arange(0, 100, 0.5)
    assert overshoots_of(t, np.sin(t / 10), []) == ()
    assert overshoots_of(t, t, [50.0]) == (None,)  # never turns back
    (single,) = overshoots_of(t, np.sin(t / 20), [20.0])
    # One execute alone leaves 80 s to average over 3 % of: the straight line there misses the curvature.
    assert single == pytest.approx(1 - np.sin(1), abs=2e-3)
    (port,) = overshoots_of(t, -np.sin(t / 20), [20.0])
    assert port == pytest.approx(single)


def test_rudder_reversed_by_a_clock_is_no_zigzag():
    rng = np.random.default_rng(5)
    t = np.arange(0, 900, 0.5)
    flips = np.cumsum(rng.integers(10, 90, 40))
    side = (-1.0) ** np.searchsorted(flips, t)
    r = np.zeros_like(t)
    for k in range(len(t) - 1):
        r[k + 1] = r[k] + 0.5 * (0.1 * 10 * side[k] - r[k]) / 10
    psi = np.cumsum(r) * 0.5
    trial = Trial.from_frame(pd.DataFrame({"t [s]": t, "psi [deg]": psi, "delta [deg]": 10 * side}))
    with pytest.raises(e.NotAManoeuvreError, match="regular headings"):
        measure(trial)
    assert measure(trial, "zig-zag").kind == "zig-zag"


@pytest.mark.parametrize(("step", "when"), [(5.0, 100.0), (-2.0, 45.0), (15.0, 40.0)])
@pytest.mark.parametrize("rate", [True, False])
def test_across_a_heading_that_was_set_nothing_is_measured(logged, step, when, rate):
    trial, orders, overshoots = logged(0.5, noise=0.05)
    frame = trial.to_frame()
    frame["psi [deg]"] += np.where(frame["t [s]"] > when, step, 0.0)
    if rate:
        frame["r [deg/s]"] = np.gradient(trial["psi"], trial["t"]) * 180 / np.pi
    found = measure(Trial.from_frame(frame))
    swing = int(np.searchsorted(orders, when)) - 2
    for k, beyond in enumerate(found.overshoots):
        if k == swing:
            assert beyond is None and "set to another value" in found.reasons[f"overshoots[{k + 1}]"]
        else:
            assert np.degrees(beyond) == pytest.approx(overshoots[k], abs=0.15)


@pytest.mark.parametrize(("size", "off"), [(20.0, 3.0), (20.0, -4.0), (10.0, 2.0)])
def test_a_rudder_that_reads_to_one_side(logged, size, off):
    trial, orders, overshoots = logged(0.5, switch=size)
    frame = trial.to_frame()
    frame["delta [deg]"] += off
    found = measure(Trial.from_frame(frame))
    assert found.nominal == f"20/{size:.0f}" and found.first_execute == pytest.approx(orders[0], abs=0.1)
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.1)


@pytest.mark.parametrize(("rate", "size"), [(0.5, 20.0), (1.5, 10.0)])
def test_slow_gear_is_listed_and_measured_as_ordered(logged, rate, size):
    trial, orders, overshoots = logged(0.5, rudder_rate=rate, switch=size, duration=400.0)
    found = measure(trial)
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.4)
    listed = [m for m in check_trial(trial).manoeuvres if m.kind == "zigzag"]
    assert len(listed) == 1 and (listed[0].rudder_deg, listed[0].heading_deg) == (20.0, size)
    assert listed[0].start == pytest.approx(orders[0], abs=6.0)


@pytest.mark.parametrize("late", [2.0, 6.0])
def test_an_order_logged_late_is_not_measured_by(logged, late):
    trial, _, overshoots = logged(0.5, order=True)
    frame = trial.to_frame()
    rows = np.arange(len(frame))
    frame["delta_order [deg]"] = frame["delta_order [deg]"].to_numpy()[np.maximum(rows - round(2 * late), 0)]
    late_trial = Trial.from_frame(frame)
    found = measure(late_trial)
    assert "after the rudder has moved" in found.read_from
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.1)
    assert "order-late" in {f.kind for f in check_trial(late_trial).findings}
    frame["delta_order [deg]"] *= -1.0
    kinds = {(f.kind, f.channel) for f in check_trial(Trial.from_frame(frame)).findings}
    assert ("rudder-sign", "delta_order") in kinds
    frame["delta_order [deg]"] = 0.0
    assert "order-stands" in {f.kind for f in check_trial(Trial.from_frame(frame)).findings}


def test_three_digits_are_tenths_of_a_degree_about_a_peak(logged):
    """The step of the digits changes with the value, and that of the whole record is the finest of them."""
    trial, _, overshoots = logged(0.02, order=True, course=0.0)
    frame = trial.to_frame()
    frame["psi [deg]"] = [float(f"{psi:.3g}") for psi in frame["psi [deg]"]]
    found = np.degrees(measure(Trial.from_frame(frame)).overshoot_uncertainties)
    assert np.all(found > 0.055) and np.all(np.degrees(measure(trial).overshoot_uncertainties) < 0.03)
    assert np.all(np.abs(np.degrees(measure(Trial.from_frame(frame)).overshoots) - overshoots[: found.size]) < found)


def test_gear_so_slow_that_its_first_plates_are_tips_is_measured_from_the_first_reversal(sailed):
    # The rudder is reversed at 12 and at 24 deg before it reaches its 35.
    t, psi, delta, _, orders, overshoots = sailed(rudder=35.0, switch=5.0, rudder_rate=0.5, duration=520.0)
    columns = {"t [s]": t[::100], "psi [deg]": psi[::100], "delta [deg]": delta[::100]}
    found = measure(Trial.from_frame(pd.DataFrame(columns), name="slow"), "zig-zag")
    assert found.nominal == "35/5" and found.first_side == "starboard"
    assert found.executes[:3] == pytest.approx(orders[1:4], abs=1.0)
    assert [np.degrees(v) for v in found.overshoots[:2]] == pytest.approx(overshoots[:2], abs=0.3)


def test_a_record_that_begins_with_the_rudder_on_its_way_leaves_that_reversal_out(logged):
    trial, orders, overshoots = logged(1.0)
    found = measure(trial.window(orders[1] + 2.0, 240.0))
    assert found.executes[0] == pytest.approx(orders[2], abs=0.5)
    assert np.degrees(found.overshoots[0]) == pytest.approx(overshoots[1], abs=0.3)


def test_a_clock_in_another_unit_than_it_says_is_refused(logged):
    frame = logged(1.0)[0].to_frame()
    frame["r [deg/s]"] = np.gradient(frame["psi [deg]"], frame["t [s]"])
    frame["x [m]"] = np.cumsum(8.0 * np.cos(np.radians(frame["psi [deg]"])))
    frame["y [m]"] = np.cumsum(8.0 * np.sin(np.radians(frame["psi [deg]"])))
    frame["t [s]"] *= 1000.0
    with pytest.raises(e.ClockError, match="Write the unit of the clock"):
        measure(Trial.from_frame(frame, name="ms"))


def test_a_rudder_drawn_across_an_execute_leaves_it_unknown(logged):
    trial, orders, overshoots = logged(interval=0.5)
    frame, t = trial.to_frame(), trial["t"]
    across = (t > orders[1] - 8) & (t < orders[1] + 22)
    frame["delta [deg]"] = np.interp(t, t[~across], frame["delta [deg]"][~across])
    found = measure(Trial.from_frame(frame, name="drawn"))
    assert found.executes[0] is None and found.overshoots[0] is None and "overshoots[1]" in found.reasons
    assert np.degrees(found.overshoots[1]) == pytest.approx(overshoots[1], abs=0.2)


def test_a_rudder_logged_slowly_and_drawn_between_is_known_at_its_own_samples(logged):
    trial, _, overshoots = logged(interval=0.5, rudder_rate=5.0, duration=400.0)
    frame, t = trial.to_frame(), trial["t"]
    frame["delta [deg]"] = np.interp(t, t[4::10], np.round(frame["delta [deg]"][4::10], 2))
    found = measure(Trial.from_frame(frame, name="slow"))
    n = len(found.leading_overshoots)
    off = np.abs(np.degrees(found.leading_overshoots) - overshoots[:n])
    assert n > 4 and np.all(off <= np.degrees(found.overshoot_uncertainties[:n]) + 0.05)


def test_a_helm_that_wanders_before_the_first_execute_leaves_it_uncertain(logged):
    trial, orders, _ = logged(interval=0.2, start=30.0)
    frame, t = trial.to_frame(), trial["t"]
    frame["delta [deg]"] += 4 * np.sin(2 * np.pi * t / 9) * (t < orders[0])
    found = measure(Trial.from_frame(frame, name="waves"))
    assert abs(found.first_execute - orders[0]) <= found.execute_within
    assert measure(trial).execute_within < 0.2


def test_a_record_that_begins_on_the_ramp_does_not_show_the_first_execute(logged):
    trial, orders, overshoots = logged(interval=0.2, start=30.0)
    found = measure(trial.window(float(orders[0]) + 0.5, None))
    assert found.first_execute is None and found.initial_turning_time is None
    assert np.degrees(found.overshoots[0]) == pytest.approx(overshoots[0], abs=0.1)


def test_a_heading_that_may_be_off_by_a_factor_is_told(logged):
    trial, _, _ = logged(interval=0.5)
    frame = trial.to_frame()
    rate = np.degrees(np.gradient(trial["psi"], trial["t"])) + np.random.default_rng(1).normal(0, 0.01, len(trial))
    frame["psi [deg]"] = frame["psi [deg]"] * 1.05
    found = measure(Trial.from_frame(frame.assign(**{"r [deg/s]": rate}), name="factor"))
    assert any(note.kind == "rate-scale" and "if it is not the heading" in note for note in found.notes)


def until(sailed, angle, **settings):
    """Track from the order until the heading has changed by so many degrees, of a zig-zag sailed without noise at 8 m/s."""
    t, psi, *_, orders, _ = sailed(**settings)
    return 8.0 * float(t[np.argmax(np.abs(psi - psi[0]) >= angle)] - orders[0])


@pytest.mark.parametrize("switch", [9.0, 10.0, 11.8])
def test_the_ability_to_turn_is_that_of_the_ship_and_not_of_whoever_reverses_the_rudder(logged, sailed, switch):
    settings = {"switch": switch}
    found = measure(logged(order=True, **settings)[0], length="50 m")
    # With the rudder reversed at 9 deg, she turns on to 10 within 2 s.
    truth = until(sailed, 10.0, switch=10.0)
    assert found.nominal == "20/10"
    assert found.initial_turning_ability == pytest.approx(truth, abs=found.initial_turning_ability_uncertainty)
    assert found.initial_turning_ability_uncertainty < 4.0
    assert found.initial_turning_ability_ratio == pytest.approx(found.initial_turning_ability / 50)
    assert found.initial_turning_distance == pytest.approx(until(sailed, switch, **settings), abs=4.0)
    assert "initial turning ability" in found.text() and "±" in found.text()


def test_a_rudder_reversed_far_too_early_shows_no_ability_to_turn(logged):
    found = measure(logged(order=True, switch=8.0)[0])
    assert found.initial_turning_distance is not None and found.initial_turning_ability is None
    assert "reversed before the heading had changed by 10 deg" in found.reasons["initial_turning_ability"]


@pytest.mark.parametrize(("noise", "interval"), [(0.2, 0.5), (1.0, 0.5), (0.5, 1.0)])
def test_the_uncertainty_of_the_ability_to_turn_holds_the_truth(logged, sailed, noise, interval):
    settings = {"switch": 10.0, "order": True}
    truth = until(sailed, 10.0, switch=10.0)
    found = [measure(logged(noise=noise, interval=interval, seed=k, **settings)[0]) for k in range(40)]
    off = np.array([one.initial_turning_ability - truth for one in found])
    stated = np.array([one.initial_turning_ability_uncertainty for one in found])
    assert np.mean(np.abs(off) <= stated) >= 0.9
    assert np.median(stated) < 4 * np.std(off) + 8.0 * interval


def test_a_hole_before_the_heading_has_changed_hides_the_ability_to_turn(logged):
    trial, orders, _ = logged(order=True, switch=10.0)
    table = trial.table.copy()
    table.loc[table["t"].between(orders[0] + 2, orders[1] - 2), "u"] = np.nan
    found = measure(Trial(trial.name, table, trial.source))
    assert found.initial_turning_ability is None and "in the speed" in found.reasons["initial_turning_ability"]
    whole = measure(trial)
    for start, end, known in ((0.3, 0.6, True), (0.85, 1.1, False)):
        table = trial.table.copy()
        at = orders[0] + (orders[1] - orders[0]) * np.array([start, end])
        table.loc[table["t"].between(*at), "psi"] = np.nan
        found = measure(Trial(trial.name, table, trial.source))
        if known:
            assert found.initial_turning_ability == pytest.approx(whole.initial_turning_ability, rel=0.01)
        else:
            assert found.initial_turning_ability is None and "heading" in found.reasons["initial_turning_ability"]
