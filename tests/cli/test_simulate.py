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
    assert "autopilot (pole) ordered 30 deg at 60 s" in answer.err.replace("\n", " ")


def test_one_course_and_a_value(call, schedule):
    arguments = ("simulate", "de-keizer", "--ship", "soesterberg", "--autopilot", schedule, "--course", "60 deg")
    usual, slow = call(*arguments), call(*arguments, "--set", "K=0.8 1")
    assert usual.code == slow.code == 0
    assert usual.out != slow.out and usual.out.splitlines()[0].startswith("# Simulated, not measured")


def test_refusals(refused, schedule):
    ship = ["simulate", "de-keizer", "--ship", "soesterberg"]
    refused(2, ship, "--manoeuvre, or an --autopilot")
    refused(
        2,
        [*ship, "--manoeuvre", "turn:20", "--autopilot", schedule, "--course", "60 deg"],
        "--manoeuvre, or an --autopilot",
    )
    refused(2, [*ship, "--autopilot", schedule], "needs a --course")
    refused(2, [*ship, "--manoeuvre", "turn:20", "--course", "60 deg"], "belong to --autopilot")
    refused(2, [*ship, "--autopilot", schedule, "--course", "60 deg", "--course", "9 deg"], "each has its time")
    refused(
        2, [*ship, "--autopilot", schedule, "--course", "60 deg", "--input", "shaft=1 rps"], "reads no input 'shaft'"
    )
    refused(
        2, [*ship, "--autopilot", schedule, "--course", "60 deg", "--waves", "0.3 deg"], "does not say where it flows"
    )
    refused(3, [*ship, "--autopilot", schedule, "--course", "60 m"], "a course")
