"""The figures of a report as matplotlib figures, for a notebook or a paper."""

from __future__ import annotations

from typing import TYPE_CHECKING

from shipid.foundation.errors import UsageError
from shipid.report.figures.svg import collected
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
    with collected() as drawings:
        page_of(result)
    kind = type(result).__name__
    if not drawings:
        raise UsageError(f"the report of this {kind} has no figure; its numbers are in to_frame().")
    words = str(which or "").lower().split()
    for key, drawing in drawings.items():
        if all(word in f"{key} {drawing.title}".lower() for word in words):
            return drawing.figure()
    listed = "; ".join(drawing.title for drawing in drawings.values())
    raise UsageError(f"no figure of this {kind} is called '{which}'. There are: {listed}.")
