"""HDF5 files, and those of MATLAB 7.3: groups of arrays, read in a process of its own."""

from __future__ import annotations

import importlib.util
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.foundation.processes.apart import NotStartedError, run_apart
from shipid.trials.errors import DamagedFileError, FileSizeError, ReaderNotStartedError
from shipid.trials.logs.tables.files.arrays import Array, Node, Unreadable
from shipid.trials.logs.tables.opening import LARGEST

#: Processor time and time by the clock [s] after which reading is given up: the largest file that is read takes 2 s.
_SECONDS, _LONGEST = 8, 60
_READER = Path(__file__).with_name("hdf5_apart.py")


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
    try:
        return run_apart(_READER, [str(LARGEST), str(_SECONDS)], data, longest=_LONGEST)
    except NotStartedError as error:
        raise ReaderNotStartedError(
            f"'{file}' was not read: the process that reads HDF5 could not be started ({error}). Write the table as CSV."
        ) from None


def _node(tree: Mapping[str, Plain], arrays: Sequence[np.ndarray]) -> Node:
    """A node of the reader, with its arrays."""
    if "group" in tree:
        return {name: _node(inner, arrays) for name, inner in tree["group"].items()}
    if "unreadable" in tree:
        return Unreadable(tree["unreadable"])
    names, units = tuple(tree.get("names", ())), tuple(tree.get("units", ()))
    return Array(arrays[tree["array"]], tree.get("unit"), names, units)
