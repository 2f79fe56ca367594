"""MATLAB files of versions 4 to 7: arrays and structs, within the bounds of the file.

Level 4 and level 5 of *MAT-File Format* (The MathWorks). The sizes that a file claims are held against the bytes it has, before
anything is made of them; objects and functions are not read.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from shipid.trials.errors import DamagedFileError, FileSizeError
from shipid.trials.logs.tables.files.arrays import Array, Node, Unreadable
from shipid.trials.logs.tables.opening import LARGEST

_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_TEXTS = {1: "latin-1", 2: "latin-1", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_OLD = ("f8", "f4", "i4", "i2", "u2", "u1")
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 5, 16, 17
_COMPLEX = 0x0800
#: Structs in structs, and elements of a file.
_DEEPEST, _MOST_ELEMENTS = 12, 200_000


class _DamageError(Exception):
    """Sizes that do not fit into each other."""


def matlab_arrays(data: bytes, file: Path) -> dict[str, Node]:
    """Return the variables of a MATLAB file.

    Parameters
    ----------
    data : bytes
        The file, of version 4, 5, 6 or 7.
    file : Path
        The file, for messages.

    Returns
    -------
    dict of str to node

    Raises
    ------
    DamagedFileError
        If it is damaged.
    FileSizeError
        If it expands to more than is read.
    """
    try:
        if data.startswith(b"MATLAB"):
            return dict(_Level5(data, file).variables())
        return dict(_level_4(data))
    except (_DamageError, struct.error, ValueError, zlib.error, IndexError, UnicodeError, OverflowError):
        raise DamagedFileError(f"'{file}' is a damaged MATLAB file. Check that it was copied completely.") from None


def _level_4(data: bytes) -> Iterator[tuple[str, Node]]:
    at = 0
    while at + 20 <= len(data):
        order = "<" if struct.unpack_from("<i", data, at)[0] in range(5000) else ">"
        kind, rows, columns, imaginary, length = struct.unpack_from(order + "5i", data, at)
        digits = (kind // 1000, kind // 100 % 10, kind // 10 % 10, kind % 10)
        if kind not in range(5000) or digits[1] or digits[2] >= len(_OLD) or min(rows, columns, length) < 0:
            raise _DamageError
        at += 20
        name = data[at : at + length].split(b"\0")[0].decode("latin-1")
        at += length
        dtype = np.dtype(order + _OLD[digits[2]])
        size = rows * columns * dtype.itemsize
        if at + size * (1 + (imaginary != 0)) > len(data):
            raise _DamageError
        values = np.frombuffer(data, dtype, rows * columns, at).reshape((rows, columns), order="F")
        at += size * (1 + (imaginary != 0))
        if digits[3] == 1:
            yield (
                name,
                Array(np.array(["".join(chr(int(c) % 0x110000) for c in row).rstrip() for row in values[:1000]])),
            )
        elif digits[3] == 0 and not imaginary:
            yield name, Array(values)
        else:
            yield name, Unreadable("a sparse or complex matrix")
    if at == 0:
        raise _DamageError


@dataclass(frozen=True)
class _Element:
    kind: int
    start: int
    end: int


class _Level5:
    """A file of level 5.

    Parameters
    ----------
    data : bytes
        The file.
    file : Path
        For messages.
    """

    def __init__(self, data: bytes, file: Path) -> None:
        self.data, self.file = data, file
        mark = data[126:128]
        if mark not in (b"IM", b"MI"):
            raise _DamageError
        self.order = "<" if mark == b"IM" else ">"
        self.expanded = self.count = 0

    def variables(self) -> Iterator[tuple[str, Node]]:
        """Yield name and content of each variable."""
        at = 128
        while at + 8 <= len(self.data):
            element, at = self._element(self.data, at)
            if element.kind == _COMPRESSED:
                inner = self._expand(self.data[element.start : element.end])
                matrix, _ = self._element(inner, 0)
                found = self._matrix(inner, matrix, 0) if matrix.kind == _MATRIX else None
            else:
                found = self._matrix(self.data, element, 0) if element.kind == _MATRIX else None
            if found is not None and found[0]:
                yield found

    def _expand(self, data: bytes) -> bytes:
        engine = zlib.decompressobj()
        inner = engine.decompress(data, LARGEST + 1 - self.expanded)
        self.expanded += len(inner)
        if self.expanded > LARGEST:
            raise FileSizeError(
                f"'{self.file}' expands to more than {LARGEST // 1_000_000} MB. Save the variables of the trial in a file of their own."
            )
        return inner

    def _element(self, data: bytes, at: int) -> tuple[_Element, int]:
        """The element at a place, and the place behind it."""
        self.count += 1
        kind, size = struct.unpack_from(self.order + "II", data, at)
        if self.count > _MOST_ELEMENTS:
            raise _DamageError
        if kind >> 16:  # a small element: its size stands beside its kind, its content in the next four bytes
            kind, size = kind & 0xFFFF, kind >> 16
            if size > 4:
                raise _DamageError
            return _Element(kind, at + 4, at + 4 + size), at + 8
        end = at + 8 + size
        if end > len(data):
            raise _DamageError
        return _Element(kind, at + 8, end), end if kind == _COMPRESSED else at + 8 + -(-size // 8) * 8

    def _numbers(self, data: bytes, element: _Element) -> np.ndarray:
        if element.kind not in _NUMBERS:
            raise _DamageError
        dtype = np.dtype(self.order + _NUMBERS[element.kind])
        return np.frombuffer(data, dtype, (element.end - element.start) // dtype.itemsize, element.start)

    def _matrix(self, data: bytes, element: _Element, depth: int) -> tuple[str, Node]:
        """Name and content of a matrix."""
        if depth > _DEEPEST or element.start == element.end:
            return "", Array(np.empty(0))
        flags, at = self._element(data, element.start)
        word = int(self._numbers(data, flags)[0])
        kind = word & 0xFF
        if kind == _OPAQUE:
            name, at = self._element(data, at)
            _, at = self._element(data, at)
            what, _ = self._element(data, at)
            return self._text(data, name), Unreadable(f"a {self._text(data, what)} of MATLAB")
        shape_element, at = self._element(data, at)
        shape = tuple(int(n) for n in self._numbers(data, shape_element))
        name, at = self._element(data, at)
        content = self._content(data, at, element.end, kind, shape, word, depth)
        return self._text(data, name), content

    def _content(
        self, data: bytes, at: int, end: int, kind: int, shape: tuple[int, ...], word: int, depth: int
    ) -> Node:
        count = math.prod(shape)
        if min(shape, default=0) < 0 or len(shape) > 8:
            raise _DamageError
        if kind in (_FUNCTION, _OBJECT, _SPARSE) or word & _COMPLEX:
            return Unreadable("an object, a function, or a sparse or complex matrix")
        if kind == _STRUCT:
            return self._struct(data, at, count, depth)
        if kind == _CELL:
            return self._cell(data, at, count, depth)
        if at >= end:
            return Array(np.empty(0))
        part, _ = self._element(data, at)
        if kind == _CHAR:
            text = self._text(data, part)
            if len(shape) == 2 and shape[0] > 1 and len(text) == count and shape[0] <= 1000:
                return Array(np.array([text[row :: shape[0]].rstrip() for row in range(shape[0])]))
            return Array(np.array([text]))
        values = self._numbers(data, part)
        if values.size != count:
            raise _DamageError
        return Array(values.reshape(shape, order="F"))

    def _struct(self, data: bytes, at: int, count: int, depth: int) -> Node:
        length_element, at = self._element(data, at)
        length = int(self._numbers(data, length_element)[0])
        names_element, at = self._element(data, at)
        text = data[names_element.start : names_element.end]
        if length <= 0 or len(text) % length:
            raise _DamageError
        names = [text[k : k + length].split(b"\0")[0].decode("latin-1") for k in range(0, len(text), length)]
        rows: list[dict[str, Node]] = []
        for _ in range(min(count, _MOST_ELEMENTS) if names else 0):
            row: dict[str, Node] = {}
            for name in names:
                element, at = self._element(data, at)
                row[name] = self._matrix(data, element, depth + 1)[1]
            rows.append(row)
        return rows[0] if len(rows) == 1 else _of_rows(names, rows)

    def _cell(self, data: bytes, at: int, count: int, depth: int) -> Node:
        """A cell array: of texts, or of anything else by number."""
        cells: list[Node] = []
        for _ in range(min(count, _MOST_ELEMENTS)):
            element, at = self._element(data, at)
            cells.append(self._matrix(data, element, depth + 1)[1])
        texts = [
            c.values[0] for c in cells if isinstance(c, Array) and c.values.dtype.kind == "U" and c.values.size == 1
        ]
        if cells and len(texts) == len(cells):
            return Array(np.array(texts))
        return {str(k + 1): cell for k, cell in enumerate(cells)}

    def _text(self, data: bytes, element: _Element) -> str:
        if element.kind not in _TEXTS:
            raise _DamageError
        encoding = _TEXTS[element.kind]
        if encoding in ("utf-16", "utf-32"):
            encoding += "-le" if self.order == "<" else "-be"
        return data[element.start : element.end].decode(encoding, "replace")


def _of_rows(names: list[str], rows: Sequence[Mapping[str, Node]]) -> Node:
    """A struct array: one element a sample where every field holds one number, else the elements by number."""
    columns: dict[str, Node] = {}
    for name in names:
        leaves = [row[name] for row in rows]
        numbers = [
            leaf.values.reshape(-1)
            for leaf in leaves
            if isinstance(leaf, Array) and leaf.values.size == 1 and leaf.values.dtype.kind in "fiu"
        ]
        if len(numbers) != len(rows):
            return {str(k + 1): row for k, row in enumerate(rows)}
        columns[name] = Array(np.concatenate(numbers).astype(float) if numbers else np.empty(0))
    return columns
