"""``shipid report`` as a surveyor calls it."""

from __future__ import annotations

import json

import shipid
from shipid.cli import run


def test_a_folder_with_the_sheet_and_its_conditions(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, manoeuvre in (("ten", "zigzag:10/10"), ("turn", "turn:35")):
        shipid.write_trial(shipid.simulate("de-keizer", ship="soesterberg", manoeuvre=manoeuvre), f"{name}.csv")
    (tmp_path / "day.toml").write_text('[trial]\nlength = "226 m"\nwho = "Trial party"\n', encoding="utf-8")
    assert run(["report", "ten.csv", "turn.csv", "--conditions", "day.toml", "--out", "sheet"]) == 0
    told = json.loads((tmp_path / "sheet" / "result.json").read_text(encoding="utf-8"))
    assert told["length"] == {"value": 226, "unit": "m"} and told["conditions"]["who"] == "Trial party"
    assert [m["kind"] for m in told["manoeuvres"]] == ["zig-zag", "turning circle"]
    page = (tmp_path / "sheet" / "report.html").read_text(encoding="utf-8")
    assert "Trial party" in page and "10/10 second overshoot" in page
    assert "tactical diameter" in capsys.readouterr().out


def test_a_day_that_was_partly_unreadable_ends_in_doubt(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    day = tmp_path / "day"
    (day / "photos").mkdir(parents=True)
    (day / "photos" / "bow.jpg").write_text("x")
    (day / "day.toml").write_text("[trial]\n")
    shipid.write_trial(shipid.simulate("de-keizer", ship="soesterberg", manoeuvre="zigzag:10/10"), day / "ten.csv")
    (day / "torn.csv").write_text("t [s],psi [deg]\n0,x\n", encoding="utf-8")
    assert run(["report", "day", "--length", "226 m"]) == 5
    told = capsys.readouterr()
    assert "1. zig-zag 10/10" in told.out and "not measured: day/torn.csv" in told.out and "day.toml" not in told.out
    assert "folders in it are not read, give them each by itself: photos" in told.err


def test_a_folder_without_a_log_is_told(tmp_path, capsys):
    assert run(["report", str(tmp_path)]) == 3
    assert "there are no trials in" in capsys.readouterr().err


def test_conditions_that_are_not_there_are_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shipid.write_trial(shipid.simulate("de-keizer", ship="soesterberg", manoeuvre="zigzag:10/10"), "ten.csv")
    assert run(["report", "ten.csv", "--conditions", "day.toml"]) != 0
    assert "day.toml" in capsys.readouterr().err
