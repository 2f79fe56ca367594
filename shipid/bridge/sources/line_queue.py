"""Lines as they arrive over a network, between two readings: so many at most, none too long, whatever bytes are in them."""

from __future__ import annotations

from collections import deque

#: A line is no longer than this, in bytes: a sentence has 82, a TAG block before it as many again. So many lines wait at most.
LONGEST_LINE, _MOST = 1024, 4000


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
