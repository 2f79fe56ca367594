"""A figure drawn by matplotlib as inline SVG: small, the same bytes for the same data, readable on light and dark paper."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import ceil, floor, log10
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup, escape

from shipid.foundation.aliases import Plain
from shipid.trials.filling import GAP, usual_interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Panels
    from matplotlib.figure import Figure

#: Most points of one curve.
MOST_POINTS = 600
#: Width in inches: text of 9 pt stays readable when a phone shrinks it to 330 px.
WIDTH = 4.7
#: A mark of a legend in points, at least.
_MARK = 3.5
#: Colours as matplotlib draws them. On a page each is the custom property of that name, which has a shade of its own on light
#: paper, on dark paper and in print.
BLUE, ORANGE, GREEN, PURPLE, GOLD, RED = "#2f7fc4", "#d9700a", "#2e9e6b", "#a9589f", "#b8860b", "#c0392b"
#: Of what is less important.
MUTED = "#7d8590"
#: Behind a label that lies over lines: the paper.
PAPER = "#fefefe"
_PROPERTIES = {
    BLUE: "--blue",
    ORANGE: "--orange",
    GREEN: "--green",
    PURPLE: "--purple",
    GOLD: "--gold",
    RED: "--red",
    MUTED: "--muted",
    PAPER: "--paper",
}
#: Points that the line of an entry of a legend takes beside its name, those of a letter, and the height of a row in inches.
_ENTRY, _LETTER, _ROW = 40.0, 5.7, 0.17
#: Letters that are wider or narrower than others, in widths of a digit.
_WIDTHS = {
    **dict.fromkeys("mMW%", 1.55),
    **dict.fromkeys("wOQGD", 1.3),
    **dict.fromkeys("tr()f-", 0.64),
    **dict.fromkeys("ijl.,:;'| ", 0.5),
}
_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
#: Margins of a figure and the gap between its panels, in inches.
_LEFT, _RIGHT, _TOP, _BOTTOM, _GAP = 0.55, 0.2, 0.5, 0.45, 0.27
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
    "grid.color": MUTED,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    # Where a title stands is not searched for: a third of the time of a figure, and the panels have none above their ticks.
    "axes.titley": 1.0,
    "axes.unicode_minus": True,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
}


def thin(y: np.ndarray, most: int = MOST_POINTS) -> np.ndarray:
    """Return the indices of at most `most` samples that keep the first, the last and every extreme, and all breaks of the line.

    The record is cut into stretches of equal length; the lowest and the highest sample of each are kept.

    Parameters
    ----------
    y : ndarray, shape (n,)
        The samples; NaN where the line breaks.
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
    low = begin + np.nan_to_num(padded, nan=np.inf).argmin(axis=1)
    high = begin + np.nan_to_num(padded, nan=-np.inf).argmax(axis=1)
    return np.unique(np.clip(np.concatenate([[0, n - 1], low, high, np.flatnonzero(np.isnan(y))]), 0, n - 1))


