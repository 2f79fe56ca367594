"""The next turn of a route: where the wheel goes over, and how the predicted track keeps to the plan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

import numpy as np

from shipid.declaration.vocabulary import compass, shown
from shipid.foundation.aliases import Plain
from shipid.foundation.result import Result
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.track_pilot import TrackPilot
from shipid.prediction.following.wheel_over import TrackLeg, WheelOver, heading_on
from shipid.prediction.routes.route import Route
from shipid.prediction.routes.sailings import turned
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.track_predictor import TrackPredictor
from shipid.prediction.tracks.track_run import cruise_of
from shipid.trials.logs.geodesy import to_geographic

#: A smaller bend is none to put the wheel over for: a leg cut into pieces has many.
_BEND = np.deg2rad(2.0)
#: So near to the leg's heading, in rad, and so near before the waypoint, in ship lengths and radii, the ship turns as she is now;
#: from farther away she is taken to be on the leg by then.
_ALIGNED, _NEAR, _RADII = np.deg2rad(10.0), 12.0, 2.0
#: A ship so near to the course of a leg, in rad, is on it.
_THERE = np.deg2rad(30.0)
_UNITS = {"off_track": "m", "change": "rad", "rudder_limit": "rad", "overshoot": "m", "inside": "m"}


@dataclass(frozen=True, eq=False, repr=False)
class RouteTurn(Result):
    """The next turn of a route, or its last leg; SI.

    Attributes
    ----------
    route : Route
        The route.
    plan : PlannedTrack
        Its track in local metres.
    leg : int
        Number of the leg of the plan the ship is on.
    now : tuple of float
        Where the ship is now, to the north and to the east in m.
    off_track : float
        Of the ship now, in m, positive to starboard.
    waypoint : int or None
        Number of the waypoint of the turn, from 0; None on the last leg.
    left : float
        Along the track to that waypoint, or to the end, in m.
    change : float
        Change of course in rad, positive to starboard.
    rudder_limit : float or None
        Of the turn in rad.
    wheel_over : WheelOver or None
        Its distance and time are along the track, at the present speed over the ground.
    place : tuple of float or None
        Latitude and longitude in rad of the wheel-over, where the route has them.
    overshoot, inside : float
        Farthest that the predicted track leads to the outside of the turn and to the inside of it off the plan, in m.
    beyond : float or None
        Farthest beyond a cross-track limit in m, zero or less where the track keeps them; None where there is none.
    beyond_band : float or None
        The same for the edge of the 95 % band; None where no band is known.
    """

    UNITS: ClassVar[Mapping[str, str]] = {
        "now": "m",
        "off_track": "m",
        "left": "m",
        "change": "rad",
        "rudder_limit": "rad",
        "place": "rad",
        "overshoot": "m",
        "inside": "m",
        "beyond": "m",
        "beyond_band": "m",
    }

    route: Route
    plan: PlannedTrack
    leg: int
    now: tuple[float, float]
    off_track: float
    waypoint: int | None
    left: float
    change: float = 0.0
    rudder_limit: float | None = None
    wheel_over: WheelOver | None = None
    place: tuple[float, float] | None = None
    overshoot: float = 0.0
    inside: float = 0.0
    beyond: float | None = None
    beyond_band: float | None = None

    @property
    def words(self) -> list[str]:
        """What it says, line by line."""
        side = "starboard" if self.off_track > 0 else "port"
        now = f"{abs(self.off_track):.0f} m to {side} of the track"
        if self.waypoint is None or self.wheel_over is None:
            end = f"{self.left:.0f} m to the end" if self.left >= 0 else f"the end is passed by {-self.left:.0f} m"
            return [f"route '{self.route.name}', last leg: {end}, {now}", *self._limits()]
        found = self.wheel_over
        heading = f"{compass(found.heading)} deg"
        when = (
            f"passed by {-found.distance:.0f} m"
            if found.due
            else f"in {found.time:.0f} s, {found.distance:.0f} m ahead"
            + (": warning, less than a minute" if found.warning else "")
        )
        turn = f"{shown(abs(self.change), 'psi', digits=3)} to {'starboard' if self.change > 0 else 'port'}"
        return [
            f"route '{self.route.name}', next turn at {self.route.called(self.waypoint)}: {turn}, {self.left:.0f} m along the track; now "
            f"{now}",
            f"wheel-over to {heading} with {shown(self.rudder_limit or 0.0, 'delta', digits=2)} of rudder {when}, at {self._where(found)}",
            f"against the plan: {self.overshoot:.0f} m at most to the outside of the turn, {self.inside:.0f} m to the inside",
            *self._limits(),
        ]

    def _where(self, found: WheelOver) -> str:
        if self.place is None:
            return f"x {found.x:.0f} m, y {found.y:.0f} m"
        lat, lon = map(math.degrees, self.place)
        return f"{_minutes(lat, 2, 'NS')}, {_minutes(lon, 3, 'EW')}"

    def _limits(self) -> list[str]:
        if self.beyond is None:
            return []
        if self.beyond > 0:
            return [f"cross-track limit left by {self.beyond:.0f} m"]
        if self.beyond_band is not None and self.beyond_band > 0:
            return [f"cross-track limits kept; the 95 % band leaves them by {self.beyond_band:.0f} m"]
        return ["cross-track limits kept" + ("" if self.beyond_band is None else ", the 95 % band too")]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI; null where nothing is known."""
        sizes = {n: _plain(getattr(self, n), unit) for n, unit in _UNITS.items()}
        return {
            "name": self.route.name,
            "waypoint": None if self.waypoint is None else self.waypoint + 1,
            "waypoint_name": None if self.waypoint is None else self.route.waypoints[self.waypoint].name,
            "left": _plain(self.left, "m"),
            **sizes,
            "wheel_over": None if self.wheel_over is None else self.wheel_over.to_dict(),
            "wheel_over_place": None
            if self.place is None
            else {n: _plain(math.degrees(c), "deg") for n, c in zip(("lat", "lon"), self.place)},
            "warning": self.wheel_over is not None and self.wheel_over.warning,
            "beyond_limits": _plain(self.beyond, "m"),
            "beyond_limits_95": _plain(self.beyond_band, "m"),
            "limits_kept": None if self.beyond is None else self.beyond <= 0,
        }


