"""A robust look at the first samples of a sensor: one wild sample at the beginning must not become the first estimate."""

from __future__ import annotations

import numpy as np

#: So many of the first samples are looked at: fewer than in which a ship's rate of turn changes by much.
LOOK = 9
#: A first sample so many robust standard deviations off the line through the others is not taken.
_WILD = 6.0
#: Standard deviation over median absolute deviation, normal distribution.
_NORMAL = 1.4826


def first_value(t: np.ndarray, values: np.ndarray, level: float) -> float:
    """Return the value of a sensor at its first sample.

    Parameters
    ----------
    t, values : ndarray, shape (N,)
        Times in s and finite values, in order; the first few are looked at.
    level : float
        Standard deviation of one sample.

    Returns
    -------
    float
        The first sample; where it is wild, the line through the first samples at its time, by the median of all slopes
        (Theil 1950; Sen 1968), which two wild samples in nine do not move.
    """
    t, values = t[:LOOK], values[:LOOK]
    if values.size < 4:
        return float(values[0])
    i, j = np.triu_indices(values.size, 1)
    apart = t[j] - t[i]
    if not (apart > 0).any():
        return float(values[0])
    slope = np.median((values[j] - values[i])[apart > 0] / apart[apart > 0])
    level_line = values - slope * (t - t[0])
    start = float(np.median(level_line))
    spread = max(_NORMAL * float(np.median(np.abs(level_line - start))), level)
    return start if abs(values[0] - start) > _WILD * spread else float(values[0])
