"""HDF5 files, and those of MATLAB 7.3: groups of arrays; links to other files are not followed."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError
from shipid.trials.errors import DamagedFileError, FileSizeError, TrialError
from shipid.trials.logs.tables.files.arrays import Array, Node, Unreadable
from shipid.trials.logs.tables.opening import LARGEST

#: Groups in groups, and arrays of a file.
_DEEPEST, _MOST_ARRAYS = 12, 5_000
_NAMES = ("names", "columns", "labels", "column_names", "header")


def hdf5_arrays(data: bytes, file: Path) -> dict[str, Node]:
    """Return the groups and arrays of an HDF5 file.

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
    DamagedFileError
        If it is damaged.
    FileSizeError
        If its arrays are larger than is read.
    """
    try:
        import h5py
    except ImportError:
        raise MissingExtraError(f"the HDF5 file '{file}'", "h5py", "hdf5", "Or write the table as CSV.") from None
    try:
        with h5py.File(io.BytesIO(data), "r") as opened:
            return _Reader(h5py, file).group(opened, 0)
    except TrialError:
        raise
    except Exception:  # the library under h5py reports damage in many ways
        raise DamagedFileError(f"'{file}' is a damaged HDF5 file. Check that it was copied completely.") from None


class _Reader:
    """Reads the arrays of a file within bounds.

    Parameters
    ----------
    h5py : module
        The library.
    file : Path
        For messages.
    """

    def __init__(self, h5py: Plain, file: Path) -> None:
        self.h5py, self.file = h5py, file
        self.size = self.count = 0

    def group(self, group: Plain, depth: int) -> dict[str, Node]:
        """Return what a group holds."""
        content: dict[str, Node] = {}
        for name in group:
            self.count += 1
            if self.count > _MOST_ARRAYS or depth > _DEEPEST:
                break
            if name.startswith("#") or not isinstance(group.get(name, getlink=True), self.h5py.HardLink):
                continue  # what MATLAB keeps for itself, and links: another file's content is none of this one
            node = self._node(group[name], depth)
            if node is not None:
                content[name] = node
        return content

    def _node(self, item: Plain, depth: int) -> Node | None:
        if isinstance(item, self.h5py.Group):
            return self.group(item, depth + 1)
        if not isinstance(item, self.h5py.Dataset) or item.shape is None or item.attrs.get("MATLAB_empty"):
            return None
        if item.external or item.is_virtual:
            return Unreadable("an array that lies in another file")
        kind = _text(item.attrs.get("MATLAB_class"))
        values = self._values(item)
        if kind == "char":
            return Array(np.array(["".join(map(chr, values.reshape(-1)[:10_000].tolist()))]))
        if item.dtype == self.h5py.ref_dtype:
            return self._cells(item, values)
        if kind is not None and kind not in ("double", "single", "logical") and not kind.startswith(("int", "uint")):
            return Unreadable(f"a {kind} of MATLAB")
        if kind is not None:
            values = values.T
        names = next((found for key in _NAMES if (found := _texts(item.attrs.get(key)))), ())
        units = _texts(item.attrs.get("units")) or _texts(item.attrs.get("unit"))
        return Array(values, units[0] if len(units) == 1 else None, names, units)

    def _cells(self, item: Plain, references: np.ndarray) -> Node:
        """The texts of a cell array of MATLAB."""
        texts = []
        for reference in references.reshape(-1)[:1000]:
            node = self._node(item.file[reference], _DEEPEST) if reference else None
            if not isinstance(node, Array) or node.values.dtype.kind != "U":
                return Unreadable("a cell array")
            texts.append(str(node.values[0]))
        return Array(np.array(texts))

    def _values(self, item: Plain) -> np.ndarray:
        """The array, if what it claims to hold is not too much."""
        self.size += item.size * item.dtype.itemsize
        if self.size > LARGEST:
            raise FileSizeError(
                f"'{self.file}' holds arrays of more than {LARGEST // 1_000_000} MB. Write the trial in a file of its own."
            )
        text = self.h5py.check_string_dtype(item.dtype)
        values = np.asarray(item.asstr(errors="replace")[()] if text is not None else item[()])
        return values.astype(str) if text is not None else values


def _text(value: Plain) -> str | None:
    if isinstance(value, (bytes, np.bytes_)):
        return value.decode("utf-8", "replace")
    return str(value) if isinstance(value, str) else None


def _texts(value: Plain) -> tuple[str, ...]:
    """Texts of an attribute: one, or several."""
    single = _text(value)
    if single is not None:
        return (single,)
    if isinstance(value, np.ndarray) and value.dtype.kind in "SUO":
        found = [_text(cell) for cell in value.reshape(-1)[:10_000]]
        return tuple(text for text in found if text is not None)
    return ()
