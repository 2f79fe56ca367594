"""The bridge as a server: does it hold 10 Hz with predictions of 600 steps, how soon is a trial heading drawn, what does it cost?

One `shipid bridge` runs as a process of its own on the simulated ship and is watched over its WebSocket, as a page does it. The time
from a command to the tick that carries its track is that of the wire; a browser draws it in some 0.1 ms more. Another is watched
beside nine clients that are idle, do not read or send rubbish, and one that floods it (from a process of its own, which keeps one
processor busy). A third sails eight hours on a clock factor; its memory at the end is compared with that after the first hour. The
share of a core and the memory are those of Linux (``/proc``).

    python studies/bridge.py [--short] [--json]
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _table import Row, show
from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect

#: What is asked: frequency in Hz, seconds from a command to its track, share of a core, growth of the memory in MB.
RATE, LATENCY, SHARE, GROWTH = 10.0, 0.050, 0.15, 10.0
_TICKS, _CLOCK = os.sysconf("SC_CLK_TCK"), 240


@dataclass(frozen=True)
class Running:
    """A bridge as a process.

    Attributes
    ----------
    pid : int
        Of the process.
    address : str
        Of its WebSocket.
    """

    pid: int
    address: str

    @property
    def processor(self) -> float:
        """Seconds of processor time so far."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / _TICKS

    @property
    def memory(self) -> float:
        """Resident memory in MB."""
        found = re.search(r"VmRSS:\s+(\d+) kB", Path(f"/proc/{self.pid}/status").read_text())
        assert found is not None
        return int(found[1]) / 1024


@contextmanager
def bridge(*options: str) -> Iterator[Running]:
    """Run ``shipid bridge`` at a free port."""
    process = subprocess.Popen(
        [sys.executable, "-m", "shipid", "bridge", "--port", "0", *options], stderr=subprocess.PIPE, text=True
    )
    try:
        assert process.stderr is not None
        text = ""
        while not (found := re.search(r"http://(\S+)/\s", text)):
            line = process.stderr.readline()
            if not line:
                raise SystemExit(f"the bridge did not open: {text}")
            text += line
        yield Running(process.pid, f"ws://{found[1]}/ws")
    finally:
        process.terminate()
        process.wait(20)


def watch(ws: ClientConnection, seconds: float) -> np.ndarray:
    """Return when the ticks came, in s."""
    came, until = [], time.monotonic() + seconds
    while time.monotonic() < until:
        ws.recv()
        came.append(time.monotonic())
    return np.array(came)


def slide(ws: ClientConnection, count: int) -> np.ndarray:
    """Return the seconds from each trial heading to the tick that carries its track."""
    random, found = np.random.default_rng(0), []
    for k in range(count):
        until = time.monotonic() + random.uniform(0.02, 0.2)
        while time.monotonic() < until:
            ws.recv()
        heading = math.radians(20 + 2 * (k % 60))
        sent = time.monotonic()
        ws.send(json.dumps({"command": "trial", "heading": heading}))
        while True:
            told = json.loads(ws.recv())
            trial = (told.get("tracks") or {}).get("trial")
            # The newest track ends on the heading that was asked for, and no other within two degrees does.
            if trial and abs(trial["psi"][-1] - heading) < math.radians(1.0):
                break
        found.append(time.monotonic() - sent)
    return np.array(found)


def turn(ws: ClientConnection) -> None:
    """Execute a turn, so that the filter knows the ship and the tracks end on their headings."""
    for heading in (0.5, 0.0):
        ws.send(json.dumps({"command": "simulation", "clock_factor": 16}))
        ws.send(json.dumps({"command": "trial", "heading": heading}))
        ws.send(json.dumps({"command": "execute"}))
        watch(ws, 8.0)
    ws.send(json.dumps({"command": "simulation", "clock_factor": 1}))
    watch(ws, 1.0)


