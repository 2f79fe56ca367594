"""Commands of shipid as a user types them, in an empty folder: each is printed before it runs."""

from __future__ import annotations

import contextlib
import io
import json
import shlex
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from shipid.cli import run


def shipid(line: str) -> int:
    """Run a command, print what it prints to the standard error stream, and return its exit code.

    Parameters
    ----------
    line : str
        The command without its first word, as in ``check log.csv``.
    """
    print(f"$ shipid {line}", file=sys.stderr)
    with contextlib.redirect_stdout(sys.stderr):
        return int(run(shlex.split(line)))


def answer(line: str, code: int = 0) -> dict[str, Any]:
    """Run a command with ``--json`` and return what it answers.

    Parameters
    ----------
    line : str
        The command without its first word.
    code : int
        The exit code that it has to end with.

    Raises
    ------
    SystemExit
        If it ends with another one.
    """
    print(f"$ shipid {line} --json", file=sys.stderr)
    caught = io.StringIO()
    with contextlib.redirect_stdout(caught):
        ended = int(run([*shlex.split(line), "--json"]))
    if ended != code:
        raise SystemExit(f"shipid {line} ended with exit code {ended}, asked was {code}")
    found: dict[str, Any] = json.loads(caught.getvalue())
    return found


@contextlib.contextmanager
def empty_folder() -> Iterator[Path]:
    """Work in an empty folder, which is removed at the end."""
    with tempfile.TemporaryDirectory() as name, contextlib.chdir(name):
        yield Path(name)
