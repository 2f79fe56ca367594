"""Every command that runs or designs with a ship's coefficients says where it goes beyond the range they come from."""

from __future__ import annotations

import json

import shipid
from shipid.parameters.validity import BEYOND


def test_every_command_says_it(call, tmp_path):
    """At half the speed and twice the rudder that the coefficients come from."""
    ship = ("--ship", "soesterberg")
    asked = [
        ("simulate", "de-keizer", *ship, "--manoeuvre", "turn:35", "--speed", "5 m/s", "-o", tmp_path / "turn.csv"),
        ("criteria", "de-keizer", *ship, "--speed", "5 m/s"),
        ("plan", "--model", "de-keizer", *ship, "--time", "30min", "--speed", "5 m/s", "--draws", "0"),
        ("tune", "de-keizer", *ship, "--speeds", "4:6:1 m/s", "--rudder-limit", "30 deg"),
        ("filter", tmp_path / "turn.csv", "--model", "de-keizer", *ship),
        ("identify", tmp_path / "gentle.csv", "--model", "nomoto", *ship, "--starts", "1", "--validate", tmp_path / "turn.csv"),
    ]  # fmt: skip
    shipid.write_trial(shipid.simulate("de-keizer", "soesterberg", "zigzag:10/10"), tmp_path / "gentle.csv")
    for command in asked:
        answer = call(*command)
        said = " ".join((answer.out + answer.err).split())
        assert answer.code in (0, 5), (command, said)
        assert "The speed is" in said or "outside the identified range" in said, (command, said)
        assert "The rudder goes to" in said or command[0] in ("identify",), (command, said)


def test_json_has_it_in_one_list(call):
    answer = call("criteria", "de-keizer", "--ship", "soesterberg", "--speed", "5 m/s", "--json")
    found = [w for w in json.loads(answer.out)["warnings"] if w["kind"] == BEYOND]
    assert [w["quantity"] for w in found] == ["u", "delta"] and answer.code == 0
