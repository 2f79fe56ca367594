"""Machines that lack something: a compiler, a cache, a reader of the output, patience."""

import json
import os
import subprocess
import sys

import pytest

COMMAND = (sys.executable, "-m", "shipid")


def environment(**changes: str) -> dict[str, str]:
    return {**os.environ, **changes}


@pytest.mark.parametrize("lack", ["compiler", "cache folder"])
def test_without_a_compiler_or_a_cache(call, zigzag, fitted, tmp_path, lack):
    """One notice, the same numbers."""
    wall = tmp_path / "wall"
    wall.write_text("a file where a folder should be")
    changes = {"PATH": str(tmp_path), "CC": ""} if lack == "compiler" else {"SHIPID_CACHE": str(wall / "cache")}
    words = "no C compiler found" if lack == "compiler" else "Nothing is kept between runs"
    arguments = ["identify", f"{zigzag}@0:100", *fitted, "--json"]
    done = subprocess.run(
        [*COMMAND, *arguments], capture_output=True, text=True, env=environment(**changes), cwd=tmp_path
    )
    assert done.returncode == 0
    assert done.stderr.count("shipid: ") == 1
    assert words in " ".join(done.stderr.split())
    assert ".py" not in done.stderr
    if lack == "compiler":
        # What is not compiled: this process has compiled it already.
        usual = environment(SHIPID_COMPILE="0")
        plain = subprocess.run([*COMMAND, *arguments], capture_output=True, text=True, env=usual).stdout
    else:
        plain = call(*arguments).out
    assert json.loads(done.stdout)["parameters"] == json.loads(plain)["parameters"]


def test_read_only_working_directory(call, zigzag, fitted, tmp_path, monkeypatch):
    here = tmp_path / "here"
    here.mkdir(mode=0o555)
    monkeypatch.chdir(here)
    answer = call("identify", f"{zigzag}@0:100", *fitted)
    assert (answer.code, answer.err) == (0, "")
    assert list(here.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
@pytest.mark.parametrize(
    "arguments", [["models"], ["simulate", "de-keizer", "--ship", "soesterberg", "--manoeuvre", "turn:10"]]
)
def test_reader_that_closes_the_pipe(arguments):
    with subprocess.Popen([*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 0


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
def test_output_that_is_full():
    with open("/dev/full", "wb") as full:
        done = subprocess.run([*COMMAND, "models"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 3
    assert done.stderr == "shipid: the output: No space left on device.\n"


#: The search is stopped in the middle of the fit on any machine: it sends the signal to its own process. A shell that starts its jobs
#: in the background lets them ignore SIGINT: the handler of Python is set again.
STOPPED = """
import signal, sys, shipid.identification.search.ladder as ladder
from shipid.cli import entry
signal.signal(signal.SIGINT, signal.default_int_handler)
search, number = ladder.minimise, getattr(signal, sys.argv.pop(1))
class Dropping:
    def __del__(self):
        signal.raise_signal(number)
def stopped(*a, **k):
    how = sys.argv_how
    if how == "plainly":
        signal.raise_signal(number)
    elif how == "in a destructor":
        Dropping()
    else:
        try:
            signal.raise_signal(number)
        except BaseException as error:
            raise SystemError("a function returned a result with an exception set") from error
    return search(*a, **k)
sys.argv_how = sys.argv.pop(1)
ladder.minimise = stopped
entry()
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("number", "code", "how"),
    [
        ("SIGINT", 130, "plainly"),
        ("SIGINT", 130, "in a destructor"),
        ("SIGINT", 130, "in a library of C"),
        ("SIGTERM", 143, "in a destructor"),
    ],
)
def test_stopped_while_fitting(zigzag, fitted, tmp_path, number, code, how):
    """Also where the exception is lost: Python drops one in a destructor, NumPy's C turned one into a SystemError.

    SIGTERM in one way only: the note that finds a lost exception does not depend on the signal.
    """
    out = tmp_path / "out"
    arguments = ["identify", f"{zigzag}@0:100", *fitted, "--starts", "20", "--out", str(out), "--json"]
    command = [sys.executable, "-c", STOPPED, number, how, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout) == (code, "")
    words = "interrupted" if number == "SIGINT" else "terminated"
    assert done.stderr.lstrip("\n") == f"shipid: {words}; nothing more was written.\n"
    assert not out.exists()


#: A call that was broken off left something behind that crashes when Python takes itself apart.
ENDS_BADLY = """
import os
import shipid.cli.frame.group as group
from shipid.cli import entry
class Left:
    def __del__(self):
        os.abort()
left = Left()
def run():
    print("begun")
    raise KeyboardInterrupt
group.run = run
entry()
"""


def test_what_a_broken_off_call_left_behind_crashes_nothing():
    done = subprocess.run([sys.executable, "-c", ENDS_BADLY], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (130, "begun\n")


def test_as_a_module():
    done = subprocess.run([*COMMAND, "--version"], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stdout.startswith("shipid ")
