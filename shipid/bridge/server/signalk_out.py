"""The own ship as Signal K deltas (specification 1.8): SI, angles in rad, positive to starboard."""

from __future__ import annotations

import asyncio
import time
from contextlib import suppress
from datetime import UTC, datetime

from starlette.requests import Request
from starlette.websockets import WebSocket, WebSocketDisconnect

import shipid
from shipid.bridge.core.core import BridgeCore
from shipid.bridge.real_time import RealTime
from shipid.bridge.server.clients import PATIENCE, CommandRate
from shipid.bridge.shown.plain_values import number, strict_json
from shipid.foundation.aliases import Plain

#: Between two deltas in s, and the longest a client may take to accept one.
_EVERY, _STALLED = 1.0, 10.0
#: Path of Signal K by the name on the page.
_PATHS = {
    "psi": "navigation.headingTrue", "r": "navigation.rateOfTurn", "stw": "navigation.speedThroughWater",
    "u": "navigation.speedThroughWaterLongitudinal", "v": "navigation.speedThroughWaterTransverse",
    "sog": "navigation.speedOverGround", "cog": "navigation.courseOverGroundTrue", "delta": "steering.rudderAngle",
    "delta_order": "steering.rudderAngleTarget",
}  # fmt: skip


def signalk_endpoints(request: Request) -> dict[str, Plain]:
    """Return where the stream is, as a Signal K client looks for it.

    Parameters
    ----------
    request : Request
        Its host is the one that is answered.
    """
    host = request.headers.get("host", "")
    return {
        "endpoints": {"v1": {"version": "1.8.2", "signalk-ws": f"ws://{host}/signalk/v1/stream"}},
        "server": {"id": "shipid-bridge", "version": shipid.__version__},
    }


def delta_of(core: BridgeCore, moment: datetime) -> dict[str, Plain]:
    """Return what is known of the ship now as a delta.

    Parameters
    ----------
    core : BridgeCore
        The core.
    moment : datetime
        Now.
    """
    own = core.own_ship.to_dict()
    # Whoever reads a new time stamp takes the value as measured: what is carried on without its sensor is not sent.
    lost = set(own["estimated"]) - ({"v"} if "u" not in own["estimated"] else set())
    values = [
        {"path": path, "value": own[name]}
        for name, path in _PATHS.items()
        if own.get(name) is not None and name not in lost
    ]
    for value in values:
        if value["path"] == "navigation.headingTrue":
            value["value"] = number(value["value"] % 6.283185307179586, 7)
    return {
        "context": "vessels.self",
        "updates": [{"$source": f"shipid.{core.source.kind}", "timestamp": _stamp(moment), "values": values}],
    }


def _stamp(moment: datetime) -> str:
    return moment.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.%f")[:-3] + "Z"


async def signalk_stream(socket: WebSocket, live: RealTime) -> None:
    """Send a greeting, and then a delta a second; what a client sends is not read, and one that does not stop sending is let go.

    Parameters
    ----------
    socket : WebSocket
        Its connection, accepted.
    live : RealTime
        The running core.
    """
    hello = {
        "name": "shipid-bridge",
        "version": "1.8.2",
        "self": "vessels.self",
        "roles": ["main"],
        "timestamp": _stamp(datetime.now(UTC)),
    }

    async def send() -> None:
        await socket.send_text(strict_json(hello))
        while True:
            text = strict_json(delta_of(live.core, datetime.now(UTC)))
            await asyncio.wait_for(socket.send_text(text), _STALLED)
            await asyncio.sleep(_EVERY)

    async def listen() -> None:
        rate, refused = CommandRate(time.monotonic()), 0
        while refused < PATIENCE and (await socket.receive())["type"] == "websocket.receive":
            refused += not rate.allows(time.monotonic())

    tasks = [asyncio.create_task(send()), asyncio.create_task(listen())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        with suppress(RuntimeError, WebSocketDisconnect, TimeoutError):
            await asyncio.wait_for(socket.close(), 1.0)
