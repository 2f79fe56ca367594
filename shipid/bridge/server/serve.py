"""The server as a process: its port is taken before the page opens, and it ends when it is asked to."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import ipaddress
import signal
import socket
from collections.abc import Callable, Iterator

import uvicorn
from starlette.applications import Starlette

from shipid.foundation.errors import UsageError

#: Connections at most, and the seconds in which the server ends.
_CONNECTIONS, _END = 128, 3
#: What a WebSocket may send at most in bytes; a longer message closes it.
LONGEST_MESSAGE = 4096


def listening(host: str, port: int) -> socket.socket:
    """Return a socket that listens at an address.

    Parameters
    ----------
    host : str
        A name or an address.
    port : int
        The port; 0 for any that is free.

    Returns
    -------
    socket

    Raises
    ------
    UsageError
        If it cannot: the port is in use, or there is no such address.
    """
    made: socket.socket | None = None
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        # Named as TCP: asyncio sends small messages at once only where a socket says that it is TCP.
        made = socket.socket(family, kind, protocol or socket.IPPROTO_TCP)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(address)
        made.listen(64)
    except OSError as error:
        if made is not None:
            made.close()
        why = "is in use already" if error.errno == errno.EADDRINUSE else f"cannot be used: {error.strerror or error}"
        raise UsageError(f"port {port} of {host} {why}. Choose another --port or --host.") from None
    made.setblocking(False)
    return made


def reached_at(listener: socket.socket, host: str) -> str:
    """Return the address to open in a browser, without a scheme: name or address, and port.

    Where every address of this machine is served, no browser elsewhere can open that: this machine's own address in its
    network is named instead, where it is known.

    Parameters
    ----------
    listener : socket
        From `listening`.
    host : str
        The host that is served.
    """
    every = {socket.AF_INET: "0.0.0.0", socket.AF_INET6: "::"}.get(listener.family)
    if listener.getsockname()[0] == every:
        host = _own_address(listener.family) or host
    return f"[{host}]:{listener.getsockname()[1]}" if ":" in host else f"{host}:{listener.getsockname()[1]}"


def _own_address(family: int) -> str | None:
    """The address from which this machine would send to another network, or else that of its name; nothing is sent."""
    elsewhere = "192.0.2.1" if family == socket.AF_INET else "2001:db8::1"
    with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as made:
        made.connect((elsewhere, 9))
        return str(made.getsockname()[0])
    with contextlib.suppress(OSError):
        named = [str(found[4][0]) for found in socket.getaddrinfo(socket.gethostname(), None, family)]
        return next((a for a in named if not ipaddress.ip_address(a.split("%")[0]).is_loopback), None)
    return None


class _Server(uvicorn.Server):
    """A server whose signals are those of the command."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave the signals alone."""
        yield


def serve(app: Starlette, listener: socket.socket, ready: Callable[[], None]) -> int | None:
    """Serve until a signal comes.

    Parameters
    ----------
    app : Starlette
        The application.
    listener : socket
        From `listening`.
    ready : callable
        Called once the page can be opened.

    Returns
    -------
    int or None
        The signal that ended it.
    """
    return asyncio.run(_serve(app, listener, ready))


async def _serve(app: Starlette, listener: socket.socket, ready: Callable[[], None]) -> int | None:
    server, came = make_server(app), []
    loop = asyncio.get_running_loop()

    def end(number: int) -> None:
        came.append(number)
        server.should_exit = True

    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, end, number)
    task = asyncio.create_task(server.serve([listener]))
    while not server.started and not task.done():
        await asyncio.sleep(0.01)
    if server.started:
        ready()
        # A fault of the loop ends the server: a page that no longer changes would be the worse defect.
        await asyncio.wait({task, app.state.loop}, return_when=asyncio.FIRST_COMPLETED)
        server.should_exit = True
    await task
    if not app.state.loop.cancelled() and app.state.loop.exception() is not None:
        raise app.state.loop.exception()
    return came[0] if came else None


def make_server(app: Starlette) -> uvicorn.Server:
    """Return the server of an application, with its bounds.

    Parameters
    ----------
    app : Starlette
        The application.
    """
    return _Server(
        uvicorn.Config(
            app,
            log_level="error",
            access_log=False,
            server_header=False,
            ws="websockets-sansio",
            ws_max_size=LONGEST_MESSAGE,
            ws_ping_interval=20.0,
            ws_ping_timeout=20.0,
            ws_per_message_deflate=False,
            limit_concurrency=_CONNECTIONS,
            timeout_keep_alive=10,
            timeout_graceful_shutdown=_END,
            h11_max_incomplete_event_size=16_384,
            lifespan="on",
        )
    )
