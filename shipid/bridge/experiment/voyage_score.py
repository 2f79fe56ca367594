"""The score of a voyage along a track of the experiment: the RMS of (6.5), and the spread of the rate of turn of table 6.5."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from shipid.bridge.experiment.tracks import TrackExperiment
from shipid.bridge.shown.plain_values import number
from shipid.foundation.aliases import Plain
from shipid.foundation.result import Result, table
from shipid.prediction.following.planned_track import PlannedTrack

if TYPE_CHECKING:
    import pandas as pd

#: What the navigator sees: the planned track; the ground-speed vector as well; the predicted track; nothing, the track pilot sails.
Condition: TypeAlias = Literal["A", "B", "C", "D"]
CONDITIONS: tuple[Condition, ...] = ("A", "B", "C", "D")
#: The voyage ends where this share of the last leg is sailed.
_END = 0.9


class VoyageScore(Result):
    """Judges a voyage.

    Parameters
    ----------
    experiment : TrackExperiment
        Its numbers.
    scenario : str
        ``T1`` to ``T6``.
    condition : {"A", "B", "C", "D"}
        What the navigator sees.
    reference : PlannedTrack
        What the voyage is compared with.
    ended : callable, optional
        Called with the score when the end of the track is reached.

    Attributes
    ----------
    done : bool
        Whether the end of the track is reached.
    """

    def __init__(
        self,
        experiment: TrackExperiment,
        scenario: str,
        condition: Condition,
        reference: PlannedTrack,
        ended: Callable[[VoyageScore], None] | None = None,
    ) -> None:
        self.scenario, self.condition, self.done = scenario, condition, False
        self._experiment, self._reference, self._ended = experiment, reference, ended
        self._leg, self._last = 0, -math.inf
        count = len(reference.legs)
        self._squares, self._samples = np.zeros(count), np.zeros(count)
        self._rates: list[list[float]] = [[] for _ in range(count)]

    def add(self, t: float, values: Mapping[str, float]) -> None:
        """Take where the ship is.

        Parameters
        ----------
        t : float
            In s.
        values : mapping of str to float
            ``x``, ``y`` and ``r``, SI.
        """
        if self.done or t - self._last < self._experiment.interval - 1e-6:
            return
        self._last = t
        x, y = values["x"], values["y"]
        distance, leg = self._reference.off_track(x, y, self._leg)
        off, self._leg = float(distance[0]), max(int(leg[0]), 0)
        self._squares[self._leg] += off**2
        self._samples[self._leg] += 1
        self._rates[self._leg].append(values.get("r", 0.0))
        last = self._reference.legs[-1]
        self.done = self._leg == len(self._reference.legs) - 1 and last.along(x, y) > _END * self._experiment.leg
        if self.done and self._ended is not None:
            self._ended(self)

    @property
    def rms(self) -> float | None:
        """Root mean square of the distance from the reference in m: Passenier (1989), eq. (6.5)."""
        count = float(self._samples.sum())
        return math.sqrt(float(self._squares.sum()) / count) if count else None

    @property
    def spread(self) -> float | None:
        """Standard deviation of the rate of turn in rad/s: Passenier (1989), table 6.5."""
        every = [r for leg in self._rates for r in leg]
        return float(np.std(every)) if len(every) > 1 else None

    def by_leg(self) -> list[float | None]:
        """Return the root mean square of the distance on each leg in m."""
        return [math.sqrt(q / n) if n else None for q, n in zip(self._squares.tolist(), self._samples.tolist())]

    def to_dict(self) -> dict[str, Plain]:
        """Return what the page shows, SI."""
        return {
            "scenario": self.scenario, "condition": self.condition, "leg": self._leg, "of": len(self._reference.legs),
            "rms": number(self.rms, 5), "done": self.done, "spread": number(self.spread, 4),
        }  # fmt: skip

    def text(self) -> str:
        """Return the result in lines of text."""
        rms, spread = self.rms, self.spread
        if rms is None or spread is None:
            return f"experiment {self.scenario}, condition {self.condition}: nothing was sailed"
        changes = [math.degrees(self._experiment.changes[n]) for n in self._experiment.tracks[self.scenario]]
        legs = ["first leg", *(f"change of {c:.0f} deg" for c in changes)]
        lines = [
            f"experiment {self.scenario}, condition {self.condition}: {'the whole track' if self.done else 'NOT SAILED TO ITS END'}",
            f"  RMS distance from the reference, (6.5)   {rms:.1f} m",
            f"  spread of the rate of turn, table 6.5    {math.degrees(spread):.3f} deg/s",
        ]
        lines += [
            f"  {what:<40} {'not sailed' if value is None else f'{value:.1f} m'}"
            for what, value in zip(legs, self.by_leg())
        ]
        return "\n".join(lines)

    def to_frame(self) -> pd.DataFrame:
        """Return the root mean square of the distance on each leg as a pandas table."""
        return table(({"leg": k, "rms [m]": v} for k, v in enumerate(self.by_leg(), start=1)), "leg", ("rms [m]",))
