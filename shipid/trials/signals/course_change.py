"""A turn that ends on a course: the rudder eases as the heading comes up to it, or checks the turn from the other side."""

from __future__ import annotations

import numpy as np

_CIRCLE = np.radians(270.0)
"""A turn farther than this is a circle, whatever stops it."""

_COUNTER = 0.15
"""A turn is checked by this share of its rudder on the other side, or more."""

_EASES = 3.0
"""A rudder that takes so many times as long to come back as to go over is eased: that of a circle is released at once."""

_OVER, _BACK = 0.85, 0.15
"""Shares of its angle between which a rudder is on its way."""

_GOES_ON = 0.7
"""A heading that comes back by more than the rest of this share is steered back: that is the next manoeuvre."""


def ends_on_course(t: np.ndarray, rudder: np.ndarray, heading: np.ndarray, first: int, last: int) -> bool:
    """Return whether a turn is a change of course by an autopilot or a helmsman, and no circle.

    Parameters
    ----------
    t, rudder, heading : ndarray, shape (n,)
        Time [s], rudder angle and heading [rad].
    first, last : int
        Samples from where the rudder is half over, to where it no longer is.
    """
    held = rudder[first:last]
    if not held.size or last >= len(t):
        return False
    side = float(np.sign(np.median(held)))
    angle = float(np.quantile(side * held, 0.8))
    lasted = float(t[last] - t[first])
    stop = int(np.searchsorted(t, t[last] + lasted))
    turned = side * (heading[last:stop] - heading[first])
    # In the pull-out of a circle the ship has to be seen to come to a course.
    if t[min(stop, len(t)) - 1] - t[last] < 0.3 * lasted or turned.size < 3:
        return False
    if not 0 < turned.max() < _CIRCLE or turned[-1] < _GOES_ON * turned.max():
        return False
    if float((-side * rudder[last:stop]).max()) > _COUNTER * angle:
        return True
    over = first + np.flatnonzero(side * held >= _OVER * angle)
    before = np.flatnonzero(side * rudder[: first + 1] <= _BACK * angle)
    back = last + np.flatnonzero(side * rudder[last:stop] <= _BACK * angle)
    if not over.size or not before.size:
        return False
    up = float(t[over[0]] - t[before[-1]])
    down = float((t[back[0]] if back.size else t[stop - 1]) - t[over[-1]])
    return down > _EASES * up and down > _BACK * lasted
