"""How a target may move: the modes of one declared model, and its generated prediction for many targets at once."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from shipid.declaration.model import Model
from shipid.encounter.errors import EncounterRequestError
from shipid.encounter.tracking.filters.generated import STATES, predicted, turn_of
from shipid.estimation.multiple.cycle.moves import DisplacedMoves, GridMoves
from shipid.estimation.multiple.structures import AdaptiveGrid
from shipid.foundation.result import Result


@dataclass(frozen=True)
class TargetMode:
    """One way a target may move.

    Attributes
    ----------
    label : str
        What a figure or a table calls it.
    turn : float
        Value of the model's input: rate of turn in rad/s or curvature in rad/m, positive to starboard.
    acceleration : float
        Density of the white noise that drives each velocity, m/s^1.5.
    low, high : float
        Bounds of the turn, where the tracker adjusts it.
    more : float
        Standard deviation of the estimated part of the turn when a track begins, in the unit of `turn`; zero fixes it.
    stays : float
        Mean time a target keeps the mode, s.
    """

    label: str
    turn: float = 0.0
    acceleration: float = 0.25
    low: float = 0.0
    high: float = 0.0
    more: float = 0.0
    stays: float = 60.0


@dataclass(frozen=True, repr=False)
class Motion(Result):
    """The modes of a target and how the tracker treats them.

    Attributes
    ----------
    model : Model
        A declared model with the states x, y, vx, vy and the estimated part of a turn, and one input without a default: the turn.
    modes : tuple of TargetMode
        The one that moves straight on comes first where a track begins.
    structure : {"fixed", "variable", "grid"}
        Whether the turns of the modes stay as they are, follow their own estimates, or follow the mode probabilities.
    """

    TABLE: ClassVar[str] = "modes"

    model: Model
    modes: tuple[TargetMode, ...]
    structure: str = "fixed"

    def __post_init__(self) -> None:
        """Refuse modes that cannot be meant."""
        if not self.modes:
            raise EncounterRequestError("a motion needs at least one mode.")
        if turn_of(self.model) is None:
            raise EncounterRequestError(
                f"model {self.model.name} is no motion of a target: it has to have the states {', '.join(STATES)} and one more, and "
                "one input without a default."
            )
        for mode in self.modes:
            if not (mode.acceleration > 0 and mode.stays > 0 and mode.more >= 0 and mode.low <= mode.high):
                raise EncounterRequestError(
                    f"mode '{mode.label}' needs a positive acceleration noise and a positive mean time, and bounds in order."
                )
        if self.structure == "fixed":
            return
        bounds = sorted((m.low, m.high, m.label) for m in self.modes)
        for (_, high, one), (low, _, other) in itertools.pairwise(bounds):
            if high > low:
                raise EncounterRequestError(
                    f"the bounds of the modes '{one}' and '{other}' overlap: a turn would belong to both."
                )

    @property
    def turn(self) -> str:
        """The input that tells the modes apart: a rate of turn or a curvature."""
        named = turn_of(self.model)
        assert named is not None, "checked in __post_init__"
        return named[0]

    @property
    def transitions(self) -> np.ndarray:
        """Where a target goes that leaves a mode, shape (modes, modes): straight modes are entered as often as all turns."""
        turning = np.array([m.turn != 0 for m in self.modes], float)
        entered = np.where(turning > 0, 1.0 / max(turning.sum(), 1.0), 1.0 / max((1 - turning).sum(), 1.0))
        rows = np.tile(entered, (len(self.modes), 1)) * (1 - np.eye(len(self.modes)))
        total = rows.sum(axis=1, keepdims=True)
        return np.asarray(rows / np.where(total > 0, total, 1.0))

    def switching(self, interval: float) -> np.ndarray:
        """Return the probabilities of the mode after an interval, one row a mode before it.

        Parameters
        ----------
        interval : float
            In s.

        Returns
        -------
        ndarray, shape (modes, modes)
        """
        if len(self.modes) == 1:
            return np.ones((1, 1))
        stays = np.exp(-interval / np.array([m.stays for m in self.modes]))[:, None]
        return np.asarray(stays * np.eye(len(self.modes)) + (1 - stays) * self.transitions)

    @property
    def first_probabilities(self) -> np.ndarray:
        """MotionMode probabilities of a new track, shape (modes,): those of a target that was left alone for long."""
        found = np.full(len(self.modes), 1.0 / len(self.modes))
        step = self.switching(10.0)
        for _ in range(200):
            found = found @ step
        return found

    def predict(self, x: np.ndarray, P: np.ndarray, turn: np.ndarray, interval: float) -> tuple[np.ndarray, np.ndarray]:
        """Predict many targets over an interval, each in each mode.

        Parameters
        ----------
        x : ndarray, shape (n, modes, 5)
            Estimates: `STATES`, and the estimated part of the turn.
        P : ndarray, shape (n, modes, 5, 5)
            Their covariances.
        turn : ndarray, shape (n, modes)
            The turn of each mode.
        interval : float
            In s.

        Returns
        -------
        x, P : ndarray
            After the interval.
        """
        if not len(x):
            return x, P
        level = np.tile([m.acceleration for m in self.modes], (len(x), 1))
        return predicted(self.model, x, P, turn, level, interval)


@functools.lru_cache(maxsize=16)
def moves_of(motion: Motion) -> DisplacedMoves | GridMoves | None:
    """Return how the turns of the modes move after each scan; None where they stay.

    The same object comes back for equal motions, so that its function is generated once.

    Parameters
    ----------
    motion : Motion
        The modes.
    """
    modes, parameter = motion.modes, motion.turn
    if motion.structure == "variable":
        low, high = (np.array([getattr(m, end) for m in modes]) for end in ("low", "high"))
        return DisplacedMoves(parameter, (0,) * len(modes), low, high, True)
    if motion.structure == "grid":
        lower, middle, upper = np.argsort([m.turn for m in modes]).tolist()
        most = modes[upper].high
        return GridMoves(
            parameter, (upper, middle, lower), 0.5 * most, most, most, AdaptiveGrid.improbable, AdaptiveGrid.dominant
        )
    return None
