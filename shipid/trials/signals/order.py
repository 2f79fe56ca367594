"""Whether a logged order can be the order of the rudder angle beside it: it moves first, to the same side, and not as its copy."""

from __future__ import annotations

import numpy as np

#: Share of its range by which an order steps, and by which a rudder that is under way moves in a sample at least.
_STEP, _UNDER_WAY = 0.3, 0.005
#: Share of the orders that the rudder has to have begun to carry out before they were given.
_MOST = 0.6


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


def _opposite(order: np.ndarray, feedback: np.ndarray) -> bool:
    """Whether the two are each other's mirror image, whatever the rudder lags."""
    one, two = order - np.median(order), feedback - np.median(feedback)
    size = float(np.sqrt(np.mean(one**2) * np.mean(two**2)))
    return size > 0 and float(np.mean(one * two)) < -0.5 * size
