"""A server that speaks to the page as the bridge does: a made-up ship in a turn, and a state that a test may change at any moment."""

from __future__ import annotations

import asyncio
import copy
import json
import threading
import time
from pathlib import Path

import numpy as np
import uvicorn
from starlette.applications import Starlette
from starlette.responses import FileResponse, JSONResponse
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocketDisconnect

PAGE = Path(__file__).resolve().parents[3] / "shipid" / "bridge" / "page"
POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
DEG, KNOT, MILE = np.pi / 180, 1852 / 3600, 1852.0
SPEED, TURN, LAG = 9.5, 0.35 * DEG, 25.0


def rounded(values: np.ndarray) -> list[float]:
    return [float(v) for v in np.round(values, 4)]


def predicted(own: dict, heading: float, limit: float) -> dict:
    """A track that turns at a rate proportional to the rudder limit, and a band that widens."""
    t = np.linspace(0.0, 480.0, 160)
    change = (heading - own["psi"] + np.pi) % (2 * np.pi) - np.pi
    turned = TURN * limit / (10 * DEG) * (t - LAG * (1 - np.exp(-t / LAG)))
    psi = own["psi"] + np.sign(change) * np.minimum(turned, abs(change))
    step = np.diff(t, prepend=0.0)
    north, east = SPEED * np.cos(psi) - 0.9, SPEED * np.sin(psi) - 0.9
    return {
        "x": rounded(own["x"] + np.cumsum(north * step)),
        "y": rounded(own["y"] + np.cumsum(east * step)),
        "psi": rounded(psi),
        "t": rounded(t),
        "s": rounded(SPEED * t),
        "half_width": rounded(4 + 0.18 * t),
        "message": None,
        "beyond": False,
    }


def planned() -> dict:
    """A route of five legs with a turn of 0.35 miles at each waypoint."""
    courses = np.array([0, 75, 30, 60, -45, -30]) * DEG
    corner = np.vstack(
        [[0.0, 0.0], np.cumsum(2.25 * MILE * np.stack([np.cos(courses), np.sin(courses)], axis=1), axis=0)]
    )
    line = [corner[0]]
    share = np.linspace(0, 1, 15)[:, None]
    for before, here, after in zip(corner, corner[1:], corner[2:]):
        a = here + (before - here) / np.linalg.norm(before - here) * 0.35 * MILE
        b = here + (after - here) / np.linalg.norm(after - here) * 0.35 * MILE
        line.extend((1 - share) ** 2 * a + 2 * share * (1 - share) * here + share**2 * b)
    line.append(corner[-1])
    waypoints = [
        {
            "x": float(x),
            "y": float(y),
            "name": f"WP{i}",
            "radius": 0.35 * MILE,
            "xtd_port": 250.0,
            "xtd_starboard": 250.0,
        }
        for i, (x, y) in enumerate(corner)
    ]
    return {
        "name": "T1",
        "waypoints": waypoints,
        "line": np.round(np.array(line), 1).tolist(),
        "leg": 0,
        "off_track": 12.0,
        "wheel_over": {"seconds": 102.0, "distance": 981.0, "x": 3500.0, "y": 0.0, "course": 75 * DEG},
        "overshoot": 35.0,
    }