def next_turn(
    predictor: TrackPredictor,
    situation: Situation,
    route: Route,
    plan: PlannedTrack,
    *,
    origin: tuple[float, float] | None = None,
    rudder_limit: float | None = None,
) -> tuple[RouteTurn, Situation]:
    """Return the next turn of a route, and the ship where her wheel goes over.

    A ship that is far from the turn, or not yet on the heading that keeps her leg, is taken to be on the leg by then.

    Parameters
    ----------
    predictor : TrackPredictor
        Predicts the turn.
    situation : Situation
        What is known of the ship, her position among it.
    route : Route
        The route.
    plan : PlannedTrack
        Its track.
    origin : tuple of float, optional
        Latitude and longitude in rad of the place that is (0, 0).
    rudder_limit : float, optional
        Of the turn in rad; by default the one with which it stays nearest to its arc.

    Returns
    -------
    RouteTurn
        Without what is known only when the track is predicted.
    Situation
        Where the turn begins; on the last leg where the ship is.

    Raises
    ------
    UsageError
        If the current is too strong to keep a leg.
    """
    x, y = situation.values["x"], situation.values["y"]
    off, on = plan.off_track(x, y)
    leg = int(on[0])
    bends = np.array([turned(b.course - a.course) for a, b in zip(plan.legs, plan.legs[1:])])
    wide = np.flatnonzero(np.abs(bends[leg:]) > _BEND)
    last = len(plan.legs) - 1 if not wide.size else leg + int(wide[0])
    # Along the legs to the waypoint: the rest of this one, and those between that hardly bend.
    ends = [(w.x, w.y) for w in plan.legs[leg + 1 : last + 1]]
    ends.append(tuple(plan.line[-1]) if last + 1 == len(plan.legs) else (plan.legs[last + 1].x, plan.legs[last + 1].y))
    left = plan.legs[leg].along(*ends[0]) - plan.legs[leg].along(x, y)
    left += sum(math.hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(ends))
    if last + 1 == len(plan.legs):
        return RouteTurn(route, plan, leg, (x, y), float(off[0]), None, float(left)), situation
    there = _on_leg(predictor, situation, plan, leg, last, float(left))
    helm = TrackPilot(predictor, plan, rudder_limit=rudder_limit)
    helm.leg = last
    turn = helm.turn_ahead(there)
    course = plan.legs[last].course
    at = _moved(
        there,
        {
            "x": there.values["x"] + turn.ahead * math.cos(course),
            "y": there.values["y"] + turn.ahead * math.sin(course),
        },
    )
    distance = float(left) - (
        plan.legs[last].along(plan.legs[last + 1].x, plan.legs[last + 1].y)
        - plan.legs[last].along(at.values["x"], at.values["y"])
    )
    speed = float(np.hypot(*situation.ground_velocity))
    found = WheelOver(turn.heading, distance, distance / speed, at.values["x"], at.values["y"], turn.track)
    place = None
    if route.geographic and origin is not None:
        lat, lon = to_geographic(found.x, found.y, origin)
        place = float(lat), float(turned(lon))
    result = RouteTurn(
        route,
        plan,
        leg,
        (x, y),
        float(off[0]),
        plan.waypoints[last],
        float(left),
        float(bends[last]),
        turn.rudder_limit,
        found,
        place,
    )
    return result, situation if found.due else at


