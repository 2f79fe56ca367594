"""The outline of a ship on a plan."""

from __future__ import annotations

import numpy as np

#: Stem, shoulders, stern, in lengths; her breadth is a seventh of her length.
_HULL = np.array([[0.5, 0.0], [0.25, 0.07], [-0.5, 0.07], [-0.5, -0.07], [0.25, -0.07], [0.5, 0.0]])


def outline(length: float, heading: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the outline of a ship about her midship point, along the axis of heading zero and across it to starboard [m].

    Parameters
    ----------
    length : float
        Ship length in m.
    heading : float
        In rad, clockwise.
    """
    along, across = length * _HULL.T
    c, s = np.cos(heading), np.sin(heading)
    return c * along - s * across, s * along + c * across
