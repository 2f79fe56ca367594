"""Where targets are and go by the filter of a turning ship, for many targets that are seen at the same scans."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.estimation.multiple.interacting import InteractingMultipleModel
from shipid.estimation.multiple.modes import Mode
from shipid.parameters.catalogue import find_model

#: Columns of a motion: positions, velocities, and the rate of turn of the course.
COLUMNS = ("x", "y", "vx", "vy", "omega")


@dataclass(frozen=True)
class TargetTracker:
    """The generated filter of a ship that turns at a rate which is estimated (model turning-at-unknown-rate).

    Attributes
    ----------
    error : float
        Standard deviation of an observed coordinate, m.
    acceleration : float
        Standard deviation of her accelerations, m/s^2.
    turning : float
        How fast her rate of turn wanders, rad/s per root second.
    rate : float
        Standard deviation of the rate of turn before the first scan, rad/s.
    """

    error: float
    acceleration: float = 0.02
    turning: float = 5e-4
    rate: float = float(np.deg2rad(0.7))

    def __post_init__(self) -> None:
        if not all(value > 0 for value in vars(self).values()):
            raise EncounterRequestError("a tracker needs an error, an acceleration and rates of turn above zero.")

    def motions(self, seen: np.ndarray, period: float) -> np.ndarray:
        """Return what is known of the targets at every scan, from the scans up to it.

        Parameters
        ----------
        seen : ndarray, shape (..., scans, 2)
            Observed positions, north and east, m.
        period : float
            From one scan to the next, s.

        Returns
        -------
        ndarray, shape (..., scans, 5)
            Positions in m, velocities in m/s and rate of turn in rad/s: `COLUMNS`.
        """
        flat = seen.reshape(-1, *seen.shape[-2:])
        record = {"t": period * np.arange(flat.shape[1]), "x": flat[:, :, 0], "y": flat[:, :, 1]}
        runs = _filter_of(self).filter_runs(record)
        found = np.stack([runs[name] for name in COLUMNS], axis=-1)
        return np.asarray(found.reshape(*seen.shape[:-1], len(COLUMNS)))


def along_arc(motion: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return where targets are if they go on turning as they do, at a steady speed.

    Parameters
    ----------
    motion : ndarray, shape (..., 5)
        As `TargetTracker.motions` returns it, at one scan.
    times : ndarray, shape (k,)
        s from it.

    Returns
    -------
    ndarray, shape (..., k, 2)
        North and east, m.
    """
    angle = motion[..., 4, None] * times
    # sin(a) / a and (1 - cos(a)) / a, without 0/0.
    along = np.sinc(angle / np.pi)
    across = np.sin(angle / 2) * np.sinc(angle / (2 * np.pi))
    vx, vy = motion[..., 2, None], motion[..., 3, None]
    way = np.stack([along * vx - across * vy, across * vx + along * vy], axis=-1)
    return np.asarray(motion[..., None, :2] + times[:, None] * way)


@functools.lru_cache(maxsize=8)
def _filter_of(tracker: TargetTracker) -> InteractingMultipleModel:
    """One mode is the plain filter; this form runs many records in one call."""
    return InteractingMultipleModel(
        {"turning": Mode(find_model("turning-at-unknown-rate"))},
        [[1.0]],
        measured={"x": (tracker.error, "m"), "y": (tracker.error, "m")},
        noise={
            "ax": (tracker.acceleration, "m/s^2"),
            "ay": (tracker.acceleration, "m/s^2"),
            "omega": (tracker.turning, "rad/s^1.5"),
        },
        initial={"omega": (tracker.rate, "rad/s")},
    )
