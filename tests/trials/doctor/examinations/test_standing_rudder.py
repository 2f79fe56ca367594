"""A rudder angle that stands still while the rudder moves: found by its leap, or by the ship that turns back; what is measured."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


def standing(trial, start, end, noise=0.02):
    """The zig-zag with a rudder that repeats one value for a while."""
    frame = trial.to_frame()
    t = trial["t"]
    delta = frame["delta [deg]"].to_numpy() + np.random.default_rng(5).normal(0, noise, t.size)
    inside = (t >= start) & (t <= end)
    delta[inside] = delta[np.flatnonzero(inside)[0]]
    return Trial.from_frame(frame.assign(**{"delta [deg]": delta}), name="standing")


@pytest.fixture
def zigzag(simulated):
    trial = simulated()
    frame = trial.to_frame().drop(columns="delta_order [deg]", errors="ignore")
    return Trial.from_frame(frame, name="zigzag")


def test_a_rudder_that_leaps_after_it_stood(zigzag):
    executes = measure(zigzag).executes
    trial = standing(zigzag, executes[1] - 20, executes[1] + 40)
    [found] = [f for f in check_trial(trial).findings if f.kind == "frozen"]
    assert found.serious and found.channel == "delta" and found.fix is None
    measured = measure(trial)
    assert measured.executes[1] is None and measured.overshoots[1] is None
    assert "frozen" in measured.reasons["executes[2]"]
    assert measured.overshoots[2] == pytest.approx(measure(zigzag).overshoots[2], abs=1e-3)


def test_a_ship_that_turns_back_under_a_rudder_that_stands(zigzag):
    executes = measure(zigzag).executes
    trial = standing(zigzag, executes[0] - 20, executes[2] - 10)
    [found] = [f for f in check_trial(trial).findings if f.kind == "frozen"]
    assert found.serious and found.channel == "delta"
    measured = measure(trial)
    assert measured.initial_turning_time is None and "frozen" in measured.reasons["initial_turning_time"]
    assert any("executes in there are not counted" in note for note in measured.notes)


@pytest.mark.parametrize("digit", [0.0, 0.1, 1.0])
def test_plates_are_no_standing_rudder(zigzag, digit):
    frame = zigzag.to_frame()
    if digit:
        frame["delta [deg]"] = np.round(frame["delta [deg]"] / digit) * digit
    assert "frozen" not in check_trial(Trial.from_frame(frame, name="whole")).kinds


def test_a_rudder_at_its_stop_does_not_stand():
    """Under an autopilot it moves all the time, and lies at 25 deg in two changes of course."""
    t = np.arange(0.0, 600.0, 1.0)
    random = np.random.default_rng(3)
    wanted = (
        3 * np.sin(t / 9) + random.normal(0, 1, t.size) + 40 * ((t > 200) & (t < 220)) - 40 * ((t > 400) & (t < 415))
    )
    psi = np.cumsum(np.convolve(wanted.clip(-25, 25), np.ones(10) / 10, "same")) * 0.05
    trial = Trial.from_frame(
        {"t [s]": t, "psi [deg]": psi + random.normal(0, 0.05, t.size), "delta [deg]": wanted.clip(-25, 25)}
    )
    assert "frozen" not in check_trial(trial).kinds


def test_a_ship_that_yaws_in_waves_does_not_turn_back(zigzag):
    frame, t = zigzag.to_frame(), zigzag["t"]
    # Her rate in waves is that of the zig-zag, and they are longer than an eighth of a plate.
    frame["psi [deg]"] += 5 * np.sin(2 * np.pi * t / 21)
    trial = Trial.from_frame(frame[["t [s]", "psi [deg]", "delta [deg]"]], name="waves")
    assert "frozen" not in check_trial(trial).kinds
