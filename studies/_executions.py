"""Which test executes which line: one run of the whole suite under Coverage.py, kept in its database."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from _scratch import Scratch, digest, packages

SETTINGS = "[run]\nrelative_files = true\nsource =\n    {}\n"


class Executions:
    """Which statements the tests execute, which test executes which line, and how long each test takes.

    Parameters
    ----------
    path : Path
        A file that `measure` wrote.
    """

    def __init__(self, path: Path) -> None:
        with contextlib.closing(sqlite3.connect(path)) as base:
            self.tree: str = base.execute("SELECT digest FROM study_tree").fetchone()[0]
            self.seconds: dict[str, float] = dict(base.execute("SELECT test, seconds FROM study_test"))
            self.executed: dict[str, set[int]] = {}
            self.missing: dict[str, set[int]] = {}
            for file, executed, missing in base.execute("SELECT file, executed, missing FROM study_file"):
                self.executed[file], self.missing[file] = set(json.loads(executed)), set(json.loads(missing))
            self._lines: dict[str, list[tuple[str, bytes]]] = {}
            rows = "SELECT path, context, numbits FROM line_bits JOIN file ON file.id = file_id JOIN context ON context.id = context_id"
            for file, context, bits in base.execute(rows):
                test = context.rpartition("|")[0]
                if test in self.seconds:  # it passed; code that only an import runs belongs to no test
                    self._lines.setdefault(file, []).append((test, bits))

    def tests_of(self, file: str, lines: Iterable[int] | None = None) -> set[str]:
        """Return the tests that execute one of the lines of a file, or any.

        Parameters
        ----------
        file : str
            The source file, relative to the root.
        lines : iterable of int, optional
            Line numbers, from 1.
        """
        # Coverage.py keeps lines as bits, eight a byte, the lowest first (its documentation of the database).
        wanted = None if lines is None else [(n // 8, 1 << n % 8) for n in lines]
        return {
            test
            for test, bits in self._lines.get(file, [])
            if wanted is None or any(byte < len(bits) and bits[byte] & bit for byte, bit in wanted)
        }


def tree_digest(root: Path) -> str:
    """Return a hash of sources and tests.

    Parameters
    ----------
    root : Path
        Root of the tree.
    """
    return digest(root, [*packages(root), "tests"])


def measure(root: Path, path: Path, compiled: Path, workers: int) -> None:
    """Run the whole suite once in a scratch copy, and write what it executes.

    Parameters
    ----------
    root : Path
        Root of the tree.
    path : Path
        The file to write.
    compiled : Path
        Folder of compiled code, which the run adds to.
    workers : int
        Processes.

    Raises
    ------
    RuntimeError
        Where no test passes.
    """
    tops = packages(root)
    tree = tree_digest(root)
    with tempfile.TemporaryDirectory(prefix="shipid-coverage-") as name:
        scratch = Scratch(root, Path(name) / "tree", compiled)
        settings = scratch.folder / ".coveragerc-study"
        settings.write_text(SETTINGS.format("\n    ".join(tops)), encoding="utf-8")
        options = [f"--cov-config={settings}", *(f"--cov={top}" for top in tops), "--cov-context=test", "--cov-report="]
        done = scratch.pytest(["-n", str(workers), *options], keep=True)
        if not done.passed:
            raise RuntimeError(f"no test passed in the scratch copy; pytest says:\n{done.output[-2000:]}")
        for test in done.failed:
            print(f"fails without any change and is not used: {test}", file=sys.stderr)
        command = [sys.executable, "-m", "coverage", "json", f"--rcfile={settings}", "-q", "-o", f"{name}/report.json"]
        subprocess.run(command, cwd=scratch.folder, env=scratch.environment, check=True)
        files = json.loads(Path(f"{name}/report.json").read_text(encoding="utf-8"))["files"]
        _store(scratch.folder / ".coverage", tree, done.passed, files)
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = path.with_name(f"{path.name}.{os.getpid()}")
        shutil.copyfile(scratch.folder / ".coverage", fresh)
        fresh.replace(path)


def _store(
    base_file: Path, tree: str, seconds: Mapping[str, float], files: Mapping[str, Mapping[str, list[int]]]
) -> None:
    """Add the tree, the durations and the statements to the database of Coverage.py."""
    with contextlib.closing(sqlite3.connect(base_file)) as base, base:
        base.execute("CREATE TABLE study_tree (digest TEXT)")
        base.execute("CREATE TABLE study_test (test TEXT, seconds REAL)")
        base.execute("CREATE TABLE study_file (file TEXT, executed TEXT, missing TEXT)")
        base.execute("INSERT INTO study_tree VALUES (?)", (tree,))
        base.executemany("INSERT INTO study_test VALUES (?, ?)", seconds.items())
        rows = [(f, json.dumps(v["executed_lines"]), json.dumps(v["missing_lines"])) for f, v in files.items()]
        base.executemany("INSERT INTO study_file VALUES (?, ?, ?)", rows)
