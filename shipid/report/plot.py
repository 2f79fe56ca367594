"""The figures of a report as matplotlib figures, for a notebook or a paper."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.report.figures.svg import Drawing, fill, look, undrawn
from shipid.report.page import Page
from shipid.report.write_report import page_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shipid.report.write_report import Reported


def plot(result: Reported, which: str | None = None) -> Figure:
    """Return a figure of the report of a result as a matplotlib figure.

    A notebook shows the figure; ``plot(...).savefig("figure.pdf")`` writes it.

    Parameters
    ----------
    result : Fit, FilterRun, Trial, Autopilot, Judgement, Prediction, Tracking or another result with a report
        What is drawn.
    which : str, optional
        Words out of the title of the figure, such as ``"track"``; by default the first figure of the report.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        If there is no report for this kind of result, its report has no figure, or no figure has these words in its
        title; the message lists the figures there are.
    """
    with undrawn():
        drawings = list(_drawings(page_of(result)))
    if not drawings:
        raise UsageError(f"the report of this {type(result).__name__} has no figure.")
    words = (which or "").lower().split()
    for drawing in drawings:
        if all(word in f"{drawing.key} {drawing.words}".lower() for word in words):
            return _figure(drawing)
    listed = "; ".join(f"{d.words} ({d.key})" for d in drawings)
    raise UsageError(f"no figure of this {type(result).__name__} is called '{which}'. There are: {listed}.")


def _drawings(page: Page) -> Iterator[Drawing]:
    """The figures of a page, in order."""
    for section in page.sections:
        yield from _within(section.view)


def _within(value: Plain) -> Iterator[Drawing]:
    if isinstance(value, Drawing):
        yield value
    elif isinstance(value, Mapping):
        for inner in value.values():
            yield from _within(inner)
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for inner in value:
            yield from _within(inner)


def _figure(drawing: Drawing) -> Figure:
    """The figure, drawn again: it belongs to no window, and a notebook shows it once."""
    from matplotlib.figure import Figure

    class ReportFigure(Figure):
        """A figure that a notebook shows without pyplot."""

        def _repr_png_(self) -> bytes:
            buffer = io.BytesIO()
            self.savefig(buffer, format="png")
            return buffer.getvalue()

    with look():
        figure = ReportFigure(figsize=drawing.size, dpi=120)
        fill(figure, drawing.draw, drawing.size)
    return figure
