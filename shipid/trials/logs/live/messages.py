"""NMEA 2000 as it is sent, in canboat's text form: each message is a sample of what it says, at its own time."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite, nan, pi
from typing import ClassVar

import numpy as np

from shipid.trials.logs.live.nmea import FOLLOWED, LiveNmea
from shipid.trials.logs.live.table import LiveSample
from shipid.trials.logs.nmea.log import Origin
from shipid.trials.logs.nmea.messages.canboat import BrokenMessageError, MessageReader
from shipid.trials.logs.nmea.messages.decoding import CARRIED, decoded
from shipid.trials.logs.nmea.settings import SIGNALS

_DEG = pi / 180
#: The yaw of an attitude is a heading only where nothing better is sent; a log that is followed waits for the heading.
_NOT_FOLLOWED = ("127257",)


class LiveMessages(LiveNmea):
    """NMEA 2000 as it is sent.

    Parameters
    ----------
    fmt : NmeaFormat
        What the messages leave open.
    where : str
        The log, for messages.
    tell : callable
        Takes what there is to say of a line.
    origin : tuple of float, optional
        Latitude and longitude in rad from which x and y count; the first fix by default.
    """

    kinds: ClassVar[dict[str, tuple[str, ...]]] = {
        signal: tuple(k for k in SIGNALS[signal] if k.isdigit() and k not in _NOT_FOLLOWED) for signal in FOLLOWED
    }
    _messages: MessageReader | None = None
    _warned: bool = False

    def take(self, number: int, line: str) -> Iterator[LiveSample]:
        """Yield the sample that a line completes: the one before the first message of a new time.

        Parameters
        ----------
        number : int
            Of the line, counted from 1.
        line : str
            The line.

        Yields
        ------
        LiveSample
        """
        text = line.strip(" \t\r\n\x00\x1a")
        if not text or text.startswith("#"):
            return
        self._messages = self._messages or MessageReader()
        try:
            message = self._messages.take(text)
        except BrokenMessageError:
            self._tell(f"{self._where}, line {number}: no whole message; left out.")
            return
        self._sentences += 1
        yield from self._passes(number, message.time, dated=True)
        if message.data is None:
            return
        width, names, _ = CARRIED[message.pgn]
        data = np.frombuffer(message.data[:width], dtype=np.uint8)[None]
        self._hear(
            Origin(str(message.pgn), "", message.stream), dict(zip(names, decoded(message.pgn, data)[0].tolist()))
        )

    def _read(self, signal: str, kind: str, fields: dict[str, float]) -> dict[str, float]:
        """What a message says of a signal, SI, by the names that sentences have for it."""
        if signal in ("delta", "delta_order"):
            angle = fields["position" if signal == "delta" else "order"]
            found = super()._read(signal, kind, {"starboard": angle, "port": nan})
            return {n: v for n, v in found.items() if isfinite(v)}
        if signal == "psi" and self._fmt.reference == "true" and not isfinite(fields["heading"]):
            return super()._read(signal, kind, {"heading": fields["magnetic"] + self._known_variation(fields) / _DEG})
        if signal == "psi" and self._fmt.reference == "magnetic":
            return super()._read(signal, kind, {"heading": fields["magnetic"]})
        return super()._read(signal, kind, fields)

    def _known_variation(self, fields: dict[str, float]) -> float:
        """The variation in rad; zero where nothing states it, which is told once."""
        if self._variation is None and isfinite(fields["magnetic"]) and not self._warned:
            self._warned = True
            self._tell(
                f"{self._where}: WARNING: psi is the magnetic heading, because nothing states the variation: positions, courses and "
                "wind are true. State variation in [nmea.heading]."
            )
        return 0.0 if self._variation is None else self._variation
