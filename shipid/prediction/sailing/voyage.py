"""A voyage along a route as a result: the trial, how far off the track the ship was, and where the wheel went over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.declaration.vocabulary import shown
from shipid.foundation.aliases import Plain
from shipid.foundation.notices import Notice, plain_notices
from shipid.foundation.numbers import brief
from shipid.foundation.result import DrawnResult, ResultEntry
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.routes.route import Route
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    import pandas as pd

#: A ship that is more ship lengths than this off the track does not follow the route.
_NOT_FOLLOWED = 2.0


@dataclass(frozen=True, repr=False)
class WheelOverDone(ResultEntry):
    """A wheel-over of a voyage.

    Attributes
    ----------
    waypoint : int
        Number of the waypoint, from 0.
    name : str
        What it is called.
    t : float
        When, in s.
    before : float
        Distance from the ship to the waypoint along the leg, in m.
    change : float
        Change of course in rad, positive to starboard.
    rudder_limit : float
        In rad.
    late : bool
        Whether the place for it was passed when the leg began: the turn takes more of the leg before it than there is.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"t": "s", "before": "m", "change": "rad", "rudder_limit": "rad"}

    waypoint: int
    name: str
    t: float
    before: float
    change: float
    rudder_limit: float
    late: bool = False

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        units = {"t": "s", "before": "m", "change": "rad", "rudder_limit": "rad"}
        found: dict[str, Plain] = {"waypoint": self.waypoint + 1, "name": self.name, "late": self.late}
        return found | {n: {"value": getattr(self, n), "unit": u} for n, u in units.items()}


@dataclass(frozen=True, repr=False)
class LimitLeft(ResultEntry):
    """A stretch of a voyage beyond a cross-track limit.

    Attributes
    ----------
    waypoint : int
        Number of the waypoint the leg leads to, from 0.
    name : str
        What it is called.
    side : {"port", "starboard"}
        On which side.
    begin, end : float
        From when to when, in s.
    beyond : float
        Farthest beyond the limit, in m.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"begin": "s", "end": "s", "beyond": "m"}

    waypoint: int
    name: str
    side: str
    begin: float
    end: float
    beyond: float

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        units = {"begin": "s", "end": "s", "beyond": "m"}
        return {"waypoint": self.waypoint + 1, "name": self.name, "side": self.side} | {
            n: {"value": getattr(self, n), "unit": u} for n, u in units.items()
        }


@dataclass(frozen=True, eq=False, repr=False)
class Voyage(DrawnResult):
    """A route that was sailed in simulation; made by `sail_route`.

    Attributes
    ----------
    trial : Trial
        What happened; beside the ship's own columns ``psi_order``, ``off_track`` (m, positive to starboard) and ``waypoint`` (the one
        that is sailed to, from 1).
    route : Route
        The route.
    plan : PlannedTrack
        Its track in local metres.
    off_track : ndarray, shape (N,)
        Distance from the track in m, positive to starboard.
    turning : ndarray of bool, shape (N,)
        Whether the ship turns.
    wheel_overs : tuple of WheelOverDone
        In their order.
    left : tuple of LimitLeft
        Where cross-track limits were left.
    arrived : bool
        Whether the end of the route was reached.
    warnings : tuple of Notice
        What limits it.
    """

    trial: Trial
    route: Route
    plan: PlannedTrack
    off_track: np.ndarray
    turning: np.ndarray
    wheel_overs: Sequence[WheelOverDone]
    left: Sequence[LimitLeft]
    arrived: bool
    warnings: Sequence[str] = ()

    @property
    def statistics(self) -> dict[str, tuple[float, float]]:
        """Root mean square and largest size of the distance off the track in m: all the way, on legs, in turns."""
        parts = {
            "whole": np.ones(self.turning.shape, dtype=bool),
            "legs": ~self.turning,
            "turns": self.turning,
        }
        return {
            n: (float(np.sqrt((self.off_track[m] ** 2).mean())), float(np.abs(self.off_track[m]).max()))
            for n, m in parts.items()
            if m.any()
        }

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON, SI."""
        return {
            "route": self.route.name,
            "trial": self.trial.name,
            "arrived": self.arrived,
            "duration": {"value": float(self.trial["t"][-1]), "unit": "s"},
            "off_track": {
                n: {"rms": {"value": rms, "unit": "m"}, "largest": {"value": most, "unit": "m"}}
                for n, (rms, most) in self.statistics.items()
            },
            "wheel_overs": [w.to_dict() for w in self.wheel_overs],
            "limits_left": [left.to_dict() for left in self.left],
            "warnings": plain_notices(self.warnings),
        }

    def text(self) -> str:
        """Return the result in lines of text."""
        duration = self.trial["t"][-1]
        end = f"its end after {duration:.0f} s" if self.arrived else f"its end not reached after {duration:.0f} s"
        lines = [f"route '{self.route.name}': {len(self.route)} waypoints, {end}"]
        words = {"whole": "all the way", "legs": "on legs", "turns": "in turns"}
        said = [f"{words[n]} {rms:.1f} m rms, {most:.0f} m at most" for n, (rms, most) in self.statistics.items()]
        lines.append(f"  off the track: {'; '.join(said)}")
        for w in self.wheel_overs:
            side, where = "starboard" if w.change > 0 else "port", "before" if w.before >= 0 else "behind"
            lines.append(
                f"  wheel over at {w.t:.0f} s, {abs(w.before):.0f} m {where} {w.name}: {shown(abs(w.change), 'psi', digits=3)} to {side} with "
                f"{shown(w.rudder_limit, 'delta', digits=2)} of rudder"
            )
        lines += [
            f"  cross-track limit to {left.side} left on the way to {left.name} from {left.begin:.0f} to {left.end:.0f} s, by "
            f"{left.beyond:.0f} m"
            for left in self.left
        ]
        if not self.left and self.plan.limits is not None and np.isfinite(self.plan.limits).any():
            lines.append("  cross-track limits kept")
        return "\n".join(lines)

    def to_frame(self) -> pd.DataFrame:
        """Return the trial of the voyage as a pandas table, units in the headers (`Trial.to_frame`)."""
        return self.trial.to_frame()


