"""Figures as inline SVG: small, the same bytes for the same data, readable on light and dark paper."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup, escape

#: Most points of one curve.
MOST_POINTS = 1000
_WIDTH = 4.7  # inch: text of 9 pt stays readable when a phone shrinks it to 330 px
_PANEL = 1.25
_MUTED = "#7d8590"
#: Margins of a figure and the gap between its panels, in inches.
_LEFT, _RIGHT, _TOP, _BOTTOM, _GAP = 0.55, 0.1, 0.5, 0.45, 0.27
_STYLES: dict[str, dict[str, Any]] = {
    "measured": {"color": "#2f7fc4", "linestyle": "-", "linewidth": 1.3},
    "predicted": {"color": "#d9700a", "linestyle": (0, (4, 1.6)), "linewidth": 1.5},
    "estimate": {"color": "#d9700a", "linestyle": "-", "linewidth": 1.4},
    "95 % band": {"color": "#d9700a", "linestyle": (0, (1, 1.5)), "linewidth": 1.0},
    "innovation": {"color": "#2f7fc4", "linestyle": "none", "marker": ".", "markersize": 2.0},
    "95 % bounds": {"color": _MUTED, "linestyle": (0, (4, 1.6)), "linewidth": 1.0},
    "residual": {"color": "#2f7fc4", "linestyle": "-", "linewidth": 0.8},
    "rudder": {"color": "black", "linestyle": "-", "linewidth": 1.1},
    "order": {"color": _MUTED, "linestyle": ":", "linewidth": 1.2},
}
_SETTINGS = {
    "svg.fonttype": "none",
    "svg.hashsalt": "shipid",
    "text.parse_math": False,
    "text.usetex": False,
    "font.size": 9.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": _MUTED,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "axes.unicode_minus": True,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
}


@dataclass(frozen=True, eq=False)
class Curve:
    """A line in a panel.

    Attributes
    ----------
    kind : str
        measured, predicted, residual, rudder or order: its style and its name in the legend.
    x, y : ndarray, shape (n,)
        Its points, finite, in the units shown.
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


