"""What the doctor finds bears on the numbers: not known, with the reason, never a bare wrong one."""

import json

import numpy as np
import pandas as pd
import pytest

from shipid.trials.doctor.findings import Diagnosis
from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.measure import _check_heading, measure
from shipid.trials.trial import Trial


def without(trial, start, end, *columns):
    """The trial with samples missing."""
    frame = trial.to_frame()
    t = trial["t"]
    for column in columns or [c for c in frame if c != "t [s]"]:
        frame.loc[(t > start) & (t < end), column] = np.nan
    return Trial.from_frame(frame, name="holed")


def test_a_gap_over_a_peak_leaves_the_overshoot_unknown(logged):
    trial, orders, overshoots = logged(1.0)
    found = measure(without(trial, 37.0, 70.0, "psi [deg]"))
    assert found.overshoots[0] is None and found.extreme_headings[0] is None and found.times_to_check_yaw[0] is None
    assert found.reasons["overshoots[1]"] == "gap 37 to 70 s in the heading"
    # The execute before the gap is known, and so are the later swings.
    assert found.executes[0] == pytest.approx(orders[1], abs=0.02)
    np.testing.assert_allclose(np.degrees(found.overshoots[1:]), overshoots[1 : len(found.overshoots)], atol=0.05)
    assert "not known: gap 37 to 70 s in the heading" in found.text()
    plain = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert plain["overshoots"]["value"][0] is None and plain["overshoots"]["reason"] == "gap 37 to 70 s in the heading"
    assert found.leading_overshoots == () and len(found.leading_executes) == len(found.executes)


def test_rows_that_are_not_there_are_a_gap_too(logged):
    trial, *_ = logged(1.0)
    frame = trial.to_frame()
    found = measure(Trial.from_frame(frame[(trial["t"] < 37) | (trial["t"] > 70)]))
    assert found.overshoots[0] is None and "gap 36 to 71 s" in found.reasons["overshoots[1]"]


def test_a_gap_beside_the_peak_leaves_it_known(logged):
    """From 60 to 85 s the heading falls all the way: the peak at 51 s and the reversal at 96 s are outside."""
    trial, _, overshoots = logged(0.5)
    found = measure(without(trial, 60.0, 85.0, "psi [deg]"))
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.1)
    assert found.reach is None and "gap 60 to 85 s" in found.reasons["reach"]


@pytest.mark.parametrize("middle", [51.0, 36.0])
def test_a_short_gap_is_bridged_and_told(logged, middle):
    trial, _, overshoots = logged(0.5)
    found = measure(without(trial, middle - 1.6, middle + 1.6, "psi [deg]"))
    assert np.degrees(found.overshoots[0]) == pytest.approx(overshoots[0], abs=0.15)
    assert any("bridged" in note for note in found.notes)


def test_a_gap_of_the_rudder_leaves_the_execute_unknown(logged):
    trial, *_ = logged(1.0)
    found = measure(without(trial, 30.0, 48.0, "delta [deg]"))
    assert found.executes[0] is None and found.overshoots[0] is None
    assert found.reasons["executes[1]"] == "gap 30 to 48 s in the rudder"
    assert found.executes[1] is not None and found.overshoots[1] is not None


def test_marks_of_a_missing_heading_are_no_heading(logged):
    trial, _, overshoots = logged(0.5)
    frame = trial.to_frame()
    frame.loc[(trial["t"] >= 50) & (trial["t"] <= 52.5), "psi [deg]"] = -9999.0
    found = measure(Trial.from_frame(frame))
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.15)


def test_single_wild_headings_are_left_out(logged):
    trial, _, overshoots = logged(0.5, noise=0.05)
    frame = trial.to_frame()
    frame.loc[[60, 102, 200], "psi [deg]"] += [40.0, 15.0, -60.0]
    found = measure(Trial.from_frame(frame))
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.2)
    assert any("left out" in note for note in found.notes)
    # Without the doctor they are found one by one.
    alone = measure(Trial.from_frame(frame), diagnosis=Diagnosis("not examined"))
    assert any("3 single wild samples of psi are left out" in note for note in alone.notes)
    np.testing.assert_allclose(np.degrees(alone.overshoots), overshoots[: len(alone.overshoots)], atol=0.2)


