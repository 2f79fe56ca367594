"""A target's position and velocity by the multiple-model tracker, for many targets that are seen at the same scans."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from shipid.encounter.errors import EncounterRequestError
from shipid.estimation.multiple.interacting import InteractingMultipleModel
from shipid.estimation.multiple.modes import Mode
from shipid.parameters.catalogue import find_model

#: Probability that a target goes on as she does from one scan to the next.
_STAY = 0.9


@dataclass(frozen=True)
class TargetTracker:
    """An interacting multiple-model filter of straight motion and a turn to each side.

    Attributes
    ----------
    error : float
        Standard deviation of an observed coordinate, m.
    rate : float
        Rate of turn of the turning modes, rad/s.
    acceleration : float
        Standard deviation of the accelerations of all modes, m/s^2.
    """

    error: float
    rate: float = float(np.deg2rad(0.5))
    acceleration: float = 0.02

    def __post_init__(self) -> None:
        if not (self.error > 0 and self.rate > 0 and self.acceleration > 0):
            raise EncounterRequestError("a tracker needs an error, a rate of turn and an acceleration above zero.")

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
        ndarray, shape (..., scans, 4)
            Positions and velocities, m and m/s.
        """
        flat = seen.reshape(-1, *seen.shape[-2:])
        record = {"t": period * np.arange(flat.shape[1]), "x": flat[:, :, 0], "y": flat[:, :, 1]}
        runs = _filter_of(self).filter_runs(record)
        found = np.stack([runs[name] for name in ("x", "y", "vx", "vy")], axis=-1)
        return np.asarray(found.reshape(*seen.shape[:-1], 4))


@functools.lru_cache(maxsize=8)
def _filter_of(tracker: TargetTracker) -> InteractingMultipleModel:
    straight, turn = find_model("constant-velocity"), find_model("coordinated-turn")
    out = (1 - _STAY) / 2
    return InteractingMultipleModel(
        {
            "straight": Mode(straight),
            "port": Mode(turn, inputs={"omega": (-tracker.rate, "rad/s")}),
            "starboard": Mode(turn, inputs={"omega": (tracker.rate, "rad/s")}),
        },
        [[_STAY, out, out], [1 - _STAY, _STAY, 0.0], [1 - _STAY, 0.0, _STAY]],
        measured={"x": (tracker.error, "m"), "y": (tracker.error, "m")},
        noise={n: (tracker.acceleration, "m/s^2") for n in ("ax", "ay")},
    )
