"""A recorded trial as the source of samples: what was measured comes as it was measured, and then the source has ended."""

from __future__ import annotations

from datetime import datetime

import numpy as np

from shipid.bridge.core.source import SourceKind, SourceReading, SourceState
from shipid.declaration.vocabulary import FIELDS
from shipid.foundation.errors import UsageError
from shipid.trials.trial import Trial


class ReplayedSource:
    """A trial, sample by sample.

    Parameters
    ----------
    trial : Trial
        The trial.

    Attributes
    ----------
    started : datetime or None
        The moment of its first sample, where it is known.
    trial : Trial
        The trial.
    simulated : bool
        Whether the trial is a simulation.

    Raises
    ------
    UsageError
        If it has fewer than two samples.
    """

    kind: SourceKind = "replay"
    timed = True

    def __init__(self, trial: Trial) -> None:
        if len(trial) < 2:
            raise UsageError(f"trial {trial.name} has {len(trial)} samples, too few to be replayed.")
        self._t = trial["t"] - trial["t"][0]
        names = [n for n in FIELDS if n != "t" and trial.has(n)]
        self._names, self._table = tuple(names), np.stack([trial[n] for n in names], axis=1)
        self._next = 0
        self.trial = trial
        self.started = _moment(trial.source.start)
        self.simulated = trial.source.simulated

    @property
    def state(self) -> SourceState:
        """Running, until the last sample was taken."""
        return "running" if self._next < self._t.size else "ended"

    async def start(self) -> None:
        """Nothing has to be opened."""

    async def stop(self) -> None:
        """Nothing has to be closed."""

    def take(self, t: float) -> SourceReading:
        """Return the newest value of every column up to a time, where it is newer than the reading before.

        Parameters
        ----------
        t : float
            In s on the bridge's clock.
        """
        end = int(np.searchsorted(self._t, t + 1e-9, side="right"))
        rows, self._next = self._table[self._next : end], max(end, self._next)
        values: dict[str, float] = {}
        if len(rows):
            there = np.isfinite(rows)
            last = len(rows) - 1 - there[::-1].argmax(axis=0)
            for k, name in enumerate(self._names):
                if there[last[k], k]:
                    values[name] = float(rows[last[k], k])
        return SourceReading(values)


def _moment(start: str | None) -> datetime | None:
    try:
        found = None if start is None else datetime.fromisoformat(start)
    except ValueError:
        return None
    return found if found is None or found.tzinfo is not None else None
