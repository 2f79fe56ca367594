"""Where a run leaves the range in which its model is valid: the first sample at which a guard's margin is negative."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.declaration.guard import NOT_SAILED
from shipid.declaration.model import Model
from shipid.foundation.numbers import moment
from shipid.foundation.result import ResultEntry

#: The reason where a run has no finite number any more.
RUNS_AWAY = "the model runs away"


@dataclass(frozen=True, repr=False)
class Departure(ResultEntry):
    """The moment from which a run is no statement about a ship.

    Attributes
    ----------
    time : float
        In s, on the clock of the run.
    reason : str
        What is the case from then on.
    guard : str
        The guard of the model; empty where the run is not finite.
    """

    time: float
    reason: str
    guard: str = ""

    def __str__(self) -> str:
        return f"{NOT_SAILED}: {self.reason} from {moment(self.time)} s on"


def first_departure(
    model: Model, t: np.ndarray, margins: Mapping[str, np.ndarray], columns: np.ndarray | None = None
) -> Departure | None:
    """Return where a run first leaves the range of its model, or None.

    Parameters
    ----------
    model : Model
        What ran.
    t : ndarray, shape (N,)
        Times in s.
    margins : mapping of str to ndarray, shape (N,)
        By guard; a guard is active where its margin is negative, and where it is no number the model has run away.
    columns : ndarray, shape (n, N), optional
        What has to be finite as well.

    Returns
    -------
    Departure or None
    """
    found = []
    if columns is not None and not np.isfinite(columns).all():
        found.append(Departure(float(t[np.argmin(np.isfinite(columns).all(axis=0))]), RUNS_AWAY))
    for name, margin in margins.items():
        active = ~(margin >= 0)
        if active.any():
            first = int(np.argmax(active))
            lost = not np.isfinite(margin[first])
            found.append(Departure(float(t[first]), *((RUNS_AWAY,) if lost else (model[name].quantity.meaning, name))))
    # The guard of the model, where a run becomes infinite at the same sample.
    return min(found, key=lambda d: (d.time, not d.guard), default=None)
