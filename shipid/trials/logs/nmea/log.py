"""A whole log: every sentence sorted by kind and talker, and everything that is not one counted and named."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.nmea.errors import BrokenLogError, NotNmeaError
from shipid.trials.logs.nmea.lines import checksum, sentences_of, split_line, stamp_reader, tag_source, tag_time
from shipid.trials.logs.nmea.sentences import CARRIED
from shipid.trials.logs.nmea.settings import NmeaFormat

LONGEST_LINE = 65536
"""A longer line is read in pieces: it is no line of a log, and a file without line ends has to fit into the memory."""
_NAN = float("nan")


class Origin(NamedTuple):
    """Where values come from.

    Attributes
    ----------
    kind : str
        The sentence, ``HDT``, or the PGN, ``127250``.
    talker : str
        The talker, ``HE``; empty for a PGN.
    stream : str
        Which of several devices with one talker; the source address of a PGN.
    """

    kind: str
    talker: str = ""
    stream: str = ""

    @property
    def name(self) -> str:
        """As a format file writes it: ``HEHDT``, ``GPGGA#2``, ``127250#52``."""
        return self.talker + self.kind + (f"#{self.stream}" if self.stream else "")


@dataclass(frozen=True)
class Records:
    """All sentences of one origin.

    Attributes
    ----------
    order : ndarray of int, shape (n,)
        Which sentence of the log each is, counted from 0.
    values : ndarray, shape (n, k)
        What they carry; NaN where empty or not valid.
    fields : tuple of str
        The names of the k fields, as in `shipid.trials.logs.nmea.sentences.CARRIED`.
    """

    order: np.ndarray
    values: np.ndarray
    fields: tuple[str, ...]

    def column(self, name: str) -> np.ndarray:
        """Return the values of a field, shape (n,).

        Parameters
        ----------
        name : str
            One of `fields`.
        """
        return np.asarray(self.values[:, self.fields.index(name)])

    def keep(self, mask: np.ndarray) -> Records:
        """Return some of the sentences.

        Parameters
        ----------
        mask : ndarray of bool, shape (n,)
            Which.
        """
        return Records(self.order[mask], self.values[mask], self.fields)


@dataclass(frozen=True)
class NmeaLog:
    """A log, read.

    Attributes
    ----------
    where : str
        The file, for messages.
    numbers : ndarray of int, shape (n,)
        Line of each sentence, counted from 1.
    stamps : ndarray, shape (n,)
        The logger's stamps [s]; NaN where there is none.
    dated : bool
        Whether the stamps count from 1970; otherwise from midnight.
    exact : bool
        Whether the stamps show parts of a second.
    records : dict of Origin to Records
        The sentences that are read.
    others : Counter
        How often each address occurs that is not read.
    head : tuple of str
        The comment lines before the first sentence.
    notes : list of str
        What was left out, with line numbers.
    """

    where: str
    numbers: np.ndarray
    stamps: np.ndarray
    dated: bool
    exact: bool
    records: dict[Origin, Records]
    others: Counter[str]
    head: tuple[str, ...]
    notes: list[str] = field(default_factory=list)

    def seen(self) -> str:
        """Return the sentences of the log in words: ``HEHDT (1200), GPZDA (60)``."""
        counts = Counter({origin.name: len(r.order) for origin, r in self.records.items()}) + self.others
        shown = ", ".join(f"{address} ({n})" for address, n in counts.most_common(12))
        return shown + (f" and {len(counts) - 12} others" if len(counts) > 12 else "")


