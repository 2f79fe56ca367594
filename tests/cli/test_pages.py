"""Commands that write a page beside their result, and what the page says of how it was made."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from shipid.cli import run
from shipid.identification.choice import side_by_side

TRIALS = Path(__file__).resolve().parents[2] / "studies" / "trials"
ZIGZAGS = [str(TRIALS / f"container-{n}-{n}.csv") for n in (20, 10)]


@pytest.mark.parametrize(
    "arguments",
    [
        ["check", ZIGZAGS[0]],
        ["criteria", "nomoto", "--ship", "soesterberg"],
        ["plan", "--model", "nomoto", "--ship", "soesterberg", "--time", "15 min", "--draws", "0"],
        ["compare", *ZIGZAGS, "--models", "nomoto,norrbin", "--ship", "soesterberg", "--starts", "1"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_page_tells_the_command_that_made_it(arguments, tmp_path, capsys, monkeypatch):
    # Candidates are tried in this process: a worker loads the toolbox anew, for longer than it tries them.
    monkeypatch.setattr(side_by_side, "processors", lambda: 1)
    assert run([*arguments, "--out", str(tmp_path / "out")]) in (0, 5)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert f" by shipid {arguments[0]} " in re.sub("<[^>]*>", "", page)
    assert json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))["command"] == arguments[0]
    assert "<svg" in page


def test_trials_that_cannot_be_read_stand_on_the_page(tmp_path, capsys):
    assert run(["check", ZIGZAGS[0], str(tmp_path / "torn.csv"), "--out", str(tmp_path / "out")]) == 3
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "not read" in page and "One file could not be read" in page


def test_a_pdf_needs_a_folder(capsys):
    assert run(["check", ZIGZAGS[0], "--pdf"]) == 2
    assert "--pdf prints the report of --out DIR" in capsys.readouterr().err


def test_a_machine_without_a_browser_is_told_before_the_work(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("shipid.report.pdf._PROGRAMS", ())
    monkeypatch.setattr("shipid.report.pdf._PLACES", ())
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert run(["check", ZIGZAGS[0], "--pdf", "--out", str(tmp_path / "out")]) != 0
    assert "Chromium, Chrome or Edge" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_browser_that_prints_nothing_is_told(tmp_path):
    from shipid.report.pdf import PdfError, write_pdf

    false = tmp_path / "chromium"
    false.write_text("#!/bin/sh\necho broken >&2\n", encoding="utf-8")
    false.chmod(0o755)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", str(tmp_path), prepend=":")
        with pytest.raises(PdfError, match="did not print the page: broken"):
            write_pdf(tmp_path / "page.html", tmp_path / "page.pdf")
