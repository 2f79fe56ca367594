from __future__ import annotations

import numpy as np
import pytest

import shipid


@pytest.fixture(scope="module")
def schedule(tmp_path_factory):
    path = tmp_path_factory.mktemp("tuned") / "schedule.toml"
    shipid.write_schedule(shipid.design_autopilot("de-keizer", "soesterberg"), path)
    return str(path)


def test_courses_under_an_autopilot(call, schedule, tmp_path):
    out = tmp_path / "voyage.csv"
    answer = call(
        "simulate", "de-keizer", "--ship", "soesterberg", "--autopilot", schedule, "--course", "60 s:30 deg", "--course", "400 s:-20 deg",
        "--current", "2 kn to 90 deg", "--wind", "10 m/s from 300 deg", "--waves", "0.3 deg from 300 deg", "--noise", "standard",
        "--duration", "900 s", "-o", str(out),
    )  # fmt: skip
    assert answer.code == 0, answer
    trial = shipid.read_trial(out)
    psi = np.rad2deg(trial["psi"])
    assert psi[trial["t"] < 60].mean() == pytest.approx(0, abs=1.5)
    assert psi[(trial["t"] > 370) & (trial["t"] < 400)].mean() == pytest.approx(30, abs=3)
    assert psi[-30:].mean() == pytest.approx(-20, abs=3)
    assert "autopilot (pid) ordered 30 deg at 60 s" in answer.err.replace("\n", " ")


def test_one_course_and_a_value(call, schedule):
    arguments = ("simulate", "de-keizer", "--ship", "soesterberg", "--autopilot", schedule, "--course", "60 deg")
    usual, slow = call(*arguments), call(*arguments, "--set", "K=0.8 1")
    assert usual.code == slow.code == 0
    assert usual.out != slow.out and usual.out.splitlines()[0].startswith("# Simulated, not measured")


def test_a_schedule_of_another_ship_is_refused(refused, schedule):
    says = "was designed for ship soesterberg of 226 m, and gunnerus has 33.9 m"
    refused(3, ["simulate", "de-keizer", "--ship", "gunnerus", "--autopilot", schedule, "--course", "60 deg"], says)
    refused(3, ["predict", "de-keizer", "--ship", "gunnerus", "--schedule", schedule, "--heading", "60 deg"], says)
    refused(3, ["bridge", "--ship", "gunnerus", "--schedule", schedule], says)


def test_refusals(refused, schedule):
    ship = ["simulate", "de-keizer", "--ship", "soesterberg"]
    refused(2, ship, "--manoeuvre, or an --autopilot")
    refused(
        2,
        [*ship, "--manoeuvre", "turn:20", "--autopilot", schedule, "--course", "60 deg"],
        "--manoeuvre, or an --autopilot",
    )
    refused(2, [*ship, "--autopilot", schedule], "needs a --course")
    refused(2, [*ship, "--manoeuvre", "turn:20", "--course", "60 deg"], "belongs to --autopilot")
    refused(2, [*ship, "--autopilot", schedule, "--course", "60 deg", "--course", "9 deg"], "each has its time")
    refused(
        2, [*ship, "--autopilot", schedule, "--course", "60 deg", "--input", "shaft=1 rps"], "reads no input 'shaft'"
    )
    refused(
        2, [*ship, "--autopilot", schedule, "--course", "60 deg", "--waves", "0.3 deg"], "does not say where it flows"
    )
    refused(3, [*ship, "--autopilot", schedule, "--course", "60 m"], "a course")


PLAN = "name,lat [deg],lon [deg],radius [nm],xtd_port [m],xtd_starboard [m]\nA,53.95,7.9,,,\nB,53.97,7.9,0.7,90,90\nC,53.98,7.95,,90,90\n"


def test_a_route_is_sailed(call, schedule, refused, tmp_path):
    plan, out = tmp_path / "elbe.csv", tmp_path / "voyage.csv"
    plan.write_text(PLAN)
    ship = ("simulate", "de-keizer", "--ship", "soesterberg", "--route", str(plan))
    answer = call(*ship, "--current", "1 kn to 90 deg", "-o", str(out))
    assert answer.code == 0, answer
    said = " ".join(answer.err.split())
    assert "route 'elbe': 3 waypoints, its end after" in said and "off the track: all the way" in said
    assert "before waypoint 2 'B': 71.2 deg to starboard" in said and "cross-track limits kept" in said
    trial = shipid.read_trial(out)
    assert np.rad2deg(trial.source.origin) == pytest.approx([53.95, 7.9], abs=1e-8)
    assert np.abs(trial["off_track"]).max() < 60 and set(trial["waypoint"]) == {2.0, 3.0}
    # The same under a schedule of one's own, printed.
    printed = call(*ship, "--autopilot", schedule, "--current", "1 kn to 90 deg")
    assert printed.code == 0 and printed.out.splitlines()[1].startswith("# Origin of x and y: latitude 53.95")
    refused(2, [*ship, "--heading", "10 deg"], "leave out --heading")
    refused(2, [*ship, "--manoeuvre", "turn:20"], "leave out --manoeuvre and --course")
    refused(2, [*ship, "--course", "20 deg"], "leave out --manoeuvre and --course")
    plan.write_text(PLAN.replace("53.97,7.9", "53.95,7.9"))
    refused(3, list(ship), "are one place")


def test_a_serious_warning_stands_in_the_exit_code(call, tmp_path):
    sailed = [
        "simulate",
        "de-keizer",
        "--ship",
        "soesterberg",
        "--manoeuvre",
        "zigzag:20/20",
        "-o",
        str(tmp_path / "a.csv"),
    ]
    answer = call(*sailed, "--set", "K=-1.6")
    assert answer.code == 5 and "a ship turns to port with her rudder to starboard" in answer.said
    assert call(*sailed, "--overwrite").code == 0
