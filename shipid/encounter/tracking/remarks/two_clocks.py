"""Plots of two clocks in one log: one ship is seen twice, the later time behind the earlier one on the same course."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from shipid.encounter.plots.plots import Plots, Scan
from shipid.encounter.tracking.target_track import TargetTrack
from shipid.foundation.notices import Notice

#: Instants that are not chance, and the longest time that two clocks are taken to be apart, s.
_ENOUGH, _LONGEST = 20, 60.0
#: Two tracks are of one ship where they sail as fast within this share, on one course within this angle, rad, and one behind the other:
#: so many of their standard deviations beside each other at most, and as many and so many times that apart along the course at least.
_AS_FAST, _ONE_COURSE, _BESIDE, _APART = 0.3, 0.2, 2.0, 3.0
#: Two tracks sail together for so many times the seconds that they are apart, or one is an echo or a wake behind a ship for a while.
_TOGETHER = 5.0
#: Two values have a kurtosis of 1, all of an interval alike 1.8, and chance 3. What lies on two sides lies so much farther along the
#: course than beside it.
_TWO_SIDED, _FARTHER = 2.0, 1.5
_REMEDY = (
    "one ship by two clocks in one log, or time stamps of which some are late. Give the plots of each clock a sensor with its latency in a "
    "format file, or put the clocks right"
)


def two_clocks(tracks: list[TargetTrack], plots: Plots) -> list[Notice]:
    """Return a notice where tracks look as if ships were seen by two clocks.

    Parameters
    ----------
    tracks : list of TargetTrack
        All tracks.
    plots : Plots
        What they were made of.
    """
    moving = [one for one in tracks if one.moves.sum() >= _ENOUGH]
    told = [_pair(a, b) for a, b in combinations(moving, 2)]
    found = [n for n in told if n is not None]
    if found:
        return found
    scans = [scan for scan in plots.scans if len(scan.z)]
    late = np.concatenate([np.zeros((0, 2)), *(_lateness(one, scans) for one in moving)])
    if len(late) < 3 * _ENOUGH:
        return []
    along, across = late[:, 0] - np.median(late[:, 0]), late[:, 1]
    kurtosis = float(np.mean(along**4) / max(np.mean(along**2) ** 2, 1e-300))
    if kurtosis > _TWO_SIDED or np.std(along) < _FARTHER * np.std(across):
        return []
    apart = float(np.mean(along[along > 0]) - np.mean(along[along <= 0]))
    return [
        Notice(
            f"plots lie on two sides of the tracks, before and behind, some {apart:.0f} s apart: {_REMEDY}.",
            "two-clocks",
            seconds=apart,
        )
    ]


def _pair(a: TargetTrack, b: TargetTrack) -> Notice | None:
    """What two tracks are that sail one line at one speed."""
    _, at, there = np.intersect1d(a.t, b.t, return_indices=True)
    both = a.moves[at] & b.moves[there] & a.held[at] & b.held[there]
    if both.sum() < _ENOUGH:
        return None
    one, other = a.x[at[both]], b.x[there[both]]
    mean = 0.5 * (one[:, 2:] + other[:, 2:])
    speed = np.hypot(*mean.T)
    away, turned = other[:, :2] - one[:, :2], one[:, 2] * other[:, 3] - one[:, 3] * other[:, 2]
    along = np.einsum("ni,ni->n", away, mean) / speed
    across = (away[:, 0] * mean[:, 1] - away[:, 1] * mean[:, 0]) / speed
    # Where a track errs it errs for long: the spread is that of one position, and not that of a mean.
    spread = float(np.sqrt(np.median(np.trace((a.P[at[both]] + b.P[there[both]])[:, :2, :2], axis1=1, axis2=2)) / 2))
    faster = abs(np.median(a.speed[at[both]] / b.speed[there[both]]) - 1)
    course = abs(np.median(np.arctan2(turned, np.einsum("ni,ni->n", one[:, 2:], other[:, 2:]))))
    seconds = float(abs(np.median(along / speed)))
    together = float(np.ptp(a.t[at[both]]))
    if together < _TOGETHER * seconds:
        return None
    if faster > _AS_FAST or course > _ONE_COURSE or not 0 < seconds < _LONGEST:
        return None
    least = max(_APART * abs(np.median(across)), _BESIDE * spread)
    if abs(np.median(across)) > _BESIDE * spread or abs(np.median(along)) < least:
        return None
    return Notice(
        f"tracks {a.number} and {b.number} sail one line at one speed, {seconds:.0f} s apart: a ship and her tow, or {_REMEDY}.",
        "two-clocks",
        serious=True,
        tracks=[a.number, b.number],
        seconds=seconds,
    )


def _lateness(track: TargetTrack, scans: list[Scan]) -> np.ndarray:
    """How far the nearest plot of each scan lies before and beside where the track was going, in s at its speed."""
    steps = np.flatnonzero(track.moves[:-1] & track.held[:-1])
    times = np.array([scan.t for scan in scans])
    # Of scans at one time, by several sensors, the last.
    which = np.searchsorted(times, track.t[steps + 1], side="right") - 1
    seen = (which >= 0) & (times[which] == track.t[steps + 1])
    steps, which = steps[seen], which[seen]
    if not steps.size:
        return np.zeros((0, 2))
    counts = np.array([len(scan.z) for scan in scans])
    first = np.cumsum(counts) - counts
    begins = np.cumsum(counts[which]) - counts[which]
    step = np.repeat(np.arange(steps.size), counts[which])
    plot = np.arange(step.size) - np.repeat(begins, counts[which]) + np.repeat(first[which], counts[which])
    z, stamped = np.concatenate([s.z for s in scans]), np.concatenate([s.t - s.ago for s in scans])
    velocity = track.x[steps, 2:]
    off = z[plot] - track.x[steps, :2][step] - (stamped[plot] - track.t[steps][step])[:, None] * velocity[step]
    # The nearest plot of each step comes first among those of its step.
    off = off[np.lexsort((np.hypot(*off.T), step))[begins]]
    square = np.einsum("ni,ni->n", velocity, velocity)
    along = np.einsum("ni,ni->n", off, velocity) / square
    across = (off[:, 0] * velocity[:, 1] - off[:, 1] * velocity[:, 0]) / square
    return np.asarray(np.stack([along, across], axis=1)[np.maximum(np.abs(along), np.abs(across)) < _LONGEST])
