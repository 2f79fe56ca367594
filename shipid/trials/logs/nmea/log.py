"""A whole log: every sentence sorted by kind and talker, and everything that is not one counted and named."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.nmea.errors import BrokenLogError, NotNmeaError
from shipid.trials.logs.nmea.lines import checksum, split_line, stamp_reader, tag_time
from shipid.trials.logs.nmea.sentences import CARRIED, parser
from shipid.trials.logs.nmea.settings import NmeaFormat

if TYPE_CHECKING:
    from pynmeagps import NMEAMessage

_NAN = float("nan")


@dataclass(frozen=True)
class Records:
    """All sentences of one kind and talker.

    Attributes
    ----------
    order : ndarray of int, shape (n,)
        Which sentence of the log each is, counted from 0.
    values : ndarray, shape (n, k)
        The fields of `shipid.trials.logs.nmea.sentences.CARRIED`; NaN where empty or not valid.
    """

    order: np.ndarray
    values: np.ndarray


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
    records : dict
        By kind and talker, ``("HDT", "HE")``.
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
    records: dict[tuple[str, str], Records]
    others: Counter[str]
    head: tuple[str, ...]
    notes: list[str] = field(default_factory=list)

    def seen(self) -> str:
        """Return the sentences of the log in words: ``HEHDT (1200), GPZDA (60)``."""
        counts = Counter({talker + kind: len(r.order) for (kind, talker), r in self.records.items()}) + self.others
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
    MissingExtraError
        If pynmeagps is not installed.
    """
    parse, collector = parser(), _Collector(fmt)
    for number, line in enumerate(_lines(file, fmt), 1):
        collector.add(number, line, parse)
    return collector.log(f"'{file}'")


def _lines(file: Path, fmt: NmeaFormat) -> Iterator[str]:
    with file.open("rb") as stream:
        head = stream.read(4096)
    if fmt.encoding is None and b"\x00" in head:
        utf16 = head[:2] in (b"\xff\xfe", b"\xfe\xff") or head[1::2].count(0) > len(head) // 4
        raise NotNmeaError(
            f"'{file}' is not plain text: it holds zero bytes. "
            + (
                "It looks like UTF-16, as some terminals write it: save it as UTF-8, or state encoding = 'utf-16' beside "
                "[nmea] in a format file."
                if utf16
                else "An NMEA 0183 log is text with one sentence a line; name that file."
            )
        )
    encoding = fmt.encoding or "utf-8-sig"
    try:
        with file.open(encoding=encoding, errors="replace") as text:
            yield from text
    except UnicodeError as error:
        raise NotNmeaError(f"'{file}' cannot be read as {encoding}: {error}. Correct the encoding.") from None


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
        self.exact = 0
        self.found: dict[tuple[str, str], tuple[array[int], array[float]]] = {}
        self.others: Counter[str] = Counter()
        self.broken, self.wrong = array("q"), array("q")
        self.lines = self.contents = 0
        self.text = ""

    def add(self, number: int, line: str, parse: Callable[[str], NMEAMessage | None]) -> None:
        self.lines, self.text = number, line
        text = line.strip()
        if not text:
            return
        if text.startswith(self.comment):
            if not self.contents:
                self.head.append(text.lstrip("#;/").strip())
            return
        self.contents += 1
        sentence = split_line(text)
        if sentence is None:
            self.broken.append(number)
            return
        stamp, sound = tag_time(sentence.front) if "\\" in sentence.front else (None, True)
        if not sound or (sentence.checksum and checksum(sentence.text[1:]) != sentence.checksum.upper()):
            self.wrong.append(number)
            return
        address, kind, talker = sentence.address, sentence.address[2:], sentence.address[:2]
        values: tuple[float, ...] = ()
        known = kind in CARRIED and address[0] != "P" and sentence.text[0] == "$"
        if known:
            message = parse(sentence.text)
            try:
                values = () if message is None else CARRIED[kind][1](message)
            except AttributeError:  # too few fields
                values = ()
            if not values:
                self.broken.append(number)
                return
        if "$" in sentence.front:
            self.broken.append(number)  # half a sentence stands before this one
        if stamp is None and sentence.front:
            stamp = self.stamp(sentence.front)
        if stamp is not None and not self.use_tags:
            stamp = None
        if known:
            order, fields = self.found.setdefault((kind, talker), (array("q"), array("d")))
            order.append(len(self.numbers))
            fields.extend(values)
        else:
            self.others[address] += 1
        self.numbers.append(number)
        self.stamps.append(_NAN if stamp is None else stamp.time)
        self.dated.append(stamp is not None and stamp.dated)
        self.summed.append(sentence.checksum is not None)
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
            notes.append("WARNING: no sentence has a checksum, so lines garbled on the wire are not found out.")
        records = {}
        for key, (order, fields) in self.found.items():
            at = np.array(order, dtype=int)
            values = np.array(fields, dtype=float).reshape(len(at), -1)
            records[key] = Records(at[keep[at]], values[keep[at]])
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

    def _judge(self, where: str, good: int, broken: list[int]) -> None:
        bad = len(broken) + len(self.wrong)
        if not good and not self.wrong:
            raise NotNmeaError(
                f"{where} is not an NMEA 0183 log: none of its {self.contents} lines holds a sentence such as "
                "$HEHDT,123.4,T*2D. Leave out --format nmea for a table, or name the log."
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
