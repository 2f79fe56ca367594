"""What Sphinx finds no page for: files of the repository, and words between backticks."""

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
        folders = (_ROOT, _ROOT / ".github", Path(app.env.doc2path(app.env.docname)).parent)
        if link["reftype"] == "myst" and target and any((f / target).exists() for f in folders):
            link.replace_self(link.children)


def _find_or_leave(app: Any, environment: Any, node: nodes.Element, content: nodes.Element) -> nodes.Element | None:
    """Look for a word between single backticks among the public names, and leave it as code where it is none of them."""
    if node.get("reftype") != "obj":
        return None
    first, dot, rest = str(node["reftarget"]).partition(".")
    path = app.config.numpydoc_xref_aliases.get(first, f"shipid.{first}") + dot + rest
    found: nodes.Element | None = environment.domains["py"].resolve_xref(
        environment, node["refdoc"], app.builder, "obj", path, node, content
    )
    return found or content


def setup(app: Any) -> dict[str, bool]:
    """Connect both to what Sphinx reads, and to what it does not find."""
    app.connect("doctree-read", _name_files)
    app.connect("missing-reference", _find_or_leave)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
