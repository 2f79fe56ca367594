"""Drift of a turning circle over the ground: how far it is displaced each time the ship has turned through 360 deg."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from shipid.trials.signals.channel import Channel

_PAIRS = 40
_LEAST = np.radians(15.0)
"""Headings over which pairs of positions are compared, at the least."""


@dataclass(frozen=True)
class CircleDrift:
    """The drift of a circle.

    Attributes
    ----------
    north, east : float
        Velocity over the ground [m/s].
    scatter : float
        Root-mean-square deviation of the single pairs from it [m/s].
    through : float
        Heading change over which pairs were compared [rad].
    """

    north: float
    east: float
    scatter: float
    through: float

    @property
    def speed(self) -> float:
        """Speed of the drift [m/s]."""
        return float(np.hypot(self.north, self.east))

    @property
    def direction(self) -> float:
        """Direction it drifts to, clockwise from north, in [0, 2 pi) [rad]."""
        return float(np.arctan2(self.east, self.north) % (2 * pi))


def drift_of(x: Channel, y: Channel, t: np.ndarray, turned: np.ndarray) -> CircleDrift | None:
    """Return the drift of a circle that turns through more than 360 deg.

    Two positions at headings 360 deg apart would be one point in still water, once the turn is steady. Their distance over
    the time between is the drift (IMO MSC/Circ.1053, appendix: correction for the environment). The mean of pairs
    from 180 deg of heading change on is taken, from 90 deg on where the circle does not go far enough.

    Parameters
    ----------
    x, y : Channel
        Positions, north and east [m].
    t, turned : ndarray, shape (n,)
        Time [s] and heading change since the execute, positive into the turn [rad], while the rudder is over.

    Returns
    -------
    CircleDrift or None
        None where the circle does not turn through 450 deg and a little more, or positions are missing there.
    """
    rising = np.maximum.accumulate(turned)
    final = float(rising[-1])
    begin = pi if final >= 3 * pi + _LEAST else 0.5 * pi
    if final < begin + 2 * pi + _LEAST:
        return None
    at = np.linspace(begin, final - 2 * pi, _PAIRS)
    keep = np.concatenate(([True], np.diff(rising) > 0))
    one, two = np.interp(at, rising[keep], t[keep]), np.interp(at + 2 * pi, rising[keep], t[keep])
    good = np.array([not any(c.hole(when) for c in (x, y) for when in pair) for pair in zip(one, two)])
    if good.sum() < 0.5 * _PAIRS:
        return None
    one, two = one[good], two[good]
    north = (np.interp(two, x.t, x.y) - np.interp(one, x.t, x.y)) / (two - one)
    east = (np.interp(two, y.t, y.y) - np.interp(one, y.t, y.y)) / (two - one)
    scatter = float(np.sqrt(np.mean((north - north.mean()) ** 2 + (east - east.mean()) ** 2)))
    return CircleDrift(float(north.mean()), float(east.mean()), scatter, float(at[-1] - at[0]))
