"""Lines as they arrive over a network, between two readings: so many at most, none too long, whatever bytes are in them."""

from __future__ import annotations

import re
from collections import deque

#: A line is no longer than this, in bytes: a sentence has 82, a TAG block before it as many again. So many lines wait at most.
LONGEST_LINE, _MOST = 1024, 4000
#: What a sentence or its TAG block begins with, and what a whole one ends with; so many senders are remembered.
_STARTS, _FINISHED, _MOST_SENDERS = (b"$", b"!", b"\\"), re.compile(rb"\*[0-9A-Fa-f]{2}\s*$"), 500


class LineQueue:
    """Lines that wait to be read.

    Attributes
    ----------
    dropped : int
        Lines that were left out since the last reading: too long, or too many.
    """

    def __init__(self) -> None:
        self.dropped = 0
        self._lines: deque[str] = deque()
        self._part = b""
        self._skips = False

    def feed(self, data: bytes, *, whole: bool) -> None:
        """Take bytes.

        Parameters
        ----------
        data : bytes
            What has come.
        whole : bool
            Whether it ends a line also where no line end does: a datagram.
        """
        *lines, rest = (self._part + data).replace(b"\r", b"\n").split(b"\n")
        if whole:
            lines, rest = [*lines, rest], b""
        for line in lines:
            if self._skips:
                self._skips = False
            elif len(line) > LONGEST_LINE:
                self.dropped += 1
            elif line.strip():
                self._lines.append(line.decode("latin-1"))
        if len(rest) > LONGEST_LINE:
            self.dropped += not self._skips
            rest, self._skips = b"", True
        self._part = rest
        while len(self._lines) > _MOST:
            self._lines.popleft()
            self.dropped += 1

    def cut(self) -> None:
        """Forget a line that was begun: the connection is gone, and what comes next begins a line."""
        self._part, self._skips = b"", False

    def take(self) -> tuple[list[str], int]:
        """Return the lines that wait, and how many were left out."""
        lines, dropped = list(self._lines), self.dropped
        self._lines.clear()
        self.dropped = 0
        return lines, dropped


class SplitLines:
    """Joins the lines of datagrams that end inside a sentence, as those of a serial port on a network do.

    What a sender left unfinished belongs to its next datagram, unless that begins a sentence. A sender that was never seen to split
    a line is not waited for: many send a line without its end.
    """

    def __init__(self) -> None:
        #: By sender: what was left unfinished, and whether it waits.
        self._rests: dict[str, tuple[bytes, bool]] = {}
        self._splitting: set[str] = set()

    def joined(self, data: bytes, sender: str) -> bytes:
        """Return the lines that a datagram completes.

        Parameters
        ----------
        data : bytes
            The datagram.
        sender : str
            Who sent it.
        """
        rest, waits = self._rests.pop(sender, (b"", False))
        if rest and not data.startswith(_STARTS):
            self._splitting.add(sender)
            data = rest + data
        elif waits:
            data = rest + b"\n" + data
        lines, end, rest = data.rpartition(b"\n")
        if not rest or _FINISHED.search(rest) or len(rest) > LONGEST_LINE:
            return data
        if max(len(self._rests), len(self._splitting)) >= _MOST_SENDERS:
            self._rests, self._splitting = {}, set()
        waits = sender in self._splitting
        self._rests[sender] = rest, waits
        return lines + end if waits else data
