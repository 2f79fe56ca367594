"""Speed and course over ground: a course that comes late, and a log that is off where no heading is logged."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.foundation.numbers import percent


def log(trial, late=0.0, factor=1.0, noise=0.0):
    """A trial as a receiver and a log say it: the receiver `late` seconds, the log `factor` times the truth."""
    t = trial["t"]
    made = np.gradient(trial["x"], t) + 1j * np.gradient(trial["y"], t)
    made = np.interp(t - late, t, made.real) + 1j * np.interp(t - late, t, made.imag)
    rng = np.random.default_rng(2)
    x, y = (trial[c] + noise * rng.normal(size=t.size) for c in ("x", "y"))
    table = {
        "t [s]": t, "x [m]": x, "y [m]": y, "r [rad/s]": trial["r"], "u [m/s]": factor * trial["u"], "SOG [m/s]": np.abs(made),
        "COG [rad]": np.angle(made) % (2 * np.pi),
    }  # fmt: skip
    return pd.DataFrame(table)


def told(frame, ship=None):
    return {f.kind: f for f in shipid.check_trial(shipid.Trial.from_frame(frame), ship).findings if f.confidence >= 0.5}


@pytest.mark.parametrize("late", [4.0, 7.0])
@pytest.mark.parametrize("noise", [0.0, 0.3])
def test_a_course_later_than_the_positions_is_named(simulated, late, noise):
    finding = told(log(simulated(noise="none"), late=late, noise=noise))["latency"]
    assert finding.channel == "COG" and not finding.spoils and finding.fix is None
    number = float(finding.message.split("about ")[1].split(" s")[0])
    assert number == pytest.approx(late, abs=0.6)


@pytest.mark.parametrize("positions", [True, False])
@pytest.mark.parametrize("manoeuvre", ["zigzag:20/20", "turn:25"])  # at 35 deg this model drifts by 29 deg
def test_a_course_that_lags_by_the_drift_of_the_ship_is_sound(simulated, manoeuvre, positions):
    frame = log(simulated(noise="none", manoeuvre=manoeuvre))
    seen = told(frame if positions else frame.drop(columns=["x [m]", "y [m]"]))
    assert "latency" not in seen and "speed-scale" not in seen


def test_without_positions_a_course_is_late_beyond_any_drift(simulated):
    frame = log(simulated(noise="none", model="norrbin", ship="zeefakkel"), late=14.0).drop(columns=["x [m]", "y [m]"])
    finding = told(frame)["latency"]
    assert (
        finding.channel == "COG" and "after the integral of r, more than the drift of a ship makes" in finding.message
    )


@pytest.mark.parametrize("factor", [0.75, 0.85, 1.3])
def test_a_log_that_is_off_is_named_without_a_heading(simulated, factor):
    finding = told(log(simulated("turn:35", "none", "norrbin", "zeefakkel"), factor=factor))["speed-scale"]
    assert finding.serious and not finding.repaired
    assert f"reads {percent(abs(1 - factor))} {'low' if factor < 1 else 'high'}" in finding.message


def test_a_speed_over_ground_at_a_quarter_of_the_track_is_told(simulated):
    frame = log(simulated(noise="none"))
    assert "speed-scale" not in told(frame)
    found = told(frame.assign(**{"SOG [m/s]": frame["SOG [m/s]"] / 4}))["speed-scale"]
    assert found.channel == "SOG" and found.serious and "3.99" in found.message and found.fix is None


def test_a_current_along_a_zigzag_is_no_serious_fault_of_the_speed(simulated):
    trial = simulated()
    frame = trial.to_frame().drop(columns="delta_order [deg]", errors="ignore")
    ahead = float(np.median(trial["psi"]))
    flow = 0.12 * float(np.median(trial["u"])) * trial["t"]
    along = frame.assign(**{
        "x [m]": frame["x [m]"] + flow * np.cos(ahead), "y [m]": frame["y [m]"] + flow * np.sin(ahead)
    })  # fmt: skip
    diagnosis = shipid.check_trial(shipid.Trial.from_frame(along))
    assert not diagnosis.serious
    assert {"speed-scale", "track-inconsistent"} & set(diagnosis.kinds)
