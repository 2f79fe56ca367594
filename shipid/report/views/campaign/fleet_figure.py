"""The coefficients of a fleet: each trial's value with its 95 % interval, a panel a coefficient, and the mean over the trials."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from shipid.campaign.fleet import PARTS
from shipid.campaign.fleet_result import FleetResult
from shipid.declaration.units import pretty
from shipid.estimation.standing import DETERMINED
from shipid.foundation.statistics import interval_95
from shipid.report.figures.svg import BLUE, MUTED, ORANGE, WIDTH, legend, panel_title, power_of, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Most coefficients, and most trials, that are drawn.
_PANELS, _TRIALS = 6, 40
_PANEL = 0.85


def fleet_figure(found: FleetResult, key: str) -> Markup | None:
    """Return the figure as SVG; None for fewer than two trials with a coefficient that they determine.

    Parameters
    ----------
    found : FleetResult
        The fleet.
    key : str
        Put before every id.
    """
    rows = found.rows
    known = {n: np.flatnonzero(np.asarray(rows[f"{n}_{PARTS[3]}"]) == DETERMINED)[:_TRIALS] for n in found.coefficients}
    drawn = [n for n, at in known.items() if at.size > 1][:_PANELS]
    if not drawn:
        return None
    trials = sorted({int(k) for n in drawn for k in known[n]})

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
        for ax, name in zip(axes, drawn):
            at, scatter = known[name], found.coefficients[name]
            power = power_of(np.asarray(rows[name], dtype=float)[at])
            values, stds = (np.asarray(rows[c], dtype=float)[at] / 10.0**power for c in (name, f"{name}_std"))
            where = np.searchsorted(trials, at) + 1
            if scatter.mean is not None and scatter.mean_std is not None:
                mean, std = scatter.mean / 10.0**power, scatter.mean_std / 10.0**power
                ax.axhspan(*interval_95(mean, std), color=ORANGE, alpha=0.25, linewidth=0)
                ax.axhline(mean, color=ORANGE, linewidth=1.0, label="mean, with its 95 % interval")
            ends = np.array([interval_95(value, std) for value, std in zip(values, stds)])
            ax.vlines(where, ends[:, 0], ends[:, 1], color=BLUE, linewidth=1.4)
            ax.plot(where, values, "o", color=BLUE, markersize=3.5, label="a trial, with its 95 % interval")
            ax.set_title(panel_title(name, pretty(scatter.unit), power), loc="left", fontsize=9, pad=3)
            ax.tick_params(axis="x", colors=MUTED)
        axes[-1].set_xlim(0.5, len(trials) + 0.5)
        axes[-1].set_xticks(np.arange(len(trials)) + 1, [str(rows["trial"][k]).rsplit(".", 1)[0] for k in trials])
        if sum(len(str(rows["trial"][k])) for k in trials) > 50:
            axes[-1].set_xticks(axes[-1].get_xticks(), [str(k + 1) for k in trials])
            axes[-1].set_xlabel("trial, in the order of the table")
        legend(figure, axes)

    size = (WIDTH, 1.0 + (_PANEL + 0.27) * len(drawn))
    return svg(draw, size, key, f"Coefficients of {found.model} by trial, with 95 % intervals, and their means")