def with_gaps(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a line through the samples that are there, broken where they have a hole.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Times in s, rising.
    y : ndarray, shape (n,)
        The samples; NaN where one is missing.

    Returns
    -------
    t, y : ndarray, shape (m,)
        NaN between two samples that are further apart than a hole may be to be filled (`shipid.trials.filling`).
    """
    there = np.isfinite(y)
    t, y = t[there], y[there]
    if t.size < 2:
        return t, y
    behind = np.flatnonzero(np.diff(t) > GAP * usual_interval(t)) + 1
    return np.insert(t, behind, t[behind]), np.insert(y, behind, np.nan)


def axis_range(values: Sequence[np.ndarray]) -> tuple[float, float]:
    """Return the range of an axis: everything, but no more than one and a half spans beyond the first line.

    Parameters
    ----------
    values : sequence of ndarray
        The lines.
    """
    there = [v[np.isfinite(v)] for v in values]
    lows, highs = zip(*((float(v.min()), float(v.max())) for v in there if len(v)))
    span = max(highs[0] - lows[0], 1e-9 * max(1.0, abs(highs[0])))
    low = max(min(lows), lows[0] - 1.5 * span)
    high = min(max(highs), highs[0] + 1.5 * span)
    pad = 0.05 * max(high - low, 1e-9)
    return low - pad, high + pad


def power_of(values: np.ndarray) -> int:
    """Return the power of ten to take out of the values of an axis, so that its labels stay short; mostly 0.

    Parameters
    ----------
    values : ndarray
        What the axis shows.
    """
    largest = float(np.nanmax(np.abs(values), initial=0.0))
    power = floor(log10(largest)) if 0 < largest < np.inf else 0
    return 0 if -2 < power < 5 else power


def panel_title(label: str, unit: str, power: int = 0) -> str:
    """Return what a panel shows, with its unit in brackets where there is one.

    Parameters
    ----------
    label, unit : str
        What the vertical axis shows.
    power : int
        Of ten, that was taken out of the values.
    """
    if power:
        unit = f"10{str(power).translate(_SUPERSCRIPT)}{'' if unit in ('', '1') else f' {unit}'}"
    return label if unit in ("", "1") else f"{label} [{unit}]"


def legend(figure: Figure, axes: Iterable[Panels]) -> None:
    """Put one legend above the panels, where there is more than one kind of line.

    Parameters
    ----------
    figure : Figure
        The figure.
    axes : iterable of Axes
        Its panels.
    """
    from matplotlib.lines import Line2D

    handles = {label: h for ax in axes for h, label in zip(*ax.get_legend_handles_labels())}
    if len(handles) > 1:
        drawn = figure.legend(
            handles.values(),
            handles.keys(),
            loc="upper left",
            bbox_to_anchor=(0.0, 1.0),
            borderaxespad=0.1,
            ncols=_columns(handles),
            columnspacing=1.2,
            handlelength=2.4,
        )
        # Dots that are small because there are many of them are seen as one of them, too.
        for mark in drawn.legend_handles:
            if isinstance(mark, Line2D) and mark.get_markersize() < _MARK:
                mark.set_markersize(_MARK)


def _columns(labels: Iterable[str]) -> int:
    """Entries of a legend beside each other: as many as stand in the width of a figure, four at most, filled column by column."""
    wide = [_LETTER * sum(_WIDTHS.get(letter, 1.0) for letter in label) for label in labels]
    for n in range(min(4, len(wide)), 1, -1):
        taken = sum(_ENTRY + max(column) for column in np.array_split(np.array(wide), n))
        if taken < 72 * WIDTH:
            return n
    return 1


def panel_size(size: tuple[float, float]) -> tuple[float, float]:
    """Return width and height of the panel of a figure with a single one, in inches.

    Parameters
    ----------
    size : tuple of float
        Of the figure, in inches.
    """
    return size[0] - _LEFT - _RIGHT, size[1] - _TOP - _BOTTOM


@dataclass(frozen=True, eq=False)
class Drawing:
    """A figure that is not drawn yet.

    Attributes
    ----------
    draw : callable
        Draws into the figure it is given.
    size : tuple of float
        Width and height in inches.
    title : str
        What a screen reader says.
    """

    draw: Callable[[Figure], None]
    size: tuple[float, float]
    title: str

    def figure(self) -> Figure:
        """Return it as a figure of matplotlib, for a notebook or a file of one's own."""
        from matplotlib import rc_context, rcParamsDefault

        from shipid.report.notebook_figure import NotebookFigure

        settings: Plain = {k: v for k, v in rcParamsDefault.items() if not k.startswith("backend")}
        with rc_context(settings | _SETTINGS):
            figure = NotebookFigure(figsize=self.size)
            self.draw(figure)
            # Margins in inches, for labels whose size is known: laying out by measuring text takes half of the time.
            labels = [text.get_text() for one in figure.legends for text in one.get_texts()]
            extra = _ROW * (ceil(len(labels) / _columns(labels)) - 1) if labels else 0.0
            width, height = self.size[0], self.size[1] + extra
            figure.set_size_inches(width, height)
            place = figure.axes[0].get_subplotspec() if figure.axes else None
            rows = 1 if place is None else place.get_gridspec().nrows
            top = _TOP + extra
            panel = (height - top - _BOTTOM - _GAP * (rows - 1)) / rows
            figure.subplots_adjust(
                left=_LEFT / width,
                right=1 - _RIGHT / width,
                bottom=_BOTTOM / height,
                top=1 - top / height,
                hspace=_GAP / panel,
                wspace=0.16,
            )
        return figure

    def svg(self, key: str) -> Markup:
        """Return it as inline SVG.

        Parameters
        ----------
        key : str
            Put before every id, so that several figures can stand in one page.
        """
        from matplotlib import rc_context, rcParamsDefault

        if (collected := _COLLECTED.get()) is not None:
            collected[key] = self
            return Markup("<svg/>")
        figure, buffer = self.figure(), io.StringIO()
        for axis in (one for ax in figure.axes for one in (ax.xaxis, ax.yaxis)):
            # Room for a label without words is not searched for among the labels of the ticks.
            if not axis.get_label_text():
                axis.set_label_coords(0.0, 0.0)
        settings: Plain = {k: v for k, v in rcParamsDefault.items() if not k.startswith("backend")}
        with rc_context(settings | _SETTINGS):
            figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
        return _inline(buffer.getvalue(), key, self.title)


def svg(draw: Callable[[Figure], None], size: tuple[float, float], key: str, title: str) -> Markup:
    """Return a figure as inline SVG.

    Parameters
    ----------
    draw, size, title
        See `Drawing`.
    key : str
        Put before every id, so that several figures can stand in one page.
    """
    return Drawing(draw, size, title).svg(key)


#: Where figures go that are collected, and not drawn.
_COLLECTED: ContextVar[dict[str, Drawing] | None] = ContextVar("collected", default=None)


@contextmanager
def collected() -> Iterator[Mapping[str, Drawing]]:
    """Return a context in which figures are collected by their keys, and have no SVG: for a page that nobody reads."""
    found: dict[str, Drawing] = {}
    token = _COLLECTED.set(found)
    try:
        yield found
    finally:
        _COLLECTED.reset(token)


_HEAD = re.compile(r"^.*?<svg[^>]*?(viewBox=\"[^\"]*\")[^>]*>", re.DOTALL)
_METADATA = re.compile(r"<metadata>.*?</metadata>|<style.*?</style>", re.DOTALL)
_NAME = re.compile(r"(\sid=\"|url\(#|href=\"#)")
_NAMED = re.compile(r"\sid=\"([^\"]*)\"")
_USED = re.compile(r"(?:url\(|href=\")#([^)\"]*)")
#: Where a place stands, and not a word or a shade; a curve of many points needs one decimal, the outline of a mark two.
_PLACE = re.compile(r" (?:d|x|y|transform|points)=\"[^\"]*\"")
_LONG = {1: re.compile(r"(-?\d+\.\d)\d+"), 2: re.compile(r"(-?\d+\.\d\d)\d+")}
_MANY = 400
_ZERO = re.compile(r"-0(?:\.0+)?(?![\d.])|(?<=\d)\.0+(?!\d)")
_FONT = re.compile(r"font: ([\d.]+px)[^;\"]*|font-family:[^;\"]*;?")
_COLOUR = re.compile("|".join(_PROPERTIES))
#: Lines of the grid, ticks and text that is not turned, as matplotlib writes each of them in full.
_GRID = re.compile(
    r" clip-path=\"[^\"]*\" style=\"fill: none; stroke: #7d8590; stroke-opacity: 0\.3; stroke-width: 0\.5[^\"]*\""
)
_TICK = re.compile(r"(<use [^>]*?) style=\"stroke: #000000; stroke-width: 0\.[68]\"")
_UPRIGHT = re.compile(r" transform=\"rotate\(-?0 [^\"]*\"")
_GROUP = re.compile(r"<g>((?:(?!</?g\b).)*)</g>", re.DOTALL)


def _inline(svg: str, key: str, title: str) -> Markup:
    """Make a whole SVG file fit for the inside of a page: no head, no names of its own, few digits, nothing said twice."""
    head = _HEAD.match(svg)
    assert head is not None
    body = _METADATA.sub("", svg[head.end() :]).replace("xlink:href", "href")
    body = _UPRIGHT.sub("", _TICK.sub(r"\1", _GRID.sub(' class="grid"', body)))
    used = set(_USED.findall(body))
    body = _NAMED.sub(lambda m: m.group() if m.group(1) in used else "", body)
    body = _NAME.sub(rf"\g<1>{key}-", body)
    body = _PLACE.sub(lambda m: _short(m.group()), body)
    body = body.replace("#000000", "currentColor").replace("\nL ", "L").replace("\n", " ")
    body = _COLOUR.sub(lambda m: f"var({_PROPERTIES[m.group()]})", body)
    body = _FONT.sub(lambda m: f"font-size: {m.group(1)}" if m.group(1) else "", body)
    body = re.sub(r"\s{2,}", " ", body).replace("> <", "><")
    while (less := _GROUP.sub(r"\1", body)) != body:
        body = less
    label = escape(title)
    return Markup(f'<svg {head.group(1)} role="img" aria-label="{label}"><title>{label}</title>{body}')


def _short(places: str) -> str:
    """Places with the digits that are seen."""
    few = _LONG[1 if len(places) > _MANY else 2].sub(r"\1", places)
    return _ZERO.sub(lambda m: "0" if m.group()[0] == "-" else "", few)
