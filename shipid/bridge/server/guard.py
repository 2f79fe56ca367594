"""What the server refuses: other hosts, other origins, a missing token; and the headers that keep the page to itself."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

#: Of every answer: nothing is loaded from elsewhere, nothing embeds the page, nothing is guessed or kept.
HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "geolocation=(), camera=(), microphone=()",
    "Cache-Control": "no-store",
}
_LOOPBACK_NAMES = ("localhost",)
#: The cookie that carries the token after the page was opened with it.
COOKIE = "shipid-bridge"


def is_loopback(host: str) -> bool:
    """Return whether an address reaches this machine only.

    Parameters
    ----------
    host : str
        A name or an address.
    """
    if host.lower() in _LOOPBACK_NAMES:
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True)
class Guard:
    """Who is let in.

    Attributes
    ----------
    port : int
        The port the server listens at.
    token : str or None
        What has to be shown; None where only this machine is served.
    """

    port: int
    token: str | None = None

    def refuses(self, connection: HTTPConnection) -> str | None:
        """Return why a connection is refused, or None where it is let in.

        Parameters
        ----------
        connection : HTTPConnection
            A request or a WebSocket.
        """
        host = _host_of(connection.headers)
        if host is None:
            return "no host is named"
        name, port = host
        if self.token is None and (not is_loopback(name) or port != self.port):
            return "another host is named"
        origin = connection.headers.get("origin")
        if origin is not None and not _same(origin, name, port):
            return "another page asks"
        if self.token is not None and not self._shown(connection):
            return "the token is missing or wrong"
        return None

    def _shown(self, connection: HTTPConnection) -> bool:
        assert self.token is not None
        shown, cookie = connection.query_params.get("token", ""), connection.cookies.get(COOKIE, "")
        by_query = hmac.compare_digest(shown.encode("utf-8", "replace"), self.token.encode())
        return by_query or hmac.compare_digest(cookie.encode("utf-8", "replace"), self.cookie.encode())

    @property
    def cookie(self) -> str:
        """What the cookie holds: a token may have signs that a cookie cannot."""
        return hashlib.sha256((self.token or "").encode()).hexdigest()


def _host_of(headers: Headers) -> tuple[str, int] | None:
    """Name and port of the header ``Host``; None where it is missing, stands twice, or is none."""
    stated = headers.getlist("host")
    if len(stated) != 1:
        return None
    try:
        parts = urlsplit(f"//{stated[0]}")
        if parts.hostname is None or parts.username or parts.path:
            return None
        return parts.hostname, parts.port or 80
    except ValueError:
        return None


def _same(origin: str, name: str, port: int) -> bool:
    """Whether an origin is the page of a host."""
    try:
        parts = urlsplit(origin)
        return parts.scheme in ("http", "https") and parts.hostname == name and (parts.port or 80) == port
    except ValueError:
        return False


class GuardMiddleware:
    """Lets in whom the guard lets in, and adds the headers to every answer.

    Parameters
    ----------
    app : ASGI application
        What is guarded.
    guard : Guard
        Who is let in.
    """

    def __init__(self, app: ASGIApp, guard: Guard) -> None:
        self._app, self._guard = app, guard

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a connection on, or refuse it.

        Parameters
        ----------
        scope, receive, send
            Of ASGI.
        """
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        why = self._guard.refuses(connection)
        if scope["type"] == "websocket":
            if why is None:
                await self._app(scope, receive, send)
            else:
                # Closed before it was accepted: the client sees a plain 403.
                await receive()
                await send({"type": "websocket.close", "code": 1008, "reason": why})
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers[name] = value
                token = self._guard.token
                if why is None and token is not None and connection.query_params.get("token") is not None:
                    headers.append("Set-Cookie", f"{COOKIE}={self._guard.cookie}; HttpOnly; SameSite=Strict; Path=/")
            await send(message)

        if why is None:
            await self._app(scope, receive, with_headers)
        else:
            await PlainTextResponse(f"refused: {why}\n", 403)(scope, receive, with_headers)
