"""What raises the alarms of the bridge: the source, the sensors, the filter, the recording and the route."""

from __future__ import annotations

from shipid.bridge.core.companions import Recording
from shipid.bridge.core.route_watch import RouteWatch
from shipid.bridge.core.source import SampleSource
from shipid.bridge.own_ship.own_ship import OwnShip
from shipid.bridge.shown.alarms import AlarmKind, Alarms
from shipid.declaration.vocabulary import compass
from shipid.prediction.routes.rtz import MILE

#: The source is stale where nothing was heard in so many seconds after the beginning.
STALE = 5.0
#: Sensors without which a navigator knows neither where the ship is nor where she heads.
_VITAL = ("psi", "x")


class AlarmWatch:
    """Looks at everything that may raise an alarm.

    Parameters
    ----------
    alarms : Alarms
        The alarms.
    source : SampleSource
        Where the samples come from.
    own_ship : OwnShip
        The own ship.
    route : RouteWatch or None
        The route that is sailed.
    recording : Recording or None
        What keeps the samples.
    """

    def __init__(
        self,
        alarms: Alarms,
        source: SampleSource,
        own_ship: OwnShip,
        route: RouteWatch | None,
        recording: Recording | None,
    ) -> None:
        self._alarms, self._source, self._own_ship = alarms, source, own_ship
        self._route, self._recording = route, recording
        self._warned = 0

    def look(self, t: float) -> None:
        """Say of every condition whether it holds.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        self._look_at_sensors(t)
        alarms, own = self._alarms, self._own_ship
        health = own.health
        alarms.set("diverged", health == "diverged", t, "alarm", f"the filter has diverged: {own.diverged_by}")
        alarms.set("doubtful", health == "doubtful", t, "warning", "the filter rejects many samples")
        jumped = own.jumped
        if jumped is not None:
            alarms.set("jump", True, t, "alarm", f"the position has jumped by {_distance(jumped)}: check the fixes")
        else:
            alarms.set("jump", False, t)
        stopped = None if self._recording is None else self._recording.to_dict()["message"]
        alarms.set("recording", bool(stopped), t, "warning", str(stopped or ""))
        if self._route is not None:
            self._look_at_route(t, self._route)

    def _look_at_sensors(self, t: float) -> None:
        own, alarms, source = self._own_ship, self._alarms, self._source
        quiet = own.sensors.youngest
        silent = t > STALE if quiet is None else own.sensors.silent
        stale = source.state == "lost" or (source.state == "running" and silent)
        alarms.set("stale", stale, t, "alarm", f"no data from the source ({source.kind})")
        ended = (
            "the replay has ended: this is its last moment" if source.timed else f"the source has ended ({source.kind})"
        )
        alarms.set("ended", source.state == "ended", t, "caution", ended)
        lost = own.sensors.lost
        told = {c.partition(":")[2] for c in alarms.conditions if c.startswith("lost:")}
        # Silence of the whole source is one alarm; a sensor that was lost before has not come back with it.
        for name in told if stale or source.state == "ended" else {*lost, *told}:
            kind: AlarmKind = "alarm" if name in _VITAL else "warning"
            alarms.set(f"lost:{name}", name in lost, t, kind, f"sensor lost: {lost.get(name, name)}")

    def _look_at_route(self, t: float, route: RouteWatch) -> None:
        alarms = self._alarms
        off = route.off_track or 0.0
        side = "starboard" if off > 0 else "port"
        if route.off_track is not None:
            alarms.set("off track", route.is_off, t, "alarm", f"off track: {_distance(abs(off))} to {side}")
        due, turn = route.warns(t) and route.next_leg is not None, route.turn
        if route.leg != self._warned:
            # The turn that was warned of is sailed.
            self._warned = route.leg
            alarms.drop("wheel-over")
        alarms.set("unsteered", bool(route.unsteered), t, "alarm", f"the track pilot orders nothing: {route.unsteered}")
        to = compass(0.0 if turn is None else turn.heading)
        alarms.set("wheel-over", due, t, "warning", f"wheel-over to {to}° within a minute")
        alarms.set("route ended", route.finished, t, "caution", "the end of the route is passed")


def _distance(metres: float) -> str:
    """A distance as the page writes it."""
    return f"{metres:.0f} m" if metres < MILE else f"{metres / MILE:.2f} nm"
