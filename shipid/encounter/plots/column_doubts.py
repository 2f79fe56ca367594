"""What the columns of a log of plots can hardly mean: times far from all others, bearings in degrees; times of day go on over midnight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from shipid.encounter.plots.raw_plots import RawPlots
from shipid.foundation.notices import Notice

#: Seconds of a day.
DAY = 86400.0
#: How far a time of day jumps back at least where midnight has passed, s; turns that no bearing counts.
_MOST_OF_DAY, _TURNS = 43200.0, 2.5
#: A wrong clock: plots so far from all others in time, within so short a time, s, and this share of all plots at most.
_FAR, _BRIEF, _FEW = 3600.0, 5.0, 0.05


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
    if known.size > 1 and t[known].min() >= 0 and t[known].max() <= DAY:
        step = np.diff(t[known])
        # A wrong time jumps ahead, and the next one back: that is no midnight.
        back = step < -_MOST_OF_DAY
        back[1:] &= ~(step[:-1] > _MOST_OF_DAY)
        days[known[1:]] = np.cumsum(back)
    return days


def on_one_clock(raw: RawPlots) -> RawPlots:
    """Return plots without those that a wrong clock has put far from all others: a few, at times an hour or more from the rest.

    Parameters
    ----------
    raw : RawPlots
        As the log has them.
    """
    far = _strays(raw.t)
    if not far.any():
        return raw
    count = int(far.sum())
    told = f"{count} plot{'s' * (count > 1)} stamped an hour or more away from all others left out: a wrong clock."
    notes = (*raw.notes, Notice(told, "plots-far-in-time", count=count))
    return replace(raw, t=np.where(far, np.nan, raw.t), notes=notes)


def _strays(t: np.ndarray) -> np.ndarray:
    """Which times a wrong clock may have stamped, shape (N,)."""
    far = np.zeros(t.size, bool)
    order = np.argsort(t, kind="stable")[: np.isfinite(t).sum()]
    for group in np.split(order, np.flatnonzero(np.diff(t[order]) > _FAR) + 1):
        far[group] = np.ptp(t[group]) <= _BRIEF if group.size else False
    return far if far.sum() <= _FEW * order.size else np.zeros(t.size, bool)
