"""A route as a planned track in local metres: legs that are curved in the plane are cut into straight pieces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shipid.foundation.errors import UsageError
from shipid.prediction.following.planned_track import PlannedTrack, planned_track
from shipid.prediction.routes.errors import RoutePlaneError
from shipid.prediction.routes.route import Route
from shipid.prediction.routes.sailings import (
    along_great_circle,
    along_rhumb_line,
    angle_between,
    great_circle,
    rhumb_line,
    turned,
)  # fmt: skip
from shipid.trials.logs.geodesy import SEMI_MAJOR, to_local

#: A straight piece of a leg is nowhere farther from the leg than this, in m; points of a leg at which that is looked at.
_NEAR, _LOOKED = 1.0, 65
#: In a plane of local metres, distances 300 km from the origin are short by a thousandth, and north is off by 3 degrees at most.
_FARTHEST, _CONVERGENCE = 300e3, np.deg2rad(3.0)
#: A piece of a leg leaves room for the turn at its end, with this to spare.
_ROOM = 1.1


def plan_of(route: Route, *, origin: tuple[float, float] | None = None, radius: float | None = None) -> PlannedTrack:
    """Return the planned track of a route in local metres.

    Parameters
    ----------
    route : Route
        The route.
    origin : tuple of float, optional
        Latitude and longitude in rad of the place that is (0, 0); the first waypoint by default.
    radius : float, optional
        Radius of the turns in m where the route states none.

    Returns
    -------
    PlannedTrack
        A loxodrome or a great circle that is not straight in the plane is cut into pieces, nowhere more than 1 m off.

    Raises
    ------
    RoutePlaneError
        If the route is too long, or too near to a pole, for one plane.
    UsageError
        If a turn has no radius, does not fit between its neighbours, or turns back.
    """
    corners = len(route) - 1
    stated = [w.radius if w.radius is not None else radius for w in route.waypoints[1:-1]]
    gone = [k for k, r in enumerate(stated, start=1) if r is None]
    if gone:
        raise UsageError(f"{route.called(gone[0])} of route '{route.name}' states no turn radius, and none is given.")
    radii = np.array(stated, dtype=float)
    names = [route.called(k) for k in range(len(route))]
    if route.geographic:
        at = origin or route.waypoints[0].position
        _check_plane(route, at)
        points, leads_to = _on_the_way(route, at, radii)
    else:
        points, leads_to = route.local(), np.arange(1, len(route))
    # A piece between two waypoints turns by fractions of a degree: any radius rounds it.
    whole = np.flatnonzero(np.diff(leads_to)) + 1
    sizes = np.full(len(leads_to) - 1, radii.min(initial=1.0))
    sizes[whole - 1] = radii
    called = [names[0], *(names[k] if last else f"a point before {names[k]}" for k, last in _marked(leads_to))]
    plan = planned_track(points, sizes, called)
    limits = np.array([(w.xtd_port or np.inf, w.xtd_starboard or np.inf) for w in route.waypoints[1:]])
    assert len(limits) == corners
    return replace(plan, limits=limits[leads_to - 1], waypoints=tuple(leads_to.tolist()))


def _marked(leads_to: np.ndarray) -> list[tuple[int, bool]]:
    """The waypoint each piece leads to, and whether it reaches it."""
    last = np.append(np.diff(leads_to) > 0, True)
    return list(zip(leads_to.tolist(), last.tolist()))


def _check_plane(route: Route, origin: tuple[float, float]) -> None:
    at = route.positions
    first, second = np.array(origin[0]), np.array(origin[1])
    away = SEMI_MAJOR * angle_between(first, second, at[:, 0], at[:, 1])
    far = int(away.argmax())
    if away[far] > _FARTHEST:
        raise RoutePlaneError(
            f"{route.called(far)} of route '{route.name}' is {away[far] / 1000:.0f} km from the origin, and a plane of local metres "
            f"holds {_FARTHEST / 1000:.0f} km: cut the route into parts."
        )
    north = np.abs(turned(at[:, 1] - second) * np.sin(np.maximum(np.abs(at[:, 0]), abs(origin[0]))))
    far = int(north.argmax())
    if north[far] > _CONVERGENCE or np.abs(at[:, 0]).max() > np.deg2rad(89.5):
        raise RoutePlaneError(
            f"at {route.called(far)} of route '{route.name}' north is {np.rad2deg(north[far]):.1f} deg off north at the origin, and a "
            f"plane of local metres holds {np.rad2deg(_CONVERGENCE):.0f} deg: so near to a pole, cut the route into shorter parts."
        )


def _on_the_way(route: Route, origin: tuple[float, float], radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Waypoints and points of curved legs between them in m, shape (N, 2); and the waypoint each leads to, shape (N - 1,)."""
    share = np.linspace(0.0, 1.0, _LOOKED)
    curves = _curves(route, origin, np.arange(len(route) - 1), share[None, :])
    chord = curves[:, -1] - curves[:, 0]
    length = np.hypot(chord[:, 0], chord[:, 1])
    off = curves - curves[:, :1]
    across = np.abs(off[..., 1] * chord[:, None, 0] - off[..., 0] * chord[:, None, 1]) / length[:, None]
    pieces = np.maximum(1, np.ceil(np.sqrt(across.max(axis=1) / _NEAR)).astype(int))
    # What the turns at the two ends of a leg take of it.
    begin, end = curves[:, 1] - curves[:, 0], curves[:, -1] - curves[:, -2]
    turn = turned(np.arctan2(begin[1:, 1], begin[1:, 0]) - np.arctan2(end[:-1, 1], end[:-1, 0]))
    taken = _ROOM * radii * np.tan(np.minimum(np.abs(turn), 3.0) / 2)
    leg = np.repeat(np.arange(len(pieces)), pieces)
    number = np.arange(len(leg)) - np.repeat(np.cumsum(pieces) - pieces, pieces) + 1
    part = number / pieces[leg]
    room = np.append(0.0, taken)[leg] / length[leg], np.append(taken, 0.0)[leg] / length[leg]
    reached = number == pieces[leg]
    kept = reached | ((part > room[0]) & (part < 1 - room[1]))
    leg, part, reached = leg[kept], part[kept], reached[kept]
    points = _curves(route, origin, leg, part[:, None])[:, 0]
    return np.concatenate([curves[:1, 0], points]), leg + 1


