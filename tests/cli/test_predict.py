from __future__ import annotations

import dataclasses
import json
import re

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.trial_situation import logged_inputs


@pytest.fixture(scope="module")
def voyage(tmp_path_factory):
    """A course change in a current, as a log."""
    pilot = shipid.design_autopilot("de-keizer", "soesterberg")
    trial = sail(pilot, [(300, "60 deg")], noise="standard", current=("1 m/s", "90 deg"), duration=700)
    path = tmp_path_factory.mktemp("voyage") / "voyage.csv"
    shipid.write_trial(trial, path)
    return path


def test_a_track_from_a_state(call):
    answer = call(
        "predict", "de-keizer", "--ship", "soesterberg", "--from", "psi=350 deg,u=9 m/s", "--heading", "60 deg"
    )
    assert answer.code == 0, answer
    assert "heading 350.0 deg, forward speed 9 m/s" in answer.out and "on the new heading" in answer.out
    assert "the band is not known" in answer.out


def test_what_sets_the_ship_and_which_way_ahead_is(call, tmp_path):
    """In a strong current 'to starboard' is not counted from the heading; the wind that was given is told as the current is."""
    order = ("predict", "de-keizer", "--ship", "soesterberg", "--from", "psi=350 deg,u=9 m/s", "--heading", "10 deg")
    said = call(*order, "--current", "12 kn to 90 deg", "--wind", "12 m/s from 90 deg", "--out", str(tmp_path / "p"))
    for line in (
        "current 6.17 m/s to 090 deg",
        "wind 12 m/s from 090 deg",
        "along the course over the ground, 027.5 deg",
    ):
        assert line in said.out
    assert (
        "ahead and aside are told along the course over the ground, 027.5 deg"
        in (tmp_path / "p" / "report.html").read_text().lower()
    )
    assert "ahead and aside" not in call(*order).out


def test_a_track_from_a_trial_uses_nothing_later(call, voyage, tmp_path):
    order = ("--heading", "60 deg", "--json")
    whole = call("predict", "de-keizer", "--ship", "soesterberg", "--from", f"{voyage}@300", *order)
    assert whole.code == 0, whole
    lines = voyage.read_text().splitlines()
    cut = tmp_path / "voyage.csv"
    head = [line for line in lines if not line[:1].isdigit()]
    cut.write_text(
        "\n".join([*head, *(line for line in lines if line[:1].isdigit() and float(line.split(",")[0]) <= 300)])
    )
    before = call("predict", "de-keizer", "--ship", "soesterberg", "--from", str(cut), *order)
    one, other = json.loads(whole.out), json.loads(before.out)
    np.testing.assert_allclose(
        one["prediction"]["track"]["x"]["values"], other["prediction"]["track"]["x"]["values"], atol=1e-6
    )
    # What is predicted is what was sailed: within its band nearly everywhere.
    truth = shipid.read_trial(voyage).table
    rows = truth["t"] >= 300
    end = one["stages"][-1]
    assert end["half_width_95"]["value"] > 20
    t = np.array(one["prediction"]["track"]["t"]["values"]) + 300
    x = np.interp(600, t, one["prediction"]["track"]["x"]["values"])
    assert x == pytest.approx(np.interp(600, truth["t"][rows], truth["x"][rows]), abs=150)
    assert one["situation"]["current_east"]["value"] == pytest.approx(1.0, abs=0.4)
    assert one["origin"] == "trial voyage at 300 s"
    # The interval of the current is one, wherever it stands; and what widens the band is there as numbers.
    assert one["situation"]["current_east"]["std"] == one["current"]["east"]["std"] > 0.3
    past = one["past_predictions"]
    assert past["predictions"] > 0 and past["lost"] == 0 and min(past["track_factors"]) >= 1
    assert len(past["ship_lengths"]) == len(past["track_factors"]) == len(past["heading_factors"])
    assert one["prediction"]["grown"] == 1.0


