"""Charts of an autopilot: panels over one axis with limits, and Nyquist curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.foundation.aliases import Plain
from shipid.report.figures.svg import (
    BLUE,
    GOLD,
    GREEN,
    MUTED,
    ORANGE,
    PURPLE,
    RED,
    WIDTH,
    axis_range,
    legend,
    panel_title,
    svg,
    thin,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Height of a panel in inches: of one among several, and of a panel of a Bode diagram, which stands beside a Nyquist curve.
_PANEL, _TALL = 1.35, 1.65
#: Colours of the lines, in order; readable on light and dark paper.
_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, GOLD, MUTED)


@dataclass(frozen=True, eq=False)
class Line:
    """A line of a chart.

    Attributes
    ----------
    label : str
        In the legend; an empty one is left out.
    x, y : ndarray, shape (n,)
        Its points.
    look : {"line", "points", "limit", "faint", "dashed"}
        How it is drawn.
    colour : int
        Which of the colours.
    """

    label: str
    x: np.ndarray
    y: np.ndarray
    look: str = "line"
    colour: int = 0


@dataclass(frozen=True, eq=False)
class Axes:
    """One set of axes.

    Attributes
    ----------
    label, unit : str
        What the vertical axis shows.
    lines : sequence of Line
        Limits are drawn over the whole width and do not widen the range by much.
    """

    label: str
    unit: str
    lines: Sequence[Line]


def _look(line: Line) -> dict[str, Plain]:
    colour = _COLOURS[line.colour % len(_COLOURS)]
    return {
        "line": {"color": colour, "linewidth": 1.4},
        "points": {"color": colour, "linewidth": 1.2, "marker": "o", "markersize": 3.2},
        "dashed": {"color": colour, "linewidth": 1.2, "linestyle": (0, (4, 1.6))},
        "limit": {"color": RED, "linewidth": 1.1, "linestyle": (0, (2, 2))},
        "faint": {"color": MUTED, "linewidth": 0.5, "alpha": 0.6},
    }[line.look]


def chart(panels: Sequence[Axes], across: str, key: str, title: str, *, log: bool = False) -> Markup:
    """Return panels above each other over one horizontal axis as SVG.

    Parameters
    ----------
    panels : sequence of Axes
        From top to bottom.
    across : str
        What the horizontal axis shows, with its unit.
    key : str
        Put before every id, so that several figures can stand in one page.
    title : str
        What a screen reader says.
    log : bool
        Whether the horizontal axis is logarithmic.
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for ax, panel in zip(axes, panels):
            for line in panel.lines:
                if not len(line.x):
                    continue
                kept = thin(line.y) if len(line.y) > 1 else np.arange(len(line.y))
                ax.plot(line.x[kept], line.y[kept], label=line.label or "_", **_look(line))
            shown = [line.y for line in panel.lines if len(line.y)]
            if shown:
                ax.set_ylim(*_limits(np.concatenate(shown)))
            ax.set_title(panel_title(panel.label, panel.unit), loc="left", fontsize=9, pad=3)
            ax.margins(x=0.02)
            ax.locator_params(axis="y", nbins=5)
        if log:
            axes[-1].set_xscale("log")
            axes[-1].xaxis.set_major_formatter(lambda value, _: f"{value:g}")
            axes[-1].xaxis.set_minor_formatter(lambda *_: "")
        axes[-1].set_xlabel(across)
        legend(figure, axes)

    return svg(draw, (WIDTH, 0.75 + (_TALL if log else _PANEL) * len(panels)), key, title)


def _limits(y: np.ndarray) -> tuple[float, float]:
    """The range of an axis; a nearly constant value is not magnified."""
    low, high = axis_range([y])
    least = 0.2 * max(abs(low), abs(high))
    short = max(0.0, least - (high - low)) / 2
    return low - short, high + short


def nyquist(lines: Sequence[Line], disk: float, key: str, title: str) -> Markup:
    """Return Nyquist curves with the unit circle, the point -1 and the circle of a disk margin, on equal axes, as SVG.

    Parameters
    ----------
    lines : sequence of Line
        Real part across, imaginary part up.
    disk : float
        The loop keeps this disk margin while its curve stays out of the circle.
    key, title : str
        As for `chart`.
    """
    left, right = -2.2, 1.2
    low, high = -2.0, 1.0

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        turn = np.linspace(0, 2 * np.pi, 181)
        ends = -(2 + disk) / (2 - disk), -(2 - disk) / (2 + disk)
        centre, radius = 0.5 * sum(ends), 0.5 * (ends[1] - ends[0])
        ax.plot(np.cos(turn), np.sin(turn), color=MUTED, linewidth=0.7)
        limit: dict[str, Plain] = {"color": RED, "linewidth": 1.1, "linestyle": (0, (2, 2))}
        ax.plot(centre + radius * np.cos(turn), radius * np.sin(turn), label="limit", **limit)
        ax.plot([-1], [0], "+", color=RED, markersize=7, label="_")
        for line in lines:
            inside = (line.x > 1.5 * left) & (line.x < 1.5 * right) & (line.y > 1.5 * low) & (line.y < 1.5 * high)
            ax.plot(np.where(inside, line.x, np.nan), np.where(inside, line.y, np.nan), label=line.label, **_look(line))
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlim(left, right)
        ax.set_ylim(low, high)
        ax.set_xlabel("real part")
        ax.set_ylabel("imaginary part")
        ax.locator_params(nbins=6)
        legend(figure, [ax])

    return svg(draw, (WIDTH, 0.95 + 3.6 * (high - low) / (right - left)), key, title)
