"""Signal K deltas (specification 1.8) from a server as the source of samples: SI, angles in rad, positive to starboard."""

from __future__ import annotations

import asyncio
import json
import math
import time
from collections.abc import Callable
from datetime import UTC, datetime
from urllib.parse import urlsplit

from shipid.bridge.core.source import SourceKind, SourceReading, SourceState
from shipid.bridge.sources.hosts import check_host, why_not_reached
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.printable import printable
from shipid.trials.logs.geodesy import to_local

#: A trial's column by the path of Signal K.
_PATHS = {
    "navigation.headingTrue": "psi", "navigation.rateOfTurn": "r", "navigation.speedThroughWaterLongitudinal": "u",
    "navigation.speedThroughWaterTransverse": "v", "navigation.speedOverGround": "SOG",
    "navigation.courseOverGroundTrue": "COG", "steering.rudderAngle": "delta", "steering.rudderAngleTarget": "delta_order",
    "navigation.speedThroughWater": "u", "environment.wind.speedTrue": "wind_speed",
    "environment.wind.directionTrue": "wind_direction", "environment.wind.speedApparent": "wind_speed_relative",
    "environment.wind.angleApparent": "wind_direction_relative",
}  # fmt: skip
#: What no ship shows, in SI: a server that sends more speaks another unit.
_MOST = {
    "psi": 2 * math.pi, "COG": 2 * math.pi, "wind_direction": 2 * math.pi, "r": 0.5, "delta": math.pi / 2, "delta_order": math.pi / 2,
    "u": 60.0, "v": 60.0, "SOG": 60.0, "wind_speed": 120.0, "wind_speed_relative": 120.0, "wind_direction_relative": 2 * math.pi,
}  # fmt: skip
#: What is told by where it comes from, and kept by where it flows to.
_FROM = ("wind_direction", "wind_direction_relative")
#: A message is no longer than this in bytes; a value no larger than this; seconds until a connection is tried again, from and to.
_LONGEST, _LARGEST, _AGAIN, _LATEST = 1 << 18, 1e9, 1.0, 10.0
#: A value that is older by the server's clock is what the server has kept, in s; where nothing else comes for so long the clock is asked again.
_OLD, _NOTHING_NEW = 5.0, 10.0
#: The time stamps of so many quantities and their sources are remembered.
_STAMPS = 1000


