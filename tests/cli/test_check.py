"""shipid check: exit codes, JSON, --fix."""

from __future__ import annotations

import json

import pytest

import shipid
from shipid.cli import run


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    path = tmp_path_factory.mktemp("check") / "sound.csv"
    trial = shipid.simulate(shipid.find_model("nomoto"), "zeefakkel", "zigzag:20/20", noise="standard", seed=1)
    return shipid.write_trial(trial, path, comment="")


@pytest.fixture(scope="module")
def turned(sound):
    frame = shipid.read_trial(sound).to_frame()
    frame["delta [deg]"] *= -1
    frame["delta_order [deg]"] *= -1
    path = sound.with_name("turned.csv")
    frame.to_csv(path, index=False)
    return path


def test_sound_trial(sound, capsys):
    assert run(["check", str(sound)]) == 0
    out = capsys.readouterr().out
    assert "': usable; nothing found" in out and "zigzag 20/20" in out


def test_json_of_a_fault(turned, capsys):
    assert run(["check", str(turned), "--json"]) == 3
    told = json.loads(capsys.readouterr().out)
    found = told["findings"][0]
    assert found["kind"] == "rudder-sign" and told["verdict"] == "not usable as it is"
    assert set(found) >= {"kind", "channel", "where", "confidence", "effect", "repair"}
    assert 0.8 <= found["confidence"] <= 1 and found["fix"]["factor"] == -1
    stretch = next(m for m in told["manoeuvres"] if m["kind"] == "zigzag")
    assert set(stretch) >= {"kind", "rudder", "heading", "from", "to", "regular"}
    assert (stretch["rudder"], stretch["heading"]["value"], stretch["regular"]) == (
        {"value": 20, "unit": "deg"},
        20,
        True,
    )


def test_fix_round_trip(turned, tmp_path, capsys):
    fixed = tmp_path / "fixed.csv"
    assert run(["check", str(turned), "--fix", "-o", str(fixed)]) == 0
    capsys.readouterr()
    assert run(["check", str(fixed), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["findings"] == []
    assert run(["check", str(turned), "--fix", "-o", str(fixed)]) == 3
    assert "never overwrites" in " ".join(capsys.readouterr().err.split())


def test_several_trials_and_one_that_is_missing(sound, turned, capsys):
    assert run(["check", str(sound), str(turned), "nowhere.csv", "--json"]) == 3
    told = json.loads(capsys.readouterr().out)["trials"]
    assert [len(one["findings"]) for one in told[:2]] == [0, 1]
    assert "no file" in told[2]["error"]


def test_unreadable_file(tmp_path, capsys):
    path = tmp_path / "words.csv"
    path.write_text("no columns here\nat all\n")
    assert run(["check", str(path)]) == 3
    assert "line 1" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [["--fix"], ["-o", "x.csv"]])
def test_fix_and_output_go_together(sound, arguments, capsys):
    assert run(["check", str(sound), *arguments]) == 2
    assert "go together" in capsys.readouterr().err


def test_fix_takes_one_trial(sound, turned, capsys):
    assert run(["check", str(sound), str(turned), "--fix", "-o", "x.csv"]) == 2
    assert "one trial at a time" in " ".join(capsys.readouterr().err.split())


def test_the_ship_is_asked_for_by_name(sound, capsys):
    assert run(["check", str(sound), "--ship", "zeefakkel"]) == 0
    assert run(["check", str(sound), "--ship", "zeefakel"]) == 2
    assert "zeefakkel" in capsys.readouterr().err


def test_each_of_several_trials_is_told_of_even_where_it_was_not_read(sound, tmp_path, capsys):
    bare = tmp_path / "bare.csv"
    bare.write_text("0,1,2\n1,2,3\n", encoding="utf-8")
    assert run(["check", str(sound), str(bare)]) == 3
    said = capsys.readouterr()
    assert f"Check of '{bare}': not read" in said.out
    assert "shipid format FILE drafts one" in " ".join(said.err.split())


def test_one_sentence_stands_once_for_all_channels(tmp_path, capsys):
    log = tmp_path / "units.csv"
    rows = (f"{t},{t % 7},{t % 5},{t},{t},{t % 9}" for t in range(60))
    log.write_text("t,psi,delta,x,y,r\n" + "\n".join(rows), encoding="utf-8")
    run(["check", str(log)])
    told = capsys.readouterr().out
    assert told.count("m was assumed") == 1 and "x (90 %), y (90 %): the column says no unit" in told