def test_its_files(call, voyage, tmp_path):
    out = tmp_path / "predicted"
    answer = call(
        "predict",
        "de-keizer",
        "--ship",
        "soesterberg",
        "--from",
        f"{voyage}@300",
        "--rudder",
        "10 deg",
        "--out",
        str(out),
    )
    assert answer.code == 0, answer
    table = pd.read_csv(out / "track.csv")
    assert {"x [m]", "psi [deg]", "half width of the 95 % band [m]"} <= set(table)
    page = (out / "report.html").read_text()
    for word in (
        "Predicted track of soesterberg",
        "Stages",
        "95 % band",
        "to starboard",
        "Where it begins",
        "Current to the east",
    ):
        assert word in page
    said = next(line.strip() for line in answer.out.splitlines() if line.strip().startswith("current "))
    assert said[1:] in page
    # What it begins from has the same digits on the terminal.
    start = next(line for line in answer.out.splitlines() if "forward speed" in line)
    for what in ("Heading", "Forward speed", "Rate of turn"):
        value, std = re.search(rf"{what}</th>.*?>([^<]*)</td>.*?>([^<]*)</td>", page).groups()
        assert f"{what.lower()} {value.replace(chr(0x2212), '-')} ± {std} " in start
    assert "nan" not in page.lower().replace("dominant", "")
    # A value has the digits that its standard deviation allows.
    cell = r'<td class="n" data-label="(?:Value|Standard deviation)">([^<]*)</td>'
    pairs = re.findall(cell + cell, page)
    assert len(pairs) > 5
    for value, std in pairs:
        if std != "taken as known":
            assert len(value.partition(".")[2]) == len(std.partition(".")[2]), (value, std)


def test_a_track_that_leaves_the_model_is_doubtful(call):
    state = "psi=0 deg,u=9.5 m/s,K_u=0.9 1"
    answer = call(
        "predict",
        "de-keizer",
        "--ship",
        "soesterberg",
        "--from",
        state,
        "--rudder",
        "35 deg",
        "--horizon",
        "40",
        "--json",
    )
    assert answer.code == 5
    told = json.loads(answer.out)["warnings"]
    assert [w["kind"] for w in told if w["serious"]] == ["outside-the-model"]


def test_wind_current_and_schedule(call, tmp_path):
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", damping=0.7)
    shipid.write_schedule(pilot, tmp_path / "schedule.toml")
    answer = call(
        "predict", "de-keizer", "--ship", "soesterberg", "--schedule", str(tmp_path / "schedule.toml"), "--heading", "60 deg",
        "--current", "2 kn to 90 deg", "--wind", "10 m/s from 300 deg", "--rudder-limit", "12 deg", "--band", "none", "--json",
    )  # fmt: skip
    told = json.loads(answer.out)
    assert told["prediction"]["current_east"]["value"] == pytest.approx(2 * 1852 / 3600)
    delta = np.rad2deg(told["prediction"]["track"]["delta"]["values"])
    assert np.abs(delta).max() == pytest.approx(12, abs=0.01)
    # Wind from the port quarter needs rudder to hold the course.
    assert abs(delta[-1]) > 0.2


def test_waves_make_a_state_that_is_read_uncertain(call):
    ship = [
        "predict",
        "de-keizer",
        "--ship",
        "soesterberg",
        "--from",
        "psi=40 deg,u=9 m/s",
        "--rudder",
        "10 deg",
        "--json",
    ]
    widths = [
        json.loads(call(*ship, *waves).out)["prediction"]["half_width_95"]
        for waves in ([], ["--waves", "0.5 deg from 300 deg"], ["--waves", "1 deg from 300 deg"])
    ]
    assert widths[0] is None
    assert (
        widths[2]["values"][-1] == pytest.approx(2 * widths[1]["values"][-1], rel=0.01) and widths[1]["values"][-1] > 1
    )


def test_refusals(refused, voyage):
    ship = ["predict", "de-keizer", "--ship", "soesterberg"]
    refused(2, ship, "--heading, --rudder, --rate or --route")
    refused(2, [*ship, "--heading", "60 deg", "--rudder", "5 deg"], "not heading with a rudder")
    refused(2, [*ship, "--heading", "60 deg", "--from", "psi=10 deg,speed=9 m/s"], "speed")
    refused(2, [*ship, "--heading", "60 deg", "--from", "psi=10 deg,u=0 m/s"], "makes none")
    refused(2, [*ship, "--heading", "60 deg", "--from", f"{voyage}@3"], "too few for a filter")
    refused(2, [*ship, "--heading", "60 deg", "--from", f"{voyage}@9999"], "is not in it")
    refused(2, [*ship, "--heading", "60 deg", "--from", f"{voyage}@0"], "has 1 samples up to 0 s", "give a later time")
    refused(2, [*ship, "--heading", "60 deg", "--from", f"{voyage}@1.2.3"], "no time in s")
    refused(2, [*ship, "--heading", "60 deg", "--from", f"{voyage}@noon"], "'noon' is no time in s")
    refused(
        2,
        [*ship, "--heading", "60 deg", "--from", f"{voyage}@300", "--current", "1 kn to 0 deg"],
        "leave --current out",
    )
    waves = ["--waves", "0.5 deg from 300 deg"]
    refused(2, [*ship, "--heading", "60 deg", "--from", f"{voyage}@300", *waves], "leave --waves out")
    refused(2, [*ship, "--heading", "60 deg", *waves], "give it in the state")
    refused(2, [*ship, "--heading", "60 deg", "--horizon", "0"], "ship lengths")
    refused(2, [*ship, "--heading", "60 m"], "heading")


