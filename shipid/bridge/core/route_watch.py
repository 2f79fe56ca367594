"""The ship beside her route: the leg she is on, how far she is off the planned line, and the turn that comes next."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.wheel_over import WARNING, TrackLeg, WheelOver
from shipid.prediction.tracks.predicted_track import PredictedTrack

#: Distance off the track in m that is an alarm where a leg states none: a tenth of a nautical mile.
OFF_TRACK = 185.2
#: The place on the line is looked for so far ahead of the place before and behind it, in m: a route may cross itself.
_AHEAD, _BEHIND = 2000.0, 500.0
#: The line is sought as a whole again where the ship is so much farther from the place that was found, in m.
_LOST = 1000.0


@dataclass(frozen=True)
class Waypoint:
    """A waypoint of the route in local metres.

    Attributes
    ----------
    x, y : float
        To the north and to the east in m.
    name : str
        Its name, or nothing.
    radius : float or None
        Of the turn there in m.
    xtd_port, xtd_starboard : float or None
        Limits of the leg that ends there, in m.
    """

    x: float
    y: float
    name: str = ""
    radius: float | None = None
    xtd_port: float | None = None
    xtd_starboard: float | None = None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        numbers = ("x", "y", "radius", "xtd_port", "xtd_starboard")
        return {"name": self.name, **{n: number(getattr(self, n), 8) for n in numbers}}


@dataclass(frozen=True)
class PlannedRoute:
    """A route as the bridge uses it.

    Attributes
    ----------
    name : str
        Its name.
    waypoints : tuple of Waypoint
        Two at least.
    plan : PlannedTrack
        Its legs, and the line over the ground.
    """

    name: str
    waypoints: tuple[Waypoint, ...]
    plan: PlannedTrack


class RouteWatch:
    """Follows the ship along a route.

    Parameters
    ----------
    route : PlannedRoute
        The route.

    Attributes
    ----------
    leg : int
        Number of the leg the ship is on, or turns to.
    off_track : float or None
        Distance from the planned line in m, positive to starboard.
    finished : bool
        Whether the end of the route is passed.
    turn : WheelOver or None
        The turn onto the next leg.
    overshoot : float or None
        How far the predicted track swings beyond the next leg in m.
    """

    def __init__(self, route: PlannedRoute) -> None:
        self.route = route
        self.leg = 0
        self.off_track: float | None = None
        self.finished = False
        self.turn: WheelOver | None = None
        self.overshoot: float | None = None
        self._asked = 0.0
        line = route.plan.line
        self._begin, self._along = line[:-1], np.diff(line, axis=0)
        self._lengths = np.maximum(np.hypot(self._along[:, 0], self._along[:, 1]), 1e-9)
        self._sailed = np.concatenate([[0.0], np.cumsum(self._lengths)])
        # A leg begins in the middle of the turn onto it: at the point of the line that is nearest to its waypoint.
        self._starts = [0.0]
        for leg in route.plan.legs[1:]:
            nearest = np.hypot(line[:, 0] - leg.x, line[:, 1] - leg.y)
            after = self._sailed > self._starts[-1]
            self._starts.append(float(self._sailed[np.where(after, nearest, np.inf).argmin()]))
        self._place: float | None = None

    @property
    def next_leg(self) -> TrackLeg | None:
        """The leg after the one the ship is on; None on the last."""
        legs = self.route.plan.legs
        return legs[self.leg + 1] if self.leg + 1 < len(legs) else None

    def update(self, x: float, y: float) -> None:
        """Take the ship's place.

        Parameters
        ----------
        x, y : float
            In m.
        """
        away = np.array([x, y]) - self._begin
        share = np.clip((away * self._along).sum(axis=1) / self._lengths**2, 0.0, 1.0)
        left = away - share[:, None] * self._along
        gap = np.hypot(left[:, 0], left[:, 1])
        place = self._sailed[:-1] + share * self._lengths
        best = int(gap.argmin())
        if self._place is not None:
            near = (place > self._place - _BEHIND) & (place < self._place + _AHEAD)
            if near.any():
                close = int(np.where(near, gap, np.inf).argmin())
                if gap[close] <= gap[best] + _LOST:
                    best = close
        side = self._along[best, 0] * left[best, 1] - self._along[best, 1] * left[best, 0]
        legs = self.route.plan.legs
        self._place = float(place[best])
        self.leg = max(k for k, start in enumerate(self._starts) if start <= self._place)
        last = legs[-1]
        self.finished = self.leg == len(legs) - 1 and bool(last.along(x, y) >= self.route.plan.end)
        # Before and behind the line its first and last leg go on.
        if self._place <= 0.0 or self.finished:
            self.off_track = float((last if self.finished else legs[0]).across(x, y))
        else:
            self.off_track = float(np.sign(side) * gap[best])

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
        point = self.route.waypoints[min(self.leg + 1, len(self.route.waypoints) - 1)]
        return point.xtd_port or OFF_TRACK, point.xtd_starboard or OFF_TRACK

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

    def to_dict(self, t: float) -> dict[str, Plain]:
        """Return what the page shows, SI.

        Parameters
        ----------
        t : float
            Now, in s.
        """
        turn, left = self.turn, self.to_wheel_over(t)
        speed = None if turn is None or not turn.time else turn.distance / turn.time
        return {
            "leg": self.leg,
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
    def fixed(self) -> dict[str, Plain]:
        """What does not change: name, waypoints and line."""
        line = [[number(v, 8) for v in point] for point in self.route.plan.line.tolist()]
        return {
            "name": self.route.name,
            "waypoints": [w.to_dict() for w in self.route.waypoints],
            "line": line,
        }
