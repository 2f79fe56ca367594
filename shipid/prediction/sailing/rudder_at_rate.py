"""A loop that cycles: the rudder goes to and fro at its rate limit, since the gains are too high for the steering gear."""

from __future__ import annotations

import numpy as np

from shipid.declaration.vocabulary import shown
from shipid.foundation.notices import Notice

#: The kind of the notice.
CYCLES = "rudder-cycles"
#: The rudder moves at its limit where it does so by this share of it.
_AT_LIMIT = 0.9
#: A cycle: so many reversals at the limit, and at the limit for this share of the time from the first to the last of them. A sound loop
#: moves the rudder at its limit for a moment after each order, and reverses there a few times at most.
_REVERSALS, _MOST = 10, 0.5


def cycles_at_rate(t: np.ndarray, delta: np.ndarray, rate: float) -> list[Notice]:
    """Return what has to be said of a rudder that goes to and fro at its rate limit for most of the time.

    Waves that are fed back make a sound loop do so too: of a run in waves, ask of the same run without them.

    Parameters
    ----------
    t, delta : ndarray, shape (N,)
        Times in s, several between two reversals, and rudder angles in rad.
    rate : float
        Largest rate of the rudder in rad/s.

    Returns
    -------
    list of Notice
        None or one.
    """
    speed = np.diff(delta) / np.diff(t)
    moving = np.flatnonzero(np.abs(speed) >= _AT_LIMIT * rate)
    turned = moving[1:][np.diff(np.sign(speed[moving])) != 0]
    if turned.size < _REVERSALS:
        return []
    span = slice(turned[0], turned[-1] + 1)
    share = float(np.mean(np.abs(speed[span]) >= _AT_LIMIT * rate))
    if share <= _MOST:
        return []
    return [
        Notice(
            f"the rudder goes to and fro at its rate limit of {shown(rate, 'r', digits=3)}, {turned.size} times from {t[turned[0]]:.0f} to "
            f"{t[turned[-1]]:.0f} s: the loop cycles, since the gains of the autopilot are too high for this steering gear. "
            "Compare them with those of shipid tune.",
            CYCLES,
            serious=True,
            reversals=int(turned.size),
            share=share,
        )
    ]
