"""A matplotlib figure that a notebook shows."""

from __future__ import annotations

import io

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from shipid.foundation.aliases import Plain

#: Dots per inch on the screen.
_DPI = 120


class NotebookFigure(Figure):
    """A figure that belongs to no window of pyplot, and that a notebook shows as the result of its cell, once.

    Parameters
    ----------
    **settings
        As for ``matplotlib.figure.Figure``.
    """

    def __init__(self, **settings: Plain) -> None:
        super().__init__(**settings)
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=_DPI)
        return buffer.getvalue()
