"""How dense the false plots of a sensor are, where a plot lies: learned from what no track explains."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

#: Scans that are remembered, and from how many on the map counts fully.
_SCANS, _FULL = 40, 20
#: Widths of the map, in standard deviations of a plot: returns of one buoy, of a shore.
_WIDTHS = (6.0, 20.0)
#: Weight of the newest scan in the mean number of false plots, the number that is expected at first, and the
#: fewest: none at all is never sure.
_NEWEST, _AT_FIRST, _FEWEST = 0.1, 1.0, 0.1
#: The smallest reach of a sensor whose place is not known, in standard deviations of a plot.
_LEAST = 100.0
#: The edge of what a sensor covers begins at this share of its reach; with false plots there in this share of the scans, it may cut
#: something off.
_EDGE, _CUT = 0.85, 0.5


@dataclass
class ClutterMap:
    """The false plots of one sensor: a mean density over what it covers, and a map where they come again and again.

    Attributes
    ----------
    reach : float
        Largest distance of a plot from the sensor so far, m.
    count : float
        Mean number of false plots a scan.
    low, high : ndarray, shape (2,)
        Corners of the box that holds all plots, where the place of the sensor is not known.
    scans : list of tuple of ndarray
        Positions and weights of the plots of the last scans.
    at_edge : float
        Share of the scans with a false plot at the edge of what the sensor covers.
    """

    reach: float = 1.0
    count: float = _AT_FIRST
    low: np.ndarray = field(default_factory=lambda: np.full(2, np.inf))
    high: np.ndarray = field(default_factory=lambda: np.full(2, -np.inf))
    scans: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)
    at_edge: float = 0.0

    @property
    def area(self) -> float:
        """What the sensor covers, m^2."""
        return float(np.pi * self.reach**2)

    def cover(self, z: np.ndarray, own: np.ndarray, width: np.ndarray) -> None:
        """Take note of how far the sensor sees.

        Parameters
        ----------
        z : ndarray, shape (m, 2)
            Plots, m.
        own : ndarray, shape (2,)
            Where the sensor is; NaN where that is not known. Then what it covers is a circle around the plots.
        width : ndarray, shape (m,)
            Standard deviations of the plots, m.
        """
        if not len(z):
            return
        if np.isfinite(own).all():
            self.reach = max(self.reach, float(np.hypot(*(z - own).T).max()))
            return
        self.low, self.high = np.minimum(self.low, z.min(axis=0)), np.maximum(self.high, z.max(axis=0))
        self.reach = max(0.5 * float(np.hypot(*(self.high - self.low))), _LEAST * float(width.max()))

    def density(self, z: np.ndarray, width: np.ndarray) -> np.ndarray:
        """Return the density of false plots where plots lie, shape (m,), 1/m^2.

        Parameters
        ----------
        z : ndarray, shape (m, 2)
            Plots, m.
        width : ndarray, shape (m,)
            Their standard deviations, m.
        """
        everywhere = np.full(len(z), self.count / self.area)
        if not self.scans or not len(z):
            return everywhere
        past, weight = (np.concatenate(parts) for parts in zip(*self.scans))
        away = ((z[:, None] - past) ** 2).sum(axis=-1)
        scans = max(len(self.scans), _FULL)
        here = np.zeros(len(z))
        for wide in _WIDTHS:
            h = (wide * width)[:, None] ** 2
            here = np.maximum(here, (weight * np.exp(-away / (2 * h)) / (2 * np.pi * h)).sum(axis=1) / scans)
        return everywhere + here

    def cut_off(self, x: np.ndarray, own: np.ndarray) -> np.ndarray:
        """Return where something may be a shore that the range of the sensor cuts off, shape (n,).

        Where the edge crosses a shore, the echo lies at one range, and moves along the shore as the sensor does: it looks like a ship
        that sails around own ship. A ship is sooner or later inside of the edge.

        Parameters
        ----------
        x : ndarray, shape (n, 2)
            Positions, m.
        own : ndarray, shape (2,)
            Where the sensor is; NaN where that is not known. Then nothing is cut off.
        """
        return self._beyond(x, own) & (self.at_edge > _CUT)

    def _beyond(self, x: np.ndarray, own: np.ndarray) -> np.ndarray:
        return np.asarray(np.hypot(*(x - own).T) > _EDGE * self.reach)

    def learn(self, z: np.ndarray, own: np.ndarray, false: np.ndarray, unexplained: np.ndarray) -> None:
        """Remember the plots of a scan.

        Parameters
        ----------
        z : ndarray, shape (m, 2)
            Plots, m.
        own : ndarray, shape (2,)
            Where the sensor is; NaN where that is not known.
        false : ndarray, shape (m,)
            Probability that each belongs to no track.
        unexplained : ndarray, shape (m,)
            Probability that each belongs to no track that is nearly sure.
        """
        self.count += _NEWEST * (float(false.sum()) + _FEWEST - self.count)
        self.at_edge += _NEWEST * (float(unexplained[self._beyond(z, own)].max(initial=0.0)) - self.at_edge)
        self.scans.append((z, unexplained))
        del self.scans[:-_SCANS]
