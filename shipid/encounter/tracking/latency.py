"""How late the time stamps of a sensor are, estimated with the tracks that several sensors share."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.encounter.tracking.filters.alpha_beta_filters import AlphaBetaFilters
from shipid.encounter.tracking.filters.target_filters import Expected, TargetFilters

#: Below this speed a track says nothing of a latency, m/s; the share of a plot that is surely a track's.
_MOVING, _SURELY = 1.0, 0.9


@dataclass
class Latency:
    """The latency of one sensor, by recursive least squares over the innovations along the velocities.

    Attributes
    ----------
    value : float
        s.
    std : float
        Its standard deviation; zero keeps the value.
    """

    value: float
    std: float

    def learn(
        self, filters: TargetFilters | AlphaBetaFilters, expected: Expected, shares: np.ndarray, tracks: np.ndarray
    ) -> None:
        """Take in the plots that surely belong to a moving track.

        Parameters
        ----------
        filters : TargetFilters or AlphaBetaFilters
            Before the update.
        expected : Expected
            Of the plots.
        shares : ndarray, shape (n, m + 1)
            Probability of no plot and of each.
        tracks : ndarray of bool, shape (n,)
            Those to learn from.
        """
        if not self.std or not expected.e.shape[2]:
            return
        best = filters.mu.argmax(axis=1)
        for i in np.flatnonzero(tracks & (shares[:, 1:].max(axis=1, initial=0.0) > _SURELY)):
            j, m = int(shares[i, 1:].argmax()), best[i]
            velocity = filters.x[i, m, 2:4]
            if np.hypot(*velocity) < _MOVING:
                continue
            # The plot lies where the target was: a later stamp shifts it back along the velocity.
            weighted = expected.inverse[i, m, j] @ velocity
            variance = self.std**2
            gain = variance / (1 + variance * float(velocity @ weighted))
            self.value -= gain * float(weighted @ expected.e[i, m, j])
            self.std = float(np.sqrt(gain))
