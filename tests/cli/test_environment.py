"""Machines that lack something: a compiler, a cache, a reader of the output, patience."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

COMMAND = (sys.executable, "-m", "shipid")


def environment(**changes: str) -> dict[str, str]:
    return {**os.environ, **changes}


@pytest.mark.parametrize("lack", ["compiler", "cache folder"])
def test_without_a_compiler_or_a_cache(zigzag, fitted, tmp_path, lack):
    """One notice, the same numbers."""
    wall = tmp_path / "wall"
    wall.write_text("a file where a folder should be")
    changes = {"PATH": str(tmp_path), "CC": ""} if lack == "compiler" else {"SHIPID_CACHE": str(wall / "cache")}
    words = "no C compiler found" if lack == "compiler" else "compiling failed"
    arguments = [*COMMAND, "identify", str(zigzag), *fitted, "--json"]
    plain = subprocess.run(arguments, capture_output=True, text=True, env=environment(SHIPID_COMPILE="0"))
    done = subprocess.run(arguments, capture_output=True, text=True, env=environment(**changes), cwd=tmp_path)
    assert done.returncode == plain.returncode == 0
    assert done.stderr.count("shipid: generated code is not compiled") == 1
    assert words in " ".join(done.stderr.split())
    assert ".py" not in done.stderr
    assert json.loads(done.stdout)["parameters"] == json.loads(plain.stdout)["parameters"]


def test_read_only_working_directory(zigzag, fitted, tmp_path):
    here = tmp_path / "here"
    here.mkdir(mode=0o555)
    done = subprocess.run([*COMMAND, "identify", str(zigzag), *fitted], capture_output=True, text=True, cwd=here)
    assert (done.returncode, done.stderr) == (0, "")
    assert list(here.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
@pytest.mark.parametrize(
    "arguments", [["models"], ["simulate", "nomoto", "--ship", "zeefakkel", "--manoeuvre", "turn:20"]]
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


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_interrupted_while_fitting(zigzag, tmp_path):
    out = tmp_path / "out"
    # So many starts that the search outlasts the test; the signal goes when it has begun.
    code = (
        "import sys, shipid.identification.search.least_squares as solve; from shipid.cli import run\n"
        "search = solve.minimise\n"
        "def begin(*a, **k):\n"
        "    print('searching', file=sys.stderr, flush=True)\n"
        "    return search(*a, **k)\n"
        "solve.minimise = begin\n"
        "sys.exit(run(sys.argv[1:]))"
    )
    options = ["--model", "nomoto", "--ship", "zeefakkel", "--starts", "100000", "--out", str(out), "--json"]
    command = [sys.executable, "-c", code, "identify", str(zigzag), *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None and process.stdout is not None
        assert process.stderr.readline() == "searching\n"
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        said, printed = process.stderr.read(), process.stdout.read()
    assert process.returncode == 130
    assert printed == ""
    assert "shipid: interrupted; nothing more was written.\n" in said
    assert "Traceback" not in said
    assert not out.exists()


def test_as_a_module():
    done = subprocess.run([*COMMAND, "--version"], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stdout.startswith("shipid ")