def test_a_heading_that_stands_still_over_a_peak(logged):
    """The gyro holds the value it had at 45 s until 62 s: 20 deg of the swing are not seen."""
    trial, *_ = logged(0.5, noise=0.02)
    frame = trial.to_frame()
    stuck = (trial["t"] >= 45) & (trial["t"] <= 62)
    frame.loc[stuck, "psi [deg]"] = frame.loc[stuck, "psi [deg]"].iloc[0]
    frame["r [deg/s]"] = np.degrees(np.gradient(trial["psi"], trial["t"]))
    found = measure(Trial.from_frame(frame))
    assert found.overshoots[0] is None and "frozen" in found.reasons["overshoots[1]"]
    assert found.overshoots[1] is not None
    # A sound verdict, handed in, is believed: nobody looks again.
    assert measure(Trial.from_frame(frame), diagnosis=Diagnosis("sound")).overshoots[0] is not None


def test_signals_on_clocks_of_their_own(logged):
    """Heading at 2 Hz, rudder at 1 Hz between those stamps, speed every 5 s: each is read by its own samples."""
    fine, orders, overshoots = logged(0.1)
    t = fine["t"]
    frame = fine.to_frame()
    step = np.arange(len(t))
    for column, every, offset in (("psi [deg]", 5, 0), ("delta [deg]", 10, 3), ("u [m/s]", 50, 2)):
        frame.loc[step % every != offset, column] = np.nan
    trial = Trial.from_frame(frame.dropna(how="all", subset=["psi [deg]", "delta [deg]", "u [m/s]"]))
    found = measure(trial)
    assert found.reasons == {}
    np.testing.assert_allclose(found.executes, orders[1 : 1 + len(found.executes)], atol=0.02)
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=0.05)
    assert found.initial_turning_distance == pytest.approx(8.0 * (orders[1] - orders[0]), rel=1e-3)


def test_a_compass_that_writes_only_on_change_holds_its_value(logged):
    """At full degrees it is silent for 10 s before the manoeuvre and for some seconds at each peak."""
    fine, _, overshoots = logged(0.1)
    degrees = np.round(np.degrees(fine["psi"]))
    written = np.concatenate(([True], np.diff(degrees) != 0))
    frame = fine.to_frame()
    frame["psi [deg]"] = np.where(written, degrees, np.nan)
    found = measure(Trial.from_frame(frame))
    # Half a degree at the execute and half a degree at the peak.
    np.testing.assert_allclose(np.degrees(found.overshoots), overshoots[: len(found.overshoots)], atol=1.0)
    assert np.all(np.degrees(found.overshoot_uncertainties) >= 0.5)


def test_approach_that_is_not_recorded(logged):
    trial, *_ = logged(0.5)
    found = measure(trial.window(15, 240))
    assert found.first_execute is None and "does not show the rudder" in found.reasons["reach"]
    assert any("does not show the approach" in note for note in found.notes)
    assert "not known: the record does not show" in found.text()


def test_a_gap_in_the_turn(circle_log):
    trial = circle_log()
    found = measure(without(trial, 120.0, 165.0, "x [m]", "y [m]"))
    # 90 deg are reached at 144 s.
    assert found.advance is None and found.transfer is None and found.tactical_diameter is not None
    assert found.reasons["advance"] == "gap 120 to 165 s in the position"
    assert found.times[0] is not None
    blind = measure(without(trial, 120.0, 165.0, "psi [deg]"))
    assert blind.advance is None and blind.times[0] is None and "heading" in blind.reasons["advance"]


@pytest.fixture
def circle_log():
    def make(interval=0.5, current=(0.0, 0.0), turns=2.0):
        rate, radius = 5.0 / 300.0, 300.0
        t = np.arange(0, 50 + turns * 2 * np.pi / rate, interval)
        arc = rate * np.clip(t - 50, 0, None)
        frame = pd.DataFrame({
            "t [s]": t, "psi [deg]": np.degrees(arc),
            "x [m]": 5 * np.minimum(t, 50) + radius * np.sin(arc) + current[0] * t,
            "y [m]": radius * (1 - np.cos(arc)) + current[1] * t,
            "u [m/s]": 5.0, "delta [deg]": np.clip(2.5 * (t - 50), 0, 35),
        })  # fmt: skip
        return Trial.from_frame(frame, name="circle")

    return make


