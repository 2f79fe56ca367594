"""Open a file within bounds: compressed files are judged by what they expand to."""

from __future__ import annotations

import bz2
import lzma
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from shipid.trials.errors import FileSizeError, ForeignFileError
from shipid.trials.logs.tables.archive import ZIP, member_of

#: Bytes of a file, expanded: an hour of twenty channels at 10 Hz is a fiftieth of it.
LARGEST = 256_000_000
#: What a decompressor of xz may take [bytes].
_MEMORY = 256_000_000
#: Compressed files in compressed files.
_DEEPEST = 3


class _Decompressor(Protocol):
    @property
    def eof(self) -> bool: ...

    @property
    def unused_data(self) -> bytes: ...

    def decompress(self, data: bytes, max_length: int, /) -> bytes: ...


_COMPRESSED: dict[bytes, tuple[str, Callable[[], _Decompressor]]] = {
    b"\x1f\x8b": ("gzip", lambda: zlib.decompressobj(wbits=31)),
    b"BZh": ("bzip2", bz2.BZ2Decompressor),
    b"\xfd7zXZ\x00": ("xz", lambda: lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=_MEMORY)),
}


def opened(file: Path, member: str | None = None) -> tuple[bytes, tuple[str, ...]]:
    """Return what a file holds, expanded where it is compressed.

    Parameters
    ----------
    file : Path
        The file: as it is, or compressed by gzip, bzip2, xz or zip.
    member : str, optional
        The file in a zip archive that is wanted (`shipid.trials.logs.tables.archive.in_archive`); by default the only log in it.

    Returns
    -------
    data : bytes
        At most `LARGEST`.
    notes : tuple of str
        How it was compressed.

    Raises
    ------
    FileSizeError
        If it is larger, or expands to more.
    ForeignFileError
        If a compressed file is damaged, or an archive holds several logs and none is named.
    """
    with file.open("rb") as stream:
        data = stream.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise _too_large(file, "is")
    notes: list[str] = []
    for _ in range(_DEEPEST):
        name = next((magic for magic in _COMPRESSED if data.startswith(magic)), None)
        if name is not None:
            kind, make = _COMPRESSED[name]
            data = _expanded(data, name, kind, make, file)
        elif data.startswith(ZIP):
            found = member_of(data, file, member, LARGEST)
            if found is None:
                break
            if len(found.content) > LARGEST:
                raise _too_large(file, "expands to something")
            kind, data, member = found.kind, found.content, None
        else:
            break
        notes.append(f"The file was expanded ({kind}).")
    return data, tuple(notes)


def _too_large(file: Path, how: str) -> FileSizeError:
    return FileSizeError(
        f"'{file}' {how} larger than {LARGEST // 1_000_000} MB. Cut it into parts, or leave out columns that are not needed."
    )


def _expanded(data: bytes, magic: bytes, kind: str, make: Callable[[], _Decompressor], file: Path) -> bytes:
    """Expand a file of one or several compressed streams."""
    parts: list[bytes] = []
    size = 0
    while data.startswith(magic):
        engine = make()
        try:
            part = engine.decompress(data, LARGEST + 1 - size)
        except (zlib.error, OSError, EOFError, lzma.LZMAError, ValueError, MemoryError):
            raise _damaged(file, kind) from None
        parts.append(part)
        size += len(part)
        if size > LARGEST:
            raise _too_large(file, "expands to something")
        if not engine.eof:
            raise _damaged(file, kind)
        data = engine.unused_data.lstrip(b"\0")
    if data:
        raise _damaged(file, kind)
    return b"".join(parts)


def _damaged(file: Path, kind: str) -> ForeignFileError:
    return ForeignFileError(f"'{file}' is a damaged {kind} file. Check that it was copied completely.")
