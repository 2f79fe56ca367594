"""Invalid time stamps: repeated, jumping back, or jumping ahead by more than the longest pause.

One such stamp is left out. When three in a row agree with each other the clock itself has been set, and the filter goes on
with the new one: otherwise it would leave out all samples until the old time is reached again, and one stamp far ahead
would stop it altogether.
"""

from __future__ import annotations

import math

import numpy as np

#: Longest pause in s that is bridged; so many stamps in a row that agree make a new clock.
LONGEST_GAP, CONFIRMED = 600.0, 3
#: Longest step in sampling intervals: a gap is bridged in steps no longer, so that the integration stays accurate; and so many
#: steps at most.
LONGEST_STEP, MOST_STEPS = 4.0, 2000
#: The sampling interval is the median of so many of the last.
_RECENT = 9
#: Longest time from zero in s that is valid: three thousand years, beyond which a double loses the milliseconds as well.
LATEST = 1e11


class FilterClock:
    """The filter's own time from stamps that may be wrong.

    Parameters
    ----------
    typical : float
        Sampling interval in s, where it is known beforehand.

    Attributes
    ----------
    last : float or None
        The last stamp that was used, in s; None before the first.
    shift : float
        How far the filter's time is ahead of the stamps, in s: the sum of all clock changes since the first sample.
    """

    def __init__(self, typical: float = 0.0) -> None:
        self.last: float | None = None
        self.shift = 0.0
        self._recent: list[float] = [typical] * _RECENT if typical else []
        self._suspect: list[float] = []

    @property
    def typical(self) -> float:
        """The sampling interval in s; zero before the second sample."""
        return sorted(self._recent)[len(self._recent) // 2] if self._recent else 0.0

    @property
    def now(self) -> float:
        """The filter's time of the last sample that was used, in s."""
        return (self.last or 0.0) + self.shift

    @property
    def state(self) -> list[list[float]]:
        """Its state, as numbers."""
        return [[self.last or 0.0, self.shift], self._recent, self._suspect]

    @state.setter
    def state(self, numbers: list[list[float]]) -> None:
        (self.last, self.shift), self._recent, self._suspect = numbers

    def skip_to(self, t: float) -> None:
        """Go on to the last of several stamps that follow each other.

        Parameters
        ----------
        t : float
            That stamp in s.
        """
        self.last, self._suspect = t, []

    def elapsed(self, t: float) -> float | None:
        """Return the seconds since the sample before, or None for one that is left out.

        Parameters
        ----------
        t : float
            Its time stamp in s.
        """
        if not abs(t) < LATEST:
            return None
        if self.last is None:
            self.last = t
            return 0.0
        elapsed = t - self.last
        if 0 < elapsed <= LONGEST_GAP:
            self.last, self._suspect = t, []
            self._recent = [*self._recent[1 - _RECENT :], elapsed]
            return elapsed
        follows = self._suspect and 0 < t - self._suspect[-1] <= LONGEST_GAP
        self._suspect = [*self._suspect, t] if follows else [t]
        if len(self._suspect) < CONFIRMED:
            return None
        if elapsed <= 0:
            # The first stamp of the new clock came one interval after the last of the old one.
            passed = min(t - self._suspect[0] + self.typical, LONGEST_GAP)
            self.shift += self.last + passed - t
        else:
            passed = LONGEST_GAP
        self.last, self._suspect = t, []
        return passed


def steps(elapsed: float, typical: float) -> int:
    """Return in how many steps a gap is bridged.

    Parameters
    ----------
    elapsed : float
        Seconds between two samples.
    typical : float
        Sampling interval in s; zero where it is not known.
    """
    # A whole number of longest steps is not one more by rounding.
    if elapsed <= LONGEST_STEP * typical or not typical:
        return 1
    return max(1, math.ceil(min(elapsed / (LONGEST_STEP * typical), MOST_STEPS) - 1e-6))


def filter_time(t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which samples of a record are used, shape (N,), and the filter's time of those.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Time stamps in s.
    """
    with np.errstate(invalid="ignore"):  # NaN and infinity are not used
        t = np.where(np.abs(t) < LATEST, t, np.nan)
        d = np.diff(t)
    bad = np.flatnonzero(~((d > 0) & (d <= LONGEST_GAP)))
    if not bad.size and np.isfinite(t).all():
        return np.ones(t.size, dtype=bool), t
    kept, own = np.zeros(t.size, dtype=bool), np.array(t, dtype=float)
    good = d[(d > 0) & (d <= LONGEST_GAP)]
    clock = FilterClock(float(np.median(good)) if good.size else 0.0)
    # Between two invalid stamps all follow each other: where one of them is used, so are the others.
    for a, b in zip([0, *(bad + 1)], [*(bad + 1), t.size]):
        first = next((k for k in range(a, b) if clock.elapsed(float(t[k])) is not None), b)
        kept[first:b] = True
        own[first:b] += clock.shift
        if first < b:
            clock.skip_to(float(t[b - 1]))
    return kept, own[kept]
