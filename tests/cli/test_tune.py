"""``shipid tune``: files, JSON, comparison, and every refusal in one paragraph."""

from __future__ import annotations

import contextlib
import io
import json
import tomllib

import pytest
import tomli_w

import shipid

QUICK = ("--samples", "10", "--speeds", "7,9.5 m/s")


@pytest.fixture(scope="module")
def tuned(tmp_path_factory):
    from shipid.cli import run

    folder = tmp_path_factory.mktemp("tuned")
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert run(["tune", "de-keizer", "--ship", "soesterberg", *QUICK, "--out", str(folder / "a")]) == 0
    (folder / "printed.txt").write_text(out.getvalue(), encoding="utf-8")
    return folder / "a"


def test_three_files(tuned):
    result = json.loads((tuned / "result.json").read_text())
    assert {"speeds", "gains", "poles", "margins", "robust", "steps", "weakest", "warnings"} <= set(result)
    assert result["speeds"] == {"value": [7.0, 9.5], "unit": "m/s"} and set(result["gains"]) == {"Kp", "Kd", "Ki"}
    assert len(result["margins"]["disk"]) == 2 and {"disk_worst", "samples"} <= set(result["robust"])
    schedule = tomllib.loads((tuned / "schedule.toml").read_text())
    assert schedule["schedule"]["u"]["value"] == [7.0, 9.5]
    assert schedule["schedule"]["Kp"]["value"] == pytest.approx(result["gains"]["Kp"]["value"])
    assert result["gains"]["Kd"]["unit"] == "s" and result["limits"]["phase margin"] == {"value": 30.0, "unit": "deg"}
    assert "<!DOCTYPE html>" in (tuned / "report.html").read_text()
    assert sorted(p.name for p in tuned.iterdir()) == ["report.html", "result.json", "schedule.toml"]


def test_as_json(call):
    options = ("--design", "lqr", "--rudder-weight", "2", "--samples", "0", "--speeds", "7,9.5 m/s", "--json")
    answer = call("tune", "de-keizer", "--ship", "soesterberg", *options)
    assert answer.code == 0
    result = json.loads(answer.out)
    assert result["gains"]["Kp"]["value"][0] == pytest.approx(0.5**0.5) and result["robust"]["samples"] == 0


def test_omega_and_zeta(call):
    answer = call(
        "tune",
        "de-keizer",
        "--ship",
        "soesterberg",
        *QUICK,
        "--design",
        "pole",
        "--omega-n",
        "0.05 rad/s",
        "--zeta",
        "0.8",
        "--json",
    )
    real, imaginary = json.loads(answer.out)["poles"]["value"][1][0]
    assert real == pytest.approx(-0.04, rel=1e-12) and abs(imaginary) == pytest.approx(0.03, rel=1e-12)
    degrees = call("tune", "de-keizer", "--ship", "soesterberg", *QUICK, "--omega-n", "2.8647890 deg/s", "--json")
    assert json.loads(degrees.out)["request"]["omega_n"] == {"value": pytest.approx(0.05), "unit": "rad/s"}


def test_in_words(tuned):
    printed = (tuned.parent / "printed.txt").read_text(encoding="utf-8")
    assert "The weakest point is" in printed and "Kp [1]" in printed


def test_on_board(call, refused, tmp_path):
    ship = ("tune", "de-keizer", "--ship", "soesterberg", *QUICK)
    answer = call(*ship, "--on-board", "yaw-filter", "--adapt", "reference", "--out", str(tmp_path / "out"))
    assert answer.code == 0 and "filter yaw-filter (compass 0.2 deg, gyro 0.02 deg/s), model reference" in answer.out
    result = json.loads((tmp_path / "out" / "result.json").read_text())["on_board"]
    assert result["adaptation"] == "reference" and len(result["runs"]) == 4
    assert {"overshoot", "settling", "rms_rudder", "reversals"} <= set(result["runs"][0]["changes"][0])
    assert "On board" in (tmp_path / "out" / "report.html").read_text()
    refused(2, [*ship, "--adapt", "gains"], "give the filter by --on-board")
    refused(2, [*ship, "--on-board", "yaw-filter", "--adapt", "all"], "no adaptation 'all'")
    refused(2, [*ship, "--on-board", "yaw"], "no model 'yaw'")
    refused(2, [*ship, "--on-board", "position-filter"], "does not estimate")


