"""A route: waypoints, and the legs that lead to them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Literal, get_args

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.notices import plain_notices
from shipid.foundation.numbers import brief
from shipid.foundation.result import Result, ResultEntry, table
from shipid.prediction.routes.errors import RouteError, RouteSizeError, WaypointError
from shipid.prediction.routes.sailings import turned
from shipid.trials.logs.geodesy import to_geographic, to_local

if TYPE_CHECKING:
    import pandas as pd

#: How a leg leads to its waypoint.
LegGeometry = Literal["loxodrome", "great circle"]
#: Most waypoints of a route.
MOST_WAYPOINTS = 10_000
#: Waypoints nearer to each other than this, in m, are one place. A degree of latitude is 111 km.
_ONE_PLACE, _METRES = 0.01, 111e3
#: No turn and no cross-track limit is larger, in m; no ship is faster, in m/s.
_LARGEST, _FASTEST = 185_200.0, 100.0
#: No local position is farther away, in m.
_FARTHEST = 1e7
_LONGEST_NAME = 200


@dataclass(frozen=True, repr=False)
class Waypoint(ResultEntry):
    """A waypoint, and the leg that leads to it.

    Attributes
    ----------
    position : tuple of float
        Latitude and longitude in rad, or metres to the north and to the east (`Route.geographic`).
    name : str
        Its name; empty where it has none.
    radius : float or None
        Radius of the turn at it in m; None where none is stated.
    xtd_port, xtd_starboard : float or None
        Cross-track limits of the leg that leads to it, in m to each side; None where none is stated.
    geometry : {"loxodrome", "great circle"}
        The line of that leg.
    speed : float or None
        Planned speed on that leg in m/s; None where none is stated.
    """

    UNITS: ClassVar[Mapping[str, str]] = {"radius": "m", "xtd_port": "m", "xtd_starboard": "m", "speed": "m/s"}

    position: tuple[float, float]
    name: str = ""
    radius: float | None = None
    xtd_port: float | None = None
    xtd_starboard: float | None = None
    geometry: LegGeometry = "loxodrome"
    speed: float | None = None


@dataclass(frozen=True, repr=False)
class Route(Result):
    """Waypoints in the order in which they are sailed.

    Attributes
    ----------
    name : str
        Name of the route.
    waypoints : tuple of Waypoint
        Two at least.
    geographic : bool
        Whether positions are latitude and longitude in rad; otherwise they are metres to the north and to the east.
    notes : tuple of str or Notice
        What was found out when it was read.

    Raises
    ------
    RouteError
        If there are fewer than two waypoints, or two that follow each other are one place.
    RouteSizeError
        If there are more than `MOST_WAYPOINTS`.
    WaypointError
        If a position, a radius, a limit, a speed or a geometry cannot be.
    """

    name: str
    waypoints: tuple[Waypoint, ...]
    geographic: bool = True
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        count = len(self.waypoints)
        if count < 2:
            only = "one waypoint" if count else "no waypoint"
            raise RouteError(f"route '{self.name}' has {only}, and a route leads from one to another: add waypoints.")
        if count > MOST_WAYPOINTS:
            raise RouteSizeError(
                f"route '{self.name}' has {count} waypoints, and at most {MOST_WAYPOINTS} are read. Cut it into parts."
            )
        for k in range(count):
            self._check(k)
        at = self.positions
        away = np.diff(at, axis=0)
        if self.geographic:
            away[:, 1] = turned(away[:, 1]) * np.cos(at[1:, 0])
            away = np.rad2deg(away) * _METRES
        near = np.flatnonzero(np.hypot(away[:, 0], away[:, 1]) < _ONE_PLACE)
        if near.size:
            k = int(near[0])
            raise RouteError(f"{self.called(k)} and {self.called(k + 1)} are one place: remove one of them.")

    def _check(self, k: int) -> None:
        point = self.waypoints[k]
        first, second = point.position
        if not (math.isfinite(first) and math.isfinite(second)):
            raise WaypointError(f"{self.called(k)}: its position is no pair of numbers.")
        if self.geographic and (abs(first) > math.pi / 2 + 1e-12 or abs(second) > math.pi + 1e-12):
            raise WaypointError(
                f"{self.called(k)}: latitude {math.degrees(first):.7g} deg, longitude {math.degrees(second):.7g} deg is no place on "
                "the earth: latitudes lie between -90 and 90 deg, longitudes between -180 and 180 deg."
            )
        if not self.geographic and max(abs(first), abs(second)) > _FARTHEST:
            raise WaypointError(
                f"{self.called(k)}: {brief(first, 4)} m, {brief(second, 4)} m is no place in local metres."
            )
        for what, value, most, unit in (
            ("the radius of the turn", point.radius, _LARGEST, "m"),
            ("the cross-track limit to port", point.xtd_port, _LARGEST, "m"),
            ("the cross-track limit to starboard", point.xtd_starboard, _LARGEST, "m"),
            ("the planned speed", point.speed, _FASTEST, "m/s"),
        ):
            if value is not None and not 0 < value <= most:
                raise WaypointError(
                    f"{self.called(k)}: {what} is {brief(value, 4)} {unit}. It lies between 0 and {most:g} {unit}."
                )
        if point.geometry not in get_args(LegGeometry):
            raise WaypointError(
                f"{self.called(k)}: '{point.geometry}' is no geometry of a leg: write loxodrome or great circle."
            )
        if len(point.name) > _LONGEST_NAME:
            raise WaypointError(f"waypoint {k + 1}: its name has more than {_LONGEST_NAME} characters.")

    def __len__(self) -> int:
        return len(self.waypoints)

    @property
    def positions(self) -> np.ndarray:
        """The positions as they are kept, shape (waypoints, 2)."""
        return np.array([w.position for w in self.waypoints], dtype=float)

    @property
    def origin(self) -> tuple[float, float] | None:
        """Latitude and longitude of the first waypoint in rad, the origin of local metres; None where positions are metres."""
        return self.waypoints[0].position if self.geographic else None

    def called(self, k: int) -> str:
        """Return what a waypoint is called in a message: its number and its name.

        Parameters
        ----------
        k : int
            Its index, from 0.
        """
        name = self.waypoints[k].name[:40]
        return f"waypoint {k + 1} '{name}'" if name else f"waypoint {k + 1}"

    def local(self, origin: tuple[float, float] | None = None) -> np.ndarray:
        """Return the waypoints in local metres.

        Parameters
        ----------
        origin : tuple of float, optional
            Latitude and longitude in rad of the place that is (0, 0); the first waypoint by default. A route in metres is already local.

        Returns
        -------
        ndarray, shape (waypoints, 2)
            To the north and to the east in m.
        """
        at = self.positions
        if not self.geographic:
            return at
        return np.stack(to_local(at[:, 0], at[:, 1], origin or self.waypoints[0].position), axis=1)

    def on_earth(self, origin: tuple[float, float]) -> Route:
        """Return the route with latitudes and longitudes; itself where it has them.

        Parameters
        ----------
        origin : tuple of float
            Latitude and longitude in rad of the place that is (0, 0).

        Returns
        -------
        Route
        """
        if self.geographic:
            return self
        at = self.positions
        lat, lon = to_geographic(at[:, 0], at[:, 1], origin)
        places = zip(lat.tolist(), turned(lon).tolist())
        return replace(
            self,
            waypoints=tuple(replace(w, position=place) for w, place in zip(self.waypoints, places)),
            geographic=True,
        )

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values for JSON; SI, positions in degrees where they are geographic, null where nothing is stated."""
        kind = ("lat", "lon", "deg") if self.geographic else ("x", "y", "m")
        points = []
        for w in self.waypoints:
            place = [math.degrees(c) if self.geographic else c for c in w.position]
            points.append(
                {
                    **{n: {"value": c, "unit": kind[2]} for n, c in zip(kind, place)},
                    "name": w.name,
                    "radius": _plain(w.radius, "m"),
                    "xtd_port": _plain(w.xtd_port, "m"),
                    "xtd_starboard": _plain(w.xtd_starboard, "m"),
                    "geometry": w.geometry,
                    "speed": _plain(w.speed, "m/s"),
                }
            )
        return {"name": self.name, "waypoints": points, "warnings": plain_notices(self.notes)}

    def text(self) -> str:
        """Return the result in lines of text."""
        kind = "latitude and longitude" if self.geographic else "local metres"
        return f"route '{self.name}': {len(self)} waypoints in {kind}"

    def to_frame(self) -> pd.DataFrame:
        """Return the waypoints as a pandas table, units in the headers: degrees, or metres where the positions are local."""
        names = ("lat [deg]", "lon [deg]") if self.geographic else ("x [m]", "y [m]")
        rows = (
            {
                "waypoint": k,
                "name": w.name,
                **dict(zip(names, map(math.degrees, w.position) if self.geographic else w.position)),
                "radius [m]": w.radius,
                "xtd_port [m]": w.xtd_port,
                "xtd_starboard [m]": w.xtd_starboard,
                "speed [m/s]": w.speed,
                "geometry": w.geometry,
            }
            for k, w in enumerate(self.waypoints, start=1)
        )
        return table(rows, "waypoint")


def route_through(points: Sequence[tuple[float, float]], *, radius: float | None = None, name: str = "route") -> Route:
    """Return a route in local metres through points.

    Parameters
    ----------
    points : sequence of (float, float)
        To the north and to the east in m.
    radius : float, optional
        Radius of every turn in m.
    name : str
        Its name.

    Returns
    -------
    Route
    """
    return Route(name, tuple(Waypoint((float(x), float(y)), radius=radius) for x, y in points), geographic=False)


def _plain(value: float | None, unit: str) -> Plain:
    return None if value is None else {"value": value, "unit": unit}
