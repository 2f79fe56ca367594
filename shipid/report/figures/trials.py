"""Figures of a trial or a filtered record: signals against time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.foundation.aliases import Plain
from shipid.report.figures.svg import (
    BLUE,
    MOST_POINTS,
    MUTED,
    ORANGE,
    WIDTH,
    Drawing,
    axis_range,
    legend,
    panel_title,
    power_of,
    thin,
    with_gaps,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PANEL = 1.25
#: An estimate is thin, and what was measured broad and pale beneath it, so that both are seen where they agree.
_STYLES: dict[str, dict[str, Plain]] = {
    "measured": {"color": BLUE, "linestyle": "-", "linewidth": 1.3},
    "simulated": {"color": BLUE, "linestyle": "-", "linewidth": 1.3},
    "predicted": {"color": ORANGE, "linestyle": (0, (4, 1.6)), "linewidth": 1.5},
    "measured beneath": {"color": BLUE, "linestyle": "-", "linewidth": 2.8, "alpha": 0.55},
    "estimate": {"color": ORANGE, "linestyle": "-", "linewidth": 1.0},
    "moving mean": {"color": ORANGE, "linestyle": "-", "linewidth": 1.0},
    "95 % band": {"color": ORANGE, "linestyle": (0, (1, 1.5)), "linewidth": 1.0},
    "innovation": {"color": BLUE, "linestyle": "none", "marker": ".", "markersize": 2.0},
    "95 % bounds": {"color": MUTED, "linestyle": (0, (4, 1.6)), "linewidth": 1.0},
    "residual": {"color": BLUE, "linestyle": "-", "linewidth": 0.8},
    "rudder": {"color": "black", "linestyle": "-", "linewidth": 0.9},
    "order": {"color": MUTED, "linestyle": ":", "linewidth": 1.2},
}
_POINTS = "innovation"
_BOUNDS = ("95 % band", "95 % bounds")
#: Innovations are shown up to so many times their bounds, and a band up to so many times its usual width.
_MOST_BOUNDS, _WIDEST_BAND = 4.0, 1.5


@dataclass(frozen=True, eq=False)
class Curve:
    """A line in a panel.

    Attributes
    ----------
    kind : str
        measured, simulated, predicted, residual, rudder or order: its style and its name in the legend. Measured beneath an estimate it is
        ``measured beneath``.
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
    settling : float
        Share of the record at its beginning that does not set the range: there a filter still settles, and its bounds would
        flatten the rest.
    span : tuple of float or None
        Least range of the vertical axis, such as that of a probability.
    """

    label: str
    unit: str
    curves: Sequence[Curve]
    settling: float = 0.0
    span: tuple[float, float] | None = None


def histories(panels: Sequence[Panel], key: str, title: str, most: int = MOST_POINTS) -> Markup:
    """Return panels above each other over one time axis as SVG.

    Parameters
    ----------
    panels : sequence of Panel
        From top to bottom; the horizontal values are seconds.
    key : str
        Put before every id, so that several figures can stand in one page.
    title : str
        What a screen reader says.
    most : int
        Most points of a curve.
    """
    return histories_drawing(panels, title, most).svg(key)


def halves(panels: Sequence[Panel], key: str, title: str) -> list[Markup]:
    """Return panels as two figures that stand beside each other where there is room, and above each other where there is not.

    Parameters
    ----------
    panels, key, title
        As for `histories`.
    """
    middle = (len(panels) + 1) // 2
    parts = [part for part in (panels[:middle], panels[middle:]) if part]
    return [histories(part, f"{key}-{k}", f"{title}: {_labels(part)}") for k, part in enumerate(parts)]


def histories_drawing(panels: Sequence[Panel], title: str, most: int = MOST_POINTS) -> Drawing:
    """Return panels above each other over one time axis, to be drawn.

    Parameters
    ----------
    panels, title, most
        As for `histories`.
    """

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for ax, panel in zip(axes, panels):
            low, high = _range(panel)
            power = power_of(np.array([low, high]))
            for curve in panel.curves:
                x, y = with_gaps(curve.x, curve.y)
                # Points thinned to their extremes would leave the middle empty, where most innovations lie.
                kept = np.arange(0, len(y), -(-len(y) // most)) if curve.kind == _POINTS else thin(y, most)
                ax.plot(
                    x[kept], y[kept] / 10.0**power, label=curve.kind.removesuffix(" beneath"), **_STYLES[curve.kind]
                )
            ax.set_title(panel_title(panel.label, panel.unit, power), loc="left", fontsize=9, pad=3)
            ax.set_ylim(low / 10.0**power, high / 10.0**power)
            ax.margins(x=0.01)
            # There is no waypoint 2.5.
            ax.locator_params(axis="y", nbins=5, integer=power == 0 and all(_counts(c.y) for c in panel.curves))
        axes[-1].set_xlabel("time [s]")
        legend(figure, axes)

    return Drawing(draw, (WIDTH, 0.75 + _PANEL * len(panels)), title)


def _counts(y: np.ndarray) -> bool:
    """Whether all values of a curve are whole numbers."""
    there = y[np.isfinite(y)]
    return bool(np.array_equal(there, np.round(there)))


def _range(panel: Panel) -> tuple[float, float]:
    """The range of a panel: bounds are seen for most of the record, and neither they nor what lies far beyond them flatten the rest."""
    if panel.span is not None:
        return axis_range([np.array(panel.span), *(c.y for c in panel.curves)])
    bounds = [c for c in panel.curves if c.kind in _BOUNDS]
    lines = [_settled(c.y, panel.settling) for c in panel.curves if c.kind not in _BOUNDS]
    if not bounds:
        return axis_range(lines)
    first = lines[0]
    if panel.curves[0].kind == _POINTS:
        usual = np.array([np.nanmedian(_settled(c.y, panel.settling)) for c in bounds])
        first = np.clip(first, _MOST_BOUNDS * usual.min(), _MOST_BOUNDS * usual.max())
        return axis_range([np.concatenate([first, usual]), *lines[1:]])
    return axis_range(
        [np.concatenate([first, *(_near(first, _settled(c.y, panel.settling)) for c in bounds)]), *lines[1:]]
    )


def _near(line: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """A bound about a line as far as it sets the range: where a filter knows little for a while, it runs out of the panel."""
    away = bound - line
    most = _WIDEST_BAND * float(np.nanmedian(np.abs(away)))
    return np.asarray(line + np.clip(away, -most, most))


def _settled(y: np.ndarray, settling: float) -> np.ndarray:
    later = y[int(settling * len(y)) :]
    return later if np.isfinite(later).any() else y


def _labels(panels: Sequence[Panel]) -> str:
    return ", ".join(panel.label for panel in panels)