def read_log(file: Path, fmt: NmeaFormat) -> NmeaLog:
    """Read a log.

    Parameters
    ----------
    file : Path
        The file; text with one sentence a line.
    fmt : NmeaFormat
        How the logger wrote it.

    Returns
    -------
    NmeaLog

    Raises
    ------
    EmptyFileError, NotNmeaError, BrokenLogError
        If there is nothing in it, nothing that is NMEA, or mostly broken lines.
    """
    collector = _Collector(fmt)
    encoding = fmt.encoding or encoding_of(file)
    number, whole = 0, True
    try:
        with file.open(encoding=encoding, errors="replace") as text:
            for line in iter(lambda: text.readline(LONGEST_LINE), ""):
                number += whole
                whole = line.endswith("\n")
                collector.add(number, line)
    except UnicodeError as error:
        raise NotNmeaError(f"'{file}' cannot be read as {encoding}: {error}. Correct the encoding.") from None
    log = collector.log(f"'{file}'")
    if encoding.startswith("utf-16") and fmt.encoding is None:
        log.notes.append("The file is text in UTF-16, and was read as such.")
    return log


def encoding_of(file: Path) -> str:
    """Return the encoding of a log: UTF-16 where every other byte of its head is zero, as some terminals write, else UTF-8.

    Parameters
    ----------
    file : Path
        The file.
    """
    with file.open("rb") as stream:
        head = stream.read(4096)
    if head[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16"
    for first, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        if head[first::2].count(0) > len(head) // 4 > head[1 - first :: 2].count(0):
            return name
    return "utf-8-sig"


class _Collector:
    """Sorts lines as they come."""

    def __init__(self, fmt: NmeaFormat) -> None:
        self.stamp = stamp_reader(fmt.stamp)
        self.use_tags = fmt.stamp != "none"
        self.comment = tuple({fmt.comment, "#", ";", "//"})
        self.head: list[str] = []
        self.numbers, self.stamps, self.dated = array("q"), array("d"), array("b")
        self.summed, self.addresses = array("b"), array("q")
        self.known: dict[str, int] = {}
        self.exact = self.stars = 0
        self.found: dict[Origin, tuple[array[int], array[float]]] = {}
        self.others: Counter[str] = Counter()
        self.broken, self.wrong = array("q"), array("q")
        self.lines = self.contents = 0
        self.text = ""

    def add(self, number: int, line: str) -> None:
        self.lines, self.text = number, line
        text = line.strip(" \t\r\n\x00\x1a")  # some loggers allot a file in advance, and fill it with zeros
        if not text:
            return
        if text.startswith(self.comment):
            if not self.contents:
                self.head.append(text.lstrip("#;/").strip())
            return
        for piece in sentences_of(text):
            self.contents += 1
            self._take(number, piece)

    def _take(self, number: int, text: str) -> None:
        sentence = split_line(text)
        if sentence is None:
            self.broken.append(number)
            return
        stamp, sound = tag_time(sentence.front) if "\\" in sentence.front else (None, True)
        if not sound or (sentence.checksum and checksum(sentence.text[1:]) != sentence.checksum.upper()):
            self.wrong.append(number)
            return
        address, kind, talker = sentence.address, sentence.address[-3:], sentence.address[:-3]
        known = kind in CARRIED and address[0] != "P" and sentence.text[0] == "$"  # P: proprietary, as Garmin's PGRMC
        values: tuple[float, ...] = ()
        if known:
            try:
                values = CARRIED[kind][1](sentence.text.split(","))
            except ValueError:
                self.broken.append(number)
                return
        if "$" in sentence.front:
            self.broken.append(number)  # half a sentence stands before this one
        if stamp is None and sentence.front:
            stamp = self.stamp(sentence.front)
        if stamp is not None and not self.use_tags:
            stamp = None
        if known:
            origin = Origin(kind, talker, tag_source(sentence.front) if "\\" in sentence.front else "")
            order, fields = self.found.setdefault(origin, (array("q"), array("d")))
            order.append(len(self.numbers))
            fields.extend(values)
        else:
            self.others[address] += 1
        self.numbers.append(number)
        self.stamps.append(_NAN if stamp is None else stamp.time)
        self.dated.append(stamp is not None and stamp.dated)
        self.summed.append(sentence.checksum is not None)
        self.stars += sentence.checksum is None and text.endswith("*")
        self.addresses.append(self.known.setdefault(address, len(self.known)))
        self.exact += stamp is not None and stamp.exact

    def log(self, where: str) -> NmeaLog:
        if not self.contents:
            raise EmptyFileError(
                f"{where} holds no sentences, only {self.lines} empty or comment lines. Check that the log was written "
                "and copied completely."
            )
        numbers, stamps = np.array(self.numbers, dtype=int), np.array(self.stamps, dtype=float)
        summed, dated = np.array(self.summed, dtype=bool), np.array(self.dated, dtype=bool)
        cut, broken = False, list(self.broken)
        torn = not self.text.endswith(("\n", "\r"))
        # A device sends checksums or it does not: a line that lacks one beside others that have it was cut.
        address = np.array(self.addresses, dtype=int)
        keep = summed | ~np.isin(address, np.unique(address[summed]))
        broken = sorted({*broken, *numbers[~keep].tolist()})
        if torn and keep.size and numbers[-1] == self.lines and keep[-1] and not summed[-1]:
            keep[-1] = False  # nothing says whether it is whole
            broken.append(self.lines)
        if torn and self.lines in broken:
            cut = True
            broken.remove(self.lines)
        self._judge(where, int(keep.sum()), broken)
        notes = []
        if cut:
            notes.append(f"The last line ({self.lines}) is cut off and was left out.")
        notes += _named(broken, "left out as broken (not a whole sentence, or fields that are not numbers)")
        notes += _named(list(self.wrong), "left out for a wrong checksum")
        if not summed.any():
            bare = f" ({self.stars} end in a star without one)" if self.stars else ""
            notes.append(f"WARNING: no sentence has a checksum{bare}, so lines garbled on the wire are not found out.")
        records = {}
        for origin, (order, fields) in self._by_source():
            at = np.array(order, dtype=int)
            names = CARRIED[origin.kind][0]
            values = np.array(fields, dtype=float).reshape(-1, len(names))
            records[origin] = Records(at, values, names).keep(keep[at])
        # Stamps of the rarer kind cannot be told in time from the others.
        has = np.isfinite(stamps)
        majority = bool(dated[has].mean() > 0.5) if has.any() else False
        stamps = np.where(dated == majority, stamps, np.nan)
        return NmeaLog(
            where,
            numbers,
            stamps,
            majority,
            self.exact > 0.05 * has.sum(),
            records,
            self.others,
            tuple(self.head),
            notes,
        )

    def _by_source(self) -> Iterator[tuple[Origin, tuple[array[int], array[float]]]]:
        """The sentences by origin; what a TAG block names as their source counts where one talker has several."""
        sources = Counter((origin.kind, origin.talker) for origin in self.found)
        for origin, content in self.found.items():
            alone = sources[origin.kind, origin.talker] == 1
            yield origin._replace(stream="") if alone else origin, content

    def _judge(self, where: str, good: int, broken: list[int]) -> None:
        bad = len(broken) + len(self.wrong)
        if not good and not self.wrong:
            raise NotNmeaError(
                f"{where} is not an NMEA log: none of its {self.contents} lines holds a sentence such as "
                "$HEHDT,123.4,T*2D, or a message in canboat's form. Leave out --format nmea for a table, or name the log."
            )
        if bad > good:
            first = sorted([*broken, *self.wrong])[:3]
            raise BrokenLogError(
                f"{where}: {bad} of {self.contents} lines are broken ({len(self.wrong)} have a wrong checksum), the "
                f"first in lines {', '.join(map(str, first))}. Check the baud rate of the logger and how the file was "
                "copied."
            )


def _named(lines: list[int], what: str) -> list[str]:
    if not lines:
        return []
    first = ", ".join(str(n) for n in lines[:5]) + (", ..." if len(lines) > 5 else "")
    return [f"{len(lines)} {'lines were' if len(lines) > 1 else 'line was'} {what}: {first}."]
