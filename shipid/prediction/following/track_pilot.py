"""The track pilot: a planned track sailed by itself, out of the predictor and the course-changing autopilot.

Passenier (1989), chapter 7, suggests it. The turn is predicted at every step: before it, to find where the wheel goes over; while it
lasts, to move the rudder limit so that what is left of it stays nearest to the plan. A leg is kept by the drift angle.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.prediction.following.planned_track import PlannedTrack, distance_from
from shipid.prediction.following.wheel_over import TrackLeg, heading_on
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.order import unwrapped
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.track_predictor import HORIZON, TrackPredictor
from shipid.prediction.tracks.track_run import cruise_of

#: What the pilot does.
Phase = Literal["keeping", "turning", "arrived"]
#: The ship is led onto a leg by a point so far ahead on it, in ship lengths; by 30 degrees at most.
_AHEAD, _STEEPEST = 4.0, np.deg2rad(30.0)
#: What the heading stays off its order in weather is learnt in so many seconds, at rates of turn below this.
_LEARNING, _STRAIGHT = 400.0, np.deg2rad(0.02)
#: In a turn the rudder limit is tried at these shares of the planned one; the turn ends at so small an angle from its heading.
_SHARES, _TURNED = (0.6, 0.8, 1.0, 1.25, 1.6), np.deg2rad(4.0)
#: The next turn is worked out from so far before its arc on, in ship lengths; steps of its track a ship length, every so many of
#: which count; and how much longer than its arc the track is.
_FROM, _POINTS, _EVERY, _LONGER = 12.0, 15, 8, 1.5
#: A turn of which more than this share is left at its end is none.
_ROUND = 0.25
#: Where no rudder limit is given, the turn is tried with these shares of the largest one.
_PLANNED = tuple(1.25**-k for k in range(13))
#: A wheel-over is looked for so far ahead, in ship lengths, and in so many places.
_REACH, _PLACES = 6.0, 17
#: What is left of the leg after the turn counts so far, in ship lengths; in a turn no more than the next lengths count, since the
#: limit can still be moved.
_BEYOND, _NEXT = 4.0, 5.0


@dataclass(frozen=True, eq=False, repr=False)
class TrackOrder(Result):
    """What the track pilot orders.

    Attributes
    ----------
    heading : float
        In rad, unwrapped as the ship's own.
    rudder_limit : float
        In rad.
    phase : {"keeping", "turning", "arrived"}
        What it does.
    leg : int
        Number of the leg it is on, or turns to.
    to_wheel_over : float or None
        Seconds to the next wheel-over; None where it is farther away than is looked, or there is none.
    track : PredictedTrack or None
        The turn as it is predicted now.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"heading": "rad", "rudder_limit": "rad", "to_wheel_over": "s"}

    heading: float
    rudder_limit: float
    phase: Phase
    leg: int
    to_wheel_over: float | None = None
    track: PredictedTrack | None = None


