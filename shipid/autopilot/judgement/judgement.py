"""The result of judging a design: margins, robustness, course changes, and the weakest point in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.autopilot.course_changes.course_changes import CourseChange
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.judgement.limits import ANGLES, LIMITS
from shipid.autopilot.judgement.margins import Margins
from shipid.autopilot.judgement.not_reached import not_reached
from shipid.autopilot.judgement.robust_margins import Robustness
from shipid.autopilot.on_board.on_board_runs import OnBoardRuns
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import brief, columns_of, quantity, with_units
from shipid.foundation.result import DrawnResult, Result, ResultEntry

if TYPE_CHECKING:
    import pandas as pd

#: The course change that every draw of the ship makes, and those whose histories are kept, in degrees.
SAMPLE_CHANGE, SHOWN_CHANGES = 60.0, (10.0, 60.0, 120.0)

#: Overshoots of less than this many degrees do not count as weak: the limit of one is at least this.
LEAST_OVERSHOOT = 1.0


@dataclass(frozen=True, repr=False)
class Weakest(ResultEntry):
    """The weakest point of a design.

    Attributes
    ----------
    what, where : str
        The quantity, and the speed, the draw or the manoeuvre.
    value, limit : float
        Its value, and its limit.
    unit : str
        Of both; may be empty.
    share : float
        How much of the limit is met: below 1 it is not.
    """

    what: str
    where: str
    value: float
    limit: float
    unit: str
    share: float

    @property
    def sentence(self) -> str:
        """In plain words."""
        unit = f" {self.unit}" if self.unit else ""
        kept = "within" if self.share >= 1 else "beyond"
        return f"The weakest point is the {self.what} {self.where}: {brief(self.value, 3)}{unit}, {kept} its limit of {brief(self.limit, 3)}{unit}."

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values."""
        return asdict(self)


@dataclass(frozen=True, eq=False, repr=False)
class LoopResponse(Result):
    """The loop, opened at the rudder order, against frequency: a Nyquist curve.

    Attributes
    ----------
    speed : float
        In m/s.
    omega : ndarray, shape (n,)
        Frequencies in rad/s.
    response : ndarray of complex, shape (n,)
        Of the loop.
    """

    TABLE: ClassVar[str] = "omega"
    UNITS: ClassVar[Mapping[str, str]] = {"speed": "m/s", "omega": "rad/s", "response": "1"}

    speed: float
    omega: np.ndarray
    response: np.ndarray


