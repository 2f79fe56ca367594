"""An autopilot on board: course changes by the instruments and by the filter, measured as those of the judgement are."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

import shipid
from shipid.autopilot.course_changes.course_measures import measure_history
from shipid.autopilot.course_changes.run_course_changes import run_course_changes
from shipid.autopilot.design.closed_loop import linear_ship
from shipid.autopilot.errors import DesignRequestError
from shipid.autopilot.on_board.model_reference import first_order_equivalent
from shipid.foundation.errors import UnknownNameError, UsageError

CHANGES = (0.0, 60.0, -60.0)


@pytest.fixture(scope="module")
def runs(container):
    return shipid.run_on_board(container, "yaw-filter", changes=CHANGES)


def by(runs, feedback: str, weather: str):
    (found,) = (r for r in runs.runs if r.feedback == feedback and (r.weather == "calm") == (weather == "calm"))
    return found


def test_the_filter_spares_the_rudder_and_keeps_the_course(runs):
    """By the filter the rudder turns round far less often, the heading is kept as well, and is known better."""
    for weather in ("calm", "weather"):
        raw, clean = by(runs, "instruments", weather), by(runs, "filter", weather)
        for a, b in zip(raw.changes[1:], clean.changes[1:]):
            assert b.reversals < 0.15 * a.reversals
            assert b.rms_rudder_deg < a.rms_rudder_deg and b.rms_error_deg < 1.05 * a.rms_error_deg
        assert clean.error_deg < 0.5 * raw.error_deg


def test_in_calm_it_is_the_course_change_of_the_judgement(runs, container):
    """The filter costs little: a change of 60 deg settles as without sensors, and overshoots by no more than they leave."""
    own = shipid.judge(container, samples=0)
    change = next(s for s in own.steps if s.change_deg == 60.0 and s.speed == container.own_speed)
    for found in by(runs, "filter", "calm").changes[1:]:
        assert found.settling_s == pytest.approx(change.settling_s, rel=0.1)
        assert found.overshoot_deg == pytest.approx(change.overshoot_deg, abs=0.2)


def test_the_model_reference_takes_out_the_steady_error(runs, container):
    """The disturbance that the filter estimates becomes rudder: the course is kept in wind, which the schedule alone does not do."""
    adapted = shipid.run_on_board(container, "yaw-filter", changes=(0.0,), adaptation="reference")
    assert abs(by(adapted, "filter", "weather").changes[0].mean_error_deg) < 0.2
    assert abs(by(runs, "filter", "weather").changes[0].mean_error_deg) > 2.0
    # By the instruments nothing is adapted.
    assert by(adapted, "instruments", "weather").changes[0].mean_error_deg < -2.0


def test_gains_follow_the_ship_that_is_estimated(container, sized):
    """A ship of half the yaw gain, steered by the schedule of the whole one: by adapted gains it settles as it was asked to."""
    weak = dataclasses.replace(container, ships=(sized("soesterberg", "de-keizer", K=0.8),))
    plain, adapted = (
        by(shipid.run_on_board(weak, "yaw-filter", changes=(60.0, -60.0, 20.0), adaptation=a), "filter", "calm").changes
        for a in ("none", "gains")
    )
    own = shipid.design_autopilot(
        "de-keizer",
        weak.ship,
        design="pole",
        omega_n=container.request["omega_n"],
        damping=0.9,
        speeds=container.speeds,
    )
    asked = run_course_changes(own, [9.5], [np.deg2rad(20)])
    miss = [abs(c[2].settling_s - asked.settling[0]) for c in (adapted, plain)]
    assert miss[0] < 0.5 * miss[1]


def test_a_filter_of_ones_own(container):
    """Any filter that estimates heading and rate of turn will do; its sensors are those it was made with."""
    kalman = shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"),
        container.ship,
        measured={"compass": "0.1 deg", "gyro": "0.01 deg/s"},
        inputs={"cruise": "9.5 m/s"},
    )
    found = shipid.run_on_board(container, kalman, changes=(10.0,), interval="0.5 s")
    assert found.sensors == {"compass": "0.1 deg", "gyro": "0.01 deg/s"} and found.interval == 0.5
    assert by(found, "filter", "calm").changes[0].overshoot_deg < 0.5


def test_what_the_result_says(runs):
    assert "diverged" not in runs.text()
    found = json.loads(json.dumps(runs.to_dict(), allow_nan=False))
    assert found["filter"] == "yaw-filter" and len(found["runs"]) == 4
    assert [c["change"]["value"] for c in found["runs"][0]["changes"]] == list(CHANGES)
    assert runs.to_frame().shape[0] == 12
    assert runs.text().count("\n") == 13 and "gains of the schedule" in runs.text()
    assert runs.warnings == ()


def test_a_filter_that_does_not_fit_is_named():
    """The levels of the yaw filter are those of a ship of 226 m: on a model of 7 m its heading is worse than the compass."""
    pilot = shipid.design_autopilot("bech-surge", "kvlcc2-7m", speeds=[0.8])
    found = shipid.run_on_board(pilot, "yaw-filter", changes=(20.0,))
    assert any(w.startswith("on board: the heading of the filter is off by") for w in found.warnings)


def test_measures_of_a_history():
    """A heading that swings about its order and dies out, and a rudder that goes to and fro, against numpy."""
    t = 0.5 * np.arange(801)
    psi = 0.5 * (1 - np.exp(-t / 20) * np.cos(t / 10))
    delta = 0.1 * np.sin(2 * np.pi * t / 40)
    history = {"t": t, "psi": psi, "psi_order": np.full(t.size, 0.5), "delta": delta, "x": 8.0 * t, "y": 0.0 * t,
               "current_north": 0.0 * t, "current_east": 0.0 * t}  # fmt: skip
    found = measure_history(history, 8.0, 0.5)
    assert found.overshoot[0] == pytest.approx(psi.max() - 0.5, rel=1e-12)
    last = np.flatnonzero(np.abs(psi - 0.5) > 0.01)[-1]
    crossed = np.interp(-0.01, -np.abs(psi[last : last + 2] - 0.5), t[last : last + 2])
    assert found.settling[0] == pytest.approx(crossed, abs=1e-6)
    assert found.rms_error[0] == pytest.approx(np.sqrt(np.mean((psi - 0.5) ** 2)), rel=1e-12)
    assert found.mean_error[0] == pytest.approx(np.mean(psi - 0.5), rel=1e-12)
    assert found.rms_rudder[0] == pytest.approx(np.sqrt(np.mean(delta**2)), rel=1e-12)
    assert found.travel[0] == pytest.approx(np.abs(np.diff(delta)).sum() / (801 * 0.5), rel=1e-12)
    # Twenty turns of the rudder in ten periods.
    assert found.reversals[0] * 801 * 0.5 / 60 == pytest.approx(20.0)


def test_the_ship_of_first_order():
    """Of a ship of first order its own K* and tau*, at any frequency; of one of second order the same response at one."""
    pilot = shipid.design_autopilot("de-keizer", "soesterberg")
    for omega in (0.01, 0.1):
        a, b1 = first_order_equivalent(linear_ship(pilot, [9.5]).at(0), omega, pilot.pace(9.5))
        assert (a, b1) == pytest.approx((1.6 / 1.7, 1 / 1.7), rel=1e-12)
    second = shipid.design_autopilot("nomoto-second-order", "mariner")
    speed, omega = second.own_speed, 0.05
    plant, pace = linear_ship(second, [speed]).at(0), second.pace(second.own_speed)
    a, b1 = first_order_equivalent(plant, omega, pace)
    s = 1j * omega
    expected = (plant.C[1] @ np.linalg.solve(s * np.eye(len(plant.states)) - plant.A, plant.B)).item()
    assert a * pace**2 / (s + b1 * pace) == pytest.approx(expected, rel=1e-10)


def test_requests_that_are_none(container, integral):
    at_once = shipid.design_autopilot("de-keizer", "soesterberg", actuator=None, speeds=[9.5])
    turning = shipid.design_autopilot("de-keizer", "soesterberg", mode="rate", speeds=[9.5])
    with pytest.raises(DesignRequestError, match="with a steering machine"):
        shipid.run_on_board(at_once, "yaw-filter")
    with pytest.raises(DesignRequestError, match="holds a rate of turn"):
        shipid.run_on_board(turning, "yaw-filter")
    with pytest.raises(DesignRequestError, match="of design pid"):
        shipid.run_on_board(integral, "yaw-filter", adaptation="gains")
    with pytest.raises(UnknownNameError, match="no adaptation 'more'"):
        shipid.run_on_board(container, "yaw-filter", adaptation="more")
    with pytest.raises(DesignRequestError, match="a sampling interval of 0 s"):
        shipid.run_on_board(container, "yaw-filter", interval="0 s")
    with pytest.raises(UsageError, match="does not estimate"):
        shipid.run_on_board(container, "position-filter")
    with pytest.raises(UsageError, match="not a ParameterSet"):
        shipid.judge(container.ship)


def test_a_run_that_leaves_its_model_is_named_and_not_measured():
    """Nomoto's linear ship of 45 m with 30 deg of rudder would turn in a circle of less than a length."""
    pilot = shipid.design_autopilot("nomoto", "zeefakkel", speeds=[5.0], rudder_limit="30 deg", omega_n="0.3 rad/s")
    found = shipid.run_on_board(pilot, "yaw-filter", changes=(0.0, 900.0))
    for run in found.runs:
        assert run.departure is not None and "faster than any ship" in run.departure
        assert run.changes[1].lost and run.changes[1].overshoot_deg is None
    (notice, *_) = [w for w in found.warnings if "not sailed by this model" in w]
    assert notice.serious and notice.kind == "not-sailed"
