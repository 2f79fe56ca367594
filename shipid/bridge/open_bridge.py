"""Put a bridge together and open it; what cannot be is refused before the page opens."""

from __future__ import annotations

import secrets
import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from urllib.parse import quote

from shipid.autopilot.course_changes.turn_order import RADIUS
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.design_autopilot import design_autopilot
from shipid.autopilot.design.read_schedule import check_same_ship, read_schedule
from shipid.bridge.bridge_settings import SHIP, BridgeSettings
from shipid.bridge.core.core import RUDDER_LIMIT, BridgeCore
from shipid.bridge.core.route_watch import BridgeRoute, bridge_route
from shipid.bridge.core.source import SampleSource
from shipid.bridge.experiment.open_experiment import open_experiment
from shipid.bridge.experiment.voyage_score import VoyageScore
from shipid.bridge.recorder import Recorder
from shipid.bridge.sources.replayed import ReplayedSource
from shipid.bridge.sources.source_of import source_of
from shipid.declaration.model import Model
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingExtraError, UsageError
from shipid.parameters.catalogue import find_model, find_ship
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.replaced import with_values
from shipid.prediction.charts.read_chart import read_chart
from shipid.prediction.routes.read_route import read_route
from shipid.prediction.routes.shared_origin import shared_origin
from shipid.prediction.sailing.loop_cycles import loop_cycles

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
    score : VoyageScore or None
        The score of the tracking experiment.
    recording : Path or None
        The recording.
    notes : tuple of str or Notice
        What was found out when the route and the chart were read, and of the schedule.
    """

    core: BridgeCore
    listener: socket.socket
    address: str
    token: str | None
    chart: Plain
    score: VoyageScore | None
    recording: Path | None
    notes: tuple[str, ...] = ()

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

    Raises
    ------
    UsageError
        If the model has no position and heading.
    """
    # A schedule holds its ship and names its model.
    given = None if settings.model is None else hold_inputs(find_model(settings.model), dict(settings.inputs))
    designed = None if settings.schedule is None else read_schedule(settings.schedule, given)
    ship = designed.ship if designed is not None and settings.ship is None else find_ship(settings.ship or SHIP)
    if given is not None:
        model = given
    else:
        model = hold_inputs(
            find_model(preferred_model(ship)) if designed is None else designed.model, dict(settings.inputs)
        )
    ship = with_values(ship, dict(settings.values), [model])
    if not {"x", "y", "psi"} <= set(model.states):
        raise UsageError(f"model {model.name} has no position and heading: choose another, such as de-keizer.")
    if designed is None:
        return design_autopilot(model, ship)
    check_same_ship(settings.schedule or "", designed, ship)
    return replace(designed, model=model, ships=(ship,))


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
def open_bridge(
    settings: BridgeSettings,
    host: str,
    port: int,
    token: str | None = None,
    ended: Callable[[VoyageScore], None] | None = None,
) -> Iterator[OpenedBridge]:
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
    ended : callable, optional
        Called with the score at the end of a track of the experiment.

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
        from shipid.bridge.server.serve import listening, reached_at
    except ImportError:
        raise MissingExtraError("the bridge", "starlette, uvicorn and websockets", "bridge") from None
    if token is None and not is_loopback(host):
        token = secrets.token_urlsafe(16)
    parts = _parts_of(settings, ended)
    listener = listening(host, port)
    recorder = None
    try:
        if settings.record is not None:
            # What is replayed of a simulation stays one.
            simulated = parts.source.kind == "simulate" or getattr(parts.source, "simulated", False)
            name = parts.pilot.ship.name
            recorder = Recorder(settings.record, name, settings.source, simulated=simulated, origin=parts.origin)
        # What a schedule does to the steering gear is seen once, before the page opens; one that is designed here is sound.
        faults = [] if settings.schedule is None else loop_cycles(parts.pilot)
        core = _core_of(settings, parts, recorder, faults)
        address = f"http://{reached_at(listener, host)}/" + ("" if token is None else f"?token={quote(token, safe='')}")
        yield OpenedBridge(
            core, listener, address, token, parts.chart, parts.score, settings.record, (*parts.notes, *faults)
        )
    finally:
        listener.close()
        if recorder is not None:
            recorder.close()


