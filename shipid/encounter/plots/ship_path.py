"""Where a ship was: own ship beside the radar, or the truth that tracks are judged by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.encounter.errors import TargetError

#: The velocity of a ship is that of a straight line through so many seconds of her positions.
_SECONDS = 20.0


@dataclass(frozen=True, eq=False)
class ShipPath:
    """The positions of a ship.

    Attributes
    ----------
    name : str
        Of the ship.
    t : ndarray, shape (N,)
        Rising, s.
    x, y : ndarray, shape (N,)
        North and east, m.
    """

    name: str
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray

    def __post_init__(self) -> None:
        """Refuse what is no path."""
        finite = all(np.isfinite(a).all() for a in (self.t, self.x, self.y))
        if not self.t.size or not finite or not (np.diff(self.t) > 0).all():
            raise TargetError(f"the path of {self.name} needs finite positions at rising times.")

    def at(self, t: np.ndarray | float) -> np.ndarray:
        """Return the position at some times, shape (..., 2); before and after the path that of its end.

        Parameters
        ----------
        t : ndarray or float
            In s.
        """
        return np.stack([np.interp(t, self.t, self.x), np.interp(t, self.t, self.y)], axis=-1)

    def covers(self, t: np.ndarray | float) -> np.ndarray:
        """Return whether times lie within the path.

        Parameters
        ----------
        t : ndarray or float
            In s.
        """
        return np.asarray((np.asarray(t) >= self.t[0]) & (np.asarray(t) <= self.t[-1]))

    def motion(self, t: float) -> np.ndarray | None:
        """Return position and velocity at a time, shape (4,): a line through the last 20 s; None where there are not two.

        Parameters
        ----------
        t : float
            In s.
        """
        near = (self.t <= t) & (self.t >= t - _SECONDS)
        if near.sum() < 2 or not np.ptp(self.t[near]) > 0:
            return None
        since = self.t[near] - t
        lines = np.polyfit(since, np.stack([self.x[near], self.y[near]], axis=1), 1)
        return np.concatenate([lines[1], lines[0]])


def path_of(name: str, t: np.ndarray, x: np.ndarray, y: np.ndarray) -> ShipPath | None:
    """Return the path of positions in any order, some of them missing or twice; None where none is left.

    Parameters
    ----------
    name : str
        Of the ship.
    t, x, y : ndarray, shape (N,)
        Times in s and positions in m.
    """
    known = np.isfinite(t) & np.isfinite(x) & np.isfinite(y)
    times, first = np.unique(t[known], return_index=True)
    # Names from the air hold characters that no page can show.
    shown = "".join(letter if letter.isprintable() else "?" for letter in name)
    return ShipPath(shown, times, x[known][first], y[known][first]) if times.size else None
