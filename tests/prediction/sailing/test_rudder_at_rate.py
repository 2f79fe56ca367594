"""Gains far too high: the rudder goes to and fro at its rate limit, and that is told; a sound loop in waves is not."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from shipid.prediction.routes.route import Route, Waypoint
from shipid.prediction.sailing.loop_cycles import loop_cycles
from shipid.prediction.sailing.rudder_at_rate import cycles_at_rate
from shipid.prediction.sailing.sail import sail
from shipid.prediction.sailing.sail_route import sail_route

ROUTE = Route(
    "plan",
    tuple(Waypoint((np.deg2rad(54.0 + k), np.deg2rad(8.0 + j))) for k, j in ((0, 0), (0.03, 0.0), (0.05, 0.04))),
)


def times(pilot, factor):
    gains = {name: factor * values for name, values in pilot.schedule.gains.items()}
    return dataclasses.replace(pilot, schedule=dataclasses.replace(pilot.schedule, gains=gains))


def told(notes):
    return [n for n in notes if getattr(n, "kind", "") == "rudder-cycles"]


@pytest.mark.parametrize("waves", [None, "0.3 deg from 40 deg"])
def test_gains_a_thousand_times_too_high_are_told(pilot, waves):
    (notice,) = told(sail(times(pilot, 1000), "60 deg", waves=waves).source.notes)
    assert notice.serious and notice.known["share"] > 0.6 and "2.5 deg/s" in notice


@pytest.mark.parametrize("factor", [1, 3, 10])
@pytest.mark.parametrize("waves", [None, "0.3 deg from 40 deg", "3 deg from 100 deg"])
def test_a_sound_loop_is_not(pilot, factor, waves):
    assert not told(
        sail(times(pilot, factor), [(100, "60 deg"), (300, "-10 deg"), (600, "0 deg")], waves=waves).source.notes
    )


@pytest.mark.parametrize("factor", [1, 1000])
@pytest.mark.parametrize("waves", [None, "1 deg from 40 deg"])
def test_along_a_route(pilot, factor, waves):
    voyage = sail_route(times(pilot, factor), ROUTE, waves=waves, duration=800)
    assert bool(told(voyage.warnings)) is (factor == 1000)


def test_many_turns_with_rests_between_them_are_no_cycle():
    t = np.arange(0, 2000.0)
    delta = np.interp(t, np.arange(0, 2000, 50), np.resize([0, 0, 20, 20, -20, -20], 40))
    fast = np.clip(delta, -1, 1)
    assert not cycles_at_rate(t, fast, 0.8)
    assert cycles_at_rate(t, np.abs(t % 40 - 20), 1.0)


@pytest.mark.parametrize("factor", [1, 10, 100, 1000])
def test_of_an_autopilot_alone(pilot, factor):
    assert bool(told(loop_cycles(times(pilot, factor), 7.0))) is (factor >= 100)
    assert not loop_cycles(times(pilot, factor), -1.0)  # a ship that makes no way is not sailed