@dataclass(frozen=True, eq=False, repr=False)
class Judgement(DrawnResult):
    """A design, judged; made by `shipid.judge`.

    Attributes
    ----------
    pilot : Autopilot
        The design.
    margins : tuple of tuple of Margins
        At the speeds of the schedule, for each load condition.
    between : tuple of tuple of Margins
        In the middle between two speeds.
    robust : tuple of Robustness
        For each load condition.
    steps : tuple of CourseChange
        In calm.
    in_weather : tuple of CourseChange
        In wind, waves and current.
    weather : mapping of str to float
        The wind, waves and current.
    responses : tuple of LoopResponse
        The loop against frequency at some speeds.
    histories : mapping of str to ndarray, shape (changes, n)
        Course changes of `SHOWN_CHANGES` at the ship's own speed: ``t``, ``psi`` and ``delta``, SI.
    drawn_histories : mapping of str to ndarray, shape (1 + draws, n)
        The sample course change of the ship as it is, then of some draws: ``t``, ``psi`` and ``delta``, SI.
    on_board : OnBoardRuns or None
        Runs with the Kalman filter in the loop, where they were requested.
    warnings : tuple of str
        Those of the design, and those of the judgement.
    limits : mapping of str to float
        Those of `shipid.autopilot.judgement.limits.LIMITS`, or those that were asked for.
    """

    pilot: Autopilot
    margins: tuple[tuple[Margins, ...], ...]
    between: tuple[tuple[Margins, ...], ...]
    robust: tuple[Robustness, ...]
    steps: tuple[CourseChange, ...]
    in_weather: tuple[CourseChange, ...]
    weather: Mapping[str, float]
    responses: tuple[LoopResponse, ...]
    histories: Mapping[str, np.ndarray]
    drawn_histories: Mapping[str, np.ndarray]
    on_board: OnBoardRuns | None
    warnings: tuple[str, ...]
    limits: Mapping[str, float] = field(default_factory=lambda: dict(LIMITS))

    @property
    def not_reached(self) -> tuple[str, ...]:
        """What no run reached, a sentence an entry: courses in weather, course changes that do not settle."""
        return not_reached(self.steps, self.in_weather, self.robust, self.on_board)

    @property
    def weakest(self) -> Weakest:
        """The point that meets the least of its limit."""
        return min(self.points(), key=lambda w: w.share)

    def points(self) -> list[Weakest]:
        """Return every quantity with a limit at its worst place."""
        found = []
        for j, name in enumerate(self.pilot.conditions):
            load = f" ({name})" if len(self.pilot.conditions) > 1 else ""
            everywhere = (*self.margins[j], *self.between[j])
            worst = min(everywhere, key=lambda m: m.disk)
            found.append(
                _point("disk margin", f"at {brief(worst.speed, 3)} m/s{load}", worst.disk, self.limits["disk margin"])
            )
            robust = self.robust[j]
            if robust.samples:
                where = f"over the uncertainty of the ship, at {brief(robust.speed_worst, 3)} m/s{load}"
                found.append(_point("disk margin", where, robust.disk_worst, self.limits["disk margin"]))
            filtered = robust.variants["sea filter on"]["disk"]
            if filtered is not None:
                found.append(
                    _point("disk margin", f"while the sea filter is on{load}", filtered, self.limits["disk margin"])
                )
            gains = [(min(x for x in (m.gain_high, 1 / m.gain_low if m.gain_low else None) if x), m.speed)
                     for m in everywhere if m.gain_high or m.gain_low]  # fmt: skip
            if gains:
                value, speed = min(gains)
                found.append(
                    _point("gain margin", f"at {brief(speed, 3)} m/s{load}", value, self.limits["gain margin"])
                )
            phases = [(m.phase_deg, m.speed) for m in everywhere if m.phase_deg is not None]
            if phases:
                value, speed = min(phases)
                found.append(
                    _point("phase margin", f"at {brief(speed, 3)} m/s{load}", value, self.limits["phase margin"], "deg")
                )
        return found + self._of_course_changes()

    def _of_course_changes(self) -> list[Weakest]:
        found = []
        changes = [s for s in self.steps if s.change_deg]
        for s in changes:
            where = f"in a course change of {brief(abs(s.change_deg), 3)} deg at {brief(s.speed, 3)} m/s"
            limit = max(self.limits["overshoot"] * abs(s.change_deg), LEAST_OVERSHOOT)
            if s.lost or s.overshoot_deg is None:
                found.append(Weakest("course change", where.removeprefix("in a course change "), 0.0, 1.0, "", 0.0))
            elif s.overshoot_deg > 0:
                found.append(Weakest("overshoot", where, s.overshoot_deg, limit, "deg", limit / s.overshoot_deg))
        errors = [
            (abs(s.mean_error_deg), s)
            for s in self.in_weather
            if s.mean_error_deg is not None and s.sea_filter and not s.change_deg
        ]
        if errors:
            value, s = max(errors, key=lambda e: e[0])
            limit = self.limits["steady error in wind"]
            found.append(
                Weakest("steady error in wind", f"with {s.weather}", value, limit, "deg", limit / max(value, 1e-9))
            )
        return found

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON: lists under ``gains``, ``poles`` and ``margins`` run along ``speeds``; no NaN."""
        first = self.pilot.to_dict()
        found = {n: first[n] for n in ("model", "ship", "design", "mode", "request", "service_speed", "rudder_limit")}
        found |= {
            "speeds": first["speeds"],
            "gains": first["gains"],
            "poles": first["poles"],
            "margins": _listed(self.margins[0]),
            "between": [m.to_dict() for m in self.between[0]],
            "robust": self.robust[0].to_dict(),
            "steps": [s.to_dict() for s in self.steps],
            "weather": {**with_units(self.weather), "runs": [s.to_dict() for s in self.in_weather]},
            "weakest": self.weakest.to_dict(),
            "not_reached": list(self.not_reached),
            "limits": {n: quantity(v, "deg" if n in ANGLES else "1") for n, v in self.limits.items()},
        }
        if "conditions" in first:
            found["conditions"] = {
                name: {
                    **first["conditions"][name],
                    "margins": _listed(self.margins[j]),
                    "robust": self.robust[j].to_dict(),
                }
                for j, name in enumerate(self.pilot.conditions)
            }
        if self.on_board is not None:
            found["on_board"] = self.on_board.to_dict()
        return found | {"warnings": plain_notices(self.warnings)}

    def to_frame(self) -> pd.DataFrame:
        """Return the margins as a pandas table, a row for each load condition and speed."""
        import pandas as pd

        rows = [
            {"condition": name, **columns_of(m.to_dict())}
            for name, margins in zip(self.pilot.conditions, self.margins)
            for m in margins
        ]
        return pd.DataFrame(rows).set_index(["condition", "speed [m/s]"])

    def text(self) -> str:
        """Return the result in lines of text."""
        head, _, rest = self.pilot.text().partition("\n")
        lines = [head, self.weakest.sentence, rest]
        for name, robust, *loops in zip(self.pilot.conditions, self.robust, self.margins, self.between):
            load = f" ({name})" if len(self.pilot.conditions) > 1 else ""
            lines.append(f"  margins{load}: {_worst_of([m for loop in loops for m in loop])}")
            if robust.samples:
                lines.append(
                    f"  uncertain ship{load}: worst disk margin {brief(robust.disk_worst, 3)} over {robust.samples} draws ({robust.source})"
                )
        lines += [f"  {words}" for words in self.not_reached]
        if self.on_board is not None:
            lines.append(self.on_board.text())
        said = (*self.pilot.warnings, *(self.on_board.warnings if self.on_board else ()))
        return "\n".join([*lines, *(f"  {w}" for w in self.warnings if w not in said)])


def _point(what: str, where: str, value: float, limit: float, unit: str = "") -> Weakest:
    return Weakest(what, where, float(value), limit, unit, float(value) / limit)


def _worst_of(margins: Sequence[Margins]) -> str:
    """The least margins and the largest peaks of some loops, in words."""
    phases = [m.phase_deg for m in margins if m.phase_deg is not None]
    delays = [m.delay_s for m in margins if m.delay_s is not None]
    return (
        f"disk {brief(min(m.disk for m in margins), 3)}"
        + (f", phase {min(phases):.0f} deg" if phases else "")
        + (f", delay {brief(min(delays), 3)} s" if delays else "")
        + f" at least; peaks of S {brief(max(m.sensitivity for m in margins), 3)} and of T "
        f"{brief(max(m.complementary for m in margins), 3)} at most"
    )


def _listed(margins: tuple[Margins, ...]) -> dict[str, Plain]:
    names = {"gain": "gain", "gain_low": "gain_low", "gain_high": "gain_high", "phase_deg": "phase_deg",
             "delay_s": "delay_s", "disk": "disk", "bandwidth_rad_s": "bandwidth", "sensitivity_peak": "sensitivity",
             "complementary_peak": "complementary"}  # fmt: skip
    return with_units({key: [getattr(m, name) for m in margins] for key, name in names.items()})
