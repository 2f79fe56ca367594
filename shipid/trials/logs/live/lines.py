"""The lines of a log that is still being written, whatever bytes are in them."""

from __future__ import annotations

import codecs
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from shipid.foundation.errors import MissingFileError
from shipid.trials.errors import NotALiveLogError

#: How often a file that has come to its end is looked at again [s].
_LOOK_AGAIN = 0.05
#: Characters of the longest line.
_LONGEST = 1_000_000
#: What files begin with that are no text.
_MAGIC = {
    b"PAR1": "a Parquet file", b"\x1f\x8b": "compressed by gzip", b"PK\x03\x04": "a zip archive, such as an Excel sheet",
    b"\x89HDF": "an HDF5 file", b"MATLAB": "a MATLAB file", b"BZh": "compressed by bzip2", b"\xfd7zXZ": "compressed by xz",
}  # fmt: skip
_UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def _as_cp1252(error: UnicodeError) -> tuple[str, int]:
    """Read the bytes that are not UTF-8 as cp1252, as a record with such bytes is read (a logger's degree sign)."""
    assert isinstance(error, UnicodeDecodeError)
    return error.object[error.start : error.end].decode("cp1252", "replace"), error.end


codecs.register_error("shipid.cp1252", _as_cp1252)


def lines_of(source: str, wait: float, encoding: str | None = None) -> Iterator[str]:
    """Read lines as they are written.

    Parameters
    ----------
    source : str
        A file, or ``-`` for standard input, which ends when it is closed.
    wait : float
        Seconds without a new line after which a file is taken to have ended.
    encoding : str, optional
        The text encoding; UTF-8 by default, or UTF-16 where a mark at the beginning says so.

    Yields
    ------
    str
        A line; the last one may lack its end.

    Raises
    ------
    MissingFileError
        If there is no such file.
    NotALiveLogError
        If it is not text, or a line has no end.
    """
    if source == "-":
        yield from _whole(_standard_input(encoding), source)
        return
    path = Path(source)
    if not path.is_file():
        raise MissingFileError(f"there is no file {source} to follow.")
    with path.open("rb") as file:
        chosen = encoding or _encoding(file.read(8), source)
    with path.open(encoding=chosen, errors="shipid.cp1252") as stream:
        quiet, part = 0.0, ""
        while quiet < wait:
            line = stream.readline(_LONGEST)
            if line.endswith("\n"):
                yield part + line
                quiet, part = 0.0, ""
                continue
            # A line that is still being written is finished by what comes next.
            part += line
            if len(part) >= _LONGEST:
                raise _no_end(source)
            time.sleep(_LOOK_AGAIN)
            quiet = 0.0 if line else quiet + _LOOK_AGAIN
        if part.strip():
            yield part


def _standard_input(encoding: str | None) -> TextIO:
    stream = sys.stdin
    buffer = getattr(stream, "buffer", None)
    if buffer is None:  # text that a program hands over
        return stream
    head = buffer.peek(8)[:8] if hasattr(buffer, "peek") else b""
    stream.reconfigure(encoding=encoding or _encoding(head, "standard input"), errors="shipid.cp1252")  # type: ignore[union-attr]
    return stream


def _encoding(head: bytes, source: str) -> str:
    for magic, what in _MAGIC.items():
        if head.startswith(magic):
            raise NotALiveLogError(
                f"{source} is {what}, and lines are followed in text only. Read it whole: shipid filter FILE."
            )
    return "utf-16" if head.startswith(_UTF16) else "utf-8-sig"


def _whole(stream: TextIO, source: str) -> Iterator[str]:
    while line := stream.readline(_LONGEST):
        if len(line) >= _LONGEST:
            raise _no_end(source)
        yield line


def _no_end(source: str) -> NotALiveLogError:
    return NotALiveLogError(
        f"{source}: a line of more than {_LONGEST} characters has no end, so this is no log. Check what is written there."
    )
