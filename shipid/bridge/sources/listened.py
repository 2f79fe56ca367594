"""NMEA 0183 from a network as the source of samples: what arrives between two readings is one sample."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Callable
from dataclasses import replace

from shipid.bridge.core.source import SourceKind, SourceReading, SourceState, Target
from shipid.bridge.sources.hosts import check_host, why_not_reached
from shipid.bridge.sources.line_queue import LineQueue, SplitLines
from shipid.bridge.sources.radar_targets import target_of
from shipid.bridge.sources.senders import Senders
from shipid.foundation.errors import UsageError
from shipid.trials.errors import TrialError
from shipid.trials.logs.live.nmea import LiveNmea
from shipid.trials.logs.nmea.sentences.lines import sentences_of, split_line
from shipid.trials.logs.nmea.settings import NmeaFormat

#: Bytes that are read at once; and the seconds until a connection is tried again, from and to.
_CHUNK, _AGAIN, _LATEST = 4096, 1.0, 10.0
#: A connection on which nothing comes for so many seconds is made anew: where the other side lost its power, nothing says so.
_SILENT = 60.0
#: So many remarks on lines are kept between two readings.
_REMARKS = 20


class ListenedSource:
    """Sentences of NMEA 0183 that arrive over UDP or TCP.

    Parameters
    ----------
    host : str or None
        TCP: what to connect to; UDP: the address of this machine to listen at, every one by default.
    port : int
        The port.
    protocol : {"udp", "tcp"}
        Which.
    fmt : NmeaFormat, optional
        What the sentences leave open: above all the calibration of RSA, which has no unit of its own.
    origin : tuple of float, optional
        Latitude and longitude in rad of x = y = 0; the first fix by default.

    Raises
    ------
    UsageError
        If the protocol is neither, the name of the host cannot be one, or the port cannot be listened to.
    """

    kind: SourceKind = "nmea"
    timed = False

    def __init__(
        self,
        host: str | None,
        port: int,
        protocol: str,
        fmt: NmeaFormat | None = None,
        origin: tuple[float, float] | None = None,
    ) -> None:
        if protocol not in ("udp", "tcp"):
            raise UsageError(f"NMEA comes over udp or tcp, not '{protocol}'.")
        check_host(host or "")
        self._host, self._port, self._protocol = host, port, protocol
        self._queue = LineQueue()
        self._told: list[str] = []
        self._reader = LiveNmea(
            replace(fmt or NmeaFormat("nmea", {}), stamp="seconds"), self._where, self._say, origin=origin
        )
        self._number = 0
        self._heading: float | None = None
        self._connected = protocol == "udp"
        self._tasks: list[asyncio.Task[None]] = []
        self._transport: asyncio.DatagramTransport | None = None
        self._socket = _bound(host, port) if protocol == "udp" else None

    @property
    def _where(self) -> str:
        return f"{self._protocol} {self._host or 'port'} {self._port}"

    @property
    def state(self) -> SourceState:
        """Lost while there is no connection."""
        return "running" if self._connected else "lost"

    def _say(self, text: str) -> None:
        if len(self._told) < _REMARKS:
            self._told.append(text)

    async def start(self) -> None:
        """Begin to listen."""
        if self._socket is None:
            self._tasks = [asyncio.create_task(self._connect())]
            return
        self._transport, _ = await asyncio.get_running_loop().create_datagram_endpoint(
            lambda: _Datagrams(self._queue, Senders(self._say, time.monotonic)), sock=self._socket
        )

    async def stop(self) -> None:
        """Listen no more."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        if self._transport is not None:
            self._transport.close()
        elif self._socket is not None:
            self._socket.close()

    async def _connect(self) -> None:
        """Read a connection, and try again when it is gone."""
        wait = _AGAIN
        while True:
            writer: asyncio.StreamWriter | None = None
            try:
                reader, writer = await asyncio.open_connection(self._host, self._port)
                self._connected, wait = True, _AGAIN
                while data := await asyncio.wait_for(reader.read(_CHUNK), _SILENT):
                    self._queue.feed(data, whole=False)
                self._say(f"{self._where}: the connection was closed by the other side; it is tried again.")
            except OSError as error:  # that nothing came is one, too
                said = f"nothing came for {_SILENT:g} s" if writer is not None else "no connection"
                self._say(f"{self._where}: {why_not_reached(error) or said}; it is tried again.")
            self._queue.cut()
            if writer is not None:
                writer.close()
            self._connected = False
            await asyncio.sleep(wait)
            wait = min(2 * wait, _LATEST)

    def feed(self, data: bytes) -> None:
        """Take bytes as if they had come over the network.

        Parameters
        ----------
        data : bytes
            Whole lines.
        """
        self._queue.feed(data, whole=True)

    def take(self, t: float) -> SourceReading:
        """Return what has arrived since the reading before; the newest of each quantity counts.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        lines, dropped = self._queue.take()
        if dropped:
            self._say(f"{self._where}: {dropped} lines were too long or too many, and left out.")
        values: dict[str, float] = {}
        targets: list[Target] = []
        for line in lines:
            for piece in sentences_of(line):
                self._number += 1
                # The moment of arrival counts, not the stamp of whoever sends.
                begin = max(piece.rfind("$"), piece.rfind("!"), 0)
                self._read(lambda text: self._reader.take(self._number, text), f"{t:.6f} {piece[begin:]}", values)
                target = self._target(piece, t)
                if target is not None:
                    targets.append(target)
        if lines:
            self._read(lambda _: self._reader.end(), "", values)
        self._heading = values.get("psi", self._heading)
        told, self._told = tuple(self._told), []
        return SourceReading(values, tuple(targets), told)

    def _read(self, samples: Callable[[str], object], text: str, values: dict[str, float]) -> None:
        try:
            for sample in samples(text):  # type: ignore[attr-defined]
                values.update({n: v for n, v in sample.values.items() if n != "t"})
        except TrialError as error:
            self._say(str(error))

    def _target(self, piece: str, t: float) -> Target | None:
        sentence = split_line(piece)
        if sentence is None or not sentence.address.endswith("TTM"):
            return None
        if not sentence.whole:
            return None
        return target_of(sentence.text, t, self._heading)


def _bound(host: str | None, port: int) -> socket.socket:
    """A UDP socket that has its port before the page opens."""
    family = socket.AF_INET6 if host and ":" in host else socket.AF_INET
    made = socket.socket(family, socket.SOCK_DGRAM)
    try:
        made.bind((host or "0.0.0.0", port))
    except OSError as error:
        made.close()
        raise UsageError(f"UDP port {port} cannot be listened to: {error.strerror or error}. Choose another.") from None
    made.setblocking(False)
    return made


class _Datagrams(asyncio.DatagramProtocol):
    """Datagrams of sentences."""

    def __init__(self, queue: LineQueue, senders: Senders) -> None:
        self._queue, self._senders, self._split = queue, senders, SplitLines()

    def datagram_received(self, data: bytes, addr: tuple[str | int, ...]) -> None:
        """Take a datagram."""
        sender = f"{addr[0]}:{addr[1]}"
        self._queue.feed(self._senders.kept(self._split.joined(data, sender), sender), whole=True)