def not_followed(lengths: np.ndarray, route: Route, to: np.ndarray) -> list[Notice]:
    """Return what has to be said of a ship that does not follow the route.

    Parameters
    ----------
    lengths : ndarray, shape (N,)
        Distance off the track in ship lengths.
    route : Route
        What was to be sailed.
    to : ndarray of int, shape (N,)
        The waypoint that is sailed to, from 0.
    """
    worst = int(np.abs(lengths).argmax())
    most = float(abs(lengths[worst]))
    if most <= _NOT_FOLLOWED:
        return []
    return [
        Notice(
            f"the ship is up to {brief(most, 2)} ship lengths off the track, on the way to {route.called(int(to[worst]))}: the turns of the route "
            "are tighter, or closer together, than she sails them here.",
            "route-not-followed",
            serious=True,
            ship_lengths=most,
        )
    ]


def too_late(done: Sequence[WheelOverDone]) -> list[Notice]:
    """Return what has to be said of turns that begin too late, since the legs before them are too short.

    Parameters
    ----------
    done : sequence of WheelOverDone
        Of a voyage, with their names.
    """
    return [
        Notice(
            f"the wheel goes over to the turn at {w.name} {'at the start' if w.t == 0 else f'{w.t:.0f} s after the start'}, and that is late: "
            f"with {shown(w.rudder_limit, 'delta', digits=2)} of rudder her turn takes more of the leg before it than there is. Allow more rudder, "
            "or lengthen the leg.",
            "wheel-over-late",
            waypoint=w.waypoint + 1,
        )
        for w in done
        if w.late
    ]


def limits_left(
    plan: PlannedTrack, route: Route, t: np.ndarray, off: np.ndarray, on: np.ndarray
) -> tuple[LimitLeft, ...]:
    """Return the stretches beyond a limit, each on one side and on the way to one waypoint.

    Parameters
    ----------
    plan : PlannedTrack
        What was to be sailed.
    route : Route
        Its route.
    t, off : ndarray, shape (N,)
        Times in s, and distances off the track in m, positive to starboard.
    on : ndarray of int, shape (N,)
        Numbers of the legs.
    """
    beyond_by = plan.beyond_limits(off, on)
    to = np.array(plan.waypoints)[on]
    key = np.where(beyond_by > 0, np.where(off > 0, 1, -1) * (to + 1), 0)
    begins = np.flatnonzero(np.diff(key, prepend=0))
    found = []
    for a, b in zip(begins, [*begins[1:], len(key)]):
        if key[a]:
            found.append(
                LimitLeft(
                    int(to[a]), route.called(int(to[a])), "starboard" if key[a] > 0 else "port", float(t[a]), float(t[b - 1]),
                    float(beyond_by[a:b].max()),
                )
            )  # fmt: skip
    return tuple(found)
