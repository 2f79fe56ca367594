"""A bridge that is served on a real port, in a thread of its own."""

from __future__ import annotations

import asyncio
import contextlib
import threading

import pytest

from shipid.bridge.real_time import RealTime
from shipid.bridge.server.application import application
from shipid.bridge.server.guard import Guard
from shipid.bridge.server.serve import listening, make_server


@pytest.fixture
def serve(make_core):
    """Serve a core, and return its port."""
    with contextlib.ExitStack() as stack:

        def start(core=None, token=None, chart=None):
            core = core or make_core()
            listener = listening("127.0.0.1", 0)
            port = listener.getsockname()[1]
            held = {}

            async def run():
                server = make_server(application(RealTime(core), Guard(port, token), chart))
                held["server"] = server
                await server.serve([listener])

            thread = threading.Thread(target=lambda: asyncio.run(run()), daemon=True)
            thread.start()

            def stop():
                held["server"].should_exit = True
                thread.join(10)
                assert not thread.is_alive()

            stack.callback(stop)
            return port

        yield start
