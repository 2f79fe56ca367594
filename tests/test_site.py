"""The pages of the documentation site: what their examples print is what shipid prints."""

from __future__ import annotations

import doctest
import importlib
import re
import shlex
import sys
from pathlib import Path

import pytest

from shipid.cli import run

PAGES = Path(__file__).resolve().parents[1] / ".docs"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")


class Checker(doctest.OutputChecker):
    """Compares words exactly and decimal numbers to one per cent.

    The last digits of an estimate depend on the processor; the noise of the example trial, which is seeded, does not.
    """

    def check_output(self, want: str, got: str, optionflags: int) -> bool:
        wanted, printed = NUMBER.findall(want), NUMBER.findall(got)
        near = [float(g) == pytest.approx(float(w), rel=0.01) for w, g in zip(wanted, printed, strict=False)]
        words = super().check_output(NUMBER.sub("#", want), NUMBER.sub("#", got), optionflags)
        return words and len(wanted) == len(printed) and all(near)


def session(text: str, names: dict[str, object]) -> None:
    """Run a Python session as doctest does; its names stay for the next one."""
    example = doctest.DocTestParser().get_doctest(text, {}, "page", None, None)
    example.globs = names
    runner = doctest.DocTestRunner(Checker(), optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    report: list[str] = []
    runner.run(example, out=report.append, clear_globs=False)
    assert not report, "".join(report)


def commands(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Run the commands of a console, each behind a dollar sign, and compare what they print."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        line, _, want = part.partition("\n")
        program, *arguments = shlex.split(line)
        assert program == "shipid"
        assert run(arguments) == 0, capsys.readouterr().err
        assert capsys.readouterr().out == want


def test_declaring_a_model(tmp_path, monkeypatch, capsys):
    """Write the files of the page, run its sessions and commands in its order."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    names: dict[str, object] = {}
    kinds = []
    for kind, text in BLOCK.findall((PAGES / "model.md").read_text(encoding="utf-8")):
        kinds.append(kind)
        if kind in ("python", "toml"):
            name = re.match(r"# (\S+)\n", text)
            assert name, f"a block begins with the name of its file: {text}"
            Path(name[1]).write_text(text, encoding="utf-8")
            importlib.invalidate_caches()
        elif kind == "pycon":
            session(text, names)
        elif kind == "console":
            commands(text, capsys)
    assert kinds.count("pycon") >= 5 and {"python", "toml", "console"} <= set(kinds)
    for module in ("yaw", "surge"):
        sys.modules.pop(module)