def _curves(route: Route, origin: tuple[float, float], legs: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Points of legs at shares of their length, shape (legs, shares, 2)."""
    at = route.positions
    lat, lon, to_lat, to_lon = (a[:, None] for a in (*at[legs].T, *at[legs + 1].T))
    circle = np.array([w.geometry == "great circle" for w in route.waypoints[1:]])[legs, None]
    rhumb = along_rhumb_line(lat, lon, to_lat, to_lon, share)
    length, course, _ = great_circle(lat, lon, to_lat, to_lon)
    shortest = along_great_circle(lat, lon, course, length * share)
    north, east = to_local(np.where(circle, shortest[0], rhumb[0]), np.where(circle, shortest[1], rhumb[1]), origin)
    return np.stack([north, east], axis=-1)


def leg_lengths(route: Route) -> np.ndarray:
    """Return the lengths of the legs in m, shape (legs,).

    Parameters
    ----------
    route : Route
        The route.
    """
    at = route.positions
    if not route.geographic:
        return np.asarray(np.hypot(*np.diff(at, axis=0).T))
    lat, lon, to_lat, to_lon = *at[:-1].T, *at[1:].T
    circle = [w.geometry == "great circle" for w in route.waypoints[1:]]
    return np.where(circle, great_circle(lat, lon, to_lat, to_lon)[0], rhumb_line(lat, lon, to_lat, to_lon)[0])
