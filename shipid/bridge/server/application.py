"""The web application of the bridge: the page, the chart, the WebSocket of the page, and Signal K deltas."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket

from shipid.bridge.real_time import RealTime
from shipid.bridge.server.clients import MOST_CLIENTS, Client
from shipid.bridge.server.guard import Guard, GuardMiddleware
from shipid.bridge.server.signalk_out import signalk_endpoints, signalk_stream
from shipid.bridge.shown.plain_values import strict_json
from shipid.foundation.aliases import Plain

#: The page and what it loads.
PAGE = Path(__file__).parents[1] / "page"


def application(live: RealTime, guard: Guard, chart: Plain = None) -> Starlette:
    """Return the application.

    Parameters
    ----------
    live : RealTime
        The running core; it runs as long as the application does.
    guard : Guard
        Who is let in.
    chart : plain values, optional
        The chart as the page draws it.

    Returns
    -------
    Starlette
    """
    clients = 0
    chart_text = strict_json(chart)

    async def page(_: Request) -> Response:
        if not (PAGE / "index.html").is_file():
            return PlainTextResponse("shipid bridge: not for navigation. The page is missing.\n", 500)
        return FileResponse(PAGE / "index.html")

    async def chart_json(_: Request) -> Response:
        return Response(chart_text, media_type="application/json")

    async def health(_: Request) -> Response:
        return Response(strict_json({"ok": True, "clients": clients}), media_type="application/json")

    async def endpoints(request: Request) -> Response:
        return Response(strict_json(signalk_endpoints(request)), media_type="application/json")

    async def sockets(socket: WebSocket) -> None:
        nonlocal clients
        if clients >= MOST_CLIENTS:
            await socket.close(1013)
            return
        clients += 1
        try:
            await socket.accept()
            if socket.url.path == "/ws":
                await Client(socket, live).serve()
            else:
                await signalk_stream(socket, live)
        finally:
            clients -= 1

    @asynccontextmanager
    async def running(app: Starlette) -> AsyncIterator[None]:
        task = asyncio.create_task(live.run())
        app.state.loop = task
        try:
            yield
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)

    return Starlette(
        routes=[
            Route("/", page),
            Route("/chart.json", chart_json),
            Route("/health", health),
            Route("/signalk", endpoints),
            WebSocketRoute("/ws", sockets),
            WebSocketRoute("/signalk/v1/stream", sockets),
            Mount("/static", StaticFiles(directory=PAGE, check_dir=False)),
        ],
        middleware=[Middleware(GuardMiddleware, guard=guard)],
        lifespan=running,
    )
