from __future__ import annotations

import sys

import pytest

from shipid.foundation.processes.apart import NotStartedError, run_apart

ECHO = "import sys\nsys.stdout.write('\\n')\nsys.stdout.flush()\n"


def script(folder, text):
    path = folder / "script.py"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_script_answers_and_knows_the_packages_of_this_process(tmp_path):
    text = ECHO + "import numpy, os\nsys.stdout.write(sys.argv[1] + sys.stdin.read() + os.environ['SAID'])"
    assert run_apart(script(tmp_path, text), ["a"], b"b", longest=60, surroundings={"SAID": "c"}) == b"abc"


def test_a_crash_and_a_hang_end_that_process_only(tmp_path):
    assert (
        run_apart(
            script(tmp_path, ECHO + "sys.stdout.write('x'); sys.stdout.flush(); import os; os.abort()"), [], longest=60
        )
        == b"x"
    )
    assert run_apart(script(tmp_path, ECHO + "import time; time.sleep(600)"), [], longest=2) == b""


def test_a_process_that_does_not_start(tmp_path, monkeypatch):
    with pytest.raises(NotStartedError, match="exit code 3"):
        run_apart(script(tmp_path, "raise SystemExit(3)"), [], longest=60)
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(NotStartedError, match="No such file"):
        run_apart(script(tmp_path, ECHO), [], longest=60)
