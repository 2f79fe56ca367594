"""Where a ship was: own ship beside the radar, or the truth that tracks are judged by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from shipid.encounter.errors import TargetError
from shipid.foundation.notices import Notice

#: The velocity of a ship is that of a straight line through so many seconds of her positions.
_SECONDS = 20.0
#: How far before and after its path a ship is carried on, s.
CARRIED = 5.0
#: A gap is so many of the usual intervals long, and longer than a velocity takes.
_INTERVALS = 5.0
#: No ship sails faster, m/s; and no receiver errs by more for a moment, m.
FASTEST, STRAY = 50.0, 500.0


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
        """Return the position at some times, shape (..., 2): before and after the path, carried on for a few seconds and no farther.

        Parameters
        ----------
        t : ndarray or float
            In s.
        """
        inside = np.stack([np.interp(t, self.t, self.x), np.interp(t, self.t, self.y)], axis=-1)
        early, late = np.clip(t - self.t[0], -CARRIED, 0.0), np.clip(t - self.t[-1], 0.0, CARRIED)
        first, last = self._ends
        return np.asarray(inside + np.multiply.outer(early, first) + np.multiply.outer(late, last))

    @cached_property
    def _ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Velocity where the path begins and where it ends, m/s; zero where it tells none."""
        ends = self.motion(min(float(self.t[0]) + _SECONDS, float(self.t[-1]))), self.motion(float(self.t[-1]))
        first, last = (np.zeros(2) if v is None else v[2:] for v in ends)
        return first, last

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


def path_doubts(path: ShipPath, counted_from: bool) -> list[Notice]:
    """Return what own ship's path leaves open: where it has gaps, and where it jumps.

    Parameters
    ----------
    path : ShipPath
        Hers, on the clock of the plots.
    counted_from : bool
        Whether plots are ranges and bearings from her.
    """
    if path.t.size < 2:
        return []
    steps, away = np.diff(path.t), np.hypot(np.diff(path.x), np.diff(path.y))
    gaps = np.flatnonzero(steps > max(_INTERVALS * float(np.median(steps)), _SECONDS))
    jumps = np.flatnonzero((away > STRAY) & (away > FASTEST * steps))
    told = []
    if gaps.size:
        k = gaps[steps[gaps].argmax()]
        more = f", and in {gaps.size - 1} more gap{'s' * (gaps.size > 2)}" if gaps.size > 1 else ""
        cost = ", and where she did not, the plots that count from her lie wrong" if counted_from else ""
        told.append(
            Notice(
                f"own ship's path has no positions from {path.t[k]:.0f} to {path.t[k + 1]:.0f} s{more}: she is taken to sail straight and "
                f"steadily there{cost}. Give a path without gaps.",
                "own-ship-gap",
                serious=counted_from,
                count=int(gaps.size),
            )
        )
    if jumps.size:
        k = jumps[away[jumps].argmax()]
        told.append(
            Notice(
                f"own ship's path jumps {jumps.size} time{'s' * (jumps.size > 1)}, by {away[k]:.0f} m at {path.t[k + 1]:.0f} s: wrong "
                "positions, or another ship's. Take them out.",
                "own-ship-jumps",
                serious=True,
                count=int(jumps.size),
            )
        )
    return told


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
