"""Residuals against themselves and against the rudder, with the bounds of what chance makes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from shipid.identification.validation.residual_correlation import ResidualCorrelation
from shipid.report.figures.svg import BLUE, MUTED, WIDTH, Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PANEL = 1.2


def correlations_drawing(found: Sequence[ResidualCorrelation], labels: Mapping[str, str], title: str) -> Drawing:
    """Return one row a signal: autocorrelation, and cross-correlation with the rudder.

    Parameters
    ----------
    found : sequence of ResidualCorrelation
        At least one.
    labels : mapping of str to str
        What each signal is called.
    title : str
        What a screen reader says.
    """
    columns = 2 if any(c.rudder.size for c in found) else 1

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(found), columns, sharex="col", squeeze=False)
        for row, c in zip(axes, found):
            own = c.interval * np.arange(1, c.own.size + 1)
            _panel(row[0], own, c.own, c.own_bound, f"{labels[c.signal]}: with itself")
            if c.rudder.size:
                lags = c.interval * (np.arange(c.rudder.size) - c.rudder.size // 2)
                _panel(row[1], lags, c.rudder, c.rudder_bound, f"{labels[c.signal]}: with the rudder")
        for ax in axes[-1]:
            ax.set_xlabel("lag [s]")

    return Drawing(draw, (WIDTH, 0.75 + _PANEL * len(found)), title)


def _panel(ax: Axes, lags: np.ndarray, values: np.ndarray, bound: float, title: str) -> None:
    ax.axhspan(-bound, bound, color=MUTED, alpha=0.25, linewidth=0)
    ax.plot(lags, values, color=BLUE, linewidth=1.1)
    ax.axhline(0, color=MUTED, linewidth=0.6)
    ax.set_ylim(-1.05, 1.05)
    ax.set_title(title, loc="left", fontsize=8, pad=3)
    ax.locator_params(axis="x", nbins=5)
    ax.set_yticks([-1, 0, 1])
