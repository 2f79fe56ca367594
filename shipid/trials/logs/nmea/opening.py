"""What a file is, by what its lines look like, and the log it holds."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from shipid.trials.logs.nmea.errors import NotNmeaError
from shipid.trials.logs.nmea.log import NmeaLog
from shipid.trials.logs.nmea.messages.canboat import is_message, read_messages
from shipid.trials.logs.nmea.sentences.collecting import is_sentence, read_sentences
from shipid.trials.logs.nmea.settings import NmeaFormat
from shipid.trials.logs.tables.opening import opened

LONGEST_LINE = 65536
"""A longer line is read in pieces: it is no line of a log, and a file without line ends has to fit into the memory."""
_HEAD = 65536
_COMPRESSED = (b"\x1f\x8b", b"BZh", b"\xfd7zXZ", b"PK\x03\x04")
_FEWEST = 3
"""Fewer sentences or messages do not make a log that is recognised by itself."""


def read_log(file: Path, fmt: NmeaFormat) -> NmeaLog:
    """Read a log of NMEA 0183 sentences, or of NMEA 2000 messages in canboat's form.

    Parameters
    ----------
    file : Path
        The file; text with one sentence or message a line.
    fmt : NmeaFormat
        How the logger wrote it.

    Returns
    -------
    NmeaLog

    Raises
    ------
    EmptyFileError, NotNmeaError, BrokenLogError
        If there is nothing in it, nothing that is NMEA, or mostly broken lines.
    FileSizeError, ForeignFileError
        If it is compressed, and expands to too much or is damaged.
    """
    encoding = fmt.encoding or encoding_of(file)
    sentences, messages, _ = _counted(file, encoding)
    read = read_messages if messages > sentences else read_sentences
    try:
        log = read(_lines(file, encoding), f"'{file}'", fmt)
    except UnicodeError as error:
        raise NotNmeaError(f"'{file}' cannot be read as {encoding}: {error}. Correct the encoding.") from None
    if encoding.startswith("utf-16") and fmt.encoding is None:
        log.notes.append("The file is text in UTF-16, and was read as such.")
    return log


def is_nmea(file: Path) -> bool:
    """Return whether a file is unmistakably an NMEA log: most lines of its head are sentences or messages.

    Parameters
    ----------
    file : Path
        The file.
    """
    sentences, messages, contents = _counted(file, encoding_of(file))
    most = max(sentences, messages)
    return most >= _FEWEST and most > contents / 2


def encoding_of(file: Path) -> str:
    """Return the encoding of a log: UTF-16 where every other byte of its head is zero, as some terminals write, else UTF-8.

    Parameters
    ----------
    file : Path
        The file.
    """
    with _stream(file) as stream:
        head = stream.read(4096)
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    for first, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        if head[first::2].count(0) > len(head) // 4 > head[1 - first :: 2].count(0):
            return name
    return "utf-8-sig"


def _stream(file: Path) -> BinaryIO:
    """The bytes of a file, expanded where it is compressed: then within bounds, and otherwise as they are read."""
    with file.open("rb") as stream:
        compressed = stream.read(8).startswith(_COMPRESSED)
    return io.BytesIO(opened(file)[0]) if compressed else file.open("rb")


def _lines(file: Path, encoding: str) -> Iterator[tuple[int, str]]:
    """Number and text of each line."""
    number, whole = 0, True
    with io.TextIOWrapper(_stream(file), encoding, "replace") as text:
        for line in iter(lambda: text.readline(LONGEST_LINE), ""):
            number += whole
            whole = line.endswith("\n")
            yield number, line


def _counted(file: Path, encoding: str) -> tuple[int, int, int]:
    """Sentences, messages and lines with anything but a comment in the head of a file."""
    with _stream(file) as stream:
        head = stream.read(_HEAD)
    lines = [line.strip(" \t\x00") for line in head.decode(encoding, "replace").splitlines()]
    lines = [
        line for line in (lines[:-1] if len(head) == _HEAD else lines) if line and not line.startswith(("#", ";", "//"))
    ]
    return sum(map(is_sentence, lines)), sum(map(is_message, lines)), len(lines)