class SignalKSource:
    """Deltas of a Signal K server.

    A server goes on sending the last value of a sensor that is dead: a value counts where its time stamp is a new one, and not
    old by the clock that the server greets with, or by this machine's where it says no time.

    Parameters
    ----------
    url : str
        ``ws://host:port/signalk/v1/stream``, or ``http://host:port`` for that stream of a server.
    origin : tuple of float, optional
        Latitude and longitude in rad of x = y = 0; the first fix by default.
    clock : callable
        Returns seconds that never go back.

    Raises
    ------
    UsageError
        If the address is none.
    """

    kind: SourceKind = "signalk"
    timed = False

    def __init__(
        self, url: str, origin: tuple[float, float] | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._url = stream_of(url)
        self._origin = origin
        self._self = "vessels.self"
        self._values: dict[str, float] = {}
        self._ahead = False
        self._foreign: set[str] = set()
        self._connected = False
        self._told: list[str] = []
        self._clock = clock
        self._begin()
        self._task: asyncio.Task[None] | None = None

    @property
    def state(self) -> SourceState:
        """Lost while there is no connection."""
        return "running" if self._connected else "lost"

    def _begin(self) -> None:
        """Know nothing of a connection yet."""
        self._foreign.clear()
        #: The server's clock less ours; what was said last of a quantity by a source; since when nothing but old values came.
        self._offset = time.time() - self._clock()
        self._newest: dict[tuple[str, str], tuple[float, Plain]] = {}
        self._old_since: float | None = None

    async def start(self) -> None:
        """Begin to listen."""
        self._task = asyncio.create_task(self._connect())

    async def stop(self) -> None:
        """Listen no more."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    async def _connect(self) -> None:
        from websockets.asyncio.client import connect
        from websockets.exceptions import WebSocketException

        wait = _AGAIN
        while True:
            try:
                async with connect(self._url, max_size=_LONGEST, max_queue=16, open_timeout=10) as socket:
                    self._connected, wait = True, _AGAIN
                    self._begin()
                    async for message in socket:
                        self.feed(message if isinstance(message, str) else message.decode("utf-8", "replace"))
                        if self._old_since is not None and self._clock() - self._old_since > _NOTHING_NEW:
                            break  # The server's clock may have been set: its greeting says.
            except (OSError, WebSocketException) as error:
                said = why_not_reached(error) or "no connection"
                self._told = [f"the Signal K server: {said}; it is tried again."]
            self._connected = False
            await asyncio.sleep(wait)
            wait = min(2 * wait, _LATEST)

    def feed(self, text: str) -> None:
        """Take a message as if it had come from the server.

        Parameters
        ----------
        text : str
            A greeting or a delta; anything else is left out.
        """
        try:
            message = json.loads(text)
        except (ValueError, RecursionError):
            self._told = ["a message of the Signal K server is no JSON; left out."]
            return
        if not isinstance(message, dict):
            return
        if isinstance(message.get("self"), str):
            self._self = message["self"].removeprefix("urn:")
            said = _seconds(message.get("timestamp"))
            self._offset = self._offset if said is None else said - self._clock()
        context = message.get("context", "vessels.self")
        if context not in ("vessels.self", self._self, f"vessels.{self._self}"):
            return
        updates = message.get("updates")
        for update in updates if isinstance(updates, list) else []:
            values = update.get("values") if isinstance(update, dict) else None
            for entry in values if isinstance(values, list) else []:
                if isinstance(entry, dict) and self._is_new(update, entry.get("path"), entry.get("value")):
                    self._hear(entry.get("path"), entry.get("value"))

    def _is_new(self, update: dict[str, Plain], path: Plain, value: Plain) -> bool:
        """Whether a value is news, and not what the server has kept; one without a time stamp is as old as its message."""
        if not isinstance(path, str) or (path not in _PATHS and path != "navigation.position"):
            return False
        stamp, now = _seconds(update.get("timestamp")), self._clock()
        if stamp is not None and (age := now + self._offset - stamp) > _OLD:
            self._old_since = now if self._old_since is None else self._old_since
            self._told = [
                f"{path} was {age:.0f} s old when it came, by the time stamp {printable(str(update['timestamp'])[:30])}: left out. Look at its "
                "sensor, and at the clocks of the server and of the sensor."
            ]
            return False
        self._old_since = None
        if stamp is None:
            return True
        key = path, str(update.get("$source", ""))[:100]
        before = self._newest.get(key)
        if before is not None and (stamp < before[0] or (stamp, value) == before):
            return False
        if len(self._newest) >= _STAMPS:
            self._newest.clear()
        self._newest[key] = stamp, value
        return True

    def _hear(self, path: Plain, value: Plain) -> None:
        if path == "navigation.position":
            self._fix(value)
            return
        number = _finite(value)
        if not isinstance(path, str) or number is None:
            return
        name = _PATHS.get(path)
        if name is None or path in self._foreign or (path == "navigation.speedThroughWater" and self._ahead):
            return
        if abs(number) > _MOST[name] + 1e-3:
            # A heading in degrees is a wrong one also where it is small enough.
            self._foreign.add(path)
            self._told = [
                f"{path} of {number:g} cannot be: Signal K has rad, rad/s and m/s. It is left out until the server is connected anew."
            ]
            return
        self._ahead |= path == "navigation.speedThroughWaterLongitudinal"
        self._values[name] = number + math.pi if name in _FROM else number

    def _fix(self, value: Plain) -> None:
        if not isinstance(value, dict):
            return
        lat, lon = _finite(value.get("latitude")), _finite(value.get("longitude"))
        if lat is None or lon is None or abs(lat) > 90 or abs(lon) > 180:
            return
        place = math.radians(lat), math.radians(lon)
        self._origin = self._origin or place
        north, east = to_local(*place, self._origin)
        self._values |= {"x": float(north), "y": float(east)}

    def take(self, t: float) -> SourceReading:
        """Return what has arrived since the reading before; the newest of each quantity counts.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        values, self._values = self._values, {}
        told, self._told = tuple(self._told), []
        return SourceReading(values, (), told)


def stream_of(url: str) -> str:
    """Return the address of the stream of a Signal K server.

    Parameters
    ----------
    url : str
        Of a stream, or of the server.

    Raises
    ------
    UsageError
        If it is neither.
    """
    try:
        parts = urlsplit(url)
        sound = parts.hostname is not None and (parts.port is None or parts.port > 0)
    except ValueError:
        sound = False
    if not sound or parts.scheme not in ("ws", "wss", "http", "https"):
        raise UsageError(f"'{url}' is no Signal K server: write signalk:ws://HOST:PORT/signalk/v1/stream.")
    check_host(parts.hostname or "")
    if parts.scheme in ("ws", "wss"):
        return url
    return f"{parts.scheme.replace('http', 'ws')}://{parts.netloc}/signalk/v1/stream?subscribe=self"


def _seconds(stamp: Plain) -> float | None:
    """Return the time of a stamp of Signal K in s; None where it is none. One without a zone is of UTC."""
    try:
        moment = datetime.fromisoformat(stamp) if isinstance(stamp, str) else None
    except ValueError:
        return None
    if moment is None:
        return None
    return (moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)).timestamp()


def _finite(value: Plain) -> float | None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return float(value) if abs(value) < _LARGEST else None
