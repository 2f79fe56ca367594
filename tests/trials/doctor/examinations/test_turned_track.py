"""Positions that are turned against the heading in a turning circle, and a speed over ground in another unit than its header says."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.trial import Trial


def found_in(frame, kind, channel):
    findings = check_trial(Trial.from_frame(frame, name="log")).findings
    return [f for f in findings if f.kind == kind and f.channel == channel]


@pytest.fixture
def circle(simulated):
    return simulated("turn:20").to_frame()


@pytest.mark.parametrize("turn", [20.0, -30.0])
def test_a_turned_track_is_told_from_the_drift_angle_of_a_turning_circle(circle, turn):
    place = (circle["x [m]"] + 1j * circle["y [m]"]) * np.exp(1j * np.radians(turn))
    turned = circle.assign(**{"x [m]": place.to_numpy().real, "y [m]": place.to_numpy().imag})
    [found] = found_in(turned, "track-direction", "x,y")
    side = "starboard" if turn > 0 else "port"
    assert found.serious and not found.repaired and side in found.message
    assert float(found.message.split("turned by ")[1].split(" deg")[0]) == pytest.approx(abs(turn), abs=2.5)


def test_the_track_of_a_sound_turning_circle_is_not_turned(circle):
    assert not found_in(circle, "track-direction", "x,y")


@pytest.mark.parametrize(("factor", "unit"), [(1852 / 3600, "knots"), (1 / 3.6, "km/h"), (1.0, None)])
def test_speed_over_ground_in_another_unit_is_found_beside_a_sound_log(simulated, factor, unit):
    exact = simulated("turn:20", noise="none").to_frame()
    speed = np.hypot(*(np.gradient(exact[c], exact["t [s]"]) for c in ("x [m]", "y [m]")))
    found = found_in(exact.assign(**{"SOG [m/s]": speed / factor}), "unit", "SOG")
    if unit is None:
        assert not found
    else:
        assert found[0].repaired and unit in found[0].message
