"""The track of the past: one place every few seconds, the oldest given up."""

from __future__ import annotations

from collections import deque

from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain

#: Places that are kept, and the seconds between two: eight hours.
_KEPT, _EVERY = 2880, 10.0


class PastTrack:
    """Where the ship has been.

    Attributes
    ----------
    count : int
        How many places were added since the beginning.
    """

    def __init__(self) -> None:
        self.count = 0
        self._places: deque[tuple[float, float, float]] = deque(maxlen=_KEPT)

    def add(self, t: float, x: float, y: float) -> None:
        """Take the ship's place; one that follows the last too soon is passed over.

        Parameters
        ----------
        t, x, y : float
            Time in s, and place in m.
        """
        if not self._places or t - self._places[-1][0] >= _EVERY - 1e-6:
            self._places.append((t, x, y))
            self.count += 1

    def since(self, count: int) -> list[Plain]:
        """Return the places ``[t, x, y]`` that were added after so many.

        Parameters
        ----------
        count : int
            How many a client has.
        """
        new = min(self.count - count, len(self._places))
        return [[number(v, 7) for v in self._places[k]] for k in range(len(self._places) - new, len(self._places))]

    def to_dict(self) -> dict[str, Plain]:
        """Return all places as columns."""
        columns = zip(*self._places) if self._places else ((), (), ())
        return {n: [number(v, 7) for v in column] for n, column in zip("txy", columns)}
