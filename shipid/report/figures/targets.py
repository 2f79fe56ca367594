"""Tracks of targets on a plan: north up, the plots faint, own ship, the truth, and a vector of a minute where each track ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.encounter.plots.ship_path import ShipPath
from shipid.encounter.tracking.target_track import TargetTrack
from shipid.encounter.tracking.tracking import Tracking
from shipid.report.figures.svg import BLUE, GREEN, MUTED, ORANGE, PAPER, WIDTH, legend, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Panels
    from matplotlib.figure import Figure

#: Colours of tracks that are held and lost, and of own ship.
_HELD, _LOST, _OWN = BLUE, ORANGE, GREEN
#: Most plots that are drawn: more than that is a grey field.
_MOST = 3000
#: Length of the velocity vectors, s.
_VECTOR = 60.0
#: How far beyond plots and tracks the truth is drawn, in shares of their extent.
_MARGIN = 0.2


def targets_figure(found: Tracking, key: str) -> Markup:
    """Return the plan of tracks as SVG.

    Parameters
    ----------
    found : Tracking
        The tracks.
    key : str
        Put before every id.
    """
    plots = np.concatenate([s.z for s in found.plots] or [np.zeros((0, 2))])
    plots = plots[:: max(1, -(-len(plots) // _MOST))]
    first, last = found.plots.span
    own = None if found.own is None else _within(found.own, first, last)
    held = [one.x[one.held, :2] for one in found.tracks]
    everything = np.concatenate([plots, *held, *([] if own is None else [own])])

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        ax.plot(plots[:, 1], plots[:, 0], ".", color=MUTED, markersize=1.2, alpha=0.5)
        for path in found.truth:
            true = _near(_within(path, first, last), everything)
            ax.plot(true[:, 1], true[:, 0], color=MUTED, linewidth=0.9, linestyle=(0, (4, 1.6)), label="truth")
        if own is not None:
            ax.plot(own[:, 1], own[:, 0], color=_OWN, linewidth=1.4, label="own ship")
        elif found.relative:
            ax.plot([0], [0], "o", color=_OWN, markersize=4, label="own ship")
        for one in found.tracks:
            _draw_track(ax, one, everything)
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel("east [m]")
        ax.set_title("north [m]", loc="left", fontsize=9, pad=3)
        ax.locator_params(nbins=6)
        legend(figure, [ax])

    return svg(draw, (WIDTH, 5.0), key, "Tracks, north up")


def _within(path: ShipPath, first: float, last: float) -> np.ndarray:
    """Positions of a ship while the plots last, shape (N, 2)."""
    within = (path.t >= first) & (path.t <= last)
    return np.stack([path.x[within], path.y[within]], axis=1)


def _near(positions: np.ndarray, shown: np.ndarray) -> np.ndarray:
    """Positions with NaN where they lie far off what is shown: one ship beyond the horizon would make the plan a dot."""
    if not len(shown):
        return positions
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = _MARGIN * float((high - low).max())
    there = ((positions >= low - margin) & (positions <= high + margin)).all(axis=1)
    return np.where(there[:, None], positions, np.nan)


def _draw_track(ax: Panels, one: TargetTrack, shown: np.ndarray) -> None:
    for held, colour, label in ((one.held, _HELD, "track"), (~one.held, _LOST, "lost")):
        if held.any():
            # Where a lost target may have gone does not widen the plan.
            x = _near(np.where(held[:, None], one.x[:, :2], np.nan), shown)
            ax.plot(x[:, 1], x[:, 0], color=colour, linewidth=1.3, label=label)
    if one.status != "held":
        return
    end = one.x[-1]
    ahead = end[:2] + _VECTOR * end[2:]
    ax.plot([end[1], ahead[1]], [end[0], ahead[0]], color=_HELD, linewidth=0.8)
    behind = {"facecolor": PAPER, "edgecolor": "none", "alpha": 0.8, "pad": 0.8}
    ax.annotate(
        str(one.number), (end[1], end[0]), fontsize=8, xytext=(3, 3), textcoords="offset points", bbox=behind, zorder=3
    )
