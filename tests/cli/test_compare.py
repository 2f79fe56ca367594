"""``shipid compare`` as its user meets it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from shipid.cli import run

TRIALS = Path(__file__).resolve().parents[2] / "studies" / "trials"
ZIGZAGS = [str(TRIALS / f"container-{n}-{n}.csv") for n in (20, 10)]


def test_a_ranking_is_printed(capsys):
    assert run(["compare", *ZIGZAGS, "--models", "nomoto,norrbin", "--ship", "soesterberg", "--starts", "1"]) == 0
    out = capsys.readouterr().out
    assert "to take:" in out and "nomoto" in out and "norrbin" in out


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
        (2, [], ("--models",)),
        (2, ["--models", "nomoto", "--ship", "soesterburg"], ("soesterberg",)),
        (2, ["--models", "nomoto", "--starts", "0"], ("starts",)),
    ],
)
def test_refusals(capsys, code, arguments, words):
    assert run(["compare", *ZIGZAGS, *arguments]) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert all(w in captured.err for w in words)
