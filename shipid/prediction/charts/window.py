"""Lines and rings of latitude and longitude, cut to a window about an origin, in local metres and simplified."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.trials.logs.geodesy import SEMI_MAJOR, to_local

#: Least share of the equator that a parallel is taken for: near a pole a window has every longitude.
_LEAST_COSINE = 0.02
_WHOLE = 2 * np.pi - 1e-9


class ChartWindow:
    """A window about an origin.

    Parameters
    ----------
    origin : tuple of float
        Latitude and longitude in rad.
    reach : float
        From its middle to its sides in m.
    """

    def __init__(self, origin: tuple[float, float], reach: float) -> None:
        self.origin = origin
        tall = reach / SEMI_MAJOR
        wide = min(tall / max(np.cos(abs(origin[0]) + tall), _LEAST_COSINE), 0.45 * np.pi)
        #: Half planes: the axis of a point (longitude from the origin, latitude), the side, and the bound.
        self._edges = ((0, 1.0, wide), (0, -1.0, wide), (1, 1.0, origin[0] + tall), (1, -1.0, tall - origin[0]))

    def polygons(self, parts: Sequence[np.ndarray]) -> list[tuple[np.ndarray, ...]]:
        """Return what of a polygon lies in the window, in local metres.

        Parameters
        ----------
        parts : sequence of ndarray, shape (N, 2)
            Longitude and latitude in rad of its outer ring and of its holes; closed or not.

        Returns
        -------
        list of tuples of ndarray, shape (M, 2)
            To the north and to the east in m, open: two polygons where one that goes round the earth has its edge in the window.
        """
        found = []
        for outer in self._about(parts[0]):
            ring = self._cut(outer)
            if len(ring) > 2:
                west, east = outer[:, 0].min(), outer[:, 0].max()
                # A hole belongs to the polygon of the same turn about the earth.
                holes = (h for part in parts[1:] for h in self._about(part) if west <= h[:, 0].mean() <= east)
                found.append((self._local(ring), *(self._local(h) for h in map(self._cut, holes) if len(h) > 2)))
        return found

    def _cut(self, shifted: np.ndarray) -> np.ndarray:
        """A ring, open, cut to the window."""
        ring = shifted[:-1] if len(shifted) > 1 and np.array_equal(shifted[0], shifted[-1]) else shifted
        for edge in self._edges:
            ring = cut_ring(ring, *edge)
        return ring

    def lines(self, points: np.ndarray) -> list[np.ndarray]:
        """Return the stretches of a line that lie in the window, in local metres.

        Parameters
        ----------
        points : ndarray, shape (N, 2)
            Longitude and latitude in rad.

        Returns
        -------
        list of ndarray, shape (M, 2)
            To the north and to the east in m.
        """
        found = []
        for line in self._about(points):
            for edge in self._edges:
                line = cut_line(line, *edge)
            gaps = np.flatnonzero(np.isnan(line[:, 0]))
            parts = [part[~np.isnan(part[:, 0])] for part in np.split(line, gaps)]
            found += [self._local(part) for part in parts if len(part) > 1]
        return found

    def point(self, points: np.ndarray) -> np.ndarray:
        """Return the points that lie in the window, in local metres, shape (M, 2).

        Parameters
        ----------
        points : ndarray, shape (N, 2)
            Longitude and latitude in rad.
        """
        east = np.remainder(points[:, 0] - self.origin[1] + np.pi, 2 * np.pi) - np.pi
        at = np.stack([east, points[:, 1]], axis=1)
        inside = np.all([side * at[:, axis] <= bound for axis, side, bound in self._edges], axis=0)
        return self._local(at[inside])

    def _about(self, points: np.ndarray) -> list[np.ndarray]:
        """Longitudes from the origin without a jump, shifted by whole turns to where they may reach into the window."""
        east = points[:, 0] - self.origin[1]
        steps = np.diff(east)
        # A step beyond half a turn crosses the dateline; one of a whole turn is the edge of a map of the world.
        jump = (np.abs(steps) > np.pi) & (np.abs(steps) < _WHOLE)
        east[1:] -= 2 * np.pi * np.cumsum(np.where(jump, np.sign(steps), 0.0))
        east -= 2 * np.pi * np.round(east[0] / (2 * np.pi)) if len(east) else 0.0
        wide = self._edges[0][2]
        turns = [k * 2 * np.pi for k in (-1, 0, 1)]
        return [
            np.stack([east + k, points[:, 1]], axis=1)
            for k in turns
            if len(east) and (east + k).min() <= wide and (east + k).max() >= -wide
        ]

    def _local(self, at: np.ndarray) -> np.ndarray:
        return np.stack(to_local(at[:, 1], at[:, 0] + self.origin[1], self.origin), axis=1)


def _crossings(at: np.ndarray, after: np.ndarray, axis: int, side: float, bound: float) -> tuple[np.ndarray, ...]:
    """Which points are inside, which steps cross the edge, and where."""
    before, behind = bound - side * at[:, axis], bound - side * after[:, axis]
    crossing = (before >= 0) != (behind >= 0)
    share = before[crossing] / (before[crossing] - behind[crossing])
    return before >= 0, crossing, at[crossing] + share[:, None] * (after[crossing] - at[crossing])


def cut_ring(ring: np.ndarray, axis: int, side: float, bound: float) -> np.ndarray:
    """Return the part of a ring on one side of an edge (Sutherland and Hodgman 1974).

    Parameters
    ----------
    ring : ndarray, shape (N, 2)
        Its points, open.
    axis : {0, 1}
        Which coordinate the edge bounds.
    side, bound : float
        What is kept has side times the coordinate at most at the bound.
    """
    if not len(ring):
        return ring
    inside, crossing, where = _crossings(ring, np.roll(ring, -1, axis=0), axis, side, bound)
    return _woven(ring, inside, crossing, where)


def cut_line(line: np.ndarray, axis: int, side: float, bound: float) -> np.ndarray:
    """Return the part of a line on one side of an edge; NaN where it has a gap.

    Parameters
    ----------
    line : ndarray, shape (N, 2)
        Its points.
    axis, side, bound
        See `cut_ring`.
    """
    if len(line) < 2:
        return line
    inside, crossing, where = _crossings(line[:-1], line[1:], axis, side, bound)
    kept = np.append(inside, bound - side * line[-1, axis] >= 0)
    gone = np.where(kept[:, None] | np.isnan(line), line, np.nan)
    return _woven(gone, np.ones(len(line), dtype=bool), np.append(crossing, False), where)


def _woven(points: np.ndarray, kept: np.ndarray, crossing: np.ndarray, where: np.ndarray) -> np.ndarray:
    """The points that are kept, and behind each that is followed by a crossing the place of it."""
    order = np.concatenate([np.flatnonzero(kept), np.flatnonzero(crossing) + 0.5])
    return np.asarray(np.concatenate([points[kept], where])[np.argsort(order)])


def simplified(line: np.ndarray, tolerance: float) -> np.ndarray:
    """Return a line without the points that lie in one square of a grid with the point before; its ends stay.

    Parameters
    ----------
    line : ndarray, shape (N, 2)
        In m.
    tolerance : float
        Side of a square in m.
    """
    if len(line) < 3:
        return line
    cells = np.round(line / tolerance)
    kept = np.append(True, np.any(np.diff(cells, axis=0) != 0, axis=1))
    kept[-1] = True
    return np.asarray(line[kept])
