"""A planned track over the ground: legs, and the turns that join them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.prediction.following.wheel_over import TrackLeg

#: Angle between two points of an arc in rad.
_STEP = np.deg2rad(2.0)


@dataclass(frozen=True, eq=False)
class PlannedTrack:
    """Legs, and the line over the ground that joins them.

    Attributes
    ----------
    legs : tuple of TrackLeg
        Each from its waypoint on.
    line : ndarray, shape (N, 2)
        Points of the whole track to the north and to the east in m, its turns included.
    """

    legs: tuple[TrackLeg, ...]
    line: np.ndarray

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


def planned_track(points: Sequence[tuple[float, float]] | np.ndarray, radius: float | Sequence[float]) -> PlannedTrack:
    """Return the track through waypoints, its turns on arcs.

    Parameters
    ----------
    points : sequence of (float, float)
        Waypoints to the north and to the east in m; two at least.
    radius : float or sequence of float
        Radius of the turns in m: one for all, or one for each waypoint between the first and the last.

    Returns
    -------
    PlannedTrack

    Raises
    ------
    UsageError
        If there are fewer than two waypoints, two fall on one place, or an arc does not fit between its neighbours.
    """
    at = np.asarray(points, dtype=float)
    if at.ndim != 2 or at.shape[1] != 2 or len(at) < 2 or not np.isfinite(at).all():
        raise UsageError("a planned track goes through two waypoints at least, each to the north and to the east in m.")
    away = np.diff(at, axis=0)
    lengths = np.hypot(away[:, 0], away[:, 1])
    if not (lengths > 0).all():
        raise UsageError(f"waypoints {int(np.argmin(lengths)) + 1} and {int(np.argmin(lengths)) + 2} are one place.")
    courses = np.arctan2(away[:, 1], away[:, 0])
    legs = tuple(TrackLeg(float(x), float(y), float(c)) for (x, y), c in zip(at[:-1], courses))
    turns = (np.diff(courses) + np.pi) % (2 * np.pi) - np.pi
    radii = np.broadcast_to(np.asarray(radius, dtype=float), turns.shape)
    before = radii * np.tan(np.abs(turns) / 2)
    taken = np.concatenate([[0.0], before]) + np.concatenate([before, [0.0]])
    if (taken > lengths + 1e-9).any():
        k = int(np.argmax(taken - lengths))
        raise UsageError(
            f"the turns at both ends of leg {k + 1} take {taken[k]:.4g} m, and it is {lengths[k]:.4g} m long: take smaller radii."
        )
    line = [at[:1]]
    for k, (turn, size) in enumerate(zip(turns, radii)):
        line.append(_arc(at[k + 1], courses[k], turn, size))
    return PlannedTrack(legs, np.concatenate([*line, at[-1:]]))


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