def test_a_shaft_speed_that_the_trial_records_is_held(call, own_model, own_ship, tmp_path):
    """It was refused as one that nothing states; one that is stated goes before it."""
    shaft = '    n = given("1/s", "propeller revolutions")\n    n_0 = constant("1/s", "revolutions of K", default="2 rps")\n'
    model = own_model(
        ("import Component,", "import Component, constant,"),
        ("    K = parameter", shaft + "    K = parameter"),
        ("self.K * self.delta", "self.K * self.n / self.n_0 * self.delta"),
    )
    log = tmp_path / "log.csv"
    named = (f"{model}:Yaw", "--ship", str(own_ship()))
    sailed = ("--manoeuvre", "zigzag:10/10", "--noise", "standard", "--duration", "120 s", "--input", "n=2 rps")
    assert call("simulate", *named, *sailed, "-o", str(log)).code == 0
    asked = ("predict", *named, "--from", f"{log}@80", "--rudder", "10 deg", "--band", "none", "--json")
    held, stated = call(*asked), call(*asked, "--input", "n=4 rps")
    assert held.code == 0 and "n stays at 120 rpm, as it was logged last." in held.out
    # Twice the revolutions turn her twice as fast in the end.
    rates = [json.loads(a.out)["prediction"]["track"]["r"]["values"][-1] for a in (held, stated)]
    assert rates[1] == pytest.approx(2 * rates[0], rel=0.05)


def test_a_shaft_speed_that_varied_is_told():
    model = shipid.find_model("mmg-revolutions")
    t = np.arange(0.0, 20.0)
    log = shipid.Trial("log", pd.DataFrame({"t": t, "n": 1.0 + 0.1 * t, "delta": 0 * t, "u": 0 * t + 1}))
    held, told = logged_inputs(model, log, 10.0)
    assert held == {
        "n": 2.0
    } and "n stays at 120 rpm, as it was logged last; before that it went from 60 rpm to 120" in str(told[0])
    assert logged_inputs(model, log, 10.0, ["n"]) == ({}, [])


@pytest.fixture(scope="module")
def schedules(tmp_path_factory):
    """A schedule by design, and one whose gains are a thousand times as high."""
    pilot = shipid.design_autopilot("de-keizer", "soesterberg")
    gains = {name: 1000 * values for name, values in pilot.schedule.gains.items()}
    high = dataclasses.replace(pilot, schedule=dataclasses.replace(pilot.schedule, gains=gains))
    folder = tmp_path_factory.mktemp("schedules")
    shipid.write_schedule(pilot, folder / "sound.toml")
    shipid.write_schedule(high, folder / "high.toml")
    return folder


def test_a_schedule_whose_loop_cycles_is_told(call, schedules, tmp_path):
    """Its gains are far beyond what the steering gear can follow; the track of its mean rudder looked as any other."""
    order = ("predict", "de-keizer", "--ship", "soesterberg", "--from", "psi=0 deg,u=9 m/s")
    (tmp_path / "route.csv").write_text("x [m],y [m]\n0,0\n3000,0\n5000,2000\n")
    said = "the loop cycles, since the gains of the autopilot are too high for this steering gear"
    high, page = ("--schedule", str(schedules / "high.toml")), tmp_path / "out"
    answer = call(*order, *high, "--heading", "20 deg", "--out", str(page))
    assert said in " ".join(answer.out.split()) and said in " ".join((page / "report.html").read_text().split())
    found = json.loads(call(*order, *high, "--route", str(tmp_path / "route.csv"), "--json").out)
    (notice,) = [n for n in found["warnings"] if n["kind"] == "rudder-cycles"]
    assert notice["serious"] and said in notice["message"]
    # A rudder that is held is steered by no loop, and sound gains cycle nowhere.
    assert said not in " ".join(call(*order, *high, "--rudder", "5 deg").out.split())
    sound = call(*order, "--schedule", str(schedules / "sound.toml"), "--heading", "20 deg")
    assert sound.code == 0 and "cycles" not in sound.out
