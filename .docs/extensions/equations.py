"""Equations as drawings inside the page: they need no script, no network and no font of the reader's."""

from __future__ import annotations

from html import escape
from typing import Any

from docutils import nodes
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.textpath import TextPath

#: The letters of SVG for the pieces of a path.
_LETTERS = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C", Path.CLOSEPOLY: "Z"}
#: The height of the letters, in pixels, and the room around an equation.
_SIZE, _MARGIN = 18, 1
#: Fractions stand at full size; matplotlib knows no cases, and rows behind a brace are the same.
_INSTEAD = (
    (r"\frac", r"\dfrac"),
    (r"\begin{cases}", r"\left\{\substack{"),
    (r"\end{cases}", r"}\right."),
    ("&", r"\;"),
)


def drawing(latex: str) -> str:
    """Return an equation as an SVG element in the colour of the text around it, or as code where it is too much.

    Parameters
    ----------
    latex : str
        The equation, without dollar signs.

    Returns
    -------
    str
    """
    known = " ".join(latex.split())
    for theirs, ours in _INSTEAD:
        known = known.replace(theirs, ours)
    try:
        path = TextPath((0, 0), f"${known}$", size=_SIZE, prop=FontProperties(math_fontfamily="dejavuserif"))
    except ValueError:
        return f"<code>{escape(latex)}</code>"
    box = path.get_extents()
    pieces = []
    for points, code in path.iter_segments(simplify=False):
        pairs = (f"{x:.2f} {-y:.2f}" for x, y in points.reshape(-1, 2))
        pieces.append("Z" if code == Path.CLOSEPOLY else _LETTERS[code] + " ".join(pairs))
    left, top = box.x0 - _MARGIN, -box.y1 - _MARGIN
    width, height = box.width + 2 * _MARGIN, box.height + 2 * _MARGIN
    below = max(0.0, top + height)
    return (
        f'<svg class="equation" role="img" aria-label="{escape(latex)}" width="{width:.1f}" height="{height:.1f}" '
        f'style="vertical-align: {-below:.1f}px" viewBox="{left:.2f} {top:.2f} {width:.2f} {height:.2f}">'
        f'<path fill="currentColor" d="{"".join(pieces)}"/></svg>'
    )


def _inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(drawing(node.astext()))
    raise nodes.SkipNode


def _block(writer: Any, node: nodes.math_block) -> None:
    writer.body.append(f'<div class="equation">{drawing(node.astext())}</div>\n')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer under the name ``drawing``."""
    app.add_html_math_renderer("drawing", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
