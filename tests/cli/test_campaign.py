"""`shipid campaign`: a study many times, a fleet row by row, and what an interruption leaves."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time

import pytest

from shipid.foundation.exit_codes import ExitCode

STUDY = """
import time
import shipid

def throw(rng):
    time.sleep({pause})
    return {{"miss": rng.normal(), "course": rng.normal(size=4), "hit": rng.uniform() < 0.2, "word": "left"}}

darts = shipid.Campaign(
    "darts", throw,
    {{"miss": shipid.Measure("error", "m", "distance from the middle"), "course": shipid.Measure("nees", degrees=1),
     "hit": shipid.Measure("event"), "word": shipid.Measure("text")}},
    batch=5,
)
"""


@pytest.fixture
def study(tmp_path):
    def write(pause: float = 0.0):
        path = tmp_path / "study.py"
        path.write_text(STUDY.format(pause=pause))
        return path

    return write


@pytest.fixture
def fleet(tmp_path, zigzag):
    """Two trials, one with its rudder's sign turned, a broken file, and what is no trial."""
    folder = tmp_path / "trials"
    folder.mkdir()
    text = zigzag.read_text()
    (folder / "a.csv").write_text(text)
    lines = text.splitlines()
    (folder / "b.csv").write_text("\n".join(lines[:-1]) + "\n")  # one content would count once
    at = lines[1].split(",").index(next(h for h in lines[1].split(",") if h.startswith("delta ") or h == "delta [rad]"))
    turned = [line.split(",") for line in lines[2:]]
    for row in turned:
        row[at] = str(-float(row[at]))
    (folder / "turned.csv").write_text("\n".join([*lines[:2], *(",".join(r) for r in turned)]) + "\n")
    (folder / "broken.csv").write_text("t,psi\n0,what\n")
    (folder / "notes.md").write_text("# Notes\n")
    (folder / ".hidden").write_text("x")
    return folder


def test_a_study_is_run_and_kept(call, study, tmp_path):
    answer = call("campaign", f"{study()}:darts", "--runs", 23, "--seed", 4, "--out", tmp_path / "out")
    assert answer.code == ExitCode.DONE, answer
    assert "campaign darts: 23 runs, seed 4" in answer.out and "RMSE" in answer.out and "left: 23" in answer.out
    told = json.loads((tmp_path / "out" / "result.json").read_text())
    assert told["measures"]["miss"]["rmse"]["unit"] == "m" and len(told["measures"]["course"]["course"]["mean"]) == 4
    assert told["provenance"]["identity"]
    with (tmp_path / "out" / "runs.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [int(r["run"]) for r in rows] == list(range(23))
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Campaign darts" in page and "Over the run" in page and "<svg" in page


def test_runs_are_added_with_resume(call, study, tmp_path):
    path, out = study(), tmp_path / "out"
    assert call("campaign", path, "--runs", 12, "--out", out).code == 0
    again = call("campaign", path, "--runs", 40, "--out", out, "--resume", "--json")
    assert again.code == ExitCode.DONE, again
    fresh = call("campaign", path, "--runs", 40, "--json")
    assert json.loads(again.out)["measures"] == json.loads(fresh.out)["measures"]


def test_an_interrupted_campaign_loses_no_finished_run(call, study, tmp_path):
    path, out = study(0.05), tmp_path / "out"
    command = [
        sys.executable,
        "-m",
        "shipid",
        "campaign",
        str(path),
        "--runs",
        "60",
        "--out",
        str(out),
        "--workers",
        "1",
    ]
    # A test run in the background ignores Ctrl-C, and hands that on.
    heed = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)  # noqa: E731
    running = subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=os.environ, preexec_fn=heed
    )
    for _ in range(600):
        if len(list((out / "batches").glob("*.npz"))) >= 2:
            break
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=60)
    assert running.returncode == ExitCode.INTERRUPTED, said
    kept = {p.name: p.stat().st_mtime_ns for p in (out / "batches").glob("*.npz")}
    assert 2 <= len(kept) < 12
    assert f"{5 * len(kept)} of 60 runs are kept" in " ".join(said.split()) and "--resume" in said
    resumed = call("campaign", path, "--runs", 60, "--out", out, "--resume", "--json")
    assert resumed.code == ExitCode.DONE, resumed
    assert all((out / "batches" / n).stat().st_mtime_ns == stamp for n, stamp in kept.items())
    assert (
        json.loads(resumed.out)["measures"]
        == json.loads(call("campaign", path, "--runs", 60, "--json").out)["measures"]
    )


