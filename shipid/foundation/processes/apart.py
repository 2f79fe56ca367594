"""Run a script of the toolbox in a process of its own: a library that crashes, hangs or grows ends that process only."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

#: Its packages are found where those of this process are found; nothing else of the surroundings counts.
_START = "import json, runpy, sys; sys.path[:] = json.loads(sys.argv.pop()); runpy.run_path(sys.argv.pop(1), run_name='__main__')"


def processors() -> int:
    """Return how many processors this process may use: so many processes have room side by side."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class NotStartedError(Exception):
    """The process could not be started; the message says why. The caller says what to do."""


def run_apart(
    script: Path,
    arguments: Sequence[str],
    data: bytes = b"",
    *,
    longest: float,
    surroundings: Mapping[str, str] | None = None,
) -> bytes:
    """Return what a script writes; it writes an empty line first, to say that it has begun.

    Parameters
    ----------
    script : Path
        The script; it imports nothing of shipid.
    arguments : sequence of str
        Its arguments.
    data : bytes
        Its standard input.
    longest : float
        Seconds by the clock after which it is ended.
    surroundings : mapping of str to str, optional
        Environment variables beside those of this process.

    Returns
    -------
    bytes
        Cut or empty where it crashed or took too long.

    Raises
    ------
    NotStartedError
        If it cannot be started.
    """
    command = [sys.executable or "", "-I", "-c", _START, str(script), *arguments, json.dumps(sys.path)]
    # One thread for the library that otherwise begins with as many as there are cores.
    around = {**os.environ, "OPENBLAS_NUM_THREADS": "1", **(surroundings or {})}
    try:
        ended = subprocess.run(command, input=data, capture_output=True, timeout=longest, check=False, env=around)
    except subprocess.TimeoutExpired:
        return b""
    except OSError as error:
        raise NotStartedError(error.strerror or str(error)) from None
    if ended.stdout.startswith(b"\n"):
        return ended.stdout[1:]
    raise NotStartedError(f"exit code {ended.returncode}")
