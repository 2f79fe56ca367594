"""Every command that runs or designs with a ship's coefficients says where it goes beyond the range they come from."""

from __future__ import annotations

import json

import pytest

import shipid
from shipid.parameters.validity import BEYOND, UNKNOWN

SENSORS = ("--measured", "psi=0.2 deg,r=0.02 deg/s")


def test_every_command_says_it(call, tmp_path):
    """At half the speed and twice the rudder that the coefficients come from."""
    ship = ("--ship", "soesterberg")
    asked = [
        ("simulate", "de-keizer", *ship, "--manoeuvre", "turn:35", "--speed", "5 m/s", "-o", tmp_path / "turn.csv"),
        ("criteria", "de-keizer", *ship, "--speed", "5 m/s"),
        ("plan", "--model", "de-keizer", *ship, "--time", "30min", "--speed", "5 m/s", "--draws", "0", "--repertoire", "zigzag"),
        ("tune", "de-keizer", *ship, "--speeds", "4:6:1 m/s", "--rudder-limit", "30 deg", "--samples", "0"),
        ("filter", tmp_path / "turn.csv", "--model", "de-keizer", *ship),
        ("filter", tmp_path / "turn.csv", "--model", "nomoto", *ship, "--method", "rls", "--estimate", "K"),
        ("filter", "--follow", tmp_path / "turn.csv", "--wait", "0.1 s", "--model", "nomoto", *ship, *SENSORS),
        ("compare", tmp_path / "gentle.csv", "--models", "nomoto", *ship, "--starts", "1", "--validate", tmp_path / "turn.csv"),
        ("identify", tmp_path / "gentle.csv", "--model", "nomoto", *ship, "--starts", "1", "--validate", tmp_path / "turn.csv"),
    ]  # fmt: skip
    shipid.write_trial(shipid.simulate("de-keizer", "soesterberg", "zigzag:10/10"), tmp_path / "gentle.csv")
    for command in asked:
        answer = call(*command)
        said = " ".join((answer.out + answer.err).split())
        assert answer.code in (0, 5), (command, said)
        assert "The speed is" in said or "The schedule runs from" in said, (command, said)
        assert "the rudder goes to" in said.lower() or command[0] in ("identify",), (command, said)


@pytest.mark.parametrize("tail", [("--method", "rls", "--estimate", "K"), ("--wait", "0.1 s", *SENSORS), ()])
def test_a_speed_that_is_given_goes_before_that_of_the_log(call, tmp_path, tail):
    shipid.write_trial(shipid.simulate("nomoto", "soesterberg", "zigzag:10/10"), tmp_path / "log.csv")
    log = ("--follow", tmp_path / "log.csv") if "--wait" in tail else (tmp_path / "log.csv",)
    ship = ("--model", "nomoto", "--ship", "soesterberg")
    for speed, said in (("9.5 m/s", False), ("14 m/s", True)):
        answer = call("filter", *log, *ship, *tail, "--input", f"u={speed}")
        assert ("The speed is 14 m/s" in " ".join(answer.err.split())) == said, (speed, answer)


def test_one_wild_sample_is_no_amplitude_of_a_followed_log(call, tmp_path):
    shipid.write_trial(shipid.simulate("nomoto", "soesterberg", "zigzag:10/10"), tmp_path / "log.csv")
    rows = (tmp_path / "log.csv").read_text().splitlines()
    heads = next(line for line in rows if not line.startswith("#")).split(",")
    wild = rows[60].split(",")
    wild[heads.index("delta [deg]")] = "34"
    rows[60] = ",".join(wild)
    (tmp_path / "log.csv").write_text("\n".join(rows))
    answer = call(
        "filter",
        "--follow",
        tmp_path / "log.csv",
        "--wait",
        "0.1 s",
        "--model",
        "nomoto",
        "--ship",
        "soesterberg",
        *SENSORS,
    )
    assert answer.code == 0 and "The rudder goes to" not in answer.said


def test_a_trial_left_out_that_goes_beyond_the_others(call, tmp_path):
    for name in ("10/10", "20/20"):
        trial = shipid.simulate("nomoto", "soesterberg", f"zigzag:{name}")
        shipid.write_trial(trial, tmp_path / f"{name[:2]}.csv")
    answer = call(
        "compare",
        tmp_path / "10.csv",
        tmp_path / "20.csv",
        "--models",
        "nomoto",
        "--starts",
        "1",
        "--ship",
        "soesterberg",
        "--json",
    )
    (found,) = [w for w in json.loads(answer.out)["warnings"] if w["kind"] == BEYOND and w["quantity"] == "delta"]
    assert found["subject"] == "20" and "at most 10 deg" in found["message"]


def test_what_a_ship_does_not_state_is_named(call):
    """The speed of the Mariner's model tests is known, their rudder angles are not."""
    answer = call("criteria", "nomoto", "--ship", "mariner", "--speed", "5 m/s", "--json")
    found = {w["kind"]: w["message"] for w in json.loads(answer.out)["warnings"]}
    assert "range of rudder angles" in found[UNKNOWN] and "speeds" not in found[UNKNOWN]
    assert "The speed is 5 m/s" in found[BEYOND]


def test_json_has_it_in_one_list(call):
    answer = call("criteria", "de-keizer", "--ship", "soesterberg", "--speed", "5 m/s", "--json")
    found = [w for w in json.loads(answer.out)["warnings"] if w["kind"] == BEYOND]
    assert [w["quantity"] for w in found] == ["u", "delta"] and answer.code == 0
