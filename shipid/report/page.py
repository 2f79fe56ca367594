"""A page: a title, the answer in words, warnings, and sections; a section is a template and its data."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, TypeAlias

from shipid.report.typography.prose import prose

if TYPE_CHECKING:
    import jinja2

#: One row of a table: what its columns show, by key.
Row: TypeAlias = Mapping[str, object]


@dataclass(frozen=True, eq=False)
class Section:
    """One section of a page.

    Attributes
    ----------
    title : str
        Its heading.
    template : str
        The file in the folder ``templates``; its name, without folder and ending, is the anchor.
    view : mapping
        What the template reads, as ``view``.
    short : str
        How the contents call it; its title by default.
    parts : sequence of (str, str)
        Anchor and title of each part that the contents list instead of the section.
    folded : bool
        Whether only the heading is seen until the reader opens it; on paper it is open.
    """

    title: str
    template: str
    view: Mapping[str, object]
    short: str = ""
    parts: Sequence[tuple[str, str]] = ()
    folded: bool = False

    @property
    def key(self) -> str:
        """The anchor."""
        return PurePosixPath(self.template).stem

    @property
    def contents(self) -> Sequence[tuple[str, str]]:
        """Anchors and titles for the contents of the page."""
        return self.parts or [(self.key, self.short or self.title)]


@dataclass(frozen=True, eq=False)
class Page:
    """What a page says.

    Attributes
    ----------
    title : str
        Its heading.
    answers : sequence of (str, sequence of str)
        Paragraphs that come first: a name, empty where there is one only, and sentences.
    sections : sequence of Section
        In order.
    warnings, cautions : sequence of str
        What may make the result wrong, and what limits it.
    footer : str
        The last line.
    """

    title: str
    answers: Sequence[tuple[str, Sequence[str]]]
    sections: Sequence[Section]
    warnings: Sequence[str] = ()
    cautions: Sequence[str] = ()
    footer: str = ""

    def html(self, command: str = "", made: date | None = None) -> str:
        """Return the page as HTML text.

        Parameters
        ----------
        command : str
            What was typed to make it, as its last line says.
        made : date, optional
            When.
        """
        day = "" if made is None else f"{made.day} {made:%B %Y}"
        return _environment().get_template("page.html").render(page=self, command=command, day=day)


@functools.cache
def _environment() -> jinja2.Environment:
    import jinja2

    return jinja2.Environment(
        loader=jinja2.PackageLoader("shipid.report", "templates"),
        autoescape=True,
        finalize=prose,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
