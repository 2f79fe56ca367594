"""``shipid compare`` as its user meets it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from shipid.cli import run

TRIALS = Path(__file__).resolve().parents[2] / "studies" / "trials"
ZIGZAGS = [str(TRIALS / f"container-{n}-{n}.csv") for n in (20, 10)]


def test_a_ranking_is_printed(capsys):
    assert run(["compare", *ZIGZAGS, "--models", "nomoto,norrbin", "--ship", "soesterberg", "--starts", "1"]) == 0
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


@pytest.mark.parametrize(
    ("code", "arguments", "words"),
    [
        (2, ["--models", "nomotto"], ("nomotto", "nomoto")),
        (2, ["--models", "nomoto", "--ship", "soesterburg"], ("soesterberg",)),
        (2, ["--models", "nomoto", "--starts", "0"], ("starts",)),
    ],
)
def test_refusals(capsys, code, arguments, words):
    assert run(["compare", *ZIGZAGS, *arguments]) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert all(w in captured.err for w in words)
