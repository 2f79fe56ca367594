"""What is written, where, and what is left behind when it cannot be."""

import json
import os

import pytest

import shipid

FILES = {"result.json", "ship.toml", "report.html"}


@pytest.mark.usefixtures("undrawn")
def test_results_are_not_overwritten_without_being_asked(call, refused, short, fitted, tmp_path):
    out = tmp_path / "result"
    arguments = ["identify", short, *fitted, "--out", out]
    first = call(*arguments)
    assert first.code == 0
    assert {p.name for p in out.iterdir()} == FILES
    assert str(out / "ship.toml") in first.out
    (out / "report.html").write_text("mine")
    refused(2, arguments, "result.json, ship.toml, report.html", "--overwrite")
    assert (out / "report.html").read_text() == "mine"
    assert call(*arguments, "--overwrite").code == 0
    assert (out / "report.html").read_text().startswith("<!")
    assert {p.name for p in out.iterdir()} == FILES


def test_a_dash_is_standard_output_or_refused(call, refused, zigzag, fitted, tmp_path, monkeypatch):
    """As for other programs; never a file of that name."""
    monkeypatch.chdir(tmp_path)
    for arguments in (
        ["format", zigzag],
        ["ship", "--new", "tender", "--length", "24 m"],
        ["simulate", "nomoto", "--ship", "zeefakkel", "--manoeuvre", "zigzag:20/20", "--duration", "60 s"],
    ):
        written, plain = call(*arguments, "-o", "-"), call(*arguments)
        assert (written.code, written.out) == (0, plain.out)
        assert len(plain.out) > 100
    refused(2, ["check", zigzag, "--fix", "-o", "-"], "'-' is standard output")
    refused(2, ["check", zigzag, "--out", "-"], "--out names a folder")
    assert list(tmp_path.iterdir()) == []


def test_other_files_in_the_folder_are_left_alone(call, zigzag, fitted, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert call("identify", zigzag, *fitted, "--out", tmp_path).code == 0
    assert {p.name for p in tmp_path.iterdir()} == FILES | {"notes.txt"}


def test_folder_that_is_a_file(refused, zigzag, fitted, tmp_path):
    there = tmp_path / "there"
    there.write_text("mine")
    refused(2, ["identify", zigzag, *fitted, "--out", there], "there is a file", "folder")
    refused(2, ["identify", zigzag, *fitted, "--out", there / "below"], "there is a file")
    assert there.read_text() == "mine"


def test_folder_that_cannot_be_written(refused, zigzag, fitted, tmp_path):
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o555)
    if os.access(locked, os.W_OK):
        pytest.skip("this user may write everywhere")
    refused(2, ["identify", zigzag, *fitted, "--out", locked], "locked cannot be written to")
    refused(2, ["identify", zigzag, *fitted, "--out", locked / "below"], "locked cannot be written to")


def test_folder_that_the_system_refuses(refused, zigzag, fitted, tmp_path, monkeypatch):
    """Found out before the fit, also by a user whom no permission stops."""
    monkeypatch.setattr(os, "access", lambda *_, **__: False)
    refused(2, ["identify", zigzag, *fitted, "--out", tmp_path / "out"], "cannot be written to", "another --out")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("failing", ["bad data", "writing", "interrupted"])
@pytest.mark.usefixtures("undrawn")
def test_nothing_half_written(call, short, fitted, tmp_path, monkeypatch, failing):
    import shipid.report.write_report

    def fail(*_, **__):
        raise KeyboardInterrupt if failing == "interrupted" else OSError(28, "No space left on device")

    out = tmp_path / "out"
    arguments = ["identify", short, *fitted, "--out", out]
    if failing == "bad data":
        arguments += ["--window", "0:5"]
    else:
        monkeypatch.setattr(shipid.report.write_report, "write_report", fail)
    answer = call(*arguments)
    assert answer.code == (130 if failing == "interrupted" else 3)
    # What was computed is printed where it could not be written.
    assert ("K" in answer.out and "tau" in answer.out) if failing == "writing" else answer.out == ""
    assert answer.err.strip().startswith("shipid: ")
    assert not out.exists() or list(out.iterdir()) == []


@pytest.mark.usefixtures("undrawn")
def test_interrupted_while_it_overwrites(call, short, fitted, tmp_path, monkeypatch):
    """Old results stay whole until new ones are whole."""
    import shipid.report.write_report

    out = tmp_path / "out"
    assert call("identify", short, *fitted, "--out", out).code == 0
    before = {p.name: p.read_bytes() for p in out.iterdir()}

    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(shipid.report.write_report, "write_report", interrupt)
    assert call("identify", short, *fitted, "--fix", "K=0.4 1/s", "--out", out, "--overwrite").code == 130
    assert {p.name: p.read_bytes() for p in out.iterdir()} == before


def test_simulated_trial_is_not_overwritten(call, refused, tmp_path):
    path = tmp_path / "trial.csv"
    arguments = ["simulate", "nomoto", "--ship", "zeefakkel", "--manoeuvre", "turn:20", "-o", path]
    path.write_text("mine")
    refused(2, arguments, "trial.csv exists already", "--overwrite")
    assert path.read_text() == "mine"
    answer = call(*arguments, "--overwrite")
    assert (answer.code, answer.out) == (0, "")
    assert path.read_text().startswith("# Simulated, not measured")
    refused(3, [*arguments[:-1], tmp_path], "is a folder")
    refused(3, [*arguments[:-1], tmp_path / "none" / "trial.csv"], "there is no folder")


def test_trial_on_stdout(call, tmp_path):
    answer = call("simulate", "de-keizer", "--ship", "soesterberg", "--manoeuvre", "turn:10")
    assert (answer.code, answer.err) == (0, "")
    (tmp_path / "trial.csv").write_text(answer.out)
    trial = shipid.read_trial(tmp_path / "trial.csv")
    assert trial.source.simulated
    assert trial.has("psi", "r", "u", "x", "y", "delta")


@pytest.mark.parametrize(
    "name", ["a trial with spaces.csv", "Versuch é 日本.csv", "<script>alert(1)<.csv", "a'b\"c&.csv"]
)
def test_name_of_a_trial(call, short, fitted, tmp_path, name):
    log = tmp_path / name
    log.write_text(short.read_text())
    out = tmp_path / "out"
    answer = call("identify", log, *fitted, "--json", "--out", out)
    assert answer.code == 0
    assert list(json.loads(answer.out)["fit"]) == [log.stem]
    assert "<script>alert" not in (out / "report.html").read_text(encoding="utf-8")
    assert call("simulate", "nomoto", "--ship", out / "ship.toml", "--manoeuvre", "turn:20").code == 0
