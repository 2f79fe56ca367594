"""The six tracks of the tracking experiment, its disturbances, and the reference a voyage is compared with.

Passenier (1989), section 6.4 and table 6.1; the numbers stand in ``tracks.toml``.
"""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from shipid.declaration.units import to_si
from shipid.foundation.errors import UnknownNameError
from shipid.prediction.following.planned_track import PlannedTrack
from shipid.prediction.following.wheel_over import TrackLeg
from shipid.prediction.sailing.simulated_ship import SimulatedShip

#: Samples of a still-water turn, one every interval of the experiment.
_TURN = 300


@dataclass(frozen=True)
class TrackExperiment:
    """The numbers of the experiment; SI.

    Attributes
    ----------
    leg : float
        Length of a leg in m.
    rudder_limit : float
        In rad.
    current, wind : tuple of float
        Speed in m/s, and the direction it flows TO in rad.
    interval : float
        Between two samples of the error in s.
    changes : mapping of str to float
        Changes of course in rad.
    tracks : mapping of str to tuple of str
        The changes of each track, in their order.
    """

    leg: float
    rudder_limit: float
    current: tuple[float, float]
    wind: tuple[float, float]
    interval: float
    changes: Mapping[str, float]
    tracks: Mapping[str, tuple[str, ...]]

    def legs(self, track: str) -> list[TrackLeg]:
        """Return the legs of a track, the first to the north; the sides of the changes alternate, to starboard first.

        Parameters
        ----------
        track : str
            ``T1`` to ``T6``.

        Raises
        ------
        UnknownNameError
            If there is no such track.
        """
        if track not in self.tracks:
            raise UnknownNameError("scenario", track, self.tracks)
        legs, course, x, y = [TrackLeg(0.0, 0.0, 0.0)], 0.0, 0.0, 0.0
        for k, name in enumerate(self.tracks[track]):
            x, y = x + self.leg * np.cos(course), y + self.leg * np.sin(course)
            course += (-1) ** k * self.changes[name]
            legs.append(TrackLeg(float(x), float(y), float(course)))
        return legs

    def reference(self, track: str, still_water: Callable[[], SimulatedShip]) -> PlannedTrack:
        """Return the track a voyage is compared with: legs joined by the ship's own still-water turn at the rudder limit.

        Parameters
        ----------
        track : str
            ``T1`` to ``T6``.
        still_water : callable
            Returns the ship at the origin on course 000, without current and wind.
        """
        legs = self.legs(track)
        points, arcs = [np.zeros((1, 2))], [(0, 0)]
        for before, after in pairwise(legs):
            change = after.course - before.course
            distance, turn = self.still_water_turn(abs(change), still_water())
            c, s = np.cos(before.course), np.sin(before.course)
            x, y = turn[:, 0] - distance, np.sign(change) * turn[:, 1]
            kept = np.hypot(x, y) < 0.5 * self.leg
            begin = sum(len(p) for p in points)
            points.append(np.stack([after.x + c * x - s * y, after.y + s * x + c * y], axis=1)[kept])
            arcs.append((begin, begin + len(points[-1]) - 1))
        last = legs[-1]
        end = last.x + self.leg * np.cos(last.course), last.y + self.leg * np.sin(last.course)
        points.append(np.array([end]))
        return PlannedTrack(tuple(legs), np.concatenate(points), arcs=np.array(arcs))

    def still_water_turn(self, change: float, ship: SimulatedShip) -> tuple[float, np.ndarray]:
        """Return where the wheel goes over before the waypoint in still water, in m, and the turn itself, shape (N, 2).

        Parameters
        ----------
        change : float
            Change of course in rad, to starboard.
        ship : SimulatedShip
            At the origin on course 000, without current and wind.
        """
        rows = [ship.now, *(ship.advance(self.interval, change, self.rudder_limit) for _ in range(_TURN))]
        x, y = (np.array([r[n] for r in rows]) for n in ("x", "y"))
        return float(x[-1] - y[-1] / np.tan(change)), np.stack([x, y], axis=1)


@functools.cache
def track_experiment() -> TrackExperiment:
    """Return the experiment as ``tracks.toml`` states it."""
    with (Path(__file__).parent / "tracks.toml").open("rb") as file:
        table = tomllib.load(file)

    def flow(name: str) -> tuple[float, float]:
        return to_si(table[name]["speed"], "m/s"), to_si(table[name]["to"], "rad")

    return TrackExperiment(
        to_si(table["leg"], "m"),
        to_si(table["rudder_limit"], "rad"),
        flow("current"),
        flow("wind"),
        to_si(table["interval"], "s"),
        {n: to_si(v, "rad") for n, v in table["changes"].items()},
        {n: tuple(v) for n, v in table["tracks"].items()},
    )
