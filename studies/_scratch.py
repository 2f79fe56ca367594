"""A scratch copy of the tree, in which tests run without a trace in the checkout."""

from __future__ import annotations

import compileall
import contextlib
import hashlib
import os
import py_compile
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

LEFT_OUT = (".git", ".venv", ".*_cache", ".coverage*", ".hypothesis", "__pycache__", "*.egg-info", "build", "dist")


@dataclass(frozen=True)
class Outcome:
    """What a run of pytest came to.

    Attributes
    ----------
    passed : dict of str to float
        Duration [s] of each test that passed, set-up included.
    failed : list of str
        The tests that failed; ``collection`` where a file could not even be read.
    code : int or None
        Exit code of pytest, None where it ran out of time.
    output : str
        What it printed.
    """

    passed: dict[str, float]
    failed: list[str]
    code: int | None
    output: str


class Scratch:
    """A copy of the tree with an environment in which its own package is imported.

    Parameters
    ----------
    root : Path
        The tree to copy.
    folder : Path
        Where to: a folder that does not exist yet.
    compiled : Path
        Folder of generated code that has been compiled before.
    """

    def __init__(self, root: Path, folder: Path, compiled: Path) -> None:
        self.folder, self.compiled = folder, compiled
        self._running: subprocess.Popen[str] | None = None
        self._lock, self._stopped = threading.Lock(), False
        shutil.copytree(root, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))
        for top in packages(root):
            # Checked by content: a change within the same second and of the same length must not meet old byte code.
            mode = py_compile.PycInvalidationMode.CHECKED_HASH
            compileall.compile_dir(folder / top, quiet=1, invalidation_mode=mode)
        for name, place in package_folders(root).items():
            inside = folder.joinpath(*name.split("."))
            if not inside.exists():  # installed as a package of another, as shipid.models is
                inside.symlink_to(folder / place, target_is_directory=True)
        beside = root.parent / "shared"  # real trials, where the tests look for them
        if beside.is_dir() and not (folder.parent / beside.name).exists():
            (folder.parent / beside.name).symlink_to(beside, target_is_directory=True)
        compiled.mkdir(parents=True, exist_ok=True)
        #: The user's environment, less what would change how the tests run here.
        self.environment = os.environ | {
            "PYTHONPATH": str(folder),
            "PYTEST_ADDOPTS": "",
            "COVERAGE_FILE": str(folder / ".coverage"),
        }

    def pytest(self, arguments: Iterable[str], timeout: float | None = None, keep: bool = False) -> Outcome:
        """Run pytest in the copy, with a cache of its own.

        Parameters
        ----------
        arguments : iterable of str
            Options and names of tests.
        timeout : float, optional
            Time allowed [s].
        keep : bool
            Whether to keep what it compiles, generated code and byte code, for the runs to come.

        Raises
        ------
        InterruptedError
            After `stop`.
        """
        with tempfile.TemporaryDirectory(prefix="shipid-mutant-") as name:
            report, cache = Path(name) / "report.xml", Path(name) / "cache"
            cache.mkdir()
            # Compiled code is named by a hash of its source; whatever else is cached may be what a change spoils.
            for library in self.compiled.glob("*.so"):
                (cache / library.name).symlink_to(library)
            env = self.environment | {
                "SHIPID_CACHE": str(cache),
                "HYPOTHESIS_STORAGE_DIRECTORY": f"{name}/hypothesis",
            }
            if not keep:
                env["PYTHONDONTWRITEBYTECODE"] = "1"
            options = f"-p no:cacheprovider --hypothesis-seed=0 -o junit_family=xunit1 --junitxml={report}".split()
            command = [sys.executable, "-m", "pytest", *options, *arguments]
            output = Path(name) / "output"
            with output.open("w", encoding="utf-8") as sink, self._lock:
                if self._stopped:
                    raise InterruptedError
                self._running = subprocess.Popen(
                    command, cwd=self.folder, env=env, stdout=sink, stderr=sink, text=True, start_new_session=True
                )
            try:
                code: int | None = self._running.wait(timeout)
            except subprocess.TimeoutExpired:
                code = None
            finally:
                self._end()
            if self._stopped:
                raise InterruptedError
            for library in cache.glob("*.so") if keep else ():
                if not library.is_symlink():
                    shutil.move(library, self.compiled / library.name)
            return Outcome(*_read(report), code, output.read_text(encoding="utf-8", errors="replace"))

    def stop(self) -> None:
        """End the run and refuse others."""
        with self._lock:
            self._stopped = True
            self._end()

    def _end(self) -> None:
        """End pytest and whatever it started."""
        if self._running is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._running.pid, signal.SIGKILL)
            self._running.wait()


def package_folders(root: Path) -> dict[str, str]:
    """Return the folder of each package that does not lie in its parent's, relative to the root.

    Parameters
    ----------
    root : Path
        Root of the tree.
    """
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    return dict(project["tool"]["setuptools"]["package-dir"])


def packages(root: Path) -> list[str]:
    """Return the folders at the top level that hold packages.

    Parameters
    ----------
    root : Path
        Root of the tree.
    """
    return sorted({folder.split("/")[0] for folder in package_folders(root).values()})


def _read(report: Path) -> tuple[dict[str, float], list[str]]:
    """Read pytest's report: durations of the tests that passed, names of those that failed."""
    passed: dict[str, float] = {}
    failed: list[str] = []
    if not report.is_file():  # it ran out of time, or failed before the first test
        return passed, failed
    for case in ET.parse(report).iter("testcase"):
        file, name = case.get("file"), case.get("name", "")
        test = f"{file}::{name}" if file else "collection"
        if case.find("failure") is not None or case.find("error") is not None:
            failed.append(test)
        elif case.find("skipped") is None:
            passed[test] = float(case.get("time", 0))
    return passed, failed


def digest(root: Path, files: Iterable[str]) -> str:
    """Return a hash of the contents of files.

    Parameters
    ----------
    root : Path
        Root of the tree.
    files : iterable of str
        Files or folders, relative to it; those that do not exist count as empty.
    """
    made = hashlib.sha256()
    for place in sorted(files):
        folder = (root / place).is_dir()
        for path in sorted((root / place).rglob("*.py")) if folder else [root / place]:
            made.update(path.relative_to(root).as_posix().encode() + b"\0")
            made.update(path.read_bytes() if path.is_file() else b"")
    return made.hexdigest()[:16]
