"""A predicted track on a plan: north up, the ship to scale, the band, a tick every minute; a route and a chart below it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_unit, label, to_display
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.report.figures.charts import Axes, Line, chart
from shipid.report.figures.hull import outline
from shipid.report.figures.plan_view import draw_chart, draw_route
from shipid.report.figures.svg import BLUE, MUTED, WIDTH, legend, panel_size, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shipid.prediction.charts.chart import Chart
    from shipid.prediction.routes.route_turn import RouteTurn

_COLOUR = BLUE
#: What the chart along the track shows.
_ALONG = (("psi", "rad"), ("r", "rad/s"), ("u", "m/s"), ("delta", "rad"))
#: Time between two ticks in s: the first that gives no more than a dozen.
_TICKS = (30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0)


def track_figure(
    track: PredictedTrack,
    key: str,
    *,
    turn: RouteTurn | None = None,
    chart: Chart | None = None,
    now: tuple[float, float] | None = None,
) -> Markup:
    """Return the plan of a predicted track as SVG.

    Parameters
    ----------
    track : PredictedTrack
        The track.
    key : str
        Put before every id.
    turn : RouteTurn, optional
        The next turn of a route, whose plan is drawn.
    chart : Chart, optional
        Drawn below everything.
    now : tuple of float, optional
        Where the ship is, where the track begins ahead of her: to the north and to the east in m.
    """
    width = track.half_width
    x, y = (np.append(track.x, now[0]), np.append(track.y, now[1])) if now else (track.x, track.y)
    east, north = float(np.ptp(y)), float(np.ptp(x))
    reach = max(east, north, track.length)
    height = 0.95 + float(np.clip(3.8 * max(north, 0.25 * reach) / max(east, 0.25 * reach), 2.2, 5.2))
    view = _view(x, y, track.length, height)
    every = next((t for t in _TICKS if track.t[-1] / t <= 12), _TICKS[-1])

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        if chart is not None:
            draw_chart(ax, chart, view)
        if turn is not None:
            draw_route(ax, turn, view)
        if now is not None:
            ax.plot(*zip(now[::-1], (track.y[0], track.x[0])), color=_COLOUR, linewidth=1.0, linestyle=":")
        if width is not None:
            n = track.normal
            sides = [np.stack([track.x, track.y], axis=1) + s * width[:, None] * n for s in (1, -1)]
            edge = np.concatenate([sides[0], sides[1][::-1]])
            ax.fill(edge[:, 1], edge[:, 0], color=_COLOUR, alpha=0.18, linewidth=0, label="95 % band")
        ax.plot(track.y, track.x, color=_COLOUR, linewidth=1.4, label="track")
        at = track.at_time(np.arange(every, track.t[-1], every))
        ax.plot(at["y"], at["x"], "o", color=_COLOUR, markersize=3, label=f"every {_words(every)}")
        for k in (0, track.s.size - 1):
            x, y = outline(track.length, track.psi[k])
            ax.plot(
                track.y[k] + y,
                track.x[k] + x,
                color=MUTED,
                linewidth=0.9,
                label="ship" if k == 0 and turn is None else "_",
            )
        if turn is not None or chart is not None:
            # What lies around does not widen the view.
            ax.set_xlim(*view[1])
            ax.set_ylim(*view[0])
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel("east [m]")
        ax.set_title("north [m]", loc="left", fontsize=9, pad=3)
        ax.locator_params(nbins=6)
        legend(figure, [ax])

    return svg(draw, (WIDTH, height), key, "Predicted track, north up")


def _view(
    x: np.ndarray, y: np.ndarray, length: float, height: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """First and last metre to the north and to the east that are shown: the track and a margin, in the shape of the panel."""
    wide, tall = panel_size((WIDTH, height))
    margin = max(2 * length, 0.06 * max(float(np.ptp(x)), float(np.ptp(y))))
    scale = max((np.ptp(x) + 2 * margin) / tall, (np.ptp(y) + 2 * margin) / wide)
    middle = 0.5 * (x.min() + x.max()), 0.5 * (y.min() + y.max())
    half = 0.5 * scale * tall, 0.5 * scale * wide
    return (middle[0] - half[0], middle[0] + half[0]), (middle[1] - half[1], middle[1] + half[1])


def _words(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 60 else f"{seconds / 60:.0f} min"


def heading_along(track: PredictedTrack) -> np.ndarray:
    """Return the heading along a track in degrees, continued where the ship turns through north.

    She ends in compass degrees: what was ordered is read there.

    Parameters
    ----------
    track : PredictedTrack
        The track.
    """
    values = to_display(track.psi, "psi", "rad")
    return np.asarray(values - 360 * np.floor(values[-1] / 360))


def along_figure(track: PredictedTrack) -> Markup:
    """Return what the ship does along a predicted track, against time.

    Parameters
    ----------
    track : PredictedTrack
        The track.
    """
    panels = []
    for name, unit in _ALONG:
        values = heading_along(track) if name == "psi" else to_display(getattr(track, name), name, unit)
        panels.append(Axes(label(name), pretty(display_unit(name, unit)), [Line("", track.t, values)]))
    return chart(panels, "Time since the order [s]", "along", "Heading, rate of turn, speed and rudder along the track")
