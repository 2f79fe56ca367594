"""Whether the data determine a coefficient: the one rule of fits, filters, recursions, plans, reports and ship files.

A coefficient is **determined** where its standard deviation is below half of its value, and at most 90 % of the one that was
assumed before: the 95 % interval keeps its sign, and it is the data that say so. A coefficient that may be zero is **not
distinguishable from zero** where its interval holds zero and is narrow beside the size such a coefficient usually has: the data
say that it is small, not that it is there. Any other is **not determined**: the data hold no information about it, it ended at a
bound, its interval is wide, or it is hardly better known than before. Only a determined one counts as `identifiable`.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import Literal, TypeAlias

from shipid.foundation.numbers import brief, percent
from shipid.foundation.statistics import interval_95

Standing: TypeAlias = Literal["determined", "not distinguishable from zero", "not determined"]
DETERMINED: Standing = "determined"
NEAR_ZERO: Standing = "not distinguishable from zero"
UNKNOWN: Standing = "not determined"

#: Why a coefficient is not determined whose search ended at the edge of what it was allowed: it may trade off with others besides.
AT_BOUND = "it ended at its bound."

#: A standard deviation that is a larger share of the size is too large: at half of it, the 95 % interval reaches zero.
UNDETERMINED = 0.5
#: A standard deviation that is a larger share of the one before the data comes from before.
HARDLY = 0.9


def standing_of(
    value: float, std: float, *, low: float = -inf, size: float = 0.0, before: float = inf
) -> tuple[Standing, str]:
    """Return what the data say of a coefficient, and the reason where they do not determine it.

    Parameters
    ----------
    value, std : float
        Estimate and standard deviation.
    low : float
        Its lower bound: one that must be positive is never near zero.
    size : float
        Its usual size; zero where none is known.
    before : float
        Its standard deviation before the data, infinite where nothing was known.

    Returns
    -------
    standing : {"determined", "not distinguishable from zero", "not determined"}
    why : str
        A sentence; empty where it is determined.
    """
    if not isfinite(std) or not isfinite(value):
        return UNKNOWN, "the trials hold no information about it alone."
    if std > HARDLY * before:
        return (
            UNKNOWN,
            f"it is known from before: its standard deviation is {percent(std / before)} of the one it started with.",
        )
    if std < UNDETERMINED * abs(value):
        return DETERMINED, ""
    first, last = interval_95(value, std)
    if low < 0 and std <= UNDETERMINED * size and first <= 0 <= last:
        return NEAR_ZERO, f"its 95 % interval, {brief(first, 2)} to {brief(last, 2)}, holds zero."
    times = std / abs(value) if value else inf
    if times < 1:
        return (
            UNKNOWN,
            f"its standard deviation is {percent(times)} of its value, and has to be below {percent(UNDETERMINED)}.",
        )
    many = f"{brief(times, 2)} times" if times < 100 else "more than a hundred times"
    return UNKNOWN, f"its standard deviation is {many} its value: the data leave its size open."
