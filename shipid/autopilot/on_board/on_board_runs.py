"""The result of running an autopilot on board: course changes by the instruments and by the Kalman filter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from shipid.autopilot.course_changes.course_changes import CourseChange
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import brief, columns_of, quantity
from shipid.foundation.result import Result

if TYPE_CHECKING:
    import pandas as pd

#: What is adapted to the filter's estimates of the ship: nothing, the gains, or a reference that the ship follows.
Adaptation = Literal["none", "gains", "reference"]
#: The feedback of the autopilot.
Feedback = Literal["instruments", "filter"]


@dataclass(frozen=True, eq=False, repr=False)
class OnBoardRun(Result):
    """Course changes of one voyage, one after the other.

    Attributes
    ----------
    feedback : {"instruments", "filter"}
        The feedback of the autopilot: heading and rate of turn as the instruments show them, or as the filter estimates them.
    weather : str
        "calm", or the weather.
    changes : tuple of CourseChange
        In the order of the voyage; a change of zero is a course kept.
    error_deg : float or None
        Root mean square of the heading fed back less the ship's heading, in degrees; None where the run diverged.
    histories : mapping of str to ndarray, shape (n,)
        ``t``, ``psi_order``, ``psi``, ``delta`` of the whole voyage, thinned, SI; not a number from a departure on.
    departure : str or None
        Where the run leaves the range in which the model is valid, and why; nothing is measured from there on.
    """

    TABLE: ClassVar[str] = "changes"

    feedback: Feedback
    weather: str
    changes: tuple[CourseChange, ...]
    error_deg: float | None
    histories: Mapping[str, np.ndarray]
    departure: str | None = None

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, without the histories."""
        return {
            "feedback": self.feedback,
            "weather": self.weather,
            "heading_error_rms": quantity(self.error_deg, "deg"),
            "changes": [c.to_dict() for c in self.changes],
            "not_sailed": self.departure,
        }


@dataclass(frozen=True, eq=False, repr=False)
class OnBoardRuns(Result):
    """An autopilot on board, with and without its filter; made by `shipid.run_on_board`.

    Attributes
    ----------
    ship, kalman : str
        Names of the ship and of the filter's model.
    sensors : mapping of str to str
        Standard deviation of one sample of each sensor.
    interval : float
        Between two samples, in s.
    adaptation : {"none", "gains", "reference"}
        What is adapted to the filter's estimates of the ship, where the filter is fed back.
    runs : tuple of OnBoardRun
        By the instruments and by the filter, in calm and in weather.
    warnings : tuple of str
        Notes for the reader.
    """

    ship: str
    kalman: str
    sensors: Mapping[str, str]
    interval: float
    adaptation: Adaptation
    runs: tuple[OnBoardRun, ...]
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, free of NaN."""
        return {
            "ship": self.ship,
            "filter": self.kalman,
            "sensors": dict(self.sensors),
            "interval": quantity(self.interval, "s"),
            "adaptation": self.adaptation,
            "runs": [r.to_dict() for r in self.runs],
            "warnings": plain_notices(self.warnings),
        }

    def to_frame(self) -> pd.DataFrame:
        """Return a pandas table with a row for each course change."""
        import pandas as pd

        rows = [{"feedback": r.feedback, **columns_of(c.to_dict())} for r in self.runs for c in r.changes]
        return pd.DataFrame(rows).drop(columns=["sea_filter"]).set_index(["feedback", "weather", "change [deg]"])

    def text(self) -> str:
        """Return the result in lines of text."""
        sensors = ", ".join(f"{n} {level}" for n, level in self.sensors.items())
        adapted = {"none": "gains of the schedule", "gains": "gains adapted", "reference": "model reference"}
        head = (
            "change [deg]",
            "overshoot [deg]",
            "settling [s]",
            "rms error [deg]",
            "rms rudder [deg]",
            "reversals a minute",
        )
        lines = [
            f"on board, a sample every {brief(self.interval)} s: filter {self.kalman} ({sensors}), {adapted[self.adaptation]}",
            " " * 41 + "".join(h.rjust(len(h) + 2) for h in head),
        ]
        for run in self.runs:
            for c in run.changes:
                turned = bool(c.change_deg)
                numbers = (
                    f"{c.change_deg:g}",
                    _number(c.overshoot_deg if turned else None, 2),
                    _number(c.settling_s if turned else None, 0),
                    _number(c.rms_error_deg, 2),
                    _number(c.rms_rudder_deg, 2),
                    "diverged" if c.lost else _number(c.reversals, 1),
                )
                cells = "".join(n.rjust(len(h) + 2) for n, h in zip(numbers, head))
                lines.append(f"  {run.feedback}, {run.weather}".ljust(41) + cells)
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings)])


def _number(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"