@dataclass(frozen=True, eq=False, repr=False)
class TurnAhead(Result):
    """The next turn of a track as it is planned.

    Attributes
    ----------
    leg : int
        Number of the leg it leads onto.
    heading, rudder_limit : float
        What to order then, in rad.
    ahead : float
        From the ship to where the wheel goes over, along the leg she is on, in m; negative where it is passed.
    track : PredictedTrack
        The turn, as if it began where the ship is.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"heading": "rad", "rudder_limit": "rad", "ahead": "m"}

    leg: int
    heading: float
    rudder_limit: float
    ahead: float
    track: PredictedTrack


class TrackPilot:
    """Sails a planned track.

    Parameters
    ----------
    predictor : TrackPredictor
        Predicts the turns.
    plan : PlannedTrack
        The track.
    rudder_limit : float, optional
        Rudder limit of the turns in rad, as planned; it may be exceeded by 60 % where the turn gets too wide. By default that of
        each turn is the one with which it stays nearest to its arc, the autopilot's own at most.

    Attributes
    ----------
    leg : int
        Number of the leg it is on, or turns to.
    phase : {"keeping", "turning", "arrived"}
        What it does.

    Raises
    ------
    UsageError
        If the rudder limit is none.
    """

    def __init__(self, predictor: TrackPredictor, plan: PlannedTrack, *, rudder_limit: float | None = None) -> None:
        if rudder_limit is not None and not rudder_limit > 0:
            raise UsageError("a rudder limit is greater than zero.")
        self.predictor, self.plan = predictor, plan
        self.rudder_limit = predictor.pilot.rudder_limit if rudder_limit is None else rudder_limit
        self._limits: dict[int, float] = {}
        self._by_arc = rudder_limit is None and plan.radii is not None
        self.leg = 0
        self.phase: Phase = "keeping"
        self._limit, self._off = self.rudder_limit, 0.0
        self._ordered: float | None = None

    def steer(self, situation: Situation, interval: float = 2.0) -> TrackOrder:
        """Return what to order now.

        Parameters
        ----------
        situation : Situation
            What is known of the ship.
        interval : float
            Time to the next call in s.

        Returns
        -------
        TrackOrder
        """
        values = situation.values
        self._learn(situation, interval)
        seconds: float | None = None
        track: PredictedTrack | None = None
        if self.phase == "keeping" and self.leg + 1 < len(self.plan.legs):
            seconds, track = self._next_turn(situation)
            if seconds is not None and seconds <= 0.5 * interval:
                self.leg, self.phase = self.leg + 1, "turning"
                self._limit = self._limits.get(self.leg, self.rudder_limit)
        leg = self.plan.legs[self.leg]
        heading = self._heading(situation, leg)
        if self.phase == "turning":
            if abs(heading - values["psi"]) < _TURNED:
                self.phase = "keeping"
            else:
                self._limit, track = self._turn(situation, heading)
        if self.phase == "keeping":
            heading += self._back(situation, leg)
            if self.leg + 1 == len(self.plan.legs) and leg.along(values["x"], values["y"]) >= self.plan.end:
                self.phase = "arrived"
        self._ordered = heading
        limit = self._limit if self.phase == "turning" else self.rudder_limit
        return TrackOrder(heading + self._off, limit, self.phase, self.leg, seconds, track)

    def turn_ahead(self, situation: Situation) -> TurnAhead:
        """Return the turn onto the next leg, wherever on the rest of this leg it begins.

        Parameters
        ----------
        situation : Situation
            What is known of the ship, which is on the leg.

        Returns
        -------
        TurnAhead

        Raises
        ------
        UsageError
            If she is on the last leg, the current is too strong to keep the next one, or the rudder limit too small to turn onto it.
        """
        if self.leg + 1 >= len(self.plan.legs):
            raise UsageError("no turn is ahead: the ship is on the last leg of the track.")
        leg, following = self.plan.legs[self.leg], self.plan.legs[self.leg + 1]
        left = leg.along(following.x, following.y) - leg.along(situation.values["x"], situation.values["y"])
        left = max(left, 0.0) + self.predictor.length
        angle, _ = self._arc(self.leg + 1)
        limit = self.rudder_limit
        if self._by_arc and angle > _TURNED:
            limit = self._planned_limit(situation, left)
        track = self._to_next(situation, limit)
        if not _comes_round(track):
            raise UsageError(
                f"with {brief(np.rad2deg(limit))} deg of rudder the ship does not come to the heading of the next leg, so where the wheel goes "
                "over is not known: allow more rudder, or look at the wind and at the coefficients of the ship."
            )
        begin, spacing = -_REACH * self.predictor.length, 0.25 * self.predictor.length
        coarse, _ = self._place(track, np.linspace(begin, left, int((left - begin) / spacing) + 2))
        if coarse is None:
            coarse = left
        ahead, _ = self._place(track, coarse + np.linspace(-1.0, 1.0, _PLACES) * 2 * spacing)
        heading = self._heading(situation, following)
        return TurnAhead(self.leg + 1, heading, limit, coarse if ahead is None else ahead, track)

    def _learn(self, situation: Situation, interval: float) -> None:
        """What has to be ordered more, so that the ship sails the heading that is meant: a steady moment of the wind."""
        if self._ordered is None or abs(situation.values.get("r", 0.0)) > _STRAIGHT:
            return
        missing = self._ordered - situation.values["psi"]
        if abs(missing) < _TURNED:
            self._off += min(interval / _LEARNING, 1.0) * missing

    def _heading(self, situation: Situation, leg: TrackLeg) -> float:
        # In a turn the ship is slower than she will be on the leg.
        return unwrapped(heading_on(leg, situation.current, cruise_of(situation)), situation.values["psi"])

    def _back(self, situation: Situation, leg: TrackLeg) -> float:
        """The angle that leads back onto a leg, towards a point ahead on it (line of sight; Fossen 2011, section 10.3.2)."""
        across = leg.across(situation.values["x"], situation.values["y"])
        return float(np.clip(-np.arctan2(across, _AHEAD * self.predictor.length), -_STEEPEST, _STEEPEST))

    def _next_turn(self, situation: Situation) -> tuple[float | None, PredictedTrack | None]:
        """Seconds to where the turn, begun there, stays nearest to the plan; and the turn."""
        leg, following = self.plan.legs[self.leg], self.plan.legs[self.leg + 1]
        left = leg.along(following.x, following.y) - leg.along(situation.values["x"], situation.values["y"])
        north, east = situation.ground_velocity
        speed = north * np.cos(leg.course) + east * np.sin(leg.course)
        angle, radius = self._arc(self.leg + 1)
        begin = _FROM * self.predictor.length + radius * np.tan(min(angle, np.pi - _TURNED) / 2)
        if left > begin or speed < 0.8 * np.hypot(north, east):
            return None, None
        if self._by_arc and angle > _TURNED and self.leg + 1 not in self._limits:
            self._limits[self.leg + 1] = self._planned_limit(situation, left)
        track = self._to_next(situation, self._limits.get(self.leg + 1, self.rudder_limit))
        place, _ = self._place(track, np.linspace(-0.2, 1.0, _PLACES) * _REACH * self.predictor.length)
        return (None if place is None else float(place / speed)), track

    def _planned_limit(self, situation: Situation, left: float) -> float:
        """The rudder limit with which the next turn stays nearest to its arc, wherever on the rest of the leg it begins."""
        limits = [share * self.rudder_limit for share in _PLANNED]
        ahead = np.linspace(-_REACH * self.predictor.length, left, 3 * _PLACES)
        tracks = [self._to_next(situation, limit) for limit in limits]
        # A straight track lies on the plan before the turn, but it is no turn.
        costs = [self._place(track, ahead)[1] if _comes_round(track) else np.inf for track in tracks]
        return limits[int(np.argmin(costs))]

    def _to_next(self, situation: Situation, limit: float) -> PredictedTrack:
        heading = self._heading(situation, self.plan.legs[self.leg + 1])
        return self._predicted(situation, heading, limit, self._arc(self.leg + 1)[1])

    def _place(self, track: PredictedTrack, ahead: np.ndarray) -> tuple[float | None, float]:
        """Which of some places ahead is the one where the next turn, begun there, stays nearest to the plan; None where it is the last.

        Beside it stands the mean squared distance from the plan then.
        """
        course = self.plan.legs[self.leg].course
        x, y, line = self._compared(track, self.leg + 1)
        off = distance_from(line, x + ahead[:, None] * np.cos(course), y + ahead[:, None] * np.sin(course))
        cost = (off**2).mean(axis=1)
        best = int(cost.argmin())
        place, least = float(ahead[best]), float(cost[best])
        if 0 < best < ahead.size - 1:
            # The smallest value of the parabola through three places.
            a, b, c = cost[best - 1 : best + 2]
            place += float(0.5 * (a - c) / (a - 2 * b + c) * (ahead[1] - ahead[0]))
            least -= float((a - c) ** 2 / (8 * (a - 2 * b + c)))
        return (None if best == ahead.size - 1 else place), least

    def _arc(self, leg: int) -> tuple[float, float]:
        """Angle of the turn onto a leg in rad, and the radius of its arc in m."""
        angle = unwrapped(self.plan.legs[leg].course, self.plan.legs[leg - 1].course) - self.plan.legs[leg - 1].course
        return abs(angle), 0.0 if self.plan.radii is None else float(self.plan.radii[leg])

    def _turn(self, situation: Situation, heading: float) -> tuple[float, PredictedTrack]:
        """The rudder limit with which the rest of the turn stays nearest to the plan."""
        shares, planned = np.array(_SHARES), self._limits.get(self.leg, self.rudder_limit)
        radius = self._arc(self.leg)[1]
        tracks = [self._predicted(situation, heading, float(s * planned), radius) for s in shares]
        cost = np.empty(shares.size)
        for k, track in enumerate(tracks):
            x, y, line = self._compared(track, self.leg, _NEXT)
            cost[k] = (distance_from(line, x, y) ** 2).mean()
        best = int(cost.argmin())
        share = shares[best]
        if 0 < best < shares.size - 1:
            fit = np.polyfit(shares[best - 1 : best + 2] - share, cost[best - 1 : best + 2], 2)
            share += -0.5 * fit[1] / fit[0]
        return float(share * planned), tracks[best]

    def _compared(
        self, track: PredictedTrack, leg: int, most: float = np.inf
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The points of a track, up to so many ship lengths, that are compared with the plan, and the part of the plan they lie at."""
        turned = np.abs(track.psi - track.psi[-1]) < _TURNED
        end = int(np.argmax(turned)) if turned.any() else track.s.size - 1
        last = int(np.searchsorted(track.s, min(track.s[end] / track.length + _BEYOND, most) * track.length))
        rows = slice(0, last + 1, _EVERY)
        x, y = track.x[rows], track.y[rows]
        reach = float(np.hypot(x - self.plan.legs[leg].x, y - self.plan.legs[leg].y).max()) + _REACH * track.length
        return x, y, self.plan.around(leg, reach)

    def _predicted(self, situation: Situation, heading: float, limit: float, radius: float) -> PredictedTrack:
        """A turn, to its end: a wide one takes a longer track."""
        arc = abs(heading - situation.values["psi"]) * radius / self.predictor.length
        horizon = float(np.ceil(max(HORIZON, _LONGER * arc + 2 * _BEYOND)))
        return self.predictor.predict(
            situation, heading=heading, rudder_limit=limit, horizon=horizon, points=int(_POINTS * horizon), band="none"
        )


def _comes_round(track: PredictedTrack) -> bool:
    """Whether a track ends near the heading that is ordered: a wind that she leans against keeps her off it."""
    assert track.order.heading is not None
    wanted = unwrapped(track.order.heading, float(track.psi[0]))
    return bool(abs(wanted - track.psi[-1]) < max(_TURNED, _ROUND * abs(wanted - track.psi[0])))
