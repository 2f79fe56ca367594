"""Numbers that stand for a missing sample: what a logger or a protocol writes where a sensor has nothing to say."""

from __future__ import annotations

import numpy as np

#: No sensor reads as much as this in any unit.
LARGEST = 1e30
#: A mark steps away from the samples beside it by this many times the largest ordinary step.
_STEPS = 20.0
#: What a sensor shows by itself seldom reaches this many times the largest of its other samples.
_TIMES = 3.0

# Nines, the ends of short integers as they are and scaled by 0.01 and 0.1, and the codes of AIS (ITU-R M.1371): heading 511, speed 102.3, rate of turn -128,
# 91 and 181 for latitude and longitude.
_MARKS = np.array(
    [
        *(sign * nines for nines in (99.99, 999, 999.9, 999.99, 9999, 9999.9, 99999, 999999, 9999999) for sign in (1, -1)),
        *(sign * full for full in (99, 99.9, 327.67, 327.68, 3276.7, 3276.8, 655.35, 6553.5) for sign in (1, -1)),
        1e20, -1e20, 32767, -32768, 65535, 2147483647, -2147483648, 511, 102.3, 1023, -128, 91, 181,
    ]
)  # fmt: skip
#: Marks that nobody measures by chance, whatever the size of the other samples.
_UNMISTAKABLE = -998.0
#: The code for no heading in turns.
_NO_HEADING = 511 / 360


def marks_of_missing(values: np.ndarray, full_circle: float | None = None) -> np.ndarray:
    """Return which samples are marks of a missing one.

    A number counts as a mark where it is one of those in use, steps away from the samples on both sides as no other sample
    does, and lies where the sensor does not measure: far beyond all other samples, or outside the circle of a heading that is
    otherwise written within one.

    Parameters
    ----------
    values : ndarray, shape (n,)
        A channel as printed, NaN where a field is empty.
    full_circle : float, optional
        A full turn in the unit of the channel, for an angle that wraps.

    Returns
    -------
    ndarray of bool, shape (n,)
        Numbers that are infinite or beyond `LARGEST` are among them, whatever stands beside them.
    """
    with np.errstate(invalid="ignore"):
        result: np.ndarray = np.isinf(values) | (np.abs(values) >= LARGEST)
    there = np.flatnonzero(np.isfinite(values) & ~result)
    if not there.size:
        return result
    printed = values[there]
    candidate = np.isin(printed, _MARKS)
    if not candidate.any():
        return result
    others = np.flatnonzero(~candidate)
    if not others.size:
        # Nothing to compare with: only one number all through, and one that nobody measures.
        result[there[(printed < _UNMISTAKABLE) & (printed == printed[0])]] = bool(np.ptp(printed) == 0)
        return result
    plain = printed[others]
    step = float(np.quantile(np.abs(np.diff(plain)), 0.95)) if plain.size > 1 else 0.0
    at = np.flatnonzero(candidate)
    after = np.searchsorted(others, at)
    left = plain[(after - 1).clip(0)]
    right = plain[after.clip(0, others.size - 1)]
    away = np.minimum(np.abs(printed[at] - left), np.abs(printed[at] - right)) > _STEPS * step
    beyond = np.abs(printed[at]) > _TIMES * float(np.abs(plain).max())
    if full_circle is not None:
        slack = 0.01 * full_circle
        within = float(plain.min()) >= -0.5 * full_circle - slack and float(plain.max()) <= full_circle + slack
        lowest = -slack if float(plain.min()) >= -slack else -0.5 * full_circle - slack
        beyond |= within & ((printed[at] > full_circle + slack) | (printed[at] < lowest))
        # The code of AIS is none of a heading that is counted on beyond a full circle and was near before and behind it.
        beyond |= np.isclose(printed[at], _NO_HEADING * full_circle)
    far = away & (beyond | (printed[at] < _UNMISTAKABLE))
    result[there[at[far]]] = True
    return result
