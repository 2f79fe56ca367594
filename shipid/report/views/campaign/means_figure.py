"""Measures of a campaign that differ in one word beside each other: the mean of each with its 95 % interval."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from markupsafe import Markup

from shipid.campaign.moments import Statistic
from shipid.declaration.units import pretty
from shipid.declaration.vocabulary import display_factor, display_unit
from shipid.foundation.aliases import Plain
from shipid.report.figures.svg import BLUE, WIDTH, panel_title, svg
from shipid.report.views.words import sentence

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Fewer measures than this are no comparison.
_LEAST = 2
#: Height of a row in inches, and of what is around them.
_ROW, _AROUND = 0.34, 1.0


def means_figures(statistics: Iterable[Statistic]) -> list[Markup]:
    """Return a figure for each group of measures whose meanings are the same up to a colon.

    Parameters
    ----------
    statistics : iterable of Statistic
        Those with numbers; one without a mean is left out.
    """
    groups: dict[tuple[str, str], list[tuple[str, Statistic]]] = {}
    for one in statistics:
        what, colon, which = one.measure.meaning.partition(": ")
        if colon and one.mean is not None and one.measure.kind != "error":
            groups.setdefault((what, one.measure.unit), []).append((which, one))
    return [
        _figure(what, unit, members, f"means-{k}")
        for k, ((what, unit), members) in enumerate(groups.items())
        if len(members) >= _LEAST
    ]


def _figure(what: str, unit: str, members: list[tuple[str, Statistic]], key: str) -> Markup:
    factor = display_factor("", unit)

    def draw(figure: Figure) -> None:
        ax = figure.subplots()
        look: dict[str, Plain] = {"color": BLUE}
        for k, (which, one) in enumerate(members):
            assert one.mean is not None
            ends = one.mean_interval
            if ends is not None:
                ax.plot([factor * end for end in ends], [k, k], "-", linewidth=1.6, **look)
            ax.plot([factor * one.mean], [k], "o", markersize=5, **look)
            ax.text(0.01, k - 0.38, which, transform=ax.get_yaxis_transform(), fontsize=9, va="center")
        ax.set_yticks([])
        ax.set_ylim(len(members) - 0.5, -0.8)
        ax.margins(x=0.08)
        ax.locator_params(axis="x", nbins=6)
        ax.set_title(panel_title(sentence(what), pretty(display_unit("", unit))), loc="left", fontsize=9, pad=3)

    return svg(draw, (WIDTH, _AROUND + _ROW * len(members)), key, f"{sentence(what)}: means with their 95 % intervals")
