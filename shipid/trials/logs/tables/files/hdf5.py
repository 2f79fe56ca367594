"""HDF5 files, and those of MATLAB 7.3: groups of arrays, read in a process of its own."""

from __future__ import annotations

import importlib.util
import io
import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.trials.errors import DamagedFileError, FileSizeError, ReaderNotStartedError
from shipid.trials.logs.tables.files.arrays import Array, Node, Unreadable
from shipid.trials.logs.tables.opening import LARGEST

#: Processor time and time by the clock [s] after which reading is given up: the largest file that is read takes 2 s.
_SECONDS, _LONGEST = 8, 60
_READER = Path(__file__).with_name("hdf5_apart.py")
#: Its packages are found where those of this process are found; nothing else of the surroundings counts.
_START = "import json, runpy, sys; sys.path[:] = json.loads(sys.argv.pop()); runpy.run_path(sys.argv.pop(1), run_name='__main__')"


def hdf5_arrays(data: bytes, file: Path) -> dict[str, Node]:
    """Return the groups and arrays of an HDF5 file; links to other files are not followed.

    Parameters
    ----------
    data : bytes
        The file.
    file : Path
        The file, for messages.

    Returns
    -------
    dict of str to node

    Raises
    ------
    MissingExtraError
        If h5py is not installed.
    ReaderNotStartedError
        If the process that reads it cannot be started.
    DamagedFileError
        If it is damaged.
    FileSizeError
        If its arrays are larger than is read.
    """
    missing = MissingExtraError(f"the HDF5 file '{file}'", "h5py", "hdf5", "Or write the table as CSV.")
    if importlib.util.find_spec("h5py") is None:
        raise missing
    stream = io.BytesIO(_answer(data, file))
    damaged = DamagedFileError(f"'{file}' is a damaged HDF5 file. Check that it was copied completely.")
    try:
        tree = json.loads(stream.readline())
        failure = tree.get("failure")
        arrays = []
        while failure is None and stream.tell() < stream.getbuffer().nbytes:
            arrays.append(np.load(stream, allow_pickle=False))
        nodes = _node(tree, arrays) if failure is None else None
    except Exception:  # the reader crashed before its answer was whole
        raise damaged from None
    if failure == "no h5py":
        raise missing
    if failure == "too large":
        raise FileSizeError(
            f"'{file}' holds arrays of more than {LARGEST // 1_000_000} MB. Write the trial in a file of its own."
        )
    if not isinstance(nodes, dict):
        raise damaged
    return nodes


def _answer(data: bytes, file: Path) -> bytes:
    """What the reader says of a file; cut or empty where it crashed or took too long."""
    command = [
        sys.executable or "",
        "-I",
        "-c",
        _START,
        str(_READER),
        str(LARGEST),
        str(_SECONDS),
        json.dumps(sys.path),
    ]
    # One thread for the library that otherwise begins with as many as there are cores.
    surroundings = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    try:
        ended = subprocess.run(
            command, input=data, capture_output=True, timeout=_LONGEST, check=False, env=surroundings
        )
        if ended.stdout.startswith(b"\n"):
            return ended.stdout[1:]
        reason = f"exit code {ended.returncode}"
    except subprocess.TimeoutExpired:
        return b""
    except OSError as error:
        reason = error.strerror or str(error)
    raise ReaderNotStartedError(
        f"'{file}' was not read: the process that reads HDF5 could not be started ({reason}). Write the table as CSV."
    )


def _node(tree: Mapping[str, Plain], arrays: Sequence[np.ndarray]) -> Node:
    """A node of the reader, with its arrays."""
    if "group" in tree:
        return {name: _node(inner, arrays) for name, inner in tree["group"].items()}
    if "unreadable" in tree:
        return Unreadable(tree["unreadable"])
    names, units = tuple(tree.get("names", ())), tuple(tree.get("units", ()))
    return Array(arrays[tree["array"]], tree.get("unit"), names, units)