def test_turning_circle_in_a_current_gives_both(circle_log):
    found = measure(circle_log(current=(0.3, -0.8)))
    assert found.drift_speed == pytest.approx(np.hypot(0.3, 0.8), rel=1e-3)
    assert np.degrees(found.drift_direction) == pytest.approx(np.degrees(np.arctan2(-0.8, 0.3)) % 360, abs=0.1)
    assert found.advance_still_water == pytest.approx(300, rel=0.01)
    assert found.transfer_still_water == pytest.approx(300, rel=0.01)
    assert found.tactical_diameter_still_water == pytest.approx(600, rel=0.01)
    # Over the ground: 94 s of 0.3 m/s, and 188 s of -0.8 m/s.
    assert found.advance == pytest.approx(300 + 0.3 * 94.2, rel=0.01)
    assert found.tactical_diameter == pytest.approx(600 - 0.8 * 188.5, rel=0.01)
    assert any("drifts at" in note for note in found.notes)


def _slowing(current, speed_settles, rate_settles, until=365.0):
    """A circle in which speed and rate of turn settle to 60 %, each in a time of its own."""
    t = np.arange(0.0, 1200.0, 0.5)
    over = np.clip(t - 50.0, 0.0, None)
    speed = 5.0 * (0.6 + 0.4 * np.exp(-over / speed_settles))
    psi = np.cumsum(np.where(t > 50, 5.0 / 300.0 * (0.6 + 0.4 * np.exp(-over / rate_settles)), 0.0)) * 0.5
    frame = pd.DataFrame({
        "t [s]": t, "psi [deg]": np.degrees(psi), "u [m/s]": speed, "delta [deg]": np.clip(2.5 * over, 0, 35),
        "x [m]": np.cumsum(speed * np.cos(psi) + current[0]) * 0.5, "y [m]": np.cumsum(speed * np.sin(psi) + current[1]) * 0.5,
    })  # fmt: skip
    return Trial.from_frame(frame[psi < np.radians(until)], name="slowing")


@pytest.mark.parametrize("settles", [(60.0, 60.0), (120.0, 60.0), (60.0, 20.0), (100.0, 1e-3), (200.0, 100.0)])
def test_a_circle_just_over_360_degrees_in_a_current_gives_both(settles):
    """However the ship slows down, the drift lies within its uncertainty, and the distances within what that makes of them."""
    current = (0.3, -0.8)
    found, still = measure(_slowing(current, *settles)), measure(_slowing((0.0, 0.0), *settles))
    seen = found.drift_speed * np.exp(1j * found.drift_direction)
    assert abs(seen - complex(*current)) < found.drift_uncertainty < 0.6
    for name in ("advance", "transfer", "tactical_diameter"):
        away = abs(getattr(found, f"{name}_still_water") - getattr(still, name))
        assert away < found.drift_uncertainty * found.times[0 if name != "tactical_diameter" else 1]
    assert any("advance within" in note for note in found.notes)


def test_still_water_values_are_not_made_up(circle_log):
    short = measure(circle_log(current=(0.3, -0.8), turns=0.95))
    assert short.drift_speed is None and short.advance_still_water is None
    assert "its drift shows from 360 deg on" in short.reasons["advance_still_water"]
    still = measure(circle_log())
    assert still.advance_still_water is None and "not beyond its uncertainty" in still.reasons["advance_still_water"]


def test_a_propeller_that_is_stopped_in_a_zigzag_is_told(logged):
    trial, *_ = logged(0.5)
    frame = trial.to_frame()
    frame["n [rps]"] = np.where(trial["t"] < 120, 2.0, 0.0)
    assert "The propeller is stopped at 120 s: no zig-zag does that" in measure(Trial.from_frame(frame)).notes
    frame["n [rps]"] = 2.0
    assert not any("propeller" in note for note in measure(Trial.from_frame(frame)).notes)


