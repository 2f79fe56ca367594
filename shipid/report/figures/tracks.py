"""A predicted track on a plan: north up, the ship to scale, the band, and a tick every minute."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.report.figures.hull import outline
from shipid.report.figures.svg import MUTED, WIDTH, legend, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOUR = "#2f7fc4"
#: Time between two ticks in s: the first that gives no more than a dozen.
_TICKS = (30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0)


def track_figure(track: PredictedTrack, key: str) -> Markup:
    """Return the plan of a predicted track as SVG.

    Parameters
    ----------
    track : PredictedTrack
        The track.
    key : str
        Put before every id.
    """
    width = track.half_width
    east, north = float(np.ptp(track.y)), float(np.ptp(track.x))
    reach = max(east, north, track.length)
    every = next((t for t in _TICKS if track.t[-1] / t <= 12), _TICKS[-1])

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
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
                label="ship" if k == 0 else "_",
            )
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel("east [m]")
        ax.set_title("north [m]", loc="left", fontsize=9, pad=3)
        ax.locator_params(nbins=6)
        legend(figure, [ax])

    height = 0.95 + float(np.clip(3.8 * max(north, 0.25 * reach) / max(east, 0.25 * reach), 2.2, 5.2))
    return svg(draw, (WIDTH, height), key, "Predicted track, north up")


def _words(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 60 else f"{seconds / 60:.0f} min"
