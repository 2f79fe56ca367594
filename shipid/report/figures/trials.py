"""Figures of a trial or a filtered record: signals against time, and tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.foundation.aliases import Plain
from shipid.report.figures.svg import MOST_POINTS, MUTED, WIDTH, axis_range, legend, panel_title, svg, thin, with_gaps

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PANEL = 1.25
_STYLES: dict[str, dict[str, Plain]] = {
    "measured": {"color": "#2f7fc4", "linestyle": "-", "linewidth": 1.3},
    "predicted": {"color": "#d9700a", "linestyle": (0, (4, 1.6)), "linewidth": 1.5},
    "estimate": {"color": "#d9700a", "linestyle": "-", "linewidth": 1.4},
    "95 % band": {"color": "#d9700a", "linestyle": (0, (1, 1.5)), "linewidth": 1.0},
    "innovation": {"color": "#2f7fc4", "linestyle": "none", "marker": ".", "markersize": 2.0},
    "95 % bounds": {"color": MUTED, "linestyle": (0, (4, 1.6)), "linewidth": 1.0},
    "residual": {"color": "#2f7fc4", "linestyle": "-", "linewidth": 0.8},
    "rudder": {"color": "black", "linestyle": "-", "linewidth": 1.1},
    "order": {"color": MUTED, "linestyle": ":", "linewidth": 1.2},
}


@dataclass(frozen=True, eq=False)
class Curve:
    """A line in a panel.

    Attributes
    ----------
    kind : str
        measured, predicted, residual, rudder or order: its style and its name in the legend.
    x, y : ndarray, shape (n,)
        Its points, in the units shown; NaN where a sample is missing.
    """

    kind: str
    x: np.ndarray
    y: np.ndarray


@dataclass(frozen=True, eq=False)
class Panel:
    """One set of axes: what is shown, its unit, its lines.

    Attributes
    ----------
    label, unit : str
        What the vertical axis shows.
    curves : sequence of Curve
        Its lines; the first one decides the range when another runs far out of it.
    """

    label: str
    unit: str
    curves: Sequence[Curve]


def histories(panels: Sequence[Panel], key: str, title: str) -> Markup:
    """Return panels above each other over one time axis as SVG.

    Parameters
    ----------
    panels : sequence of Panel
        From top to bottom; the horizontal values are seconds.
    key : str
        Put before every id, so that several figures can stand in one page.
    title : str
        What a screen reader says.
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for ax, panel in zip(axes, panels):
            for curve in panel.curves:
                x, y = with_gaps(curve.x, curve.y)
                kept = thin(y)
                ax.plot(x[kept], y[kept], label=curve.kind, **_STYLES[curve.kind])
            ax.set_title(panel_title(panel.label, panel.unit), loc="left", fontsize=9, pad=3)
            ax.set_ylim(*axis_range([c.y for c in panel.curves]))
            ax.margins(x=0.01)
            ax.locator_params(axis="y", nbins=5)
        axes[-1].set_xlabel("time [s]")
        legend(figure, axes)

    return svg(draw, (WIDTH, 0.75 + _PANEL * len(panels)), key, title)


def tracks(curves: Sequence[Curve], key: str, title: str) -> Markup:
    """Return tracks on equal axes, north up, as SVG.

    Parameters
    ----------
    curves : sequence of Curve
        Horizontal: east in m; vertical: north in m.
    key, title : str
        As for `histories`.
    """
    across, along = axis_range([c.x for c in curves]), axis_range([c.y for c in curves])
    wide, tall = across[1] - across[0], along[1] - along[0]
    # A straight track would make a figure of one line's width: a panel is at most 1.8 times as wide as tall, or 1.25 as tall.
    across, along = _widen(across, tall / 1.25), _widen(along, 0.55 * wide)
    shape = (along[1] - along[0]) / (across[1] - across[0])

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        for curve in curves:
            kept = np.union1d(thin(curve.x, MOST_POINTS // 2), thin(curve.y, MOST_POINTS // 2))
            ax.plot(curve.x[kept], curve.y[kept], label=curve.kind, **_STYLES[curve.kind])
        begins = np.flatnonzero(np.isfinite(curves[0].x))[:1]
        ax.plot(
            curves[0].x[begins], curves[0].y[begins], "o", color="black", markersize=4, linestyle="none", label="start"
        )
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlim(*across)
        ax.set_ylim(*along)
        ax.set_xlabel("east [m]")
        ax.set_ylabel("north [m]")
        ax.locator_params(nbins=6)
        legend(figure, [ax])

    return svg(draw, (WIDTH, 0.9 + 3.9 * shape), key, title)


def _widen(limits: tuple[float, float], least: float) -> tuple[float, float]:
    short = max(0.0, least - (limits[1] - limits[0])) / 2
    return limits[0] - short, limits[1] + short
