"""The ship beside her route: the leg she is on, how far she is off the planned line, and the turn that comes next."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from shipid.bridge.shown.plain_values import number, strict_json
from shipid.foundation.aliases import Plain
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.wheel_over import WARNING, TrackLeg, WheelOver
from shipid.prediction.routes.route import Route
from shipid.prediction.routes.route_plan import plan_of
from shipid.prediction.tracks.predicted_track import PredictedTrack

#: Distance off the track in m that is an alarm where a leg states none: a tenth of a nautical mile.
OFF_TRACK = 185.2
#: The whole track is looked at again where the ship is so much farther, in m, from the part she was on.
_ELSEWHERE = 1000.0
#: The line is sent with so many points at most.
_SENT = 1000


@dataclass(frozen=True, eq=False)
class BridgeRoute:
    """A route as the bridge uses it, in local metres.

    Attributes
    ----------
    name : str
        Its name.
    plan : PlannedTrack
        Its legs, and the line over the ground.
    points : tuple of dict
        Its waypoints as the page shows them: ``x``, ``y``, ``name``, ``radius``, ``xtd_port``, ``xtd_starboard``; SI.
    """

    name: str
    plan: PlannedTrack
    points: tuple[dict[str, Plain], ...]


def bridge_route(route: Route, origin: tuple[float, float] | None, radius: float) -> BridgeRoute:
    """Return a route as the bridge uses it.

    Parameters
    ----------
    route : Route
        The route.
    origin : tuple of float or None
        Latitude and longitude in rad of x = y = 0; the first waypoint by default.
    radius : float
        Of the turns in m where the route states none.
    """
    plan = plan_of(route, origin=origin, radius=radius)
    points = []
    for point, (x, y) in zip(route.waypoints, route.local(origin).tolist()):
        numbers = {"x": x, "y": y, "radius": point.radius, "xtd_port": point.xtd_port}
        numbers["xtd_starboard"] = point.xtd_starboard
        points.append({"name": point.name, **{n: number(v, 8) for n, v in numbers.items()}})
    return BridgeRoute(route.name, plan, tuple(points))


class RouteWatch:
    """Follows the ship along a route.

    Parameters
    ----------
    route : BridgeRoute
        The route.

    Attributes
    ----------
    leg : int
        Number of the leg of the planned track that the ship is on, or turns to.
    off_track : float or None
        Distance from the planned line in m, positive to starboard.
    finished : bool
        Whether the end of the route is passed.
    turn : WheelOver or None
        The turn onto the next leg.
    overshoot : float or None
        How far the predicted track swings beyond the next leg in m.
    unsteered : str
        Why the track pilot orders nothing, where it steers and cannot.
    """

    def __init__(self, route: BridgeRoute) -> None:
        self.route = route
        self.leg = 0
        self.off_track: float | None = None
        self.finished = False
        self.turn: WheelOver | None = None
        self.overshoot: float | None = None
        self.unsteered = ""
        self._asked = 0.0

    @property
    def next_leg(self) -> TrackLeg | None:
        """The leg that begins at the next waypoint; None behind the last one that is turned at."""
        plan = self.route.plan
        if not plan.waypoints:
            return plan.legs[self.leg + 1] if self.leg + 1 < len(plan.legs) else None
        # A leg that is curved in the plane has several pieces, all of which lead to one waypoint.
        return next((leg for leg, to in zip(plan.legs, plan.waypoints) if to > plan.waypoints[self.leg]), None)

    def update(self, x: float, y: float) -> None:
        """Take the ship's place.

        Parameters
        ----------
        x, y : float
            In m.
        """
        plan = self.route.plan
        off, leg = plan.off_track(x, y, None if self.off_track is None else self.leg)
        if self.off_track is not None:
            elsewhere, other = plan.off_track(x, y)
            if abs(elsewhere[0]) + _ELSEWHERE < abs(off[0]):
                off, leg = elsewhere, other
        self.leg = max(int(leg[0]), 0)
        first, last = plan.legs[0], plan.legs[-1]
        self.finished = self.leg == len(plan.legs) - 1 and bool(last.along(x, y) >= plan.end)
        # Before and behind the line its first and last leg go on.
        if self.finished:
            off = last.across(np.array([x]), np.array([y]))
        elif self.leg == 0 and first.along(x, y) < 0:
            off = first.across(np.array([x]), np.array([y]))
        self.off_track = float(off[0])

    def lose(self) -> None:
        """Forget where the ship is: nothing is known of her now, as where she makes no way ahead."""
        self.off_track = self.turn = self.overshoot = None

    def take(self, turn: WheelOver | None, track: PredictedTrack | None, t: float) -> None:
        """Take what was predicted.

        Parameters
        ----------
        turn : WheelOver or None
            The turn onto the next leg.
        track : PredictedTrack or None
            The track that was predicted under what is executed.
        t : float
            When it was asked for, in s.
        """
        self.turn, self._asked = turn, t
        self.overshoot = None if track is None else self._beyond(track)

    def to_wheel_over(self, t: float) -> float | None:
        """Return the seconds to the next wheel-over; negative where it is passed.

        Parameters
        ----------
        t : float
            Now, in s.
        """
        return None if self.turn is None else self.turn.time - (t - self._asked)

    def warns(self, t: float) -> bool:
        """Return whether the next wheel-over is less than a minute away.

        Parameters
        ----------
        t : float
            Now, in s.
        """
        left = self.to_wheel_over(t)
        return left is not None and left <= WARNING

    @property
    def limits(self) -> tuple[float, float]:
        """Limits to port and to starboard of the present leg in m."""
        stated = (np.inf, np.inf) if self.route.plan.limits is None else self.route.plan.limits[self.leg]
        port, starboard = (float(v) if np.isfinite(v) else OFF_TRACK for v in stated)
        return port, starboard

    @property
    def is_off(self) -> bool:
        """Whether the ship is farther from the planned line than the limits of the leg allow."""
        port, starboard = self.limits
        return self.off_track is not None and not -port <= self.off_track <= starboard

    def _beyond(self, track: PredictedTrack) -> float | None:
        """How far a track swings beyond a leg it turns to: the present one, or the next."""
        for leg in (self.next_leg, self.route.plan.legs[self.leg]):
            if leg is None:
                continue
            change = float(np.arctan2(np.sin(leg.course - track.psi[0]), np.cos(leg.course - track.psi[0])))
            final = float(np.arctan2(np.sin(leg.course - track.psi[-1]), np.cos(leg.course - track.psi[-1])))
            if abs(change) > 0.1 and abs(final) < 0.2:
                return float(max((-np.sign(change) * leg.across(track.x, track.y)).max(), 0.0))
        return None

    def text(self, t: float) -> str:
        """Return what the page shows as JSON: what does not change was written once.

        Parameters
        ----------
        t : float
            Now, in s.
        """
        return f"{self._fixed[:-1]},{strict_json(self.to_dict(t))[1:]}"

    def to_dict(self, t: float) -> dict[str, Plain]:
        """Return what changes, SI.

        Parameters
        ----------
        t : float
            Now, in s.
        """
        turn, left = self.turn, self.to_wheel_over(t)
        speed = None if turn is None or not turn.time else turn.distance / turn.time
        return {
            "leg": self.leg if not self.route.plan.waypoints else self.route.plan.waypoints[self.leg] - 1,
            "off_track": number(self.off_track, 5),
            "wheel_over": None
            if turn is None or left is None or speed is None
            else {
                "seconds": number(left, 5),
                "distance": number(left * speed, 5),
                "x": number(turn.x, 8),
                "y": number(turn.y, 8),
                "course": number(turn.heading % (2 * np.pi), 6),
            },
            "overshoot": number(self.overshoot, 4),
        }

    @functools.cached_property
    def _fixed(self) -> str:
        """What does not change: name, waypoints and line."""
        line = self.route.plan.line
        kept = np.unique(np.linspace(0, len(line) - 1, min(_SENT, len(line))).round().astype(int))
        return strict_json({
            "name": self.route.name,
            "waypoints": list(self.route.points),
            "line": [[number(v, 6) for v in point] for point in line[kept].tolist()],
        })  # fmt: skip