@dataclass(frozen=True)
class _Parts:
    """What a bridge is put together from."""

    pilot: Autopilot
    source: SampleSource
    route: BridgeRoute | None = None
    chart: Plain = None
    score: VoyageScore | None = None
    predicts: bool = True
    heading: float = 0.0
    rudder_limit: float = RUDDER_LIMIT
    notes: tuple[str, ...] = ()
    origin: tuple[float, float] | None = None


def _parts_of(settings: BridgeSettings, ended: Callable[[VoyageScore], None] | None) -> _Parts:
    pilot = pilot_of(settings)
    if settings.scenario is not None:
        return _experiment_of(settings, pilot, ended)
    if settings.condition is not None:
        raise UsageError("--condition belongs to a --scenario of the tracking experiment.")
    # A record has its place of x = y = 0 already; a route and every other source take that of the route.
    replayed = source_of(settings, pilot) if settings.source.startswith("replay:") else None
    read = None if settings.route is None else read_route(settings.route)
    origin = shared_origin(read, replayed.trial if isinstance(replayed, ReplayedSource) else None)
    route = None
    notes: list[str] = []
    if read is not None:
        notes += [f"route: {n}" for n in read.notes]
        route = bridge_route(read, origin, RADIUS * pilot.length)
    chart: Plain = None
    if settings.chart is not None:
        if origin is None:
            raise UsageError(
                "a chart needs the place of x = y = 0: give a --route with latitudes and longitudes beside it, or replay a log whose "
                "positions are such."
            )
        drawn = read_chart(settings.chart, origin)
        notes += [f"chart: {n}" for n in drawn.notes]
        chart = drawn.to_dict()
    begin = None if route is None else route.plan.legs[0]
    source = replayed or source_of(settings, pilot, origin, begin)
    heading = begin.course if begin is not None and source.kind == "simulate" else 0.0
    return _Parts(pilot, source, route, chart, heading=heading, notes=tuple(notes), origin=origin)


def _experiment_of(settings: BridgeSettings, pilot: Autopilot, ended: Callable[[VoyageScore], None] | None) -> _Parts:
    if settings.source != "simulate" or any(s is not None for s in (settings.route, settings.chart, settings.waves)):
        raise UsageError(
            "the tracking experiment is simulated, on a track of its own and without waves: leave --source, --route, --chart and --waves "
            "out."
        )
    opened = open_experiment(
        pilot,
        settings.scenario or "",
        settings.condition or "C",
        current=settings.current,
        wind=settings.wind,
        seed=settings.seed,
        ended=ended,
    )
    return _Parts(
        pilot,
        opened.source,
        opened.route,
        None,
        opened.score,
        opened.predicts,
        opened.source.now["psi"],
        opened.rudder_limit,
    )


def _core_of(
    settings: BridgeSettings, parts: _Parts, recorder: Recorder | None, faults: Sequence[str] = ()
) -> BridgeCore:
    source = parts.source
    core = BridgeCore(
        parts.pilot,
        source,
        route=parts.route,
        recording=recorder,
        score=parts.score,
        filter_interval=settings.filter_interval,
        prediction_interval=settings.prediction_interval,
        started=source.started if isinstance(source, ReplayedSource) else datetime.now(UTC),
        predicts=parts.predicts,
        heading=parts.heading,
        rudder_limit=parts.rudder_limit,
        notes=parts.notes,
        faults=faults,
    )
    if source.timed:
        core.clock_factor = settings.clock_factor
    if parts.score is not None:
        # In condition D nobody steers; in the others the navigator's limit is that of the experiment.
        core.command({"command": "trial", "mode": "track"} if parts.score.condition == "D" else {"command": "trial"})
        core.command({"command": "execute"})
    return core