def test_measured_as_if_the_slow_heading_were_alone(logged):
    """A heading of every 4 s repeated at 2 Hz is 2 s old on average, and 2.6 degrees behind at the execute."""
    trial, _, overshoots = logged(0.5)
    frame = trial.to_frame()
    rows = np.arange(len(frame))
    frame["psi [deg]"] = frame["psi [deg]"].to_numpy()[(rows // 8) * 8]
    slow = Trial.from_frame(pd.DataFrame(frame))
    assert any("psi repeats" in note for note in slow.source.notes)
    measured = measure(slow)
    assert not measured.reasons
    found = np.degrees(measured.leading_overshoots)
    assert len(found) >= 3
    np.testing.assert_allclose(found, overshoots[: len(found)], atol=0.3)


@pytest.mark.parametrize(
    ("column", "by", "word"), [("x [m]", 200.0, "positions jump by 200 m"), ("psi [deg]", 10.0, "another value")]
)
def test_distances_across_a_jump_are_unknown(circle_log, column, by, word):
    trial = circle_log()
    frame = trial.to_frame()
    frame[column] += np.where(trial["t"] > 120.0, by, 0.0)
    found = measure(Trial.from_frame(frame))
    # 90 deg are reached at 144 s.
    assert found.advance is None and found.tactical_diameter is None
    assert word in found.reasons["advance"]


def test_a_heading_of_which_nothing_is_left_is_refused(logged):
    trial, _, _ = logged(0.5)
    kept = np.flatnonzero(trial["t"] < 60)[:40]
    frame = trial.to_frame().iloc[kept]
    wrong = Faults(Diagnosis("log"), {"psi": np.arange(len(kept)) > 0}, {"psi": [(0.0, 60.0, "glitches")]})
    with pytest.raises(
        NotAManoeuvreError, match=r"fewer than two samples of the heading that can be right \(glitches\)"
    ):
        _check_heading(Trial.from_frame(frame), wrong)


@pytest.mark.parametrize(("end", "known"), [(105.0, 1), (125.0, 2)])
def test_no_peak_is_taken_past_the_last_sample_of_the_rudder(logged, end, known):
    """The second reversal is at 96 s, its peak at 111 s; the record goes on without the rudder."""
    trial, _, overshoots = logged(0.1, order=True)
    frame = trial.to_frame()[["t [s]", "psi [deg]", "u [m/s]", "delta_order [deg]"]]
    frame.loc[trial["t"] > end, "delta_order [deg]"] = np.nan
    found = measure(Trial.from_frame(frame, name="silent"))
    np.testing.assert_allclose(np.degrees(found.overshoots[:known]), overshoots[:known], atol=0.3)
    assert found.overshoots[known:] == (None,) * (2 - known)
    assert ("overshoots[2]" in found.reasons) == (known == 1)
    assert found.reasons.get("overshoots[2]", "gap 105 to ").startswith("gap 105 to ")


def test_a_heading_at_the_end_of_its_range_gives_no_overshoot(logged):
    """Each extreme is cut off at 23 deg: one stretch was left out, and 3.0 deg for 13 was stated of the others."""
    trial, *_ = logged(0.5, noise=0.1)
    frame = trial.to_frame()
    frame["psi [deg]"] = frame["psi [deg]"].clip(327.0, 373.0)
    found = measure(Trial.from_frame(frame))
    # The last stretch ends with the record, and is not told yet.
    assert all(beyond is None for beyond in found.overshoots[:3])


def test_a_late_heading_bears_on_overshoots_from_the_order_too(logged):
    """The rudder follows its order, so that both are early beside the heading: 18.6 deg for 13.4 stood there with a note."""
    trial, *_ = logged(0.5, noise=0.1, order=True)
    frame = trial.to_frame()
    frame["psi [deg]"] = frame["psi [deg]"].shift(8, fill_value=frame["psi [deg]"].iloc[0])
    found = measure(Trial.from_frame(frame))
    assert [n.known["channel"] for n in found.notes if n.kind == "latency" and n.serious] == ["delta"]
    assert not any(n.serious for n in measure(trial).notes)


@pytest.mark.parametrize(
    ("interval", "wobble", "start", "lasts"), [(0.2, 0.0, -3.0, 9.0), (0.5, 0.01, -3.0, 6.0), (0.5, 0.01, 0.5, 6.0)]
)
def test_a_heading_that_stands_still_near_its_peak_is_in_the_interval(logged, interval, wobble, start, lasts):
    """The peak is at 49.6 s; 13.10 +- 0.14 deg for 13.46 was stated, of a heading that repeats its value or nearly so."""
    trial, _, overshoots = logged(interval, noise=0.05)
    frame = trial.to_frame()
    stuck = (trial["t"] >= 49.6 + start) & (trial["t"] <= 49.6 + start + lasts)
    last = frame["psi [deg]"].to_numpy()[np.argmax(stuck)]
    frame.loc[stuck, "psi [deg]"] = last + np.random.default_rng(2).normal(0, wobble, int(stuck.sum()))
    found = measure(Trial.from_frame(frame))
    if found.overshoots[0] is None:
        assert "frozen" in found.reasons["overshoots[1]"]
    else:
        assert abs(np.degrees(found.overshoots[0]) - overshoots[0]) < np.degrees(found.overshoot_uncertainties[0])
    # The next peak is sound, and stated as closely as before.
    assert found.overshoot_uncertainties[1] == pytest.approx(measure(trial).overshoot_uncertainties[1], rel=0.2)


def test_a_straight_line_across_a_gap_shows_no_peak(logged):
    """A logger drew the heading from 37 to 70 s: 1.5 deg for 13.5 stood there."""
    trial, *_ = logged(0.5, noise=0.05)
    frame = trial.to_frame()
    t = trial["t"]
    known = (t <= 37) | (t >= 70)
    frame["psi [deg]"] = np.interp(t, t[known], frame["psi [deg]"][known])
    found = measure(Trial.from_frame(frame))
    assert found.overshoots[0] is None and "frozen 37 to 70 s" in found.reasons["overshoots[1]"]
    assert any("one straight line" in str(note) for note in found.notes)
    assert not measure(trial).notes


@pytest.mark.parametrize("late", [-2.0, 3.0])
def test_a_rudder_on_another_clock_gives_both_overshoots(logged, late):
    """The rudder alone is logged, too early or too late: 16.1 +- 0.7 and 9.4 +- 0.7 deg were stated for 13.46."""
    trial, _, overshoots = logged(0.5, noise=0.05)
    frame = trial.to_frame()
    frame["delta [deg]"] = np.interp(trial["t"] - late, trial["t"], np.degrees(trial["delta"]))
    found = measure(Trial.from_frame(frame))
    counted, beside, within = (
        np.degrees(v) for v in (found.overshoots, found.overshoots_set_out, found.overshoot_uncertainties)
    )
    np.testing.assert_allclose(beside, overshoots[: len(beside)], atol=0.15 * abs(late) * 1.4)  # deg/s at the executes
    assert np.all(np.abs(counted - overshoots[: len(counted)]) < within) and np.all(within > 2)
    (notice,) = [n for n in found.notes if n.serious]
    assert notice.kind == "latency" and "counted from there the overshoots are 13." in str(notice)
    assert found.nominal == "20/20"


@pytest.mark.parametrize(("rate", "size", "count"), [(True, 3.0, 1), (True, 3.0, 2), (False, 1.0, 1)])
def test_a_small_glitch_of_the_heading_at_an_execute_is_left_out_or_within_the_uncertainty(logged, rate, size, count):
    trial, orders, overshoots = logged(1.0, noise=0.05)
    frame = trial.to_frame()
    k = int(np.searchsorted(frame["t [s]"], orders[1]))
    if rate:
        frame["r [deg/s]"] = np.gradient(
            frame["psi [deg]"].rolling(3, center=True, min_periods=1).mean(), frame["t [s]"]
        )
    frame.loc[k : k + count - 1, "psi [deg]"] += size
    found = measure(Trial.from_frame(frame))
    off = abs(np.degrees(found.overshoots[0]) - overshoots[0])
    assert off < max(np.degrees(found.overshoot_uncertainties[0]), 0.3)
    assert not rate or off < 0.5


def test_two_wild_samples_of_the_rudder_at_an_execute_are_left_out(logged):
    trial, orders, overshoots = logged(1.0)
    frame = trial.to_frame()
    k = int(np.searchsorted(frame["t [s]"], orders[1]))
    frame["delta [deg]"] += np.random.default_rng(2).normal(0, 0.1, len(frame))
    frame.loc[k : k + 1, "delta [deg]"] -= 20.0
    found = measure(Trial.from_frame(frame))
    assert np.degrees(found.overshoots[0]) == pytest.approx(overshoots[0], abs=0.3)


def test_a_rudder_of_some_forty_values_written_again_is_read_at_its_beat(logged):
    trial, _, overshoots = logged(0.5)
    frame = trial.to_frame()
    noisy = frame["delta [deg]"] + np.random.default_rng(3).normal(0, 0.1, len(frame))
    frame["delta [deg]"] = noisy.where(np.arange(len(frame)) % 10 == 0).ffill()
    found = measure(Trial.from_frame(frame))
    for one, within, true in zip(found.overshoots, found.overshoot_uncertainties, overshoots):
        assert abs(np.degrees(one) - true) < np.degrees(within) + 0.3
