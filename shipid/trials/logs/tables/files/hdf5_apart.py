"""Reads an HDF5 file in a process of its own: damage can crash the HDF5 library, and only this process ends then.

It is run as a script and imports nothing of shipid, so that it starts quickly. Standard input is the file. Standard output is an
empty line when it begins, a line of JSON, which says what the file holds, and then its arrays, one after the other, each as
``numpy.save`` writes it.

    python -I hdf5_apart.py BYTES SECONDS PATHS

BYTES bounds the arrays together, SECONDS the processor time, and PATHS is the list of folders in which packages are found.
"""

from __future__ import annotations

import io
import json
import sys
from contextlib import suppress
from typing import Any, TypeAlias

import numpy as np

#: Groups in groups, and arrays of a file.
_DEEPEST, _MOST_ARRAYS = 12, 5_000
#: Memory beside the arrays and the file [bytes]: the interpreter, its packages, and buffers of the library.
_BESIDE = 1_500_000_000
_NAMES = ("names", "columns", "labels", "column_names", "header")
#: A node in JSON: ``{"group": {name: node}}``, ``{"array": number, ...}`` or ``{"unreadable": "what it is"}``.
_Node: TypeAlias = dict[str, Any]
#: The library and what it opens; it declares no types.
_Plain: TypeAlias = Any


class TooLargeError(Exception):
    """The arrays claim to be larger than is read."""


class Reader:
    """Reads the arrays of a file within bounds.

    Parameters
    ----------
    h5py : module
        The library.
    largest : int
        Bytes of all arrays together.
    """

    def __init__(self, h5py: _Plain, largest: int) -> None:
        self.h5py, self.largest = h5py, largest
        self.size = self.count = 0
        self.arrays: list[np.ndarray] = []

    def group(self, group: _Plain, depth: int = 0) -> _Node:
        """Return what a group holds.

        Parameters
        ----------
        group : h5py.Group
            The group.
        depth : int
            Groups around it.
        """
        content: dict[str, _Node] = {}
        for name in group:
            self.count += 1
            if self.count > _MOST_ARRAYS or depth > _DEEPEST:
                break
            if name.startswith("#") or not isinstance(group.get(name, getlink=True), self.h5py.HardLink):
                continue  # what MATLAB keeps for itself, and links: another file's content is none of this one
            node = self._node(group[name], depth)
            if node is not None:
                content[name] = node
        return {"group": content}

    def _node(self, item: _Plain, depth: int) -> _Node | None:
        if isinstance(item, self.h5py.Group):
            return self.group(item, depth + 1)
        if not isinstance(item, self.h5py.Dataset) or item.shape is None or item.attrs.get("MATLAB_empty"):
            return None
        if item.external or item.is_virtual:
            return {"unreadable": "an array that lies in another file"}
        kind = _text(item.attrs.get("MATLAB_class"))
        values = self._values(item)
        if kind == "char":
            return self._array(np.array([_of_codes(values)]))
        if self.h5py.check_ref_dtype(item.dtype) is self.h5py.Reference:
            return self._cells(item, values)
        if values.dtype.hasobject:
            return {"unreadable": "an array of arrays or of references"}
        if kind is not None and kind not in ("double", "single", "logical") and not kind.startswith(("int", "uint")):
            return {"unreadable": f"a {kind} of MATLAB"}
        if kind is not None:
            values = values.T
        names = next((found for key in _NAMES if (found := _texts(item.attrs.get(key)))), [])
        units = _texts(item.attrs.get("units")) or _texts(item.attrs.get("unit"))
        return self._array(values, unit=units[0] if len(units) == 1 else None, names=names, units=units)

    def _array(self, values: np.ndarray, **beside: object) -> _Node:
        self.arrays.append(values)
        return {"array": len(self.arrays) - 1, **beside}

    def _cells(self, item: _Plain, references: np.ndarray) -> _Node:
        """The texts of a cell array of MATLAB."""
        texts = []
        for reference in references.reshape(-1)[:1000]:
            cell = item.file[reference] if reference else None
            if not isinstance(cell, self.h5py.Dataset) or _text(cell.attrs.get("MATLAB_class")) != "char":
                return {"unreadable": "a cell array"}
            texts.append("" if cell.attrs.get("MATLAB_empty") else _of_codes(self._values(cell)))
        return self._array(np.array(texts))

    def _values(self, item: _Plain) -> np.ndarray:
        """The array, if what it claims to hold is not too much."""
        self.size += item.size * item.dtype.itemsize
        if self.size > self.largest:
            raise TooLargeError
        text = self.h5py.check_string_dtype(item.dtype)
        values = np.asarray(item.asstr(errors="replace")[()] if text is not None else item[()])
        return values.astype(str) if text is not None else values


def _of_codes(values: np.ndarray) -> str:
    return "".join(map(chr, values.reshape(-1)[:10_000].tolist()))


def _text(value: object) -> str | None:
    if isinstance(value, (bytes, np.bytes_)):
        return value.decode("utf-8", "replace")
    return str(value) if isinstance(value, str) else None


def _texts(value: object) -> list[str]:
    """Texts of an attribute: one, or several."""
    single = _text(value)
    if single is not None:
        return [single]
    if isinstance(value, np.ndarray) and value.dtype.kind in "SUO":
        found = [_text(cell) for cell in value.reshape(-1)[:10_000]]
        return [text for text in found if text is not None]
    return []


def answer(data: bytes, largest: int) -> tuple[_Node, list[np.ndarray]]:
    """Return what a file holds, or why it cannot be read.

    Parameters
    ----------
    data : bytes
        The file.
    largest : int
        Bytes of all arrays together.

    Returns
    -------
    tree : dict
        A node, or ``{"failure": "too large"}``, ``{"failure": "damaged"}``, ``{"failure": "no h5py"}``.
    arrays : list of ndarray
        Those that the nodes count.
    """
    try:
        import h5py
    except ImportError:
        return {"failure": "no h5py"}, []
    reader = Reader(h5py, largest)
    try:
        with h5py.File(io.BytesIO(data), "r") as opened:
            return reader.group(opened), reader.arrays
    except (TooLargeError, MemoryError):
        return {"failure": "too large"}, []
    except Exception:  # the library reports damage in many ways
        return {"failure": "damaged"}, []


def bound(memory: int, seconds: int) -> None:
    """Bound what this process may take, where the system can do so; a crash leaves no copy of the memory on the disk.

    Parameters
    ----------
    memory : int
        Bytes.
    seconds : int
        Processor time in s.
    """
    try:
        import resource
    except ImportError:  # Windows
        return
    for kind, most in ((resource.RLIMIT_AS, memory), (resource.RLIMIT_CPU, seconds), (resource.RLIMIT_CORE, 0)):
        with suppress(ValueError, OSError):  # a lower bound is set already, or the system knows none of this kind
            resource.setrlimit(kind, (most, most))


def main() -> None:
    """Read standard input, and write what it holds."""
    largest, out = int(sys.argv[1]), sys.stdout.buffer
    out.write(b"\n")
    out.flush()
    data = sys.stdin.buffer.read()
    bound(_BESIDE + 3 * largest, int(sys.argv[2]))
    tree, arrays = answer(data, largest)
    out.write(json.dumps(tree).encode() + b"\n")
    for values in arrays:
        written = io.BytesIO()
        np.save(written, values, allow_pickle=False)
        out.write(written.getbuffer())
    out.flush()


if __name__ == "__main__":
    main()
