"""One target, from the confirmation of its track on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from shipid.encounter.closest_approach import ClosestApproach
from shipid.foundation.result import Result

#: How a track stands: held, told to be lost, or given up before the log ended.
Status = Literal["held", "lost", "ended"]


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

    @property
    def speed(self) -> np.ndarray:
        """Speed over the ground, shape (N,), m/s."""
        return np.asarray(np.hypot(self.x[:, 2], self.x[:, 3]))

    @property
    def course(self) -> np.ndarray:
        """Course over the ground, shape (N,), rad, within a turn."""
        return np.asarray(np.arctan2(self.x[:, 3], self.x[:, 2]) % (2 * np.pi))
