"""Put a bridge together and open it; what cannot be is refused before the page opens."""

from __future__ import annotations

import secrets
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.design_autopilot import design_autopilot
from shipid.autopilot.design.read_schedule import read_schedule
from shipid.bridge.bridge_settings import SHIP, BridgeSettings
from shipid.bridge.core.core import BridgeCore
from shipid.bridge.core.source import SampleSource
from shipid.bridge.sources.simulated import SimulatedSource
from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError, UsageError
from shipid.parameters.catalogue import find_model, find_ship
from shipid.parameters.parameter_set import ParameterSet

#: Models that are preferred for a bridge, the best first: they have position, heading and speed.
_PREFERRED = ("de-keizer", "cross-flow", "bech-slipstream", "bech-surge", "pershitz", "de-keizer-minimal")


@dataclass
class OpenedBridge:
    """A bridge that can be served.

    Attributes
    ----------
    core : BridgeCore
        The core.
    listener : socket
        It listens already.
    address : str
        What to open in a browser.
    token : str or None
        What has to be shown.
    chart : plain values
        The chart as the page draws it.
    recording : Path or None
        The recording.
    """

    core: BridgeCore
    listener: socket.socket
    address: str
    token: str | None
    chart: Plain
    recording: Path | None

    @property
    def ship(self) -> str:
        """Name of the ship."""
        return self.core.pilot.ship.name

    @property
    def source(self) -> str:
        """Kind of the source."""
        return self.core.source.kind

    def serve(self, ready: Callable[[], None]) -> int | None:
        """Serve until a signal comes.

        Parameters
        ----------
        ready : callable
            Called once the page can be opened.

        Returns
        -------
        int or None
            The signal that ended it.
        """
        from shipid.bridge.real_time import RealTime
        from shipid.bridge.server.application import application
        from shipid.bridge.server.guard import Guard
        from shipid.bridge.server.serve import serve

        port = self.listener.getsockname()[1]
        app = application(RealTime(self.core), Guard(port, self.token), self.chart)
        return serve(app, self.listener, ready)


def pilot_of(settings: BridgeSettings) -> Autopilot:
    """Return the autopilot of a bridge, with model and ship.

    Parameters
    ----------
    settings : BridgeSettings
        What the bridge is opened with.
    """
    ship = find_ship(settings.ship or SHIP)
    model = find_model(settings.model or preferred_model(ship))
    if settings.schedule is None:
        return design_autopilot(model, ship)
    return replace(read_schedule(settings.schedule, model.name), model=model, ships=(ship,))


def preferred_model(ship: ParameterSet) -> str:
    """Return the name of the model of a bridge for a ship.

    Parameters
    ----------
    ship : ParameterSet
        The ship.

    Raises
    ------
    UsageError
        If her set holds no coefficients of a model with position and heading.
    """
    for name in _PREFERRED:
        if name in ship.sections:
            return name
    for name in ship.sections:
        found = _model(name)
        if found is not None and {"x", "y", "psi"} <= set(found.states):
            return name
    raise UsageError(f"ship {ship.name} holds no model with position and heading: name one with --model.")


def _model(name: str) -> Model | None:
    try:
        return find_model(name)
    except UsageError:
        return None


@contextmanager
def open_bridge(settings: BridgeSettings, host: str, port: int, token: str | None = None) -> Iterator[OpenedBridge]:
    """Open a bridge: take its port and its recording, and close both at the end.

    Parameters
    ----------
    settings : BridgeSettings
        What it is opened with.
    host : str
        Address to serve at.
    port : int
        Port; 0 for any.
    token : str, optional
        What has to be shown; made up where another host than this machine is served.

    Yields
    ------
    OpenedBridge

    Raises
    ------
    MissingExtraError
        If the web server is not installed.
    """
    try:
        from shipid.bridge.server.guard import is_loopback
        from shipid.bridge.server.serve import listening
    except ImportError:
        raise MissingExtraError("the bridge", "starlette, uvicorn and websockets", "bridge") from None
    if token is None and not is_loopback(host):
        token = secrets.token_urlsafe(16)
    pilot = pilot_of(settings)
    source = source_of(settings, pilot)
    core = BridgeCore(
        pilot,
        source,
        filter_interval=settings.filter_interval,
        prediction_interval=settings.prediction_interval,
        started=datetime.now(UTC),
    )
    if source.timed:
        core.clock_factor = settings.clock_factor
    listener = listening(host, port)
    try:
        shown = f"[{host}]" if ":" in host else host
        address = f"http://{shown}:{listener.getsockname()[1]}/" + ("" if token is None else f"?token={token}")
        yield OpenedBridge(core, listener, address, token, None, settings.record)
    finally:
        listener.close()


def source_of(settings: BridgeSettings, pilot: Autopilot) -> SampleSource:
    """Return the source of a bridge.

    Parameters
    ----------
    settings : BridgeSettings
        What the bridge is opened with.
    pilot : Autopilot
        The autopilot, with the ship.

    Raises
    ------
    UsageError
        If there is no such source.
    """
    kind, _, _rest = settings.source.partition(":")
    if kind == "simulate":
        calm = (0.0, 0.0)
        return SimulatedSource(pilot, seed=settings.seed, current=settings.current or calm, wind=settings.wind or calm)
    raise UsageError(
        f"there is no source '{settings.source}': write simulate, replay:TRIAL, nmea:udp:PORT, nmea:tcp:HOST:PORT or signalk:URL."
    )
