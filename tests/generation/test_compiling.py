"""Compile once, keep; and do without a compiler."""

import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from shipid.foundation import cache
from shipid.foundation.cache import CacheNotice
from shipid.generation import compiling
from shipid.generation.compiling import CompilerNotice, compile_function
from shipid.generation.record import make_record


def make_function(number: float = 1.0) -> Any:
    x = ca.SX.sym("x", 3)
    return ca.Function("step", [x], [number * ca.sin(x) + x[0] ** 2])


@pytest.fixture(autouse=True)
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A cache folder of this test's own, and nothing remembered of the compiler or of notices."""
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("SHIPID_COMPILE", raising=False)
    for remembered in (compiling.find_compiler, compiling.notice_once, make_record):
        remembered.cache_clear()
    yield tmp_path / "cache"
    for remembered in (compiling.find_compiler, compiling.notice_once, make_record):
        remembered.cache_clear()


@pytest.fixture
def compiler() -> None:
    if compiling.find_compiler() is None:
        pytest.skip("there is no C compiler on this machine")


def libraries(folder: Path) -> dict[str, int]:
    return {p.name: p.stat().st_mtime_ns for p in folder.iterdir()}


@pytest.mark.usefixtures("compiler")
def test_the_cache_folder_is_made_with_those_above_it(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = fresh / "not" / "there" / "yet"
    monkeypatch.setenv("SHIPID_CACHE", str(inner))
    with warnings.catch_warnings():
        warnings.simplefilter("error", CompilerNotice)
        compile_function(make_function())
    assert len(libraries(inner)) == 1


@pytest.mark.usefixtures("compiler")
@pytest.mark.parametrize("name", ["de-keizer", "pershitz", "pershitz-discrete", "bech"])
def test_compiled_and_interpreted_give_the_same_numbers(
    name: str, fresh: Path, sail: Any, named: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Over a record with sensitivities, to round-off: the compiler may contract a multiplication and an addition."""
    pair = named[name]
    x0, u, intervals = sail(pair, 80, 0.2 * pair.unit_time)
    names = pair.model.parameters + pair.model.constants
    results = []
    for switch in ("1", "0"):
        monkeypatch.setenv("SHIPID_COMPILE", switch)
        make_record.cache_clear()
        record = make_record(pair.model, pair.model.states, names, pair.model.states)
        results.append(record(x0, u, intervals, record.system.vector(names, pair.coefficients)))
        assert record.loop.compiled == (switch == "1")
    assert len(libraries(fresh)) == 1
    for compiled, interpreted in zip(*results):
        scale = np.abs(interpreted).max(axis=-1, keepdims=True)
        assert (np.abs(compiled - interpreted) <= 1e-11 * scale).all()


@pytest.mark.usefixtures("compiler")
def test_the_second_call_compiles_nothing(fresh: Path) -> None:
    first = compile_function(make_function())
    before = libraries(fresh)
    assert len(before) == 1
    assert next(iter(before)).endswith(".so")
    second = compile_function(make_function())
    assert libraries(fresh) == before
    assert np.array_equal(first([1, 2, 3]).full(), second([1, 2, 3]).full())
    np.testing.assert_allclose(first([1, 2, 3]).full(), make_function()([1, 2, 3]).full(), rtol=1e-15)


@pytest.mark.usefixtures("compiler")
def test_another_function_is_another_library(fresh: Path) -> None:
    """Both have the same name and both stay usable."""
    one, other = compile_function(make_function(1.0)), compile_function(make_function(1.0000000001))
    assert len(libraries(fresh)) == 2
    assert float(other([0.5, 0, 0])[0] - one([0.5, 0, 0])[0]) == pytest.approx(1e-10 * np.sin(0.5), rel=1e-4)


def without_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "/nowhere/cc")
    monkeypatch.setenv("PATH", "")
    compiling.find_compiler.cache_clear()


def test_without_a_compiler_there_is_one_notice(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    without_compiler(monkeypatch)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        results = [compile_function(make_function(k)) for k in (1.0, 2.0)]
    assert [w.category for w in caught] == [CompilerNotice]
    assert "no C compiler found; install gcc or clang, or set CC" in str(caught[0].message)
    for k, function in zip((1.0, 2.0), results):
        assert np.array_equal(function([1, 2, 3]).full(), make_function(k)([1, 2, 3]).full())
    assert not fresh.exists()


def fake_compiler(path: Path, script: str) -> str:
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return str(path)


def test_a_broken_compiler_falls_back_with_one_notice(
    tmp_path: Path, fresh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = 'case "$1" in --version) echo broken 1.0;; *) echo "no space in $(ls)" >&2; exit 1;; esac'
    monkeypatch.setenv("CC", fake_compiler(tmp_path / "cc", script))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        functions = [compile_function(make_function(k)) for k in (1.0, 2.0)]
    assert [w.category for w in caught] == [CompilerNotice]
    assert "compiling failed: no space in code.c" in str(caught[0].message)
    assert np.array_equal(functions[1]([1, 2, 3]).full(), make_function(2.0)([1, 2, 3]).full())
    assert libraries(fresh) == {}  # nothing half-made is left behind


def test_a_compiler_that_makes_rubbish_falls_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = 'case "$1" in --version) echo rubbish 1.0;; *) echo rubbish > code.so;; esac'
    monkeypatch.setenv("CC", fake_compiler(tmp_path / "cc", script))
    with pytest.warns(CompilerNotice, match="compiling failed"):
        function = compile_function(make_function())
    assert np.array_equal(function([1, 2, 3]).full(), make_function()([1, 2, 3]).full())


def test_a_compiler_that_does_not_say_its_version_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setenv("CC", fake_compiler(tmp_path / "cc", "exit 1"))
    assert compiling.find_compiler() is None


@pytest.mark.usefixtures("compiler")
def test_without_a_cache_it_is_compiled_all_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "file" / "cache"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "tmp"))
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr("tempfile.tempdir", None)
    cache._notice_once.cache_clear()  # noqa: SLF001 - so that it is said here
    with pytest.warns(CacheNotice, match="Not a directory. Nothing is kept between runs"):
        function = compile_function(make_function())
    assert function.class_name() == "External"
    np.testing.assert_allclose(function([1, 2, 3]).full(), make_function()([1, 2, 3]).full(), rtol=1e-15)
    assert list((tmp_path / "tmp").iterdir()) == []


def only_library(folder: Path, number: float) -> tuple[str, bytes]:
    """Compile into a folder of its own, by a process of its own: name of the library, and what it holds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SHIPID_CACHE", str(folder))
        patch.delenv("SHIPID_COMPILE", raising=False)
        run_alone(number)
    (library,) = folder.iterdir()
    return library.name, library.read_bytes()


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, bytes]:
    """The library of the function that is called, under its name."""
    return only_library(tmp_path_factory.mktemp("sound"), 1.0)


@pytest.fixture(scope="module")
def harmful(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The library of another function."""
    return only_library(tmp_path_factory.mktemp("harmful"), 3.0)[1]


@pytest.mark.usefixtures("compiler")
@pytest.mark.parametrize(
    "harm", ["cut to nothing", "cut in half", "a bit", "one more byte", "another library", "a folder"]
)
def test_a_damaged_library_is_not_executed(fresh: Path, sound: tuple[str, bytes], harmful: bytes, harm: str) -> None:
    """It is compiled anew. The system would execute a library that is cut, and end the process by SIGBUS."""
    name, whole = sound
    fresh.mkdir(mode=0o700)
    library = fresh / name
    if harm == "a folder":
        library.mkdir()
    else:
        middle = len(whole) // 2
        library.write_bytes(
            {
                "cut to nothing": b"",
                "cut in half": whole[:middle],
                "a bit": whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :],
                "one more byte": whole + b"\0",
                "another library": harmful,
            }[harm]
        )
    printed = run_alone(1.0)
    assert float(printed[1]) == pytest.approx(np.sin(3) + 1, rel=1e-15)
    if harm != "a folder":
        assert printed[0] == "External"
        assert [p.read_bytes() for p in fresh.iterdir()] == [whole]


def run_alone(number: float) -> list[str]:
    """Compile and call in a process of its own, which may be killed by what it loads."""
    code = (
        "import sys, casadi as ca\nfrom shipid.generation.compiling import compile_function\n"
        "x = ca.SX.sym('x', 3)\n"
        "made = compile_function(ca.Function('step', [x], [float(sys.argv[1]) * ca.sin(x) + x[0] ** 2]))\n"
        "print(made.class_name(), float(made([1, 2, 3])[2]))"
    )
    done = subprocess.run([sys.executable, "-c", code, str(number)], capture_output=True, text=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no users of POSIX")
@pytest.mark.usefixtures("compiler")
def test_a_library_that_another_user_may_have_put_there_is_not_executed(fresh: Path) -> None:
    function = make_function(2.0)
    compile_function(function)
    (library,) = fresh.iterdir()
    before = library.read_bytes()
    fresh.chmod(0o777)
    cache._notice_once.cache_clear()  # noqa: SLF001 - so that it is said here
    with pytest.warns(CacheNotice, match="other users can write to it"):
        assert compile_function(function).class_name() == "External"
    assert [p.read_bytes() for p in fresh.iterdir()] == [before]


def test_compiling_can_be_switched_off(fresh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SHIPID_COMPILE", "0")
    function = make_function()
    assert compile_function(function) is function
    assert not fresh.exists()


RACER = """
import sys, time, casadi as ca
from pathlib import Path
from shipid.generation.compiling import compile_function
x = ca.SX.sym("x", 3)
function = ca.Function("step", [x], [ca.sin(x) + x[0] ** 2])
Path(sys.argv[1], sys.argv[2]).touch()
while len(list(Path(sys.argv[1]).iterdir())) < 4:
    time.sleep(0.001)
print(compile_function(function).class_name(), float(compile_function(function)([1, 2, 3])[2]))
"""


@pytest.mark.usefixtures("compiler")
def test_four_processes_race_for_one_library(tmp_path: Path, fresh: Path) -> None:
    """They start together, once all four are ready; nobody sees half a file, and one library is left."""
    gate = tmp_path / "gate"
    gate.mkdir()
    command = [sys.executable, "-W", "error", "-c", RACER, str(gate)]
    racers = [subprocess.Popen([*command, str(i)], stdout=subprocess.PIPE, text=True, env=os.environ) for i in range(4)]
    printed = [r.communicate(timeout=60)[0].split() for r in racers]
    assert [r.returncode for r in racers] == [0] * 4
    assert {p[0] for p in printed} == {"External"}
    # sin(3) + 1, which a machine may round by one unit in the last place
    assert all(float(p[1]) == pytest.approx(np.sin(3) + 1, rel=1e-15) for p in printed)
    assert len(libraries(fresh)) == 1
    assert [p.suffix for p in fresh.iterdir()] == [".so"]
