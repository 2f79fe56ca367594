"""What the columns of a table of plots can hardly mean, and times of day that go on over midnight."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.foundation.notices import Notice

#: Seconds of a day.
DAY = 86400.0
#: How far a time of day jumps back at least where midnight has passed, s; turns that no bearing counts.
_MOST_OF_DAY, _TURNS = 43200.0, 2.5


def doubts(t: np.ndarray, columns: Mapping[str, np.ndarray]) -> list[Notice]:
    """Return what was put right, and what the columns can hardly mean.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times as the log has them, s.
    columns : mapping of str to ndarray
        The other columns, SI.
    """
    found = []
    if midnights(t).any():
        found.append(Notice("the clock passes midnight.", "clock-midnight"))
    bearings = columns.get("bearing", np.zeros(0))
    most = float(np.abs(bearings[np.isfinite(bearings)]).max(initial=0.0)) / (2 * np.pi)
    if most > _TURNS:
        found.append(
            Notice(
                f"bearings reach {most:.0f} turns: their column says rad, and may hold degrees.",
                "bearing-unit",
                serious=True,
            )
        )
    return found


def midnights(t: np.ndarray) -> np.ndarray:
    """Return how many midnights have passed at each time of day, shape (N,); none where the times are no times of day.

    Parameters
    ----------
    t : ndarray, shape (N,)
        In the order of the log, s.
    """
    known = np.flatnonzero(np.isfinite(t))
    days = np.zeros(t.size)
    if known.size and t[known].min() >= 0 and t[known].max() <= DAY:
        days[known[1:]] = np.cumsum(np.diff(t[known]) < -_MOST_OF_DAY)
    return days