def voyage() -> dict:
    """The state of a ship on her first leg with a trial that is not executed yet, in simulation."""
    own = {
        "x": 2519.0, "y": 12.0, "psi": 7.5 * DEG, "r": 0.0, "u": SPEED, "v": 0.0, "stw": 18.5 * KNOT, "sog": 17.1 * KNOT, "cog": 3.2 * DEG,
        "delta": -2.1 * DEG, "delta_order": -3.0 * DEG, "age": 0.1, "estimated": ["cog", "sog"],
    }  # fmt: skip
    settings = {"mode": "heading", "heading": 75 * DEG, "rudder_limit": 10 * DEG, "rate": 20 * DEG / 60, "rudder": 0.0}
    past = np.arange(0.0, 260.0, 2.0)
    sensors = [
        ("psi", "heading", "rad"),
        ("r", "rate of turn", "rad/s"),
        ("u", "speed through the water", "m/s"),
        ("delta", "rudder angle", "rad"),
    ]
    estimates = [
        ("K", "K*", 1.58, 0.06, 1.6),
        ("tau", "τ*", 1.74, 0.09, 1.7),
        ("K_rho", "K_ρ", 0.97, 0.02, None),
        ("gamma", "γ*", 0.57, 0.03, 0.573),
    ]
    return {
        "seq": 0,
        "ship": {"name": "Soesterberg", "length": 226.0, "beam": 30.5},
        "time": {"t": 271.0, "utc": "2026-01-01T12:04:31Z", "source": "simulate", "state": "running", "clock_factor": 4.0},
        "own": own,
        "sensors": [{"name": n, "label": label, "value": own[n], "unit": unit, "age": 0.2, "lost": False} for n, label, unit in sensors],
        "settings": {
            "mode": "heading",
            "trial": settings,
            "executed": {**settings, "heading": 7.5 * DEG},
            "limits": {"rudder_limit": [DEG, 35 * DEG], "rate": [-60 * DEG / 60, 60 * DEG / 60], "rudder": [-35 * DEG, 35 * DEG]},
            "modes": ["heading", "rudder", "rate", "track"],
        },
        "tracks": {"trial": predicted(own, 75 * DEG, 10 * DEG), "executed": predicted(own, 7.5 * DEG, 10 * DEG)},
        "past": {"t": rounded(past), "x": rounded(past * 9.3 + 80), "y": rounded(12 * np.sin(past / 90))},
        "route": planned(),
        "flow": {
            "current": {"speed": 2.4 * KNOT, "direction_to": 225 * DEG, "sd": 0.2 * KNOT},
            "wind": {"speed": 7.0, "direction_from": 315 * DEG, "measured": True},
        },
        "adaptation": {
            "values": [{"name": n, "label": label, "value": v, "sd": sd, "unit": "1", "standing": "determined", "truth": truth}
                       for n, label, v, sd, truth in estimates],
            "health": {"state": "well", "message": None, "rejected": 0.01},
        },
        "alarms": [],
        "targets": [],
        "simulation": {
            "current_speed": 2.5 * KNOT, "current_direction_to": 225 * DEG, "wind_speed": 7.0, "wind_direction_from": 315 * DEG,
            "coefficients": [{"name": "K", "label": "K*", "value": 1.6, "unit": "1", "low": 0.4, "high": 4.0},
                             {"name": "tau", "label": "τ*", "value": 1.7, "unit": "1", "low": 0.4, "high": 4.0}],
            "clock_factor": 4.0, "paused": False, "clock_factors": [1, 2, 4, 8, 16],
        },
        "experiment": None,
        "notes": [],
        "recording": {"file": "voyage.csv", "samples": 1355, "message": None},
    }  # fmt: skip


def chart() -> dict:
    """A coast in the east, a shoal in the west, buoys along the first leg."""
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    shoal = np.stack([2600 + 900 * np.cos(angle), -2100 + 600 * np.sin(angle) * (1 + 0.3 * np.cos(3 * angle))], axis=1)
    inner = np.stack([2600 + 450 * np.cos(angle), -2100 + 260 * np.sin(angle)], axis=1)
    coast = np.array(
        [[-3000, 2700], [-500, 2300], [900, 2900], [2000, 2500], [2700, 3300], [1800, 4600], [-3000, 5200]], dtype=float
    )
    buoys = [(1800, 420, "T 2", "starboard"), (1800, -420, "T 1", "port"), (3900, -500, "T 3", "port"), (2600, -2100, "Bank", "isolated"),
             (5200, 900, "Noord", "cardinal"), (600, -900, "Fairway", "safe"), (3200, 2300, None, "special")]  # fmt: skip
    return {
        "name": "made up",
        "land": [[coast.tolist()]],
        "depth_areas": [
            {"min": 10.0, "max": 20.0, "rings": [shoal.round(1).tolist()]},
            {"min": 0.0, "max": 10.0, "rings": [inner.round(1).tolist()]},
        ],
        "contours": [{"depth": 20.0, "line": [*shoal.round(1).tolist(), shoal[0].round(1).tolist()]}],
        "coast": [],
        "buoys": [{"x": float(x), "y": float(y), "name": name, "kind": kind} for x, y, name, kind in buoys],
    }


