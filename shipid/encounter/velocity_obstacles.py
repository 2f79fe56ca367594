"""Choosing a velocity that keeps out of the domains of other ships, by velocity obstacles (Fiorini and Shiller, 1998)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.ship_domain import ShipDomain


@dataclass(frozen=True)
class VelocityPlanner:
    """What a craft may choose from, and how far it looks ahead.

    Attributes
    ----------
    domain : ShipDomain
        Of every other ship.
    full_speed : float
        m/s.
    headings : int
        How many headings, evenly over `widest` to both sides of the present one.
    widest : float
        Largest change of heading in one decision, rad.
    speeds : int
        How many speeds, evenly from a share of full speed up to it.
    horizon : float
        How far ahead the others are looked at, s; not beyond the time to the goal.
    """

    domain: ShipDomain
    full_speed: float
    headings: int = 41
    widest: float = np.deg2rad(40.0)
    speeds: int = 6
    horizon: float = 150.0

    def __post_init__(self) -> None:
        if not (
            self.full_speed > 0 and self.headings > 0 and self.speeds > 0 and self.horizon > 0 and self.widest >= 0
        ):
            raise EncounterRequestError("a planner needs a full speed, headings, speeds and a horizon above zero.")

    def choose(
        self, position: np.ndarray, heading: np.ndarray, goal: np.ndarray, others: np.ndarray, delay: float = 0.0
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the velocity nearest to full speed towards the goal among those that keep out of all domains.

        Where none does, the one that keeps the largest distance, in shares of the domain.

        Parameters
        ----------
        position : ndarray, shape (..., 2)
            Own position, north and east, m.
        heading : ndarray, shape (...)
            Own heading, rad.
        goal : ndarray, shape (..., 2)
            Where to go, m.
        others : ndarray, shape (..., n, 4)
            Positions and velocities of the others as they are known, m and m/s.
        delay : float
            Time in s after which distances count: of a craft inside a domain, those from which it has begun to leave.

        Returns
        -------
        heading, speed : ndarray, shape (...)
            rad and m/s.
        clear : ndarray of bool, shape (...)
            Whether it keeps out of all domains.
        """
        turn = np.linspace(-self.widest, self.widest, self.headings) if self.headings > 1 else np.zeros(1)
        share = np.linspace(1 / self.speeds, 1.0, self.speeds)
        headings = heading[..., None, None] + turn[:, None] + 0 * share
        speeds = self.full_speed * share + 0 * headings
        headings, speeds = (a.reshape(*heading.shape, -1) for a in (headings, speeds))
        velocity = np.stack([speeds * np.cos(headings), speeds * np.sin(headings)], axis=-1)
        way = goal - position
        wanted = self.full_speed * way / np.maximum(np.hypot(way[..., 0], way[..., 1]), 1e-9)[..., None]
        cost = np.sum((velocity - wanted[..., None, :]) ** 2, axis=-1)
        # What lies behind the goal does not count: there the way ends.
        ahead = np.minimum(self.horizon, np.hypot(way[..., 0], way[..., 1])[..., None] / speeds)
        worst = np.min(self._nearest(position, velocity, others, delay, ahead), axis=-1, initial=np.inf)
        clear = worst >= 1
        # A share of a domain costs nothing among clear velocities, and everything among the others.
        best = np.argmin(np.where(clear, cost, np.where(clear.any(axis=-1, keepdims=True), np.inf, -worst)), axis=-1)
        pick = best[..., None]
        return (
            np.take_along_axis(headings, pick, axis=-1)[..., 0],
            np.take_along_axis(speeds, pick, axis=-1)[..., 0],
            np.take_along_axis(clear, pick, axis=-1)[..., 0],
        )

    def _nearest(
        self, position: np.ndarray, velocity: np.ndarray, others: np.ndarray, delay: float, ahead: np.ndarray
    ) -> np.ndarray:
        """How near each candidate comes to each domain, shape (..., candidates, n)."""
        apart = others[..., None, :, :2] - position[..., None, None, :]
        moving = others[..., None, :, 2:] - velocity[..., :, None, :]
        relative = np.concatenate([apart + delay * moving, moving], axis=-1)
        course = np.arctan2(others[..., None, :, 3], others[..., None, :, 2])
        return self.domain.nearest(relative, np.broadcast_to(course, relative.shape[:-1]), ahead[..., None])
