"""One client of the page: it is sent the newest, never a queue, and what it sends is counted and checked."""

from __future__ import annotations

import asyncio
import json
import time
from contextlib import suppress

from starlette.websockets import WebSocket, WebSocketDisconnect

from shipid.bridge.real_time import RealTime
from shipid.bridge.shown.plain_values import strict_json
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import ShipidError, UsageError

#: A command is no longer than this, in bytes; of clients there are at most so many.
LONGEST_COMMAND, MOST_CLIENTS = 2048, 32
#: Commands a second, and how many may come at once; a client that goes on after so many refusals is let go.
_RATE, _BURST, PATIENCE = 50.0, 100.0, 200
#: A client that takes nothing for so many seconds is let go.
_STALLED = 30.0


class CommandRate:
    """How many commands a client may still send: a bucket that fills with time.

    Parameters
    ----------
    now : float
        In s.
    """

    def __init__(self, now: float) -> None:
        self._left, self._t = _BURST, now

    def allows(self, now: float) -> bool:
        """Return whether one more command is taken.

        Parameters
        ----------
        now : float
            In s.
        """
        self._left = min(_BURST, self._left + _RATE * (now - self._t))
        self._t = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


def parsed_command(text: str) -> dict[str, Plain]:
    """Return a command out of strict JSON.

    Parameters
    ----------
    text : str
        What a client sent.

    Returns
    -------
    dict

    Raises
    ------
    UsageError
        If it is too long, no JSON, or no object.
    """
    if len(text.encode("utf-8", "replace")) > LONGEST_COMMAND:
        raise UsageError(f"a command has at most {LONGEST_COMMAND} bytes.")

    try:
        message = json.loads(text, parse_constant=_refused)
    except (ValueError, RecursionError):
        raise UsageError("a command is an object in JSON.") from None
    if not isinstance(message, dict):
        raise UsageError("a command is an object in JSON.")
    return message


def _refused(constant: str) -> Plain:
    """NaN and the infinities are no JSON."""
    raise ValueError(constant)


class Client:
    """A client of the page.

    Parameters
    ----------
    socket : WebSocket
        Its connection, accepted.
    live : RealTime
        What it sees and commands.
    """

    def __init__(self, socket: WebSocket, live: RealTime) -> None:
        self._socket, self._live = socket, live
        self._sending = asyncio.Lock()

    async def serve(self) -> None:
        """Serve it until it leaves, stalls, or does not stop sending what is refused."""
        tasks = [asyncio.create_task(self._send()), asyncio.create_task(self._receive())]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            with suppress(RuntimeError, WebSocketDisconnect, TimeoutError):
                await asyncio.wait_for(self._socket.close(1008), 1.0)

    async def _send(self) -> None:
        live, core = self._live, self._live.core
        sequence, version, places = live.sequence, core.board.version, core.past.count
        whole = [*core.board.since(0), ("past", strict_json(core.past.to_dict()))]
        await self._text(_frame("snapshot", sequence, whole))
        while True:
            sequence = await live.shown(sequence)
            changed = list(core.board.since(version))
            version = core.board.version
            if core.past.count > places:
                changed.append(("past_add", strict_json(core.past.since(places))))
                places = core.past.count
            await self._text(_frame("tick", sequence, changed))

    async def _text(self, text: str) -> None:
        async with self._sending:
            await asyncio.wait_for(self._socket.send_text(text), _STALLED)

    async def _receive(self) -> None:
        rate, refused = CommandRate(time.monotonic()), 0
        while refused < PATIENCE:
            message = await self._socket.receive()
            if message["type"] != "websocket.receive":
                return
            if not rate.allows(time.monotonic()):
                refused += 1
                if refused == 1:
                    await self._reply(None, "too many commands: some were left out.")
                continue
            text = message.get("text")
            name: Plain = None
            try:
                if text is None:
                    raise UsageError("a command is text, an object in JSON.")
                command = parsed_command(text)
                name = command.get("command") if isinstance(command.get("command"), str) else None
                self._live.command(command)
            except ShipidError as error:
                refused += 1
                await self._reply(name, str(error))
            else:
                await self._reply(name, None)

    async def _reply(self, name: Plain, message: str | None) -> None:
        reply = {"kind": "reply", "command": None if name is None else name[:40], "ok": message is None}
        await self._text(strict_json(reply | {"message": message}))


def _frame(kind: str, sequence: int, parts: list[tuple[str, str]]) -> str:
    """A frame out of keys whose values are JSON already."""
    return "".join([f'{{"kind":"{kind}","seq":{sequence}', *(f',"{key}":{text}' for key, text in parts), "}"])
