"""Limits and weather that are stated, and what is not reached, told in the summary."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import shipid
from shipid.autopilot.course_changes.weather import standard_weather, stated_weather
from shipid.autopilot.judgement.limits import LIMITS, stated_limits
from shipid.foundation.errors import UnitError, UnknownNameError, UsageError


@pytest.fixture(scope="module")
def judged():
    """Two poles and no integral, in a wind that turns the ship off its course."""
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", design="pole", speeds=[9.5])
    weather = stated_weather(standard_weather(226.0, 9.5), wind="13 m/s", sea="0.1 deg at 8 s", current="0 m/s")
    return shipid.judge(
        pilot, samples=0, weather=weather, limits={"disk-margin": "1.9", "steady error in wind": "1 deg"}
    )


def test_limits_and_weather_are_those_stated(judged):
    assert judged.limits["disk margin"] == 1.9 and judged.limits["gain margin"] == LIMITS["gain margin"]
    assert judged.weather["wind_m_s"] == 13.0 and judged.weather["wave_frequency_rad_s"] == pytest.approx(np.pi / 4)
    assert judged.weather["wave_heading_rms_deg"] == pytest.approx(0.1) and judged.weather["current_m_s"] == 0.0
    points = {p.what: p for p in judged.points()}
    assert points["disk margin"].limit == 1.9 and points["steady error in wind"].limit == pytest.approx(1.0)
    assert judged.to_dict()["limits"]["disk margin"] == {"value": 1.9, "unit": "1"}
    assert any(w.startswith("disk margin") and "below 1.9" in w for w in judged.warnings)
    assert any(w.startswith("sea filter: while it is on") and "below 1.9" in w for w in judged.warnings)


def test_what_is_not_reached_is_in_the_summary(judged):
    missed = [s for s in judged.in_weather if s.change_deg and s.cross_track_m is None]
    assert missed
    (sentence,) = [w for w in judged.not_reached if w.startswith("The new course is not reached")]
    assert all(s.weather.removeprefix("weather from ") in sentence for s in missed)
    assert f"({len(missed)} of 8 directions)" in sentence and sentence in judged.text()
    assert sentence in judged.to_dict()["not_reached"]
    unsettled = tuple(dataclasses.replace(s, settling_s=None) for s in judged.steps)
    robust = dataclasses.replace(
        judged.robust[0], variants={"sea filter on": {"disk": 1.0, "overshoot_deg": 1.0, "settling_s": None}}
    )
    told = dataclasses.replace(judged, steps=unsettled, robust=(robust,)).not_reached
    assert "At 9.5 m/s a course change of 5, 10, 20, 45, 60, 90 or 120 deg does not settle within the run." in told
    assert "A course change of 60 deg does not settle with sea filter on." in told


def test_with_an_integral_every_course_is_reached():
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", speeds=[9.5])
    found = shipid.judge(pilot, samples=0)
    assert found.not_reached == () and found.weakest.share >= 1


def test_waves_met(judged):
    """2 pi/8 s; a ship of 9.5 m/s that meets them head on: omega + omega^2 u/g."""
    omega = np.pi / 4
    ahead = next(s for s in judged.in_weather if s.weather == "weather from ahead" and not s.change_deg)
    assert ahead.waves_met == pytest.approx((omega + omega**2 * 9.5 / 9.81) * 30 / np.pi)
    assert all(s.waves_met is None for s in judged.steps)


def test_requests_that_are_none():
    base = standard_weather(226.0, 9.5)
    assert stated_limits({"overshoot": "5 %"})["overshoot"] == pytest.approx(0.05)
    assert stated_weather(base, sea="0.2 deg at 0.5 rad/s").wave_frequency == pytest.approx(0.5)
    assert stated_weather(base, sea="0.4 deg").wave_frequency == base.wave_frequency
    for limits, error, words in (
        ({"stiffness": "1"}, UnknownNameError, "no limit 'stiffness'"),
        ({"disk margin": "0"}, UsageError, "greater than zero"),
        ({"phase margin": "30"}, UnitError, "with no unit"),
    ):
        with pytest.raises(error, match=words):
            stated_limits(limits)
    for stated, words in (
        ({"wind": "-3 m/s"}, "the wind is -3 m/s"),
        ({"sea": "1 deg at 500 s"}, "none that yaw a ship"),
    ):
        with pytest.raises(UsageError, match=words):
            stated_weather(base, **stated)
    with pytest.raises(UnitError):
        stated_weather(base, sea="0.2")
