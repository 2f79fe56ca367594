"""Open a file within bounds: compressed files are judged by what they expand to."""

from __future__ import annotations

import bz2
import io
import lzma
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from shipid.trials.errors import FileSizeError, ForeignFileError

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
_ZIP = b"PK\x03\x04"
#: What macOS packs beside the files.
_ASIDE = ("__MACOSX/", ".DS_Store")
#: Members by which an archive is a document of its own.
_DOCUMENTS = ("[Content_Types].xml", "mimetype")


def opened(file: Path) -> tuple[bytes, tuple[str, ...]]:
    """Return what a file holds, expanded where it is compressed.

    Parameters
    ----------
    file : Path
        The file: as it is, or compressed by gzip, bzip2, xz, or zip with a single member.

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
        If a compressed file is damaged, or an archive holds several files.
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
        elif data.startswith(_ZIP):
            member = _single_member(data, file)
            if member is None:
                break
            kind, data = "zip", member
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


def _single_member(data: bytes, file: Path) -> bytes | None:
    """The only file in a zip archive; None for a document that is packed as one."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = [m for m in archive.infolist() if not m.is_dir() and not m.filename.startswith(_ASIDE)]
            if any(m.filename in _DOCUMENTS for m in members):
                return None
            if len(members) != 1:
                names = ", ".join(m.filename for m in members[:5]) + (", ..." if len(members) > 5 else "")
                raise ForeignFileError(
                    f"'{file}' is a zip archive of {len(members)} files: {names}. Unpack it and name one of them."
                )
            with archive.open(members[0]) as stream:
                inside = stream.read(LARGEST + 1)
    except ForeignFileError:
        raise
    except Exception:  # a damaged archive fails in many ways, and one with a password in another
        raise ForeignFileError(f"'{file}' is a zip archive that cannot be opened. Unpack it first.") from None
    if len(inside) > LARGEST:
        raise _too_large(file, "expands to something")
    return inside
