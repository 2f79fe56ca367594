"""The log of NMEA 0183 sentences: each is checked, taken apart and sorted as its line comes."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator

import numpy as np

from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.nmea.errors import BrokenLogError, NotNmeaError
from shipid.trials.logs.nmea.log import NmeaLog, Origin, Records, named_lines
from shipid.trials.logs.nmea.sentences.fields import CARRIED
from shipid.trials.logs.nmea.sentences.lines import (
    sentences_of,
    split_line,
    stamp_reader,
    tag_source,
    tag_time,
)
from shipid.trials.logs.nmea.settings import NmeaFormat

_NAN = float("nan")


def is_sentence(line: str) -> bool:
    """Return whether a line holds a sentence: its checksum says so, or its address where it has none.

    Parameters
    ----------
    line : str
        One line of a log.
    """
    found = split_line(line)
    if found is None:
        return False
    if found.checksum:
        return found.whole
    return found.address[-3:] in CARRIED and found.address[0] != "P" and "," in found.text


def read_sentences(lines: Iterable[tuple[int, str]], where: str, fmt: NmeaFormat) -> NmeaLog:
    """Return the log that lines of sentences make.

    Parameters
    ----------
    lines : iterable of (int, str)
        Number and text of each line, with its end.
    where : str
        The file, for messages.
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
    for number, line in lines:
        collector.add(number, line)
    return collector.log(where)


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
        if not sound or not sentence.whole:
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
        notes += named_lines(broken, "left out as broken (not a whole sentence, or fields that are not numbers)")
        notes += named_lines(list(self.wrong), "left out for a wrong checksum")
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