def live(seconds: float, commands: int) -> list[Row]:
    """Watch a bridge in real time."""
    with bridge() as running, connect(running.address, max_size=None) as ws:
        turn(ws)
        before, began = running.processor, time.monotonic()
        gaps = np.diff(watch(ws, seconds))
        share = (running.processor - before) / (time.monotonic() - began)
        taken = slide(ws, commands)
        sliding = (running.processor - before, time.monotonic() - began)
    rate, late = 1 / gaps.mean(), float(np.quantile(gaps, 0.95))
    p50, p95 = np.quantile(taken, [0.5, 0.95])
    return [
        Row(
            "ticks a second, predictions of 600 steps with their bands; one more at each new track",
            "10 Hz held: 9.9 or more",
            f"{rate:.2f} Hz",
            rate >= 0.99 * RATE,
        ),
        Row("gap between two ticks, 95 %", "0.11 s or less", f"{1000 * late:.0f} ms", late <= 0.11),
        Row(
            f"from a trial heading to its track, 95 % of {taken.size}",
            f"{1000 * LATENCY:.0f} ms or less",
            f"{1000 * p95:.0f} ms (half: {1000 * p50:.0f} ms)",
            bool(p95 <= LATENCY),
        ),
        Row("the server's share of a core, one client", f"below {100 * SHARE:.0f} %", f"{100 * share:.1f} %", share < SHARE),
        Row(
            "the same while headings are tried six times a second",
            f"below {100 * SHARE:.0f} %",
            f"{100 * sliding[0] / sliding[1]:.1f} %",
            sliding[0] / sliding[1] < SHARE,
        ),
    ]  # fmt: skip


def flood(address: str, until: float) -> int:
    """Send commands as fast as they go, connecting anew each time the client is let go; returns how many were sent."""
    sent = 0
    while time.monotonic() < until:
        try:
            with connect(address, max_size=None) as ws:
                while time.monotonic() < until:
                    ws.send(("{", '{"command":"cancel"}', "[" * 2000)[sent % 3])
                    sent += 1
        except (OSError, WebSocketException):
            continue
    return sent


def disturbed(seconds: float) -> list[Row]:
    """Watch a bridge in real time with ten clients that are idle, stop reading, send half a request or rubbish, or flood it."""
    with bridge() as running, connect(running.address, max_size=None) as ws:
        turn(ws)
        host, port = running.address.removeprefix("ws://").removesuffix("/ws").rsplit(":", 1)
        plain = [socket.create_connection((host, int(port))) for _ in range(5)]
        for one, sends in zip(
            plain, (b"", b"", b"GET /ws HTTP/1.1\r\nHost: ", b"GET /ws HTTP/1.1\r\nX: ", b"\x16\x03\x01\x02\x00" * 100)
        ):
            one.sendall(sends)
        deaf = [connect(running.address, max_size=None, max_queue=1, ping_interval=None) for _ in range(4)]
        with ProcessPoolExecutor(1) as others:
            flooding = others.submit(flood, running.address, time.monotonic() + seconds + 2)
            watch(ws, 1.0)
            gaps = np.diff(watch(ws, seconds))
            taken = slide(ws, 5)
            sent = flooding.result()
        for one in (*plain, *(client.socket for client in deaf)):
            one.close()
    late = float(np.quantile(gaps, 0.95))
    return [
        Row(
            "gap between two ticks with ten idle, deaf, malformed and flooding clients, 95 %",
            "0.15 s or less",
            f"{1000 * late:.0f} ms, at most {1000 * gaps.max():.0f} ms; {sent} messages in {seconds:.0f} s",
            late <= 0.15,
        ),
        Row("a trial heading is answered meanwhile", "1 s or less", f"{1000 * taken.max():.0f} ms at most", bool(taken.max() <= 1.0)),
    ]  # fmt: skip


def endurance(hours: float) -> list[Row]:
    """Sail so many hours on a clock factor, and compare the memory."""
    with bridge("--clock-factor", str(_CLOCK)) as running, connect(running.address, max_size=None) as ws:
        first, t, began, turned = None, 0.0, time.monotonic(), 0.0
        while t < hours * 3600:
            told = json.loads(ws.recv())
            t = told["time"]["t"] if "time" in told else t
            if t - turned > 900:
                turned = t
                ws.send(json.dumps({"command": "trial", "heading": 0.7 * (t // 900 % 9)}))
                ws.send(json.dumps({"command": "execute"}))
            if first is None and t > hours * 3600 / 8:
                first = running.memory
        growth = running.memory - (first or 0.0)
        factor = t / (time.monotonic() - began)
    return [
        Row(
            f"memory after {hours:g} h of simulated time, over that after an eighth of it",
            f"{GROWTH:.0f} MB more or less",
            f"{growth:+.1f} MB at {factor:.0f} times the time",
            growth <= GROWTH,
        )
    ]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="fewer seconds, half an hour instead of eight")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    rows = (
        live(5.0, 40) + disturbed(5.0) + endurance(0.5)
        if chosen.short
        else live(30.0, 200) + disturbed(20.0) + endurance(8.0)
    )
    show("The bridge as a server", rows, as_json=chosen.json)
