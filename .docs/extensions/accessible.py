"""What the theme leaves out for readers who use the keyboard or a screen reader; put in when the pages are written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

#: What stands in a page, and what takes its place.
_MENDED = {
    # The captions above groups of pages are headings, and a heading has a level.
    '<p class="caption" role="heading">': '<p class="caption" role="heading" aria-level="2">',
    # Two regions beside the text need names that tell them apart.
    '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="All pages">',
    '<aside class="toc-drawer">': '<aside class="toc-drawer" aria-label="This page">',
    # What is wider than a phone is moved sideways with the keyboard, too.
    "<pre>": '<pre tabindex="0">',
    '<div class="equation">': '<div class="equation" tabindex="0">',
}


def mended(page: str) -> str:
    """Return a page with what its theme leaves out.

    Parameters
    ----------
    page : str
        HTML.

    Returns
    -------
    str
    """
    for theirs, ours in _MENDED.items():
        page = page.replace(theirs, ours)
    return page


def _mend(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html":
        for path in Path(app.outdir).rglob("*.html"):
            path.write_text(mended(path.read_text(encoding="utf-8")), encoding="utf-8")


def setup(app: Any) -> dict[str, bool]:
    """Mend the pages when they are written."""
    app.connect("build-finished", _mend)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
