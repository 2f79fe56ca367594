"""Columns that follow from others of a log, sample by sample: by the rules of a whole log, with the last value held between samples."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from shipid.trials.logs.following import with_speeds, with_true_wind
from shipid.trials.logs.live.table import LiveSample

#: A heading or a speed is held for so long [s] to turn a relative wind into a true one.
_HELD = 10.0
_SHIP = ("psi", "u", "v", "U", "SOG", "COG")
_RELATIVE = ("wind_speed_relative", "wind_direction_relative")


class LiveFollowing:
    """Adds speeds and the true wind to samples, where the log holds only what they follow from.

    Parameters
    ----------
    where : str
        The log, for messages.
    tell : callable
        Takes each note once.

    Attributes
    ----------
    names : tuple of str
        What was worked out so far.
    """

    def __init__(self, where: str, tell: Callable[[str], None]) -> None:
        self.names: tuple[str, ...] = ()
        self._where, self._tell = where, tell
        self._told: set[str] = set()
        self._recorded: set[str] = set()
        self._last: dict[str, tuple[float, float]] = {}

    def complete(self, sample: LiveSample) -> LiveSample:
        """Return a sample with what follows from it.

        Parameters
        ----------
        sample : LiveSample
            As it was read.

        Returns
        -------
        LiveSample
        """
        values = sample.values
        self._recorded.update(values)
        followed = with_speeds({n: np.array([v]) for n, v in values.items()}) if "beta" in values else None
        found = {} if followed is None else {n: float(v[0]) for n, v in followed.values.items()}
        notes = [] if followed is None else list(followed.notes)
        for name in _SHIP:
            value = values.get(name, found.get(name, math.nan))
            if math.isfinite(value):
                self._last[name] = values["t"], value
        if values.keys() >= set(_RELATIVE) and "wind_speed" not in self._recorded:
            ship = {n: v for n, (then, v) in self._last.items() if 0 <= values["t"] - then <= _HELD}
            known = {"t": values["t"], **ship, **{n: values[n] for n in _RELATIVE}}
            wind = with_true_wind({n: np.array([v]) for n, v in known.items()})
            found |= {n: float(v[0]) for n, v in wind.values.items() if n not in known}
            notes += wind.notes
        for note in notes:
            if note not in self._told:
                self._told.add(note)
                self._tell(f"{self._where}: {note}")
        new = {n: v for n, v in found.items() if n not in self._recorded}
        self.names += tuple(n for n in new if n not in self.names)
        return LiveSample(sample.line, values | new) if new else sample
