"""What a file is, by what its lines look like, and the log it holds."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from shipid.trials.logs.nmea.errors import NotNmeaError
from shipid.trials.logs.nmea.log import NmeaLog
from shipid.trials.logs.nmea.messages.canboat import is_message, read_messages
from shipid.trials.logs.nmea.sentences.collecting import is_sentence, read_sentences
from shipid.trials.logs.nmea.sentences.lines import sentences_of
from shipid.trials.logs.nmea.settings import NmeaFormat
from shipid.trials.logs.tables.archive import in_archive
from shipid.trials.logs.tables.opening import opened

LONGEST_LINE = 65536
"""A longer line is read in pieces: it is no line of a log, and a file without line ends has to fit into the memory."""
_HEAD = 65536
_LONGEST_SENTENCE = 1024
"""With the stamp before it; the standard allows 82 characters."""
_COMPRESSED = (b"\x1f\x8b", b"BZh", b"\xfd7zXZ", b"PK\x03\x04")
_LIKE_A_SENTENCE = re.compile(
    r"(?:([$!])|(?<![A-Za-z0-9$!]))[A-Za-z]{2}(?i:HDT|HDG|HDM|THS|RSA|ROR|ROT|GGA|RMC|GLL|VTG|VHW|VBW|ZDA),[^*]*+(\*)?"
)
_FEWEST = 3
"""Fewer sentences or messages do not make a log that is recognised by itself."""


def read_log(file: Path, fmt: NmeaFormat, part: str | None = None) -> NmeaLog:
    """Read a log of NMEA 0183 sentences, or of NMEA 2000 messages in canboat's form.

    Parameters
    ----------
    file : Path
        The file; text with one sentence or message a line.
    fmt : NmeaFormat
        How the logger wrote it.
    part : str, optional
        The file in a zip archive.

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
    encoding = fmt.encoding or encoding_of(file, part)
    sentences, messages, _ = _counted(file, encoding, part)
    read = read_messages if messages > sentences else read_sentences
    try:
        log = read(_lines(file, encoding, part), f"'{file}'", fmt)
    except UnicodeError as error:
        raise NotNmeaError(f"'{file}' cannot be read as {encoding}: {error}. Correct the encoding.") from None
    if encoding.startswith("utf-16") and fmt.encoding is None:
        log.notes.append("The file is text in UTF-16, and was read as such.")
    return log


def is_nmea(file: Path, part: str | None = None) -> bool:
    """Return whether a file is unmistakably an NMEA log: most lines of its head are sentences or messages.

    Parameters
    ----------
    file : Path
        The file.
    part : str, optional
        The file in a zip archive.
    """
    sentences, messages, contents = _counted(file, encoding_of(file, part), part)
    most = max(sentences, messages)
    return most >= _FEWEST and most > contents / 2


def encoding_of(file: Path, part: str | None = None) -> str:
    """Return the encoding of a log: UTF-16 where every other byte of its head is zero, as some terminals write, else UTF-8.

    Parameters
    ----------
    file : Path
        The file.
    part : str, optional
        The file in a zip archive.
    """
    with _stream(file, part) as stream:
        head = stream.read(4096)
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    for first, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        if head[first::2].count(0) > len(head) // 4 > head[1 - first :: 2].count(0):
            return name
    return "utf-8-sig"


def _stream(file: Path, part: str | None) -> BinaryIO:
    """The bytes of a file, expanded where it is compressed: then within bounds, and otherwise as they are read."""
    with file.open("rb") as stream:
        compressed = stream.read(8).startswith(_COMPRESSED)
    return io.BytesIO(opened(file, in_archive(file, part)[0])[0]) if compressed else file.open("rb")


def _lines(file: Path, encoding: str, part: str | None) -> Iterator[tuple[int, str]]:
    """Number and text of each line."""
    number, whole, rest = 0, True, ""
    with io.TextIOWrapper(_stream(file, part), encoding, "replace") as text:
        for line in iter(lambda: text.readline(LONGEST_LINE), ""):
            number += whole
            whole = line.endswith("\n")
            line, rest = rest + line, ""
            if not whole and (behind := line.rfind("*") + 3) > len(line) - _LONGEST_SENTENCE:
                # A log that lost its line ends: the piece ends behind a checksum, and the sentence that is cut goes to the next.
                line, rest = line[:behind], line[behind:]
            yield number, line
    if rest:
        yield number, rest


def _counted(file: Path, encoding: str, part: str | None) -> tuple[int, int, int]:
    """Sentences, messages and lines with anything but a comment in the head of a file."""
    with _stream(file, part) as stream:
        head = stream.read(_HEAD)
    lines = [
        piece for line in head.decode(encoding, "replace").splitlines() for piece in sentences_of(line.strip(" \t\x00"))
    ]
    lines = [
        line for line in (lines[:-1] if len(head) == _HEAD else lines) if line and not line.startswith(("#", ";", "//"))
    ]
    return sum(map(is_sentence, lines)), sum(map(is_message, lines)), len(lines)


def why_no_nmea(file: Path, part: str | None = None) -> NotNmeaError | None:
    """Return what is wrong with a log whose lines look like NMEA 0183 sentences and are none; None for any other file.

    Parameters
    ----------
    file : Path
        A file that could not be read as a table.
    part : str, optional
        The file in a zip archive.
    """
    encoding = encoding_of(file, part)
    with _stream(file, part) as stream:
        lines = stream.read(_HEAD).decode(encoding, "replace").splitlines()
    like = [match for line in lines if (match := _LIKE_A_SENTENCE.search(line)) is not None]
    if len(like) < _FEWEST or len(like) * 2 < len(lines):
        return None
    marked, stars = sum(1 for match in like if match[1]), sum(1 for match in like if match[2])
    fault = (
        "no line has the sign $ in front of it"
        if marked * 2 < len(like)
        else "their checksums are wrong or cut short"
        if stars * 2 > len(like)
        else "they are no whole sentences"
    )
    return NotNmeaError(
        f"'{file}': the lines look like NMEA 0183 sentences ('{like[0][0].strip()[:40]}'), and {fault}. Check the baud rate of the "
        "logger, what it writes, and how the file was copied."
    )