def test_a_rate_of_turn(call):
    answer = call("tune", "de-keizer", "--ship", "soesterberg", *QUICK, "--mode", "rate", "--json")
    result = json.loads(answer.out)
    assert answer.code == 0 and result["mode"] == "rate" and len(result["margins"]["disk"]) == 2


def test_an_own_model_and_ship(call, refused, own_model, own_ship, tmp_path):
    out = str(tmp_path / "out")
    answer = call(
        "tune", f"{own_model()}:Yaw", "--ship", own_ship(), "--samples", "0", "--speeds", "4,5 m/s", "--out", out
    )
    assert answer.code == 0, answer
    schedule, words = tmp_path / "out" / "schedule.toml", f"{own_model()}:Yaw"
    assert shipid.read_schedule(schedule, words).model.name == "yaw"
    # The model file is code: it runs where the user names it, and not because a schedule does.
    refused(3, ["tune", "--compare", schedule, schedule], "a schedule runs none", f"shipid tune {words} --compare")
    assert call("tune", words, "--compare", schedule, schedule, "--samples", "0").code == 0


def test_two_side_by_side(call, tuned, tmp_path):
    other = str(tmp_path / "b")
    assert call("tune", "de-keizer", "--ship", "soesterberg", *QUICK, "--design", "pole", "--out", other).code == 0
    files = (str(tuned / "schedule.toml"), f"{other}/schedule.toml")
    answer = call("tune", "--compare", *files, "--samples", "10", "--out", str(tmp_path / "both"))
    assert answer.code == 0 and "least disk margin" in answer.out
    result = json.loads((tmp_path / "both" / "result.json").read_text())
    assert len(result["tunings"]) == 2 and (tmp_path / "both" / "report.html").exists()


def test_refusals(refused, tuned, tmp_path, own_ship):
    refused(2, ["tune"], "--compare with two schedules")
    refused(2, ["tune", "de-keizer"], "--ship")
    refused(2, ["tune", "de-keizr", "--ship", "soesterberg"], "de-keizer")
    refused(2, ["tune", "de-keizer", "--ship", "soesterberg", "--out", str(tuned)], "--overwrite")
    refused(2, ["tune", "de-keizer", "--ship", "soesterberg", "--design", "fuzzy"], "no design 'fuzzy'")
    refused(
        2,
        ["tune", "de-keizer", "--ship", "soesterberg", "--design", "pole", "--integral", "0.2"],
        "belongs to --design pid",
    )
    refused(2, ["tune", "de-keizer", "--ship", "soesterberg", "--rudder-weight", "2"], "belongs to --design lqr")
    refused(2, ["tune", "de-keizer", "--ship", "soesterberg", "--speeds", "fast"], "neither FROM:TO:STEP")
    refused(2, ["tune", "de-keizer", "--ship", "soesterberg", "--omega-n", "quick"], "does not start with a number")
    refused(3, ["tune", "pershitz-discrete", "--ship", "semerdjiev"], "is sampled")
    refused(4, ["tune", "de-keizer-lag", "--ship", "gunnerus", "--omega-n", "1.6 rad/s"], "is unstable")
    refused(3, ["tune", "davidson-schiff", "--ship", own_ship()], "davidson-schiff")
    schedule = str(tuned / "schedule.toml")
    refused(
        2,
        ["tune", "de-keizer", "--compare", schedule, schedule],
        "leave MODEL, --ship, --set, --input and --on-board out",
    )
    edited = tmp_path / "edited.toml"
    table = tomllib.loads((tuned / "schedule.toml").read_text())
    table["schedule"]["Kp"]["value"][0] *= -1
    edited.write_text(tomli_w.dumps(table))
    refused(3, ["tune", "--compare", schedule, str(edited)], "unstable")
