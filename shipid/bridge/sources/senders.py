"""Who sends to a port of UDP: anybody may, and of two that send one sentence only one is heard."""

from __future__ import annotations

import re
from collections.abc import Callable

#: One that has sent nothing for so many seconds is gone; so many are remembered.
_GONE, _MOST = 5.0, 500
#: Talker and sentence. What other ships send or radars see may come from several receivers.
_ADDRESS = re.compile(rb"\$([A-Z0-9]{5,8}),")
_OF_OTHERS = (b"TTM", b"TLL")


class Senders:
    """Of each sentence the first one that sends it again and again, until it is gone.

    Some programs send every datagram from a port of its own: who has sent once only holds nothing.

    Parameters
    ----------
    say : callable
        Takes what there is to say.
    clock : callable
        Returns the time in s.
    """

    def __init__(self, say: Callable[[str], None], clock: Callable[[], float]) -> None:
        self._say, self._clock = say, clock
        #: By sentence and sender: how often it was sent, and when last; by sentence: who is heard.
        self._sent: dict[tuple[bytes, str], tuple[int, float]] = {}
        self._heard: dict[bytes, str] = {}

    def kept(self, data: bytes, sender: str) -> bytes:
        """Return the lines of a datagram that are to be heard.

        Parameters
        ----------
        data : bytes
            The datagram.
        sender : str
            Who sent it.
        """
        return b"\n".join(line for line in data.splitlines() if self._keeps(line, sender))

    def _keeps(self, line: bytes, sender: str) -> bool:
        found = _ADDRESS.search(line)
        if found is None or found[1].endswith(_OF_OTHERS):
            return True
        kind, now = found[1], self._clock()
        if len(self._sent) > _MOST:
            fresh = {k: v for k, v in self._sent.items() if now - v[1] < _GONE}
            # A flood of names is nobody's: it must not cost more with every line.
            self._sent = fresh if len(fresh) < _MOST // 2 else {}
            self._heard = {k: s for k, s in self._heard.items() if (k, s) in self._sent}
        times, _ = self._sent.get((kind, sender), (0, now))
        self._sent[kind, sender] = times + 1, now
        holder = self._heard.get(kind, sender)
        held, last = self._sent.get((kind, holder), (0, now))
        if holder != sender and held > 1 and now - last < _GONE:
            self._say(
                f"{kind.decode()} comes from {holder} and from {sender}: that of {holder} is taken. Let one of them send to another port."
            )
            return False
        self._heard[kind] = sender
        return True
