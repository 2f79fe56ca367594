"""The log of NMEA 2000 messages in canboat's text form: ``time,priority,PGN,source,destination,length,hex bytes``.

canboat writes a message of several frames as a whole (FAST) or frame by frame (PLAIN); frames are put together here.
"""

from __future__ import annotations

import re
from array import array
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from shipid.trials.errors import EmptyFileError
from shipid.trials.logs.nmea.errors import BrokenLogError
from shipid.trials.logs.nmea.log import NmeaLog, Origin, Records, named_lines
from shipid.trials.logs.nmea.messages.decoding import CARRIED, FAST_PACKETS, INSTANCES, decoded
from shipid.trials.logs.nmea.sentences.lines import stamp_reader
from shipid.trials.logs.nmea.settings import NmeaFormat

_MESSAGE = re.compile(
    r"(\d{4}-\d\d-\d\d[-T ]\d\d:\d\d:\d\d(?:[.,]\d+)?Z?),(\d{1,2}),(\d{5,6}),(\d{1,3}),(\d{1,3}),(\d{1,4}),"
    r"([0-9A-Fa-f]{2}(?:,[0-9A-Fa-f]{2})*+)\s*$"
)


def is_message(line: str) -> bool:
    """Return whether a line is a message in canboat's text form.

    Parameters
    ----------
    line : str
        One line of a log.
    """
    return _MESSAGE.match(line) is not None


def read_messages(lines: Iterable[tuple[int, str]], where: str, fmt: NmeaFormat) -> NmeaLog:
    """Return the log that lines of messages make.

    Parameters
    ----------
    lines : iterable of (int, str)
        Number and text of each line.
    where : str
        The file, for messages.
    fmt : NmeaFormat
        Its layout of stamps does not count: canboat has its own.

    Returns
    -------
    NmeaLog

    Raises
    ------
    EmptyFileError, BrokenLogError
        If there is nothing in it, or mostly broken lines.
    """
    collector = _Collector()
    for number, line in lines:
        collector.add(number, line.strip(" \t\r\n\x00\x1a"))
    return collector.log(where)


class BrokenMessageError(ValueError):
    """A line that is no whole message."""


@dataclass(frozen=True)
class Message:
    """One line of a log.

    Attributes
    ----------
    time : float
        In s since 1970.
    pgn, source : int
        Number of the parameter group, and address of the device.
    data : bytes or None
        What is read of it; None for a PGN that is not read, and for a frame that does not complete a message.
    """

    time: float
    pgn: int
    source: int
    data: bytes | None

    @property
    def stream(self) -> str:
        """The device, and which of several behind one address: an instance of its own is a source of its own."""
        instance = self.data[0] if self.data is not None and self.pgn in INSTANCES else 0
        return f"{self.source}.{instance}" if 0 < instance < 250 else str(self.source)


class MessageReader:
    """Takes lines apart, and puts the frames of a message together."""

    def __init__(self) -> None:
        self._stamp = stamp_reader("iso")
        self._packets: dict[tuple[int, int, int], bytearray] = {}

    def take(self, text: str) -> Message:
        """Return the message of a line.

        Parameters
        ----------
        text : str
            The line.

        Returns
        -------
        Message

        Raises
        ------
        BrokenMessageError
            If it is no whole message.
        """
        match = _MESSAGE.match(text)
        stamp = self._stamp(match[1]) if match else None
        if match is None or stamp is None:
            raise BrokenMessageError
        pgn, source, data = int(match[3]), int(match[4]), bytes.fromhex(match[7].replace(",", ""))
        if len(data) != int(match[6]):
            raise BrokenMessageError
        whole: bytes | None = data
        if pgn not in CARRIED:
            return Message(stamp.time, pgn, source, None)
        if pgn in FAST_PACKETS and len(data) == 8:
            whole = self._put_together(pgn, source, data)
        if whole is not None and len(whole) < CARRIED[pgn][0]:
            raise BrokenMessageError
        return Message(stamp.time, pgn, source, whole)

    def _put_together(self, pgn: int, source: int, frame: bytes) -> bytes | None:
        """Keep a frame; the message, where it is the last one. Byte 0: sequence and number of the frame; then the length."""
        key, number = (pgn, source, frame[0] >> 5), frame[0] & 31
        if number == 0:
            self._packets[key] = bytearray(frame[1:])
        elif key in self._packets and len(self._packets[key]) == 7 * number:
            self._packets[key].extend(frame[1:])
        else:
            self._packets.pop(key, None)  # a frame is lost, and with it the message
            return None
        packet = self._packets[key]
        if len(packet) - 1 < packet[0]:
            return None
        return bytes(self._packets.pop(key)[1 : packet[0] + 1])


class _Collector:
    """Sorts messages by PGN as they come; their bytes are decoded all at once."""

    def __init__(self) -> None:
        self.reader = MessageReader()
        self.head: list[str] = []
        self.numbers, self.stamps, self.broken = array("q"), array("d"), array("q")
        self.found: dict[int, tuple[array[int], array[int], bytearray]] = {}
        self.others: Counter[str] = Counter()
        self.lines = 0

    def add(self, number: int, text: str) -> None:
        if not text:
            return
        if text.startswith("#"):
            if not self.numbers:
                self.head.append(text.lstrip("# "))
            return
        self.lines += 1
        try:
            message = self.reader.take(text)
        except BrokenMessageError:
            self.broken.append(number)
            return
        pgn, data = message.pgn, message.data
        if pgn not in CARRIED:
            self.others[f"PGN {pgn}"] += 1
        if data is None:
            return
        order, sources, content = self.found.setdefault(pgn, (array("q"), array("q"), bytearray()))
        order.append(len(self.numbers))
        sources.append(message.source * 256 + (data[0] if pgn in INSTANCES else 0))
        content.extend(data[: CARRIED[pgn][0]])
        self.numbers.append(number)
        self.stamps.append(message.time)

    def log(self, where: str) -> NmeaLog:
        if not self.lines:
            raise EmptyFileError(f"{where} holds no messages. Check that the log was written and copied completely.")
        if len(self.broken) > self.lines / 2:
            first = ", ".join(map(str, self.broken[:3]))
            raise BrokenLogError(
                f"{where}: {len(self.broken)} of {self.lines} lines are broken, the first in lines {first}. Check how the file "
                "was written and copied."
            )
        notes = named_lines(list(self.broken), "left out as broken (not a whole message)")
        records = dict(self._records())
        n = len(self.numbers)
        return NmeaLog(
            where,
            np.array(self.numbers, dtype=int),
            np.array(self.stamps, dtype=float),
            True,
            bool(n) and bool(np.any(np.mod(self.stamps, 1.0) != 0)),
            records,
            self.others,
            tuple(self.head),
            notes,
        )

    def _records(self) -> Iterator[tuple[Origin, Records]]:
        for pgn, (order, sources, content) in sorted(self.found.items()):
            width, fields, _ = CARRIED[pgn]
            values = decoded(pgn, np.frombuffer(content, dtype=np.uint8).reshape(-1, width))
            every = Records(np.array(order, dtype=int), values, fields)
            numbers = np.array(sources, dtype=int)
            for number in np.unique(numbers):
                source, instance = divmod(int(number), 256)
                name = f"{source}.{instance}" if 0 < instance < 250 else str(source)
                yield Origin(str(pgn), "", name), every.keep(numbers == number)
