"""Whether a logged order can be the order of the rudder angle beside it: it moves first, to the same side, and not as its copy."""

from __future__ import annotations

import numpy as np

#: Share of its range by which an order steps, and by which a rudder that is under way moves in a sample at least.
_STEP, _UNDER_WAY = 0.3, 0.005
#: Share of the orders that the rudder has to have begun to carry out before they were given.
_MOST = 0.6
#: A copy is off by less than this share of the scatter of what it copies; so many shifts are tried at most.
_COPY, _SHIFTS = 0.1, 200
#: A rudder that sets out later than this after its order, and than so many samples, has a dead time, or the order is stamped early [s].
LATE, LATE_SAMPLES = 1.5, 2.5
#: A steering gear starts to move its rudder within this time of the order [s].
GEAR = 1.0


def order_against_feedback(t: np.ndarray, order: np.ndarray, feedback: np.ndarray) -> str:
    """Return why a column is not the order that the rudder followed, in words; empty where nothing speaks against it.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    order, feedback : ndarray, shape (n,)
        The columns [rad]; NaN where a sample is missing.
    """
    both = np.isfinite(order) & np.isfinite(feedback)
    t, order, feedback = t[both], order[both], feedback[both]
    reach = float(np.ptp(order)) if order.size else 0.0
    if order.size < 10 or reach == 0 or float(np.ptp(feedback)) == 0:
        return ""
    step = np.diff(order)
    steps = np.flatnonzero(np.abs(step) > _STEP * reach)
    if np.array_equal(order, feedback):
        return "" if steps.size else "the column of the order is a copy of the rudder angle"
    if _opposite(order, feedback):
        return "the logged order counts to the other side than the rudder angle"
    if not steps.size:
        return ""
    # The rudder on its way to the new order in the sample before that order: on its way to the last one it moves to the other side.
    steps = steps[steps > 0]
    moved = np.sign(step[steps]) * (feedback[steps] - feedback[steps - 1])
    rattle = 1.4826 * float(np.median(np.abs(np.diff(feedback, 3)))) / np.sqrt(20)
    if not steps.size or float(np.mean(moved > max(6 * rattle, _UNDER_WAY * reach))) < _MOST:
        return ""
    return "the logged order comes after the rudder has moved, and cannot be what it followed"


def lag_behind_order(t: np.ndarray, order: np.ndarray, feedback: np.ndarray) -> float | None:
    """Return how long after the order the rudder sets out [s], median of the orders; None where that cannot be told.

    The ramp between 15 and 50 % of the way is extended back to where the rudder was when the order stepped. An order that never
    steps is one only where the rudder is its copy, some time later: that time.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    order, feedback : ndarray, shape (n,)
        The columns [rad]; NaN where a sample is missing.
    """
    both = np.isfinite(order) & np.isfinite(feedback)
    t, order, feedback = t[both], order[both], feedback[both]
    reach = float(np.ptp(order)) if order.size else 0.0
    if order.size < 10 or reach == 0:
        return None
    steps = np.flatnonzero(np.abs(np.diff(order)) > _STEP * reach)
    if not steps.size:
        return _copied_after(t, order, feedback)
    lags = []
    for k, then in zip(steps, [*steps[1:], len(t) - 1]):
        way = order[k + 1] - feedback[k + 1]
        if abs(way) < _STEP * reach:
            continue
        share = (feedback[k + 1 : then + 1] - feedback[k + 1]) / way
        reached = [np.flatnonzero(share >= part) for part in (0.15, 0.5)]
        if not reached[1].size or reached[0][0] == 0:
            continue
        one, other = (
            float(np.interp(part, share[j - 1 : j + 1], t[k + j : k + j + 2]))
            for part, j in ((0.15, reached[0][0]), (0.5, reached[1][0]))
        )
        lags.append(one - 0.15 / 0.35 * (other - one) - 0.5 * float(t[k] + t[k + 1]))
    # A turn has one order, and another to put the rudder amidships.
    if (
        len(lags) < min(2, len(steps))
        or not lags
        or float(np.ptp(lags)) > max(0.5 * abs(float(np.median(lags))), 2 * float(np.median(np.diff(t))))
    ):
        return None
    return float(np.median(lags))


def _copied_after(t: np.ndarray, order: np.ndarray, feedback: np.ndarray) -> float | None:
    """By how much the rudder is a later copy of an order in ramps [s]; None where it is none."""
    step = float(np.median(np.diff(t)))
    size = float(np.std(feedback))
    if step <= 0 or size == 0:
        return None
    # Up to half the time between two orders, or the copy may be of another swing.
    over = np.flatnonzero(np.diff(np.sign(order - np.median(order))) != 0)
    half = float(np.median(np.diff(t[over]))) if over.size > 1 else 0.25 * float(t[-1] - t[0])
    count = min(int(0.5 * half / step), _SHIFTS)
    if count < 2:
        return None
    shifts = np.linspace(0.0, 0.5 * half, count)
    late = np.interp(t[:, None] - shifts, t, order)
    inside = t[:, None] - shifts >= t[0]
    off = np.sqrt(
        np.sum(np.where(inside, late - feedback[:, None], 0.0) ** 2, axis=0) / np.maximum(inside.sum(axis=0), 1)
    )
    best = int(np.argmin(off))
    return float(shifts[best]) if off[best] < _COPY * size else None


def _opposite(order: np.ndarray, feedback: np.ndarray) -> bool:
    """Whether the two are each other's mirror image, whatever the rudder lags."""
    one, two = order - np.median(order), feedback - np.median(feedback)
    size = float(np.sqrt(np.mean(one**2) * np.mean(two**2)))
    return size > 0 and float(np.mean(one * two)) < -0.5 * size
