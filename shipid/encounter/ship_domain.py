"""The ship domain: the area about a ship that others should stay out of, as an ellipse that moves and turns with her."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.encounter.closest_approach import nearest_distance
from shipid.encounter.errors import EncounterRequestError


@dataclass(frozen=True)
class ShipDomain:
    """An ellipse along the ship's course; a circle where both half axes are equal.

    Attributes
    ----------
    along, across : float
        Half axes in m, along the course and across it.
    ahead, starboard : float
        Where its centre lies from the ship, m.
    """

    along: float
    across: float
    ahead: float = 0.0
    starboard: float = 0.0

    def __post_init__(self) -> None:
        if not (self.along > 0 and self.across > 0):
            raise EncounterRequestError(f"a ship domain of {self.along:g} m by {self.across:g} m has no area.")

    def nearest(self, relative: np.ndarray, course: np.ndarray, horizon: float | np.ndarray) -> np.ndarray:
        """Return how near a point comes to the domain while both keep course and speed.

        Parameters
        ----------
        relative : ndarray, shape (..., 4)
            Position and velocity of the ship that has the domain, relative to the other one; north and east, m and m/s.
        course : ndarray, shape (...)
            Course of the ship that has it, rad.
        horizon : float or ndarray, shape (...)
            s.

        Returns
        -------
        ndarray, shape (...)
            Smallest distance in shares of the domain: below 1 the other one is inside.
        """
        cos, sin = np.cos(course), np.sin(course)
        forward = np.stack([cos, sin], axis=-1)
        right = np.stack([-sin, cos], axis=-1)
        scaled = []
        for first, moved in ((0, True), (2, False)):
            part = relative[..., first : first + 2]
            ahead, aside = np.sum(part * forward, axis=-1), np.sum(part * right, axis=-1)
            if moved:
                ahead, aside = ahead + self.ahead, aside + self.starboard
            scaled += [ahead / self.along, aside / self.across]
        return nearest_distance(np.stack(scaled, axis=-1), horizon)


def circle(radius: float) -> ShipDomain:
    """Return a round domain about the ship.

    Parameters
    ----------
    radius : float
        m.
    """
    return ShipDomain(radius, radius)
