"""What the bridge remembers of the voyage, to see how far off its own predictions were."""

from __future__ import annotations

from collections import deque

import numpy as np

from shipid.prediction.situations.past import APART, LOOKED_AT, Past
from shipid.prediction.situations.situation import Situation

#: Past instants that are remembered, and samples for each ship length.
_INSTANTS, _SAMPLES = 30, 10
#: What is remembered of a sample.
_COLUMNS = ("x", "y", "psi", "u", "delta")


class Remembered:
    """The estimated voyage of the last few dozen ship lengths, and what was known at instants of it.

    Parameters
    ----------
    length : float
        Of the ship in m.
    """

    def __init__(self, length: float) -> None:
        self._length = length
        lengths = APART * _INSTANTS + LOOKED_AT[-1]
        self._samples: deque[tuple[float, ...]] = deque(maxlen=round(lengths * _SAMPLES))
        self._situations: deque[Situation] = deque(maxlen=_INSTANTS)

    def add(self, situation: Situation) -> None:
        """Take what is known now; a sample too near the last one is left out.

        Parameters
        ----------
        situation : Situation
            With the rudder angle among its values.
        """
        t, values = situation.t, situation.values
        if not all(n in values for n in _COLUMNS):
            return
        unit_time = self._length / values["u"]
        if self._samples and t < self._samples[-1][0] + unit_time / _SAMPLES:
            return
        self._samples.append((t, *(values[n] for n in _COLUMNS)))
        if not self._situations or t >= self._situations[-1].t + APART * unit_time:
            self._situations.append(situation)

    def forget(self) -> None:
        """Forget all: the filter begins again."""
        self._samples.clear()
        self._situations.clear()

    def past(self) -> Past | None:
        """Return what is remembered; None where no instant lies far enough back."""
        if not self._situations or len(self._samples) < _SAMPLES:
            return None
        t, x, y, psi, u, delta = np.array(self._samples).T
        # The first instants are those of a filter that begins.
        known = [s for s in self._situations if s.t >= t[0]]
        return Past(tuple(known), t, x, y, psi, u, delta) if known else None
