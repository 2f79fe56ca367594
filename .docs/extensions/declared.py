"""Two directives: equations as the models declare them, and the rows that a study of a paper printed.

``{equations} MODEL`` with ``:of: r u`` typesets the equations of those quantities with their sources, all of them without
``:of:``. ``{verdicts} STUDY`` shows the rows, the readings and the figure that ``studies/papers.py`` kept of a study.
"""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from click.testing import CliRunner
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

from shipid.cli import main

PAPERS = Path(__file__).resolve().parents[1] / "papers"
_HEADS = (("verdict", "Verdict"), ("published", "Published, or asked"), ("ours", "Here"), ("spread", "Spread"))
#: How a row that belongs to a claim of a paper begins; the others compare with other programs, or go beyond the paper.
_CLAIM = re.compile(r"[A-DP]\d")


@functools.cache
def equations_of(model: str) -> tuple[dict[str, Any], ...]:
    """Return the equations of a model as ``shipid show MODEL --json`` lists them.

    Parameters
    ----------
    model : str
        Its name.

    Returns
    -------
    tuple of dict
    """
    shown = CliRunner().invoke(main, ["show", model, "--json"], catch_exceptions=False).stdout
    return tuple(json.loads(shown)["equations"])


def words(text: str) -> list[nodes.Node]:
    """Return words of a docstring, with what stands between backticks as code.

    Parameters
    ----------
    text : str
        One paragraph.

    Returns
    -------
    list of Node
    """
    parts = text.replace("``", "`").split("`")
    return [nodes.literal(p, p) if i % 2 else nodes.Text(p) for i, p in enumerate(parts) if p]


def paragraphs(text: str) -> list[nodes.Node]:
    """Return the paragraphs of a docstring.

    Parameters
    ----------
    text : str
        Paragraphs with an empty line between them.

    Returns
    -------
    list of Node
    """
    return [nodes.paragraph("", "", *words(" ".join(p.split()))) for p in text.split("\n\n")]


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> nodes.table:
    """Return a table.

    Parameters
    ----------
    heads : sequence of str
        The titles of the columns.
    rows : iterable of sequence of str
        The cells.

    Returns
    -------
    table
    """

    def row(cells: Sequence[str]) -> nodes.row:
        return nodes.row("", *(nodes.entry("", *(paragraphs(cell) if cell else [])) for cell in cells))

    group = nodes.tgroup("", *(nodes.colspec(colwidth=1) for _ in heads), cols=len(heads))
    group += nodes.thead("", row(heads))
    group += nodes.tbody("", *map(row, rows))
    return nodes.table("", group, classes=["verdicts"])


def _rows(first: str, rows: list[dict[str, str]]) -> list[nodes.Node]:
    heads = [("claim", first), *((key, head) for key, head in _HEADS if any(r.get(key) for r in rows))]
    return [table([head for _, head in heads], [[r.get(key, "") for key, _ in heads] for r in rows])] if rows else []


class Equations(SphinxDirective):
    """Equations of a model, typeset by the toolbox, each with its source."""

    required_arguments = 1
    option_spec: ClassVar = {"of": directives.unchanged_required}

    def run(self) -> list[nodes.Node]:
        """Return an equation and its source for each quantity."""
        listed = equations_of(self.arguments[0])
        asked = self.options.get("of", "").split() or [e["target"] for e in listed]
        unknown = set(asked) - {e["target"] for e in listed}
        if unknown:
            raise self.error(f"{self.arguments[0]} has no equation of {', '.join(sorted(unknown))}.")
        made: list[nodes.Node] = []
        for each in (e for target in asked for e in listed if e["target"] == target):
            made.append(nodes.math_block(each["latex"], each["latex"], number=None, label=None, nowrap=False))
            made.append(nodes.container("", *paragraphs(each["source"]), classes=["source"]))
        return made


class Verdicts(SphinxDirective):
    """What a study of a paper printed: claims beside what was found, readings, and its figure."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the table, the readings, the figure and the command."""
        name, kept = self.arguments[0], PAPERS / "verdicts.json"
        self.env.note_dependency(str(kept))
        study = json.loads(kept.read_text(encoding="utf-8")).get(name)
        if study is None:
            raise self.error(f"{kept.name} holds no study '{name}'. Run studies/papers.py {name}.")
        claimed = [r for r in study["rows"] if _CLAIM.match(r["claim"])]
        made = _rows("Claim", claimed)
        if beside := [r for r in study["rows"] if r not in claimed]:
            made += [nodes.paragraph("", "Beside the claims:"), *_rows("What", beside)]
        readings = list(dict.fromkeys(r["reading"] for r in study["rows"] if r.get("reading")))
        if readings:
            made.append(nodes.paragraph("", "Readings:"))
            made.append(nodes.bullet_list("", *(nodes.list_item("", *paragraphs(text)) for text in readings)))
        if study["figure"]:
            image = nodes.image(uri=study["figure"], alt=f"Figure of studies/{name}.py", classes=["drawn"])
            made.append(nodes.figure("", image))
        made.append(nodes.paragraph("", "Printed by ", nodes.literal("", study["command"]), nodes.Text(".")))
        return made


def setup(app: Any) -> dict[str, bool]:
    """Register both directives."""
    app.add_directive("equations", Equations)
    app.add_directive("verdicts", Verdicts)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
