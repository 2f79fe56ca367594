"""Coarse and uneven records: thresholds, digits of the rudder, scattered stamps, ends on a ramp, segments of a manoeuvre."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


@pytest.fixture
def frame(simulated):
    return simulated().to_frame().drop(columns="delta_order [deg]", errors="ignore")


def found_in(frame, kind):
    return [f for f in check_trial(Trial.from_frame(frame, name="log")).findings if f.kind == kind]


def test_a_rudder_in_steps_of_5_deg_is_told_and_executes_are_right(frame):
    rounded = frame.assign(**{"delta [deg]": np.round(frame["delta [deg]"] / 5) * 5})
    [found] = found_in(rounded, "quantised")
    assert found.serious and "steps of 5 deg" in found.message
    fine, coarse = (measure(Trial.from_frame(table, name="log")) for table in (frame, rounded))
    np.testing.assert_allclose(coarse.executes, fine.executes, atol=0.6)
    assert any("quantised (delta)" in note for note in coarse.notes)
    # The rudder is known to half a step, and it is said what that makes.
    assert coarse.execute_within >= np.radians(2.5) / coarse.rudder_rate
    assert min(coarse.overshoot_uncertainties) > 1.2 * max(fine.overshoot_uncertainties[:3])


def test_a_rudder_in_whole_degrees_is_no_fault(frame):
    assert not found_in(frame.assign(**{"delta [deg]": np.round(frame["delta [deg]"])}), "quantised")


def test_positions_in_feet_are_told_and_put_right(frame):
    feet = frame.assign(**{c: frame[c] / 0.3048 for c in ("x [m]", "y [m]")})
    [found] = found_in(feet, "unit")
    assert found.channel == "x,y" and found.repaired and found.fix["factor"] == 0.3048 and "feet" in found.message


def test_a_clock_or_a_log_that_no_rate_tells_apart_is_not_repaired(frame):
    slow = frame.assign(**{"t [s]": 2 * frame["t [s]"]}).drop(columns="r [deg/s]")
    [found] = found_in(slow, "speed-scale")
    assert found.serious and not found.repaired and "a clock that runs at another speed" in found.message


def test_scattered_stamps_are_told(simulated):
    frame = simulated(noise="none").to_frame().drop(columns="delta_order [deg]", errors="ignore")
    t = frame["t [s]"].to_numpy()
    scattered = t + np.random.default_rng(1).uniform(-0.4, 0.4, t.size) * (t[1] - t[0])
    [found] = found_in(frame.assign(**{"t [s]": scattered}), "clock-jitter")
    assert found.serious and found.fix["interval"] == pytest.approx(t[1] - t[0], rel=1e-3)
    # Samples that were taken at uneven times are sound.
    uneven = frame.apply(lambda column: np.interp(scattered, t, column)).assign(**{"t [s]": scattered})
    assert not found_in(uneven, "clock-jitter")


@pytest.mark.parametrize("shift", [-30.0, 5.0])
def test_a_segment_of_a_manoeuvre_is_neither_short_nor_begins_with_a_wild_rudder(frame, shift):
    executes = measure(Trial.from_frame(frame, name="log")).executes
    t = frame["t [s]"].to_numpy()
    # Behind the execute the first samples lie on the ramp.
    part = frame[(t >= executes[1] + 5) & (t <= executes[2] + shift)].reset_index(drop=True)
    assert not found_in(part, "outlier")
    assert not [f for f in found_in(part, "short") if f.serious]


def test_an_order_stamped_early_is_told_with_both_values(simulated):
    frame = simulated().to_frame()
    t = frame["t [s]"].to_numpy()
    early = frame.assign(**{"delta_order [deg]": np.interp(t + 5, t, frame["delta_order [deg]"])})
    [found] = found_in(early, "order-early")
    assert "5 s after delta_order" in found.message.replace("4.99", "5").replace("5.01", "5")
    [note] = [n for n in measure(Trial.from_frame(early, name="log")).notes if "overshoots are" in n]
    right = np.degrees(measure(simulated()).overshoots)
    said = [float(word.strip(",")) for word in note.partition("overshoots are ")[2].split() if word[0].isdigit()]
    np.testing.assert_allclose(said[:4], right[:4], atol=0.3)


def test_of_two_columns_the_one_that_moves_is_taken(frame, tmp_path):
    path = tmp_path / "log.csv"
    twin = frame.rename(columns={"delta [deg]": "rudder stbd [deg]"})
    twin.insert(1, "rudder port [deg]", 1.3)
    twin.to_csv(path, index=False)
    diagnosis = check_trial(path)
    assert "no-rudder-movement" not in diagnosis.kinds
    assert any(
        "taken from 'rudder stbd'" in note and "rudder port (it never changes)" in note for note in diagnosis.notes
    )


def test_a_sound_trial_of_these_channels_has_none_of_these_findings(frame, simulated):
    new = {"clock-set", "clock-jitter", "written-on-change", "order-early", "frozen", "quantised", "unit"}
    assert not new & set(check_trial(Trial.from_frame(frame, name="log")).kinds)
    assert not new & set(shipid.check_trial(simulated()).kinds)