def thin(y: np.ndarray, most: int = MOST_POINTS) -> np.ndarray:
    """Return the indices of at most `most` samples that keep the first, the last and every extreme.

    The record is cut into stretches of equal length; the lowest and the highest sample of each are kept.

    Parameters
    ----------
    y : ndarray, shape (n,)
        The samples.
    most : int
        Most indices; at least 4.

    Returns
    -------
    ndarray of int
    """
    n = len(y)
    if n <= most:
        return np.arange(n)
    width = int(np.ceil(n / ((most - 2) // 2)))
    rows = int(np.ceil(n / width))
    padded = np.pad(y, (0, rows * width - n), mode="edge").reshape(rows, width)
    begin = width * np.arange(rows)
    low, high = begin + padded.argmin(axis=1), begin + padded.argmax(axis=1)
    return np.unique(np.clip(np.concatenate([[0, n - 1], low, high]), 0, n - 1))


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

    def draw(figure: Any) -> None:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for ax, panel in zip(axes, panels):
            for curve in panel.curves:
                kept = thin(curve.y)
                ax.plot(curve.x[kept], curve.y[kept], label=curve.kind, **_STYLES[curve.kind])
            ax.set_title(f"{panel.label} [{panel.unit}]", loc="left", fontsize=9, pad=3)
            ax.set_ylim(*_range([c.y for c in panel.curves]))
            ax.margins(x=0.01)
            ax.locator_params(axis="y", nbins=5)
        axes[-1].set_xlabel("time [s]")
        _legend(figure, axes)

    return _svg(draw, (_WIDTH, 0.75 + _PANEL * len(panels)), key, title)


def tracks(curves: Sequence[Curve], key: str, title: str) -> Markup:
    """Return tracks on equal axes, north up, as SVG.

    Parameters
    ----------
    curves : sequence of Curve
        Horizontal: east in m; vertical: north in m.
    key, title : str
        As for `histories`.
    """
    across, along = _range([c.x for c in curves]), _range([c.y for c in curves])
    wide, tall = across[1] - across[0], along[1] - along[0]
    # A straight track would make a figure of one line's width: a panel is at most 1.8 times as wide as tall, or 1.25 as tall.
    across, along = _widen(across, tall / 1.25), _widen(along, 0.55 * wide)
    shape = (along[1] - along[0]) / (across[1] - across[0])

    def draw(figure: Any) -> None:
        ax = figure.subplots()
        for curve in curves:
            kept = np.union1d(thin(curve.x, MOST_POINTS // 2), thin(curve.y, MOST_POINTS // 2))
            ax.plot(curve.x[kept], curve.y[kept], label=curve.kind, **_STYLES[curve.kind])
        first = curves[0]
        ax.plot(first.x[:1], first.y[:1], "o", color="black", markersize=4, linestyle="none", label="start")
        ax.set_aspect("equal", adjustable="box")
        ax.set_xlim(*across)
        ax.set_ylim(*along)
        ax.set_xlabel("east [m]")
        ax.set_ylabel("north [m]")
        ax.locator_params(nbins=6)
        _legend(figure, [ax])

    return _svg(draw, (_WIDTH, 0.9 + 3.9 * shape), key, title)


def _range(values: Sequence[np.ndarray]) -> tuple[float, float]:
    """The range of an axis: everything, but no more than one and a half spans beyond the first line."""
    lows, highs = zip(*((float(v.min()), float(v.max())) for v in values if len(v)))
    span = max(highs[0] - lows[0], 1e-9 * max(1.0, abs(highs[0])))
    low = max(min(lows), lows[0] - 1.5 * span)
    high = min(max(highs), highs[0] + 1.5 * span)
    pad = 0.05 * max(high - low, 1e-9)
    return low - pad, high + pad


def _widen(limits: tuple[float, float], least: float) -> tuple[float, float]:
    short = max(0.0, least - (limits[1] - limits[0])) / 2
    return limits[0] - short, limits[1] + short


def _legend(figure: Any, axes: Sequence[Any]) -> None:
    handles = {label: h for ax in axes for h, label in zip(*ax.get_legend_handles_labels())}
    if len(handles) > 1:
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="upper left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.1,
            ncols=4,
            columnspacing=1.2,
            handlelength=2.4,
        )


def _svg(draw: Any, size: tuple[float, float], key: str, title: str) -> Markup:
    from matplotlib import rc_context, rcParamsDefault
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    settings: Any = {**{k: v for k, v in rcParamsDefault.items() if not k.startswith("backend")}, **_SETTINGS}
    with rc_context(settings):
        figure = Figure(figsize=size)
        FigureCanvasSVG(figure)
        draw(figure)
        # Margins in inches, for labels whose size is known: laying out by measuring text takes half of the time.
        rows = len(figure.axes)
        panel = (size[1] - _TOP - _BOTTOM - _GAP * (rows - 1)) / rows
        figure.subplots_adjust(
            left=_LEFT / size[0],
            right=1 - _RIGHT / size[0],
            bottom=_BOTTOM / size[1],
            top=1 - _TOP / size[1],
            hspace=_GAP / panel,
        )
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return _inline(buffer.getvalue(), key, title)


_HEAD = re.compile(r"^.*?<svg[^>]*?(viewBox=\"[^\"]*\")[^>]*>", re.DOTALL)
_METADATA = re.compile(r"<metadata>.*?</metadata>", re.DOTALL)
_NAME = re.compile(r"(\sid=\"|url\(#|href=\"#)")
_LONG = re.compile(r"(-?\d+\.\d\d)\d+")
_FONT = re.compile(r"font: ([\d.]+px)[^;\"]*|font-family:[^;\"]*;?")


def _inline(svg: str, key: str, title: str) -> Markup:
    """Make a whole SVG file fit for the inside of a page: no head, no names of its own, few digits."""
    head = _HEAD.match(svg)
    assert head is not None
    body = _METADATA.sub("", svg[head.end() :])
    body = _NAME.sub(rf"\g<1>{key}-", body.replace("xlink:href", "href"))
    body = _LONG.sub(r"\1", body).replace("#000000", "currentColor").replace("\nL ", "L").replace("\n", " ")
    body = _FONT.sub(lambda m: f"font-size: {m.group(1)}" if m.group(1) else "", body)
    label = escape(title)
    start = f'<svg {head.group(1)} role="img" aria-label="{label}"><title>{label}</title>'
    return Markup(start + re.sub(r"\s{2,}", " ", body))
