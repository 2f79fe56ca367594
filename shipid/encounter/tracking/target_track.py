"""One target, from the confirmation of its track on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from shipid.encounter.closest_approach import ClosestApproach
from shipid.foundation.result import Result

if TYPE_CHECKING:
    import pandas as pd

#: Columns of a track and their units.
COLUMNS: Mapping[str, str] = {
    "track": "1", "t": "s", "x": "m", "y": "m", "vx": "m/s", "vy": "m/s", "SOG": "m/s", "COG": "rad", "turn_rate": "rad/s",
    "x_std": "m", "y_std": "m", "vx_std": "m/s", "vy_std": "m/s", "existence": "1", "held": "1", "widening": "1",
}  # fmt: skip
#: How a track stands: held, told to be lost, or given up before the log ended.
Status = Literal["held", "lost", "ended"]
#: A speed of so many standard deviations is not that of something that lies still.
_SURELY = 2.5


@dataclass(frozen=True, eq=False, repr=False)
class TargetTrack(Result):
    """One target, from its confirmation on.

    Attributes
    ----------
    number : int
        Of the track.
    t : ndarray, shape (N,)
        Times of scans, s.
    x : ndarray, shape (N, 4)
        North and east position and velocity, m and m/s.
    P : ndarray, shape (N, 4, 4)
        Covariance, widened.
    widening : ndarray, shape (N,)
        By how much the covariance is larger than that of the filter, because the residuals of the track contradict it.
    mu : ndarray, shape (N, modes)
        MotionMode probabilities.
    turn_rate : ndarray, shape (N,)
        rad/s, positive to starboard.
    existence : ndarray, shape (N,)
        Probability that there is a target.
    held : ndarray of bool, shape (N,)
        Whether the track is held; where it is not, it says that it is lost.
    status : {"held", "lost", "ended"}
        How it stands at the end of the log.
    approach : ClosestApproach or None
        To own ship, from the last estimate; None where own ship's motion is not known or the track is not held.
    """

    number: int
    t: np.ndarray
    x: np.ndarray
    P: np.ndarray
    widening: np.ndarray
    mu: np.ndarray
    turn_rate: np.ndarray
    existence: np.ndarray
    held: np.ndarray
    status: Status
    approach: ClosestApproach | None = None

    def to_frame(self) -> pd.DataFrame:
        """Return the track as a pandas table, one row a scan, SI; ``attrs["units"]`` holds the units."""
        import pandas as pd

        spread = np.sqrt(np.maximum(np.diagonal(self.P, axis1=1, axis2=2), 0.0))
        columns = (
            np.full(self.t.size, self.number), self.t, *self.x.T, self.speed, self.course, self.turn_rate, *spread.T,
            self.existence, self.held.astype(int), self.widening,
        )  # fmt: skip
        frame = pd.DataFrame(dict(zip(COLUMNS, columns)))
        frame.attrs["units"] = dict(COLUMNS)
        return frame

    @property
    def speed(self) -> np.ndarray:
        """Speed over the ground, shape (N,), m/s."""
        return np.asarray(np.hypot(self.x[:, 2], self.x[:, 3]))

    @property
    def course(self) -> np.ndarray:
        """Course over the ground, shape (N,), rad, within a turn."""
        return np.asarray(np.arctan2(self.x[:, 3], self.x[:, 2]) % (2 * np.pi))

    @property
    def speed_std(self) -> np.ndarray:
        """Standard deviation of the speed, shape (N,), m/s."""
        return self._spread(self.x[:, 2:])

    @property
    def course_std(self) -> np.ndarray:
        """Standard deviation of the course, shape (N,), rad; that of any course at all where the target may lie still."""
        across = self._spread(np.stack([-self.x[:, 3], self.x[:, 2]], axis=1))
        return np.asarray(np.minimum(across / np.maximum(self.speed, 1e-9), np.pi / np.sqrt(3)))

    @property
    def moves(self) -> np.ndarray:
        """Whether the target surely moves, of shape (N,): speed and course of a buoy are noise."""
        return np.asarray(self.speed > _SURELY * self.speed_std)

    def _spread(self, direction: np.ndarray) -> np.ndarray:
        """Standard deviation of the velocity along directions, shape (N,)."""
        along = direction / np.maximum(np.hypot(*direction.T), 1e-9)[:, None]
        return np.asarray(np.sqrt(np.maximum(np.einsum("ni,nij,nj->n", along, self.P[:, 2:, 2:], along), 0.0)))
