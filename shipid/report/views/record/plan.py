"""Tracks on a plan, north up, as one figure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.report.figures.svg import MUTED, WIDTH, legend, svg, thin

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS = ("#2f7fc4", "#d9700a", "#2e9e6b", "#a9589f")
#: Height of the plan over its width, at least and at most.
_FLATTEST, _TALLEST = 0.5, 1.25


def plan_figure(lines: Mapping[str, tuple[np.ndarray, np.ndarray]], title: str) -> Markup | None:
    """Return tracks on equal axes, north up, as SVG; None where no line has two points.

    Parameters
    ----------
    lines : mapping of str to (ndarray, ndarray)
        North and east in m by what the line is called; NaN where it breaks.
    title : str
        What a screen reader says.
    """
    shown = {n: xy for n, xy in lines.items() if np.isfinite(xy[0] + xy[1]).sum() > 1}
    if not shown:
        return None
    wide = max(float(np.nanmax(e) - np.nanmin(e)) for _, e in shown.values())
    tall = max(float(np.nanmax(n) - np.nanmin(n)) for n, _ in shown.values())
    shape = float(np.clip(tall / max(wide, 1e-9), _FLATTEST, _TALLEST))

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        for colour, (name, (north, east)) in zip(_COLOURS, shown.items()):
            kept = np.union1d(thin(east, 400), thin(north, 400))
            # A ship that keeps to her plan lies below it: the first of several lines is broad and pale.
            beneath = len(shown) > 1 and name == next(iter(shown))
            width, alpha = (2.8, 0.55) if beneath else (1.2, 1.0)
            ax.plot(east[kept], north[kept], color=colour, linewidth=width, alpha=alpha, label=name)
        north, east = next(iter(shown.values()))
        first = int(np.argmax(np.isfinite(north + east)))
        ax.plot(east[first], north[first], "o", color=MUTED, markersize=4, label="start")
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_xlabel("east [m]")
        ax.set_title("north [m]", loc="left", fontsize=9, pad=3)
        ax.locator_params(nbins=6)
        legend(figure, [ax])

    return svg(draw, (WIDTH, 0.95 + 4.05 * shape), "track", title)
