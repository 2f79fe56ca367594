"""The speed and the amplitudes that a log has reached so far, beside those that a ship's coefficients come from."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping

import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.notices import Notice
from shipid.parameters.parameter_set import ParameterSet
from shipid.parameters.validity import beyond, speed_given

#: An amplitude is reached when so many samples in a row are as large: one wild sample is none.
_IN_A_ROW = 3
#: The speed before the manoeuvre is the median of so many samples.
_FIRST = 10


class Reached:
    """The speed before the manoeuvre, and the largest rudder angle, rate of turn and drift angle so far.

    Parameters
    ----------
    inputs : mapping of str to float, optional
        Inputs that are held at a value, SI: a speed among them goes before that of the samples.
    """

    def __init__(self, inputs: Mapping[str, float] | None = None) -> None:
        given = speed_given(inputs or {})
        self._speeds: list[float] = [] if given is None else [given] * _FIRST
        self._last = {n: deque[float](maxlen=_IN_A_ROW) for n in ("rudder", "rate", "drift")}
        self.amplitudes: dict[str, float] = {}

    @property
    def speed(self) -> float | None:
        """The speed before the manoeuvre in m/s; None as long as too few samples have come."""
        return float(np.median(self._speeds)) if len(self._speeds) == _FIRST else None

    def add(self, sample: Mapping[str, float]) -> None:
        """Take a sample.

        Parameters
        ----------
        sample : mapping of str to float
            The channels there are, SI; NaN where one is missing.
        """
        u, v, whole = (sample.get(n, math.nan) for n in ("u", "v", "U"))
        speed = u if math.isfinite(u) else whole
        if math.isfinite(speed) and len(self._speeds) < _FIRST:
            self._speeds.append(speed)
        steered = sample.get("delta", sample.get("delta_order", math.nan))
        sizes = {"rudder": steered, "rate": sample.get("r", math.nan), "drift": math.atan2(-v, u)}
        for name, size in sizes.items():
            last = self._last[name]
            if math.isfinite(size):
                last.append(abs(size))
                if len(last) == _IN_A_ROW:
                    self.amplitudes[name] = max(self.amplitudes.get(name, 0.0), min(last))

    def beyond(self, model: Model, ship: ParameterSet | None) -> list[Notice]:
        """Return what has to be said where the log goes beyond the range that a ship's coefficients come from.

        Parameters
        ----------
        model : Model
            What is run over it.
        ship : ParameterSet or None
            Whose coefficients.

        Returns
        -------
        list of Notice
        """
        if ship is None:
            return []
        reached = self.amplitudes
        return beyond(
            model,
            ship,
            [] if self.speed is None else [self.speed],
            reached.get("rudder"),
            rate=reached.get("rate"),
            drift=reached.get("drift"),
        )
