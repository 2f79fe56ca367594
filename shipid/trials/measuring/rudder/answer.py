"""When the ship answers the rudder of a turn: a rudder on another clock than the heading shows in how the turn begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid

from shipid.trials.signals.channel import Channel

_BEGINS, _UNTIL = np.radians(2.0), np.radians(30.0)
"""The turn begins to show at the first, and up to the second a ship of any kind answers like one of the first order."""

_AROUND, _TRIED = 0.75, 0.6
"""Shares of that time: of the approach that is looked at, and of the delays that are tried, to either side."""

_UNLIKE = 0.03
"""No ship is quite of the first order: by this share of that time the delay may be wrong (hulls with cross-flow drag: 0.04)."""

_CERTAIN = 6.0
"""The misfit of a delay that is possible is larger by so many times the scatter of one sample at the most."""


@dataclass(frozen=True)
class TurnAnswer:
    """How long after the rudder, by its stamps, the ship begins to turn.

    Attributes
    ----------
    delay : float
        How long [s]; negative where the ship turns before the rudder moves.
    within : float
        By how much it may be wrong [s].
    """

    delay: float
    within: float

    @property
    def apart(self) -> bool:
        """Whether the clocks of rudder and heading cannot be one, or the rudder acts after a dead time."""
        return abs(self.delay) > self.within


def answer_of_turn(rudder: Channel, psi: Channel, side: int, when: float) -> TurnAnswer | None:
    """Fit ``psi = p0 + p1 t + a (twice integrated) delta(t - delay) - b (integrated) psi`` to the beginning of a turn.

    Integrals of the heading are known well where its derivatives are not; the delay is the one that fits best.

    Parameters
    ----------
    rudder, psi : Channel
        Rudder angle and heading [rad].
    side : int
        1 for a turn to starboard, -1 for one to port.
    when : float
        When the rudder sets out [s].

    Returns
    -------
    TurnAnswer or None
        None where the beginning of the turn is not in the record, or the fit does not tell.
    """
    turned = side * (psi.y - float(np.interp(when, psi.t, psi.y)))
    far = np.flatnonzero((psi.t > when) & (turned > _UNTIL))
    if not far.size:
        return None
    before = np.flatnonzero(turned[: far[0]] < _BEGINS)
    end, begins = float(psi.t[far[0]]), float(psi.t[before[-1]]) if before.size else when
    way = end - min(begins, when)
    start = max(min(begins, when) - _AROUND * way, float(psi.t[0]), float(rudder.t[0]))
    use = (psi.t >= start) & (psi.t <= end)
    if int(use.sum()) < 12 or psi.hole(start, end) is not None or rudder.hole(start, end) is not None:
        return None
    t, y = psi.t[use] - when, turned[use]
    shifts = np.linspace(-_TRIED, _TRIED, 121) * way
    # The rudder stays at its first angle before the record.
    moved = side * np.interp(psi.t[use][:, None] - shifts, rudder.t, rudder.y)
    twice = cumulative_trapezoid(cumulative_trapezoid(moved, t, axis=0, initial=0.0), t, axis=0, initial=0.0)
    common = np.column_stack([np.ones_like(t), t, cumulative_trapezoid(y, t, initial=0.0)])
    common = np.linalg.qr(common)[0]
    rest, columns = y - common @ (common.T @ y), twice - common @ (common.T @ twice)
    size = np.maximum(np.sum(columns**2, axis=0), 1e-300)
    gain = np.asarray(rest @ columns) / size
    misfit = np.where(gain > 0, float(rest @ rest) - gain**2 * size, np.inf)
    best = int(np.argmin(misfit))
    if not 0 < best < len(shifts) - 1 or not np.isfinite(misfit[best]):
        return None
    left = rest - gain[best] * columns[:, best]
    least = max(float(misfit[best]), 1e-12 * float(y @ y))
    # Waves go on from sample to sample: so many of them are one.
    alike = min(max(float(left[1:] @ left[:-1]) / least, 0.0), 0.98)
    free = len(y) * (1 - alike) / (1 + alike)
    possible = np.abs(shifts - shifts[best])[misfit <= least * (1 + _CERTAIN / free)]
    own = 0.25 * max(psi.interval, rudder.interval)
    return TurnAnswer(float(shifts[best]), float(possible.max()) + _UNLIKE * way + own)
