"""``shipid compare`` as its user meets it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from shipid.cli import run
from shipid.identification.choice import side_by_side

TRIALS = Path(__file__).resolve().parents[2] / "studies" / "trials"
ZIGZAGS = [str(TRIALS / f"container-{n}-{n}.csv") for n in (20, 10)]
#: Two swings, where a command is tried and not a choice.
SHORT = [f"{path}@0:300" for path in ZIGZAGS]


@pytest.fixture
def here(monkeypatch):
    """Candidates tried in this process: a worker loads the toolbox anew, for longer than it tries them."""
    monkeypatch.setattr(side_by_side, "processors", lambda: 1)


@pytest.mark.usefixtures("here")
def test_a_ranking_is_printed(capsys):
    assert run(["compare", *SHORT, "--models", "nomoto,norrbin", "--ship", "soesterberg", "--starts", "1"]) == 0
    out = capsys.readouterr().out
    assert "to take:" in out and "nomoto" in out and "norrbin" in out


def test_a_record_that_shows_nothing_determines_nothing(tmp_path, capsys):
    """Rudder and rate of turn without coherence: no model is named, and the exit code says so."""
    random = np.random.default_rng([4, 2])
    rows = np.column_stack([np.arange(600.0), random.normal(0, 5, 600), random.normal(0, 0.2, 600)])
    path = tmp_path / "noise.csv"
    np.savetxt(path, rows, delimiter=",", header="t [s],delta [deg],r [deg/s]", comments="", fmt="%.4f")
    assert run(["compare", str(path), "--models", "nomoto", "--starts", "1", "--json"]) == 5
    result = json.loads(capsys.readouterr().out)
    assert result["best"] is None and "not-determined" in {w["kind"] for w in result["warnings"]}


def test_what_was_found_of_trials_kept_apart_is_printed(capsys):
    arguments = ["compare", ZIGZAGS[0], "--models", "nomoto", "--ship", "soesterberg", "--starts", "1"]
    assert run([*arguments, "--validate", ZIGZAGS[1]]) == 0
    out = capsys.readouterr().out
    assert "predictions of container-10-10, which was kept apart and does not count" in out
    assert "Too poor a campaign to choose by" in out and "A second trial is missing" in out


def test_json_is_one_object(capsys):
    arguments = ["compare", ZIGZAGS[0], "--models", "nomoto", "--ship", "soesterberg", "--starts", "1", "--json"]
    assert run([*arguments, "--validate", ZIGZAGS[1]]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["best"] == "nomoto"
    assert set(result["ranking"][0]["validation"]) == {"container-10-10"}


def test_an_input_is_held_in_the_candidates_that_read_it(capsys, monkeypatch):
    """A speed log that a model of the speed reads and the other states; the candidates are tried in this process, then by workers."""
    trial = ["compare", SHORT[0], "--models", "nomoto,de-keizer", "--ship", "soesterberg", "--starts", "1", "--json"]
    shares = []
    for processors, arguments in ((1, trial), (2, [*trial, "--input", "u=9.5 m/s"])):
        monkeypatch.setattr(side_by_side, "processors", lambda count=processors: count)
        assert run(arguments) == 0
        shares.append({one["model"]: one["error"] for one in json.loads(capsys.readouterr().out)["ranking"]})
    assert shares[0]["de-keizer"] == shares[1]["de-keizer"]
    assert shares[0]["nomoto"] != shares[1]["nomoto"]


@pytest.mark.parametrize(
    ("code", "arguments", "words"),
    [
        (2, ["--models", "nomotto"], ("nomotto", "nomoto")),
        (2, ["--models", "nomoto", "--ship", "soesterburg"], ("soesterberg",)),
        (2, ["--models", "nomoto", "--starts", "0"], ("starts",)),
        (2, ["--models", "nomoto,norrbin", "--input", "n=2 rps"], ("no candidate reads", "'n'", "current_north")),
        (2, ["--models", "nomoto", "--input", "n=2 rps"], ("nomoto reads no input 'n'",)),
        (2, ["--models", "nomoto", "--input", "current_north=2"], ("current_north", "unit")),
        (2, ["--models", "nomoto", "--input", "K=0.1 1/s"], ("value of the ship", "--set")),
    ],
)
def test_refusals(capsys, code, arguments, words):
    assert run(["compare", *ZIGZAGS, *arguments]) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert all(w in captured.err for w in words)
