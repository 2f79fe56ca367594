"""What lies below a predicted track on its plan: a route with its limits, and a chart."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from shipid.prediction.charts.chart import Chart
from shipid.prediction.charts.window import cut_line, cut_ring
from shipid.prediction.routes.route_turn import RouteTurn
from shipid.report.figures.svg import MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Panels

#: First and last metre that are shown, to the north and to the east.
View: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
#: Colours that can be told apart on light and on dark paper.
_PLAN, _LAND, _WATER, _DRIES = "#b5651d", "#b08d3c", "#3d85c6", "#5f9e6e"
#: Water shallower than so many metres is so dark.
_DEPTHS = ((2.0, 0.55), (5.0, 0.42), (10.0, 0.30), (20.0, 0.18), (np.inf, 0.07))
_MARKS = {"red": "#d23c3c", "green": "#2e9b57", "yellow": "#d4a500", "black": "#555555", "white": "#dddddd"}
#: By kind of mark: cans, cones, and what has a form of its own.
_FORMS = {"port": "s", "starboard": "^", "cardinal": "D", "isolated": "o", "safe": "o", "special": "X"}
#: Length of the wheel-over line to each side, as a share of the view; most names of waypoints.
_ACROSS, _NAMES = 0.03, 12


def draw_chart(ax: Panels, chart: Chart, view: View) -> None:
    """Draw a chart.

    Parameters
    ----------
    ax : Axes
        The panel.
    chart : Chart
        The chart.
    view : tuple
        What of it is shown, in m.
    """
    for area in chart.depth_areas:
        dries = area.high is not None and area.high <= 0
        alpha = 0.0 if area.low is None else next(a for depth, a in _DEPTHS if area.low < depth)
        _fill(ax, area.rings, view, _DRIES if dries else _WATER, 0.45 if dries else alpha)
    for rings in chart.land:
        _fill(ax, rings, view, _LAND, 0.55)
    for contour in chart.contours:
        _line(ax, contour.line, view, _WATER, 0.5)
    for line in chart.coast:
        _line(ax, line, view, _LAND, 0.9)
    for mark in chart.buoys:
        if view[0][0] <= mark.x <= view[0][1] and view[1][0] <= mark.y <= view[1][1]:
            colour = next((_MARKS[c] for c in mark.colour if c in _MARKS), MUTED)
            form = _FORMS.get(mark.kind or "", "o")
            ax.plot(mark.y, mark.x, form, color=colour, markersize=4, markeredgecolor=MUTED, markeredgewidth=0.5)


def draw_route(ax: Panels, turn: RouteTurn, view: View) -> None:
    """Draw a planned track: its line, cross-track limits, waypoints and the next wheel-over.

    Parameters
    ----------
    ax : Axes
        The panel.
    turn : RouteTurn
        The next turn.
    view : tuple
        What of it is shown, in m.
    """
    plan = turn.plan
    for k, part in enumerate(_parts(plan.line, view)):
        ax.plot(part[:, 1], part[:, 0], color=_PLAN, linewidth=1.0, linestyle="--", label="_" if k else "plan")
    if plan.limits is not None:
        corners = np.array([(leg.x, leg.y) for leg in plan.legs] + [tuple(plan.line[-1])])
        for leg, begin, end, limits in zip(plan.legs, corners, corners[1:], plan.limits):
            across = np.array([-np.sin(leg.course), np.cos(leg.course)])
            for side, limit in zip((-1, 1), limits):
                if np.isfinite(limit):
                    for part in _parts(np.stack([begin, end]) + side * limit * across, view):
                        ax.plot(part[:, 1], part[:, 0], color=_PLAN, linewidth=0.7, linestyle=":")
    _waypoints(ax, turn, view)
    found = turn.wheel_over
    if found is not None:
        course = plan.legs[max(plan.waypoints.index(turn.waypoint), 0)].course if turn.waypoint else 0.0
        half = _ACROSS * (view[0][1] - view[0][0])
        ax.plot(
            found.y + half * np.array([-1, 1]) * np.cos(course),
            found.x - half * np.array([-1, 1]) * np.sin(course),
            color=_PLAN,
            linewidth=1.6,
        )


def _waypoints(ax: Panels, turn: RouteTurn, view: View) -> None:
    """The corners of the plan, with their names where there are few."""
    plan = turn.plan
    last = [k for k, w in enumerate(plan.waypoints) if k + 1 == len(plan.legs) or plan.waypoints[k + 1] != w]
    ends = [(leg.x, leg.y) for leg in plan.legs[1:]] + [tuple(plan.line[-1])]
    places = [(0, plan.legs[0].x, plan.legs[0].y)] + [(plan.waypoints[k], *ends[k]) for k in last]
    inside = [p for p in places if view[0][0] <= p[1] <= view[0][1] and view[1][0] <= p[2] <= view[1][1]]
    for number, x, y in inside:
        ax.plot(y, x, "o", color=_PLAN, markersize=4, markerfacecolor="none")
        if len(inside) <= _NAMES:
            name = turn.route.waypoints[number].name[:20] or str(number + 1)
            # On the outside of the turn, where no track passes.
            left = _outside(turn, number) < 0
            ax.annotate(
                name, (y, x), xytext=(-6 if left else 6, 3), textcoords="offset points", ha="right" if left else "left",
                fontsize=8, color=_PLAN, clip_on=True,
            )  # fmt: skip


def _outside(turn: RouteTurn, waypoint: int) -> float:
    """How far the outside of the turn at a waypoint lies to the east."""
    legs, leads_to = turn.plan.legs, turn.plan.waypoints
    onto = next((k for k, w in enumerate(leads_to) if w > waypoint), None)
    return 1.0 if not onto else float(np.sin(legs[onto - 1].course) - np.sin(legs[onto].course))


def _parts(line: np.ndarray, view: View) -> list[np.ndarray]:
    """What of a line is shown."""
    for axis in (0, 1):
        line = cut_line(cut_line(line, axis, 1.0, view[axis][1]), axis, -1.0, -view[axis][0])
    pieces = [p[~np.isnan(p[:, 0])] for p in np.split(line, np.flatnonzero(np.isnan(line[:, 0])))]
    return [p for p in pieces if len(p) > 1]


def _line(ax: Panels, line: np.ndarray, view: View, colour: str, width: float) -> None:
    for part in _parts(line, view):
        ax.plot(part[:, 1], part[:, 0], color=colour, linewidth=width)


def _fill(ax: Panels, rings: tuple[np.ndarray, ...], view: View, colour: str, alpha: float) -> None:
    """An area with its holes."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    found: list[np.ndarray] = []
    for ring in rings:
        for axis in (0, 1):
            ring = cut_ring(cut_ring(ring, axis, 1.0, view[axis][1]), axis, -1.0, -view[axis][0])
        if len(ring) > 2:
            closed = np.concatenate([ring, ring[:1]])[:, ::-1]
            # Of opposite sense to the ring around them, holes stay empty.
            found.append(closed if _sense(closed) == (not found) else closed[::-1])
    if found:
        codes = [[Path.MOVETO, *[Path.LINETO] * (len(ring) - 2), Path.CLOSEPOLY] for ring in found]
        path = Path(np.concatenate(found), np.concatenate(codes).astype(np.uint8))
        ax.add_patch(PathPatch(path, facecolor=colour, alpha=alpha, linewidth=0))


def _sense(ring: np.ndarray) -> bool:
    x, y = (ring - ring[0]).T
    return float(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1])) > 0
