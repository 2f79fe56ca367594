"""A planned track over the ground: legs, and the turns that join them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result
from shipid.prediction.following.wheel_over import TrackLeg

#: Angle between two points of an arc in rad; a turn beyond the second is not rounded by an arc.
_STEP, _BACK = np.deg2rad(2.0), np.deg2rad(175.0)
#: Distances from a line that are worked out at once.
_AT_ONCE = 1_000_000


@dataclass(frozen=True, eq=False, repr=False)
class PlannedTrack(Result):
    """Legs, and the line over the ground that joins them.

    Attributes
    ----------
    legs : tuple of TrackLeg
        Each from its waypoint on.
    line : ndarray, shape (N, 2)
        Points of the whole track to the north and to the east in m, its turns included.
    radii : ndarray or None, shape (legs,)
        Radius of the turn onto each leg in m, 0 for the first; None where the line was drawn in another way.
    limits : ndarray or None, shape (legs, 2)
        Cross-track limits of each leg in m, to port and to starboard; infinite where there is none.
    waypoints : tuple of int
        Number of the route's waypoint that each leg leads to, from 0: a leg that is no straight line in the plane is cut into several.
    arcs : ndarray or None, shape (legs, 2)
        First and last point, in `line`, of the turn onto each leg.
    """

    TABLE: ClassVar[str] = "legs"
    UNITS: ClassVar[Mapping[str, str]] = {"line": "m", "radii": "m", "limits": "m", "arcs": ""}

    legs: tuple[TrackLeg, ...]
    line: np.ndarray
    radii: np.ndarray | None = None
    limits: np.ndarray | None = None
    waypoints: tuple[int, ...] = ()
    arcs: np.ndarray | None = None

    @property
    def end(self) -> float:
        """Length of the last leg in m."""
        return float(self.legs[-1].along(self.line[-1, 0], self.line[-1, 1]))

    def around(self, leg: int, reach: float) -> np.ndarray:
        """Return the part of the line within a distance of the waypoint at which a leg begins, shape (M, 2).

        Parameters
        ----------
        leg : int
            Number of the leg.
        reach : float
            In m.
        """
        at = self.legs[leg]
        near = np.flatnonzero(np.hypot(self.line[:, 0] - at.x, self.line[:, 1] - at.y) <= reach)
        if near.size < 2:
            return self.line
        return self.line[max(near[0] - 1, 0) : near[-1] + 2]

    def off_track(
        self, x: np.ndarray | float, y: np.ndarray | float, leg: int | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return how far points are off the track, and the leg they are nearest to.

        Parameters
        ----------
        x, y : ndarray or float, shape (N,)
            To the north and to the east in m.
        leg : int, optional
            The leg that is sailed, or turned to: only the track beside it counts, where a track crosses itself, and past the end of the
            track the last leg goes on. All of it by default.

        Returns
        -------
        distance : ndarray, shape (N,)
            In m, positive to starboard of the track.
        leg : ndarray of int, shape (N,)
            The leg of the nearest point; the first half of a turn belongs to the leg before.
        """
        first, last = 0, len(self.line) - 1
        if leg is not None and self.arcs is not None:
            first = int(self.arcs[max(leg - 1, 0), 0])
            last = int(self.arcs[leg + 1, 1]) if leg + 1 < len(self.legs) else last
        x, y = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
        line = self.line[first : last + 1]
        rows = max(1, _AT_ONCE // len(line))
        on = leg is not None and last + 1 == len(self.line)
        parts = [_off(line, x[k : k + rows], y[k : k + rows], on) for k in range(0, len(x), rows)]
        distance = np.concatenate([d for d, _ in parts]) if parts else np.zeros(0)
        at = first + (np.concatenate([n for _, n in parts]) if parts else np.zeros(0, dtype=int))
        if self.arcs is None:
            return distance, np.full(at.shape, -1 if leg is None else leg)
        return distance, np.searchsorted(self.arcs[1:].mean(axis=1), at + 0.5)

    def beyond_limits(self, distance: np.ndarray, leg: np.ndarray) -> np.ndarray:
        """Return how far points are beyond the cross-track limits in m; zero or less where they are within.

        Parameters
        ----------
        distance : ndarray, shape (N,)
            Off the track in m, positive to starboard.
        leg : ndarray of int, shape (N,)
            The leg of each.
        """
        if self.limits is None:
            return np.full(distance.shape, -np.inf)
        port, starboard = self.limits[leg].T
        return np.asarray(np.maximum(distance - starboard, -distance - port))


def _off(line: np.ndarray, x: np.ndarray, y: np.ndarray, goes_on: bool) -> tuple[np.ndarray, np.ndarray]:
    """Distance of points from a line, positive to starboard of it, and the number of the nearest piece; the last may go on past its end."""
    along = np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    north, east = x[:, None] - line[:-1, 0], y[:, None] - line[:-1, 1]
    ends = np.ones(len(along))
    ends[-1] = np.inf if goes_on else 1.0
    share = np.clip((north * along[:, 0] + east * along[:, 1]) / square, 0.0, ends)
    away = np.hypot(north - share * along[:, 0], east - share * along[:, 1])
    at = away.argmin(axis=1)
    rows = np.arange(len(x))
    cross = east[rows, at] * along[at, 0] - north[rows, at] * along[at, 1]
    return np.where(cross < 0, -1.0, 1.0) * away[rows, at], at


def distance_from(line: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the distance of points from a line of points in m, in the shape of the points.

    Parameters
    ----------
    line : ndarray, shape (N, 2)
        To the north and to the east in m.
    x, y : ndarray
        Of one shape, in m.
    """
    points = np.stack([np.asarray(x, dtype=float), np.asarray(y, dtype=float)], axis=-1)
    begin, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    away = points[..., None, :] - begin
    share = np.clip((away * along).sum(axis=-1) / square, 0.0, 1.0)
    return np.asarray(np.sqrt(((away - share[..., None] * along) ** 2).sum(axis=-1).min(axis=-1)))


def planned_track(
    points: Sequence[tuple[float, float]] | np.ndarray,
    radius: float | Sequence[float] | np.ndarray,
    names: Sequence[str] = (),
) -> PlannedTrack:
    """Return the track through waypoints, its turns on arcs.

    Parameters
    ----------
    points : sequence of (float, float)
        Waypoints to the north and to the east in m; two at least.
    radius : float or sequence of float
        Radius of the turns in m: one for all, or one for each waypoint between the first and the last.
    names : sequence of str
        What the waypoints are called in messages; their numbers by default.

    Returns
    -------
    PlannedTrack

    Raises
    ------
    UsageError
        If there are fewer than two waypoints, two fall on one place, an arc does not fit between its neighbours, or a leg turns back
        on the one before.
    """
    at = np.asarray(points, dtype=float)
    if at.ndim != 2 or at.shape[1] != 2 or len(at) < 2 or not np.isfinite(at).all():
        raise UsageError("a planned track goes through two waypoints at least, each to the north and to the east in m.")
    away = np.diff(at, axis=0)
    lengths = np.hypot(away[:, 0], away[:, 1])
    called = list(names) or [f"waypoint {k + 1}" for k in range(len(at))]
    if not (lengths > 0).all():
        k = int(np.argmin(lengths))
        raise UsageError(f"{called[k]} and {called[k + 1]} are one place.")
    courses = np.arctan2(away[:, 1], away[:, 0])
    legs = tuple(TrackLeg(float(x), float(y), float(c)) for (x, y), c in zip(at[:-1], courses))
    turns = (np.diff(courses) + np.pi) % (2 * np.pi) - np.pi
    radii = np.broadcast_to(np.asarray(radius, dtype=float), turns.shape)
    back = np.flatnonzero(np.abs(turns) > _BACK)
    if back.size:
        k = int(back[0]) + 1
        raise UsageError(
            f"the leg from {called[k]} turns back by {np.rad2deg(abs(turns[k - 1])):.0f} deg on the one that leads there, and no arc "
            "rounds that: put a waypoint beside it."
        )
    before = radii * np.tan(np.abs(turns) / 2)
    taken = np.concatenate([[0.0], before]) + np.concatenate([before, [0.0]])
    if (taken > lengths + 1e-9).any():
        k = int(np.argmax(taken - lengths))
        raise UsageError(
            f"the turns at both ends of the leg from {called[k]} to {called[k + 1]} take {brief(taken[k], 4)} m, and it is {brief(lengths[k], 4)} m "
            "long: state smaller turn radii in the route, or leave a waypoint out."
        )
    turned = [_arc(at[k + 1], courses[k], turn, size) for k, (turn, size) in enumerate(zip(turns, radii))]
    ends = np.cumsum([1, *(len(arc) for arc in turned)])
    arcs = np.stack([np.append(0, ends[:-1]), ends - 1], axis=1)
    return PlannedTrack(
        legs,
        np.concatenate([at[:1], *turned, at[-1:]]),
        np.concatenate([[0.0], radii]),
        None,
        tuple(range(1, len(at))),
        arcs,
    )


def _arc(corner: np.ndarray, course: float, turn: float, radius: float) -> np.ndarray:
    """Points of the arc that rounds a corner."""
    side = np.sign(turn)
    ahead = np.array([np.cos(course), np.sin(course)])
    across = side * np.array([-np.sin(course), np.cos(course)])
    begin = corner - radius * np.tan(abs(turn) / 2) * ahead
    angles = np.linspace(0.0, abs(turn), max(2, int(np.ceil(abs(turn) / _STEP)) + 1))
    return np.asarray(
        begin + radius * np.sin(angles)[:, None] * ahead + radius * (1 - np.cos(angles))[:, None] * across
    )