def _on_leg(
    predictor: TrackPredictor, situation: Situation, plan: PlannedTrack, leg: int, last: int, left: float
) -> Situation:
    """The ship as she begins her turn: as she is where she is near and on her heading, else on the leg and steady."""
    before = plan.legs[last]
    wanted = heading_on(before, situation.current, cruise_of(situation))
    radius = 0.0 if plan.radii is None else float(plan.radii[last + 1])
    near = left < _NEAR * predictor.length + _RADII * radius
    if leg == last and near and abs(turned(wanted - situation.values["psi"])) < _ALIGNED:
        return situation
    x, y = situation.values["x"], situation.values["y"]
    along = before.along(x, y) if leg == last else 0.0
    steady: dict[str, float] = {n: 0.0 for n in ("r", "v", "delta") if n in situation.values}
    psi = situation.values["psi"] + float(turned(wanted - situation.values["psi"]))
    place = _at(before, max(along, 0.0))
    return _moved(situation, {"psi": psi, "x": place[0], "y": place[1], **steady})


def _at(leg: TrackLeg, along: float) -> tuple[float, float]:
    return leg.x + along * math.cos(leg.course), leg.y + along * math.sin(leg.course)


def _moved(situation: Situation, values: dict[str, float]) -> Situation:
    return replace(situation, values={**situation.values, **values})


def against_plan(turn: RouteTurn, track: PredictedTrack) -> RouteTurn:
    """Return a turn with how its predicted track keeps to the plan.

    Parameters
    ----------
    turn : RouteTurn
        The turn.
    track : PredictedTrack
        The track, from the wheel-over on.
    """
    plan = turn.plan
    onto = turn.leg
    if turn.waypoint is not None:
        onto = max(k for k, w in enumerate(plan.waypoints) if w == turn.waypoint) + 1
    rows = slice(0, _end_on(plan, onto, track))
    off, on = plan.off_track(track.x[rows], track.y[rows], onto)
    outward = -math.copysign(1.0, turn.change) * off
    found = replace(turn, overshoot=max(float(outward.max()), 0.0), inside=max(float(-outward.min()), 0.0))
    if plan.limits is None or not np.isfinite(plan.limits[np.unique(on)]).any():
        return found
    found = replace(found, beyond=float(plan.beyond_limits(off, on).max()))
    width = track.half_width
    if width is None:
        return found
    edges = [float(plan.beyond_limits(off + side * width[rows], on).max()) for side in (1, -1)]
    return replace(found, beyond_band=max(edges))


def _end_on(plan: PlannedTrack, onto: int, track: PredictedTrack) -> int:
    """How many points of a track count: those before the ship, on her new leg, would turn again or be at the end."""
    leg = plan.legs[onto]
    end = plan.end
    if onto + 1 < len(plan.legs) and plan.arcs is not None:
        end = float(leg.along(*plan.line[plan.arcs[onto + 1, 0]]))
    elif onto + 1 < len(plan.legs):
        end = float(leg.along(plan.legs[onto + 1].x, plan.legs[onto + 1].y))
    there = (np.abs(turned(track.psi - leg.course)) < _THERE) & (np.asarray(leg.along(track.x, track.y)) > end)
    return max(1, int(np.argmax(there))) if there.any() else track.s.size


def _minutes(value: float, digits: int, sides: str) -> str:
    """Degrees and minutes, as navigators write them: 53°30.50' N."""
    minutes = round(abs(value) * 60, 2)
    return f"{int(minutes // 60):0{digits}d}°{minutes % 60:05.2f}' {sides[0] if value >= 0 else sides[1]}"


def _plain(value: float | None, unit: str) -> Plain:
    return None if value is None else {"value": float(value), "unit": unit}
