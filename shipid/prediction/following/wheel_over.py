"""Wheel-over: where and when a turn has to begin so that the ship comes onto the next leg."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.declaration.vocabulary import Number, compass, shown
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result, ResultEntry
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.track_predictor import POINTS, TrackPredictor

#: Rounds in which the heading that keeps the next leg is found, when it is; and the smallest angle in rad between track and leg that meet.
_ROUNDS, _SETTLED, _PARALLEL = 8, 1e-5, np.deg2rad(2.0)
#: A turn has ended when the last half of its track lies within this distance of its end across the leg, in ship lengths; and the
#: longest track on which this is looked for, in horizons.
_ENDED, _LONGEST = 2e-3, 8
#: A heading that moves by less than this over the last quarter of a track stays, in rad.
_STEADY = 1e-5
#: How far ahead of a wheel-over a navigator is warned, in s.
WARNING = 60.0


@dataclass(frozen=True, repr=False)
class TrackLeg(ResultEntry):
    """A straight piece of a planned track.

    Attributes
    ----------
    x, y : float
        A point of it in m: the waypoint at which it begins.
    course : float
        Course over the ground in rad.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"x": "m", "y": "m", "course": "rad"}

    x: float
    y: float
    course: float

    def across(self, x: Number, y: Number) -> Number:
        """Return the distance of points from the leg's line in m, positive to starboard of it.

        Parameters
        ----------
        x, y : float or ndarray
            In m.
        """
        return (y - self.y) * math.cos(self.course) - (x - self.x) * math.sin(self.course)

    def along(self, x: Number, y: Number) -> Number:
        """Return the distance of points along the leg from its first point in m.

        Parameters
        ----------
        x, y : float or ndarray
            In m.
        """
        return (x - self.x) * math.cos(self.course) + (y - self.y) * math.sin(self.course)


@dataclass(frozen=True, eq=False, repr=False)
class WheelOver(Result):
    """Where a turn onto a leg has to begin.

    Attributes
    ----------
    heading : float
        Heading to order in rad: the leg's course, the drift angle that keeps it in the current, and how far the ship stays beside
        her order in the wind.
    distance : float
        From the ship to the point along her present course over the ground in m; negative where it is passed.
    time : float
        Seconds to it at the present speed over the ground; negative where it is passed.
    x, y : float
        The point.
    track : PredictedTrack
        The turn as it is predicted from the point.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"heading": "rad", "distance": "m", "time": "s", "x": "m", "y": "m"}

    heading: float
    distance: float
    time: float
    x: float
    y: float
    track: PredictedTrack

    @property
    def due(self) -> bool:
        """Whether the wheel is to be put over now."""
        return self.distance <= 0

    @property
    def warning(self) -> bool:
        """Whether it is less than a minute away."""
        return self.time <= WARNING

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {n: {"value": float(getattr(self, n)), "unit": unit} for n, unit in self.UNITS.items()}

    def text(self) -> str:
        """Return the result in lines of text."""
        place = (
            f"in {self.time:.0f} s, {shown(self.distance, 'x')}"
            if self.distance > 0
            else f"passed by {-self.distance:.0f} m"
        )
        return f"wheel-over to {compass(self.heading)} deg {place}"


def wheel_over(
    predictor: TrackPredictor,
    situation: Situation,
    leg: TrackLeg,
    *,
    rudder_limit: str | float | None = None,
    horizon: float = 20.0,
) -> WheelOver:
    """Return where the turn onto a leg has to begin, the ship on her present course until then.

    The turn is predicted from the present state; its end is a straight line, and it is moved along the present course over the
    ground until that line is the leg. In a current the heading at the end is the one that keeps the leg, and where a moment turns the ship off her
    order, what is ordered is so much beside it. The prediction is lengthened
    until its end is straight: an autopilot with an integral comes onto its heading slowly, and a ship that has lost speed gains it
    slowly, while she still moves across the leg.

    Parameters
    ----------
    predictor : TrackPredictor
        Predicts the turn.
    situation : Situation
        What is known of the ship.
    leg : TrackLeg
        The next leg.
    rudder_limit : str or float, optional
        Largest rudder angle of the turn.
    horizon : float
        Length of the track that is returned, in ship lengths; the end of the turn is looked for up to eight times as far ahead.

    Returns
    -------
    WheelOver

    Raises
    ------
    UsageError
        If the present course does not meet the leg, or the current is too strong to keep it.
    """
    north, east = situation.ground_velocity
    course, over_ground = np.arctan2(east, north), float(np.hypot(north, east))
    angle = np.sin(leg.course - course)
    if abs(angle) < np.sin(_PARALLEL):
        raise UsageError("the present course does not meet the leg: they are parallel. Steer towards it first.")
    heading, times, track = leg.course, 1, None
    for _ in range(_ROUNDS):
        track = predictor.predict(
            situation,
            heading=heading,
            rudder_limit=rudder_limit,
            horizon=times * horizon,
            points=times * POINTS,
            band="none",
        )
        wanted = heading_on(leg, situation.current, float(track.u[-1]), float(track.v[-1])) - _lean(track, heading)
        if abs(wanted - heading) >= _SETTLED:
            heading = wanted
        elif track.ended or times >= _LONGEST or _is_on(leg, track):
            break
        else:
            times *= 2
    assert track is not None
    # Moved ahead by d along the present course, the end of the turn moves across the leg by d sin(course - leg).
    distance = float(leg.across(track.x[-1], track.y[-1]) / angle)
    x = situation.values.get("x", 0.0) + distance * np.cos(course)
    y = situation.values.get("y", 0.0) + distance * np.sin(course)
    return WheelOver(heading, distance, distance / over_ground, float(x), float(y), track.part(0, POINTS + 1))


def _lean(track: PredictedTrack, ordered: float) -> float:
    """How far the heading at the end of a track stays beside the ordered one.

    A moment that an autopilot without an integral does not take up, as that of the wind, turns the ship until her rudder holds it. Where
    the heading still moves an integral is at work, and there will be none.
    """
    if np.ptp(track.psi[-track.psi.size // 4 :]) > _STEADY:
        return 0.0
    return float(np.arctan2(np.sin(track.psi[-1] - ordered), np.cos(track.psi[-1] - ordered)))


def _is_on(leg: TrackLeg, track: PredictedTrack) -> bool:
    """Whether the last half of a track is a straight line beside a leg."""
    across = np.asarray(leg.across(track.x, track.y))
    return bool(np.ptp(across[across.size // 2 :]) < _ENDED * track.length)


def heading_on(leg: TrackLeg, current: tuple[float, float], speed: float, sway: float = 0.0) -> float:
    """Return the heading that keeps a leg in a current.

    Parameters
    ----------
    leg : TrackLeg
        The leg.
    current : tuple of float
        To the north and to the east in m/s.
    speed, sway : float
        Through the water in m/s.

    Returns
    -------
    float
        In rad.

    Raises
    ------
    UsageError
        If the current sets across or against the leg faster than the ship sails.
    """
    through = np.hypot(speed, sway)
    across = (current[1] * np.cos(leg.course) - current[0] * np.sin(leg.course)) / through
    against = -(current[0] * np.cos(leg.course) + current[1] * np.sin(leg.course)) / through
    if abs(across) >= 1 or against >= np.sqrt(1 - across**2):
        raise UsageError(
            f"a current of {brief(np.hypot(*current))} m/s sets {'across' if abs(across) >= 1 else 'against'} the leg faster than the ship "
            "sails: the leg cannot be kept."
        )
    return float(leg.course - np.arcsin(across) - np.arctan2(sway, speed))
