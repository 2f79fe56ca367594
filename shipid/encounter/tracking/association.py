"""Which plot is which target's: probabilities of all pairs together, or the one assignment that is nearest.

A pair has a weight: the likelihood that the plot is the target's, over that it is clutter and the target is not detected.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

#: Passes of messages, and the change at which they have settled.
_PASSES, _SETTLED = 200, 1e-7


def joint_probabilities(weights: np.ndarray) -> np.ndarray:
    """Return the marginal probabilities of joint association, every plot to one target at most and the other way round.

    Parameters
    ----------
    weights : ndarray, shape (n, m)
        Of each target with each plot, zero outside the gate; the weight of no plot is one.

    Returns
    -------
    ndarray, shape (n, m + 1)
        Probability of no plot, then of each; rows sum to one.

    Notes
    -----
    Loopy belief propagation (Williams and Lau, 2014): exact where no two targets share two plots, close to it elsewhere, and
    its cost grows with the number of pairs, not with that of the hypotheses.
    """
    messages = np.ones_like(weights)
    for _ in range(_PASSES if weights.size else 0):
        weighted = weights * messages
        to_plots = weights / (1 + weighted.sum(axis=1, keepdims=True) - weighted)
        new = 1 / (1 + to_plots.sum(axis=0, keepdims=True) - to_plots)
        done = np.abs(new - messages).max() < _SETTLED
        messages = new
        if done:
            break
    return with_none(weights * messages)


def nearest_assignment(weights: np.ndarray) -> np.ndarray:
    """Return the most probable joint association as probabilities of zero and one: global nearest neighbour.

    Parameters
    ----------
    weights : ndarray, shape (n, m)
        As for `joint_probabilities`.

    Returns
    -------
    ndarray, shape (n, m + 1)
    """
    n, m = weights.shape
    found = np.zeros((n, m + 1))
    found[:, 0] = 1.0
    if not weights.size:
        return found
    # A pair that is less probable than none of the two is not made.
    gain = np.log(np.maximum(weights, 1e-300))
    rows, columns = linear_sum_assignment(np.maximum(gain, 0.0), maximize=True)
    made = gain[rows, columns] > 0
    found[rows[made], 0] = 0.0
    found[rows[made], columns[made] + 1] = 1.0
    return found


def with_none(weights: np.ndarray) -> np.ndarray:
    """Return probabilities from weights beside that of no plot, which is one.

    Parameters
    ----------
    weights : ndarray, shape (n, m)
        See `joint_probabilities`.

    Returns
    -------
    ndarray, shape (n, m + 1)
    """
    total = 1 + weights.sum(axis=1, keepdims=True)
    return np.concatenate([1 / total, weights / total], axis=1)