class FakeBridge:
    """The server. A test reads and changes `state`; what changed goes to every client with the next tick."""

    def __init__(self) -> None:
        self.state = voyage()
        self.chart: dict | None = chart()
        self.commands: list[dict] = []
        self.refuse: str | None = None
        self.raw: str | None = None
        self.silent = False
        self.port = 0
        self._clients: set = set()

    def start(self) -> None:
        """Serve on a free port of this machine, in a thread."""
        routes = [
            Route("/", lambda request: FileResponse(PAGE / "index.html", headers={"Content-Security-Policy": POLICY})),
            Route("/chart.json", lambda request: JSONResponse(self.chart)),
            WebSocketRoute("/ws", self._serve),
            Mount("/static", StaticFiles(directory=PAGE)),
        ]
        config = uvicorn.Config(
            Starlette(routes=routes),
            host="127.0.0.1",
            port=self.port,
            log_level="error",
            lifespan="off",
            ws="websockets-sansio",
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, daemon=True)
        self._thread.start()
        while not self._server.started:
            time.sleep(0.01)
        self.port = self._server.servers[0].sockets[0].getsockname()[1]

    def stop(self) -> None:
        self._server.force_exit = self._server.should_exit = True
        self._thread.join(10)

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}/"

    async def _serve(self, socket) -> None:
        await socket.accept()
        known = copy.deepcopy(self.state)
        await socket.send_text(json.dumps({"kind": "snapshot", **known}, allow_nan=False))
        listener = asyncio.create_task(self._listen(socket))
        try:
            while not listener.done():
                await asyncio.sleep(0.1)
                if self.silent:
                    continue
                if self.raw is not None:
                    await socket.send_text(self.raw)
                    continue
                self.state["seq"] += 1
                now = copy.deepcopy(self.state)
                news = {key: value for key, value in now.items() if value != known.get(key) and key != "past"}
                known = now
                await socket.send_text(json.dumps({"kind": "tick", **news}, allow_nan=False))
        except (WebSocketDisconnect, RuntimeError):
            pass
        finally:
            listener.cancel()

    async def _listen(self, socket) -> None:
        async for text in socket.iter_text():
            command = json.loads(text)
            self.commands.append(command)
            if self.refuse is None:
                self._obey(command)
            reply = {"kind": "reply", "command": command["command"], "ok": self.refuse is None, "message": self.refuse}
            await socket.send_text(json.dumps(reply))

    def _obey(self, command: dict) -> None:
        settings, own = self.state["settings"], self.state["own"]
        name, rest = command["command"], {k: v for k, v in command.items() if k != "command"}
        if name == "trial":
            settings["trial"] = {**settings["trial"], **rest}
        elif name == "execute":
            settings["executed"] = dict(settings["trial"])
            settings["mode"] = settings["trial"]["mode"]
        elif name == "cancel":
            settings["trial"] = dict(settings["executed"])
        elif name == "acknowledge":
            self.state["alarms"] = [
                {**a, "acknowledged": a["acknowledged"] or a["id"] == rest["id"]} for a in self.state["alarms"]
            ]
        elif name == "simulation":
            if "coefficient" in rest:
                coefficients = self.state["simulation"]["coefficients"]
                rest = {
                    "coefficients": [
                        {**c, "value": rest["value"]} if c["name"] == rest["coefficient"] else c for c in coefficients
                    ]
                }
            self.state["simulation"] = {**self.state["simulation"], **rest}
        if own["psi"] is not None and own["x"] is not None:
            trial, executed = settings["trial"], settings["executed"]
            same = trial == executed
            self.state["tracks"] = {
                "trial": None if same else predicted(own, trial["heading"], trial["rudder_limit"]),
                "executed": predicted(own, executed["heading"], executed["rudder_limit"]),
            }
