"""What is no link on the site: files of the repository, and words between backticks that the API does not have."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref

_ROOT = Path(__file__).resolve().parents[2]


def _name_files(app: Any, page: nodes.document) -> None:
    """Replace a link of an included file (README, contribution guide) to a file of the repository by its text.

    A path that leads nowhere stays as it is, and Sphinx warns of it.
    """
    for link in list(page.findall(pending_xref)):
        target = str(link["reftarget"])
        if link["reftype"] == "myst" and target and any((_ROOT / f / target).exists() for f in ("", ".github")):
            link.replace_self(link.children)


def _leave_code(app: Any, environment: Any, node: nodes.Element, content: nodes.Element) -> nodes.Element | None:
    """Leave a word between single backticks as code where the API has no such name."""
    return content if node.get("reftype") == "obj" else None


def setup(app: Any) -> dict[str, bool]:
    """Connect both to what Sphinx reads and does not find."""
    app.connect("doctree-read", _name_files)
    app.connect("missing-reference", _leave_code)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
