"""Channels that move in steps: printed in coarse digits, or written again only when they have moved by more than a threshold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: A rudder that stays on a value for so many times the usual stay on a ramp is held there.
_STAYS = 3.0
#: Stays on ramps, of two samples at least, from which on a rudder is coarse.
_FEWEST = 4
#: Share of the record that is spent on ramps at most, and how many times as long as a step of a ramp a plate is held at least.
_ON_RAMPS, _PLATES = 0.5, 2.0
#: The smallest of the steps over the usual one, from which on a threshold decides whether a value is written.
_SMALLEST = 0.6
#: A digit goes into the smallest step fewer times than this.
_FINEST = 8
#: Share of the steps to the same side as the one before that come after a repeated value, where a threshold decides.
_REPEATED = 0.25


@dataclass(frozen=True, eq=False)
class Ramps:
    """A rudder that takes several samples for each step of its ramps.

    Attributes
    ----------
    y : ndarray, shape (n,)
        The rudder angle with its ramps drawn as lines through the moments at which a step is known [rad].
    step : float
        The usual step [rad].
    """

    y: np.ndarray
    step: float


def threshold_of(values: np.ndarray, places: np.ndarray | None = None) -> float | None:
    """Return the threshold of a channel that is written again only when it has moved by more than that; None of any other.

    Its steps are never small, of any size above the threshold, and no multiples of a digit.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The samples that are there, repeated where nothing was written; an angle unwrapped.
    places : ndarray of int, shape (n,), optional
        The rows of the record they stand in, where repeated values are left out of it.
    """
    step = np.abs(np.diff(values))
    moves = step[step > 0]
    steps = np.flatnonzero(np.diff(values))
    changed = steps if places is None else places[steps + 1]
    # What moves on to the same side after a sample without a move: a ramp without noise moves in every sample.
    onward = np.diff(np.sign(np.diff(values)[steps])) == 0
    if moves.size < 12 or not onward.any() or np.mean(np.diff(changed)[onward] > 1) < _REPEATED:
        return None
    small, usual = float(np.quantile(moves, 0.03)), float(np.median(moves))
    if small < _SMALLEST * usual or _printed(moves, small):
        return None
    return small


def _printed(moves: np.ndarray, digit: float) -> bool:
    """Whether steps are whole numbers of this digit, or of a half, a third, ... of it."""
    count = np.outer(np.arange(1, _FINEST), moves / digit)
    near = np.abs(count - np.round(count)) < 0.02
    return bool(np.any(near.mean(axis=1) > 0.9))


def ramps_of(t: np.ndarray, y: np.ndarray) -> Ramps | None:
    """Return a rudder of coarse steps with its ramps as lines; None where its steps are finer than its samples.

    A rounded angle changes where the true one lies in the middle between two digits. One that is written when it has moved by more
    than a threshold is right at the moment it is written. On a ramp these moments lie on a line, and the samples beside it.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and rudder angle [rad], without missing samples.
    """
    steps = np.diff(y)
    changed = np.flatnonzero(steps)
    if len(changed) < _FEWEST + 1:
        return None
    apart = np.diff(changed)
    onward = np.diff(np.sign(steps[changed])) == 0
    usual = float(np.median(apart[onward])) if onward.any() else 0.0
    # Where the rudder goes on to the same side after a long stay it was held there.
    ramp = onward & (apart <= _STAYS * usual)
    if usual < 2 or int(ramp.sum()) < _FEWEST:
        return None
    # A rudder that is held at one angle after the other, as in a spiral, is on no ramp: ramps are short, and plates are long.
    plates = apart[~onward]
    if float(apart[ramp].sum()) > _ON_RAMPS * len(y) or (plates.size and float(plates.max()) < _PLATES * usual):
        return None
    inside = np.zeros(len(y), dtype=bool)
    for first, last in zip(changed[:-1][ramp], changed[1:][ramp]):
        inside[first + 1 : last + 1] = True
    size = float(np.median(np.abs(steps[changed])))
    if threshold_of(y) is None:
        when, angle = 0.5 * (t[changed] + t[changed + 1]), 0.5 * (y[changed] + y[changed + 1])
    else:
        when, angle = t[changed + 1], y[changed + 1]
    return Ramps(np.where(inside, np.interp(t, when, angle), y), size)
