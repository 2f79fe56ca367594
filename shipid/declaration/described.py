"""A model as a notebook and a terminal show it: its quantities by kind, with units, and its equations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape

from shipid.declaration.quantity import Kind, Quantity
from shipid.declaration.units import pretty

#: Kinds in the order of reading, and what a list of them is called.
_KINDS: tuple[tuple[Kind, str], ...] = (
    ("state", "states"),
    ("given", "inputs"),
    ("parameter", "parameters"),
    ("constant", "constants"),
    ("derived", "derived"),
    ("output", "sensors"),
)
#: Most characters of the names of one kind in a text.
_WIDTH = 130


def model_text(name: str, components: Sequence[str], quantities: Sequence[Quantity]) -> str:
    """Return a model in at most ten lines of text.

    Parameters
    ----------
    name : str
        Of the model.
    components : sequence of str
        What it was joined from.
    quantities : sequence of Quantity
        All it has, in the order of declaration.
    """
    lines = [f"Model {name}: {', '.join(components)}"]
    for title, found in _by_kind(quantities):
        named = [q.name if q.unit == "1" else f"{q.name} [{pretty(q.unit)}]" for q in found]
        lines.append(f"  {title:<11s} {_fitting(named)}")
    return "\n".join([*lines, "  equations   shipid.typeset(model), or as a notebook shows the model"])


def model_html(
    name: str,
    components: Sequence[str],
    quantities: Sequence[Quantity],
    equations: Sequence[tuple[str, str, str]],
) -> str:
    """Return a model as HTML for a notebook: its equations, then its quantities in a table.

    Parameters
    ----------
    name, components, quantities
        See `model_text`.
    equations : sequence of (str, str, str)
        Each as MathML, as plain text, and its source.
    """
    parts = [f"<p><strong>Model {escape(name)}</strong>: {escape(', '.join(components))}</p>"]
    listed = (
        f'<li><span role="math" aria-label="{escape(plain)}">{mathml}</span><br><small>{escape(source.replace("`", ""))}</small></li>'
        for mathml, plain, source in equations
    )
    parts.append(f"<ul>{''.join(listed)}</ul>")
    parts.append("<table><thead><tr><th>Kind</th><th>Name</th><th>Unit</th><th>Meaning</th></tr></thead><tbody>")
    for title, found in _by_kind(quantities):
        for k, q in enumerate(found):
            cells = (escape(title) if k == 0 else "", f"<code>{escape(q.name)}</code>", escape(pretty(q.unit)))
            row = "".join(f"<td>{cell}</td>" for cell in (*cells, escape(q.meaning)))
            parts.append(f"<tr>{row}</tr>")
    return f"<div>{''.join(parts)}</tbody></table></div>"


def _by_kind(quantities: Sequence[Quantity]) -> Iterator[tuple[str, list[Quantity]]]:
    for kind, title in _KINDS:
        if found := [q for q in quantities if q.kind == kind]:
            yield title, found


def _fitting(names: Sequence[str]) -> str:
    """As many names as fit in a line, and how many more there are."""
    kept: list[str] = []
    for k, one in enumerate(names):
        if kept and len(", ".join([*kept, one])) > _WIDTH:
            return f"{', '.join(kept)} and {len(names) - k} more"
        kept.append(one)
    return ", ".join(kept)
