"""An input that acts later than it is given, sample by sample: its last values are kept for as long as its dead time.

It is the counterpart of `shipid.declaration.delays.shifted_rows`, which shifts a whole record.
"""

from __future__ import annotations

from bisect import bisect_right

from shipid.foundation.aliases import Plain


class DelayLine:
    """The last values of an input, with their times.

    Parameters
    ----------
    delay : float
        How much later the input acts, in s. What acts earlier than it is given (a negative one) cannot be known as it happens: its last
        value stands.
    """

    def __init__(self, delay: float) -> None:
        self.delay = delay
        self._times: list[float] = []
        self._values: list[float] = []

    @property
    def last(self) -> float | None:
        """The last value that was given; None before the first."""
        return self._values[-1] if self._values else None

    def take(self, t: float, value: float) -> None:
        """Take a value as it is given.

        Parameters
        ----------
        t : float
            Time in s, not before the last one.
        value : float
            SI.
        """
        if self._times:
            # One value before the earliest that can be asked for: that of the last sample, its dead time ago.
            spent = bisect_right(self._times, self._times[-1] - self.delay) - 1
            if spent > 0:
                del self._times[:spent], self._values[:spent]
        self._times.append(t)
        self._values.append(value)

    def at(self, t: float) -> float:
        """Return the value that acts at a time, in a straight line between those that were given.

        Parameters
        ----------
        t : float
            Time in s, not before that of the last sample but one.
        """
        when, times, values = t - self.delay, self._times, self._values
        k = bisect_right(times, when)
        if k in (0, len(times)):
            return values[max(k - 1, 0)]
        return values[k - 1] + (when - times[k - 1]) / (times[k] - times[k - 1]) * (values[k] - values[k - 1])

    @property
    def state(self) -> list[list[Plain]]:
        """Times and values as text that keeps every digit."""
        return [[float(v).hex() for v in row] for row in (self._times, self._values)]

    @state.setter
    def state(self, plain: list[list[Plain]]) -> None:
        self._times, self._values = ([float.fromhex(str(v)) for v in row] for row in plain)
