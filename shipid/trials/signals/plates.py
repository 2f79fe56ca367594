"""Plates of the rudder: stretches at one angle, which a zig-zag or a turn is steered in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.checks import STEADY_RUDDER

_DWELL = 0.15
"""A plate on which the rudder spends less of its stretch than this is hand steering."""


@dataclass(frozen=True)
class Plate:
    """A stretch at one rudder angle.

    Attributes
    ----------
    first, last : int
        Samples from where the rudder is half over to this side, to where it is half over to the other.
    angle : float
        The rudder angle held, with its sign [rad].
    dwell : float
        Share of the stretch that the rudder stays within 20 % of that angle.
    """

    first: int
    last: int
    angle: float
    dwell: float

    @property
    def side(self) -> int:
        """1 for starboard, -1 for port."""
        return 1 if self.angle > 0 else -1


def plates(rudder: np.ndarray) -> list[Plate]:
    """Split a rudder record into plates of alternating sides.

    Parameters
    ----------
    rudder : ndarray, shape (n,)
        Rudder angle [rad].

    Returns
    -------
    list of Plate
        In order of time; empty where the rudder stays within 0.5 deg of midships.
    """
    size = float(np.quantile(np.abs(rudder), 0.9))
    if size < STEADY_RUDDER:
        return []
    over = np.where(rudder > size / 2, 1, np.where(rudder < -size / 2, -1, 0))
    held = np.flatnonzero(over)
    turns = held[1:][np.diff(over[held]) != 0]
    starts = [int(held[0]), *(int(k) for k in turns)]
    result = []
    for first, last in zip(starts, [*starts[1:], len(rudder)]):
        stretch = np.abs(rudder[first:last])
        angle = held_angle(stretch[stretch >= 0.5 * stretch.max()])
        dwell = float(np.mean(np.abs(stretch - angle) <= 0.2 * angle))
        result.append(Plate(first, last, float(over[first]) * angle, dwell))
    return result


def held_angle(values: np.ndarray) -> float:
    """Return the value at which a rudder stays: the middle of the narrowest interval with a third of the samples.

    A median would be drawn down by the ramps of a short plate, a maximum up by an order that overshoots.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Rudder angles [rad], in any order.
    """
    ordered = np.sort(values)
    count = max(1, -(-len(ordered) // 3))
    widths = ordered[count - 1 :] - ordered[: len(ordered) - count + 1]
    k = int(np.argmin(widths))
    return float(np.median(ordered[k : k + count]))


def regular(found: list[Plate]) -> list[Plate]:
    """Return the longest run of plates of about the same angle, each held: the zig-zag without the hand steering.

    Parameters
    ----------
    found : list of Plate
        All plates of a record.

    Returns
    -------
    list of Plate
    """
    steady = [plate for plate in found if plate.dwell >= _DWELL]
    if not steady:
        return []
    weights = np.array([(p.last - p.first) * p.dwell for p in steady])
    angles = np.array([abs(p.angle) for p in steady])
    order = np.argsort(angles)
    middle = np.searchsorted(np.cumsum(weights[order]), 0.5 * weights.sum())
    nominal = angles[order][middle]
    best: list[Plate] = []
    run: list[Plate] = []
    for plate in found:
        fits = plate.dwell >= _DWELL and abs(abs(plate.angle) - nominal) <= 0.25 * nominal
        run = [*run, plate] if fits else []
        best = run if len(run) > len(best) else best
    return best