def test_a_fleet_is_a_row_a_trial(call, fleet, tmp_path):
    answer = call(
        "campaign",
        fleet,
        "--model",
        "nomoto",
        "--ship",
        "zeefakkel",
        "--starts",
        1,
        "--json",
        "--out",
        tmp_path / "out",
    )
    assert answer.code == ExitCode.DOUBTFUL, answer
    told = json.loads(answer.out)
    rows = {r["trial"]: r for r in told["trials"]}
    assert list(rows) == ["a.csv", "b.csv", "broken.csv", "turned.csv"]
    assert rows["broken.csv"]["outcome"] == "not read" and "no unit" in rows["broken.csv"]["message"]
    assert rows["broken.csv"]["doctor"] is None or rows["broken.csv"]["doctor"] != []
    assert "rudder-sign" in rows["turned.csv"]["doctor"]
    kinds = {w["kind"]: w for w in told["warnings"]}
    assert kinds["trial-faults"]["trials"] == ["turned.csv"] and kinds["not-identified"]["trials"] == ["broken.csv"]
    alone = call("identify", fleet / "a.csv", "--model", "nomoto", "--ship", "zeefakkel", "--starts", 1, "--json")
    same = json.loads(alone.out)["parameters"]["K"]
    for key in ("value", "std", "interval_95", "unit", "standing"):
        assert rows["a.csv"]["parameters"]["K"][key] == same[key], key
    assert told["coefficients"]["K"]["trials"] >= 2
    page = (tmp_path / "out" / "report.html").read_text()
    assert "turned.csv" in page and "rudder-sign" in page and "Over the trials" in page


def test_a_fleet_without_a_good_trial_says_so(call, tmp_path):
    folder = tmp_path / "f"
    folder.mkdir()
    (folder / "x.csv").write_text("nothing\n")
    answer = call("campaign", folder, "--model", "nomoto")
    assert answer.code == ExitCode.DOUBTFUL
    assert "no trial was identified" in answer.out and "not examined" in answer.out


def test_bad_requests(refused, call, study, fleet, tmp_path):
    path = study()
    refused(2, ["campaign", fleet], "say with --model what to identify")
    refused(2, ["campaign", path], "say with --runs")
    refused(2, ["campaign", path, "--runs", 3, "--model", "nomoto"], "are for a folder of trials")
    refused(2, ["campaign", path, "--runs", 3, "--resume"], "--resume goes on with the runs of --out DIR")
    refused(2, ["campaign", path, "--runs", 3, "--scheduler", "nonsense://1"], "no scheduler answers")
    refused(2, ["campaign", "song-2081"], "Did you mean song-2018")
    refused(2, ["campaign", "no-such-study", "--runs", 3], "there is no campaign 'no-such-study'")
    refused(2, ["campaign", fleet, "--model", "nomoto", "--runs", 9], "has 4 runs at most")
    (tmp_path / "empty").mkdir()
    refused(2, ["campaign", tmp_path / "empty", "--model", "nomoto"], "there are no trials in")
    assert call("campaign", path, "--runs", 3, "--out", tmp_path / "o").code == 0
    refused(2, ["campaign", path, "--runs", 3, "--out", tmp_path / "o"], "already")
    refused(2, ["campaign", path, "--runs", 3, "--seed", 1, "--out", tmp_path / "o", "--resume"], "another seed")
