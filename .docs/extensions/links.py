"""After the build: each link inside the site leads somewhere, and no page asks another host for anything.

Each fault is a warning, so that a build with ``-W`` fails. Nothing is fetched: links to other hosts are for the reader to follow, and
are not looked at.
"""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from sphinx.util import logging

logger = logging.getLogger(__name__)
#: What a browser fetches by itself, by element: its attribute.
_FETCHED = {"script": "src", "img": "src", "source": "src", "iframe": "src", "link": "href"}
#: Links of the head that name an address and fetch nothing.
_NAMED_ONLY = {"canonical", "next", "prev", "index", "search", "author", "license"}
_IN_STYLE = re.compile(r"""(?:@import\s+(?!url)|url\()\s*["']?([^"')\s]+)""")


class Page(HTMLParser):
    """The anchors of a page, where its links lead, and what it fetches."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take the anchors and addresses of one element."""
        given = {key: value or "" for key, value in attrs}
        self.anchors |= {given[key] for key in ("id", "name") if given.get(key)}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        named = tag == "link" and set(given.get("rel", "").split()) & _NAMED_ONLY
        if not named and given.get(_FETCHED.get(tag, "")):
            self.fetched.append(given[_FETCHED[tag]])


def faults(site: Path) -> list[str]:
    """Return what is wrong with the links of a built site, one line each.

    Parameters
    ----------
    site : Path
        The folder with its pages.

    Returns
    -------
    list of str
    """
    files = {p for p in site.rglob("*") if p.is_file()}
    pages = {p: Page(p.read_text(encoding="utf-8")) for p in files if p.suffix == ".html"}
    found = []
    for path, page in sorted(pages.items()):
        where = path.relative_to(site).as_posix()
        found += [f"{where} fetches {a} from another host" for a in page.fetched if urlsplit(a).netloc]
        inside = [a for a in page.links + page.fetched if not urlsplit(a).scheme and not urlsplit(a).netloc]
        for address in dict.fromkeys(inside):
            parts = urlsplit(address)
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if target not in files:
                found.append(f"{where} leads to {address}, which is not there")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                found.append(f"{where} leads to {address}, and that page has no such place")
    for path in sorted(p for p in files if p.suffix == ".css"):
        fetched = _IN_STYLE.findall(path.read_text(encoding="utf-8"))
        found += [f"{path.name} fetches {a} from another host" for a in fetched if urlsplit(a).netloc]
    return found


def _look(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html":
        for fault in faults(Path(app.outdir).resolve()):
            logger.warning("%s", fault)


def setup(app: Any) -> dict[str, bool]:
    """Look at the pages when they are written."""
    app.connect("build-finished", _look)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
