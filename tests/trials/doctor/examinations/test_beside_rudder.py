"""What the ship's answer to the rudder shows: a sensor that stops short, beside a rudder that stops, and a heading that is late."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.trial import Trial


def sailed(over: float, sensor: float, scatter: float = 1.0, rate: float = 3.0) -> Trial:
    """A zig-zag at 20 deg of heading by a first-order ship whose rudder is put over so far, in a log that ends there."""
    step, every = 0.1, 10
    t = np.arange(0, 300, step)
    psi, r, delta = np.zeros(t.size), np.zeros(t.size), np.zeros(t.size)
    order, now, turning, heading = 0.0, 0.0, 0.0, 0.0
    for k, when in enumerate(t):
        order = over if order == 0 and when >= 10 else -order if order * heading >= 20.0 * abs(order) > 0 else order
        now += np.clip(order - now, -rate * step, rate * step)
        turning += step * (0.08 * now - turning) / 12
        heading += step * turning
        psi[k], r[k], delta[k] = heading, turning, now
    noise = scatter * np.random.default_rng(2).standard_normal((2, t[::every].size))
    frame = pd.DataFrame({
        "t [s]": t[::every], "psi [deg]": psi[::every] + 0.1 * noise[0], "r [deg/s]": r[::every] + 0.01 * noise[1],
        "delta [deg]": np.clip(delta, -sensor, sensor)[::every],
    })  # fmt: skip
    return Trial.from_frame(frame)


def clipped(trial: Trial) -> list[str]:
    return [f.message for f in check_trial(trial).findings if f.kind == "clipped" and f.confidence >= 0.9 and f.serious]


@pytest.mark.parametrize("scatter", [0.0, 1.0])
def test_a_sensor_that_stops_short_is_told_with_what_the_rudder_did(scatter):
    """It passed for a zig-zag 15/25: overshoots of 11.2 and 12.6 deg for 13.4 and 15.2, K .106 for .080."""
    (message,) = clipped(sailed(20.0, 15.0, scatter))
    assert message.startswith("delta stops at 15 deg, and the ship answers a rudder that goes on to some 2")


@pytest.mark.parametrize(("over", "sensor", "rate"), [(15.0, 90.0, 3.0), (20.0, 20.0, 3.0), (20.0, 15.0, 30.0)])
def test_a_rudder_that_stops_itself_is_sound(over, sensor, rate):
    """The last one is over before anybody could see it."""
    assert not clipped(sailed(over, sensor, rate=rate))


@pytest.mark.parametrize(
    ("late", "channel", "words"),
    [("psi", "psi", "answers the rudder as it is logged"), ("r", "r", "behind the slope of the heading")],
)
def test_what_is_late_is_told_by_the_rudder(late, channel, words):
    """A heading that was 3 s late was told as a rate that runs ahead, and a rudder that is early."""
    sound = sailed(20.0, 90.0)
    table = sound.table.copy()
    table[late] = np.interp(sound["t"] - 3.0, sound["t"], sound[late])
    (found,) = [f for f in check_trial(Trial("log", table)).findings if f.kind == "latency"]
    assert found.channel == channel and words in found.message and found.fix["column"] == channel
    assert found.fix["seconds"] == pytest.approx(3.0, abs=0.2)


@pytest.mark.parametrize(("sensor", "said"), [(15.0, True), (90.0, False)])
def test_a_sensor_that_scatters_and_repeats_at_its_stop_shows_no_more(sensor, said):
    """With a gear so quick that the ship's answer does not show it."""
    sound = sailed(20.0, 90.0, rate=30.0)
    table = sound.table.copy()
    scatter = np.deg2rad(0.05) * np.random.default_rng(3).standard_normal(len(table))
    table["delta"] = np.clip(table["delta"] + scatter, -np.deg2rad(sensor), np.deg2rad(sensor))
    found = clipped(Trial("log", table))
    assert len(found) == said and all("repeats 15 deg exactly" in message for message in found)


def test_heading_and_rudder_under_each_other_s_name_are_told():
    """It was told as four faults: a frozen heading, glitches of it, and a rudder with the wrong sign."""
    table = sailed(20.0, 90.0).table.rename(columns={"psi": "delta", "delta": "psi"})
    (found,) = check_trial(Trial("log", table)).findings
    assert found.kind == "mislabelled" and "r is the slope of the column called delta" in found.message
