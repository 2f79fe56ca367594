"""How dense the false plots of a sensor are, where a plot lies: learned from what no confirmed track explains."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

#: Scans that are remembered, and from how many on the map counts fully.
_SCANS, _FULL = 40, 20
#: Widths of the map, in standard deviations of a plot: returns of one buoy, of a shore.
_WIDTHS = (6.0, 20.0)
#: Weight of the newest scan in the mean number of false plots, and the number that is expected at first.
_NEWEST, _AT_FIRST = 0.1, 1.0


@dataclass
class ClutterMap:
    """The false plots of one sensor: a mean density over what it covers, and a map where they come again and again.

    Attributes
    ----------
    reach : float
        Largest distance of a plot from the sensor so far, m.
    count : float
        Mean number of false plots a scan.
    scans : list of tuple of ndarray
        Positions, widths and weights of the plots of the last scans.
    """

    reach: float = 1.0
    count: float = _AT_FIRST
    scans: list[tuple[np.ndarray, np.ndarray]] = field(default_factory=list)

    @property
    def area(self) -> float:
        """What the sensor covers, m^2."""
        return float(np.pi * self.reach**2)

    def cover(self, distances: np.ndarray) -> None:
        """Take note of how far the sensor sees.

        Parameters
        ----------
        distances : ndarray, shape (m,)
            Of plots from the sensor, m.
        """
        self.reach = max(self.reach, float(distances.max(initial=0.0)))

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

    def learn(self, z: np.ndarray, false: np.ndarray, unexplained: np.ndarray) -> None:
        """Remember the plots of a scan.

        Parameters
        ----------
        z : ndarray, shape (m, 2)
            Plots, m.
        false : ndarray, shape (m,)
            Probability that each belongs to no track.
        unexplained : ndarray, shape (m,)
            Probability that each belongs to no confirmed track.
        """
        self.count += _NEWEST * (float(false.sum()) + 0.5 - self.count)
        self.scans.append((z, unexplained))
        del self.scans[:-_SCANS]
