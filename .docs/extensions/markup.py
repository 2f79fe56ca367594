"""The few pieces of reStructuredText that the generated pages are made of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path


def title(text: str, line: str = "=") -> str:
    """Return a heading.

    Parameters
    ----------
    text : str
        The words.
    line : str
        What underlines them: ``=`` for a page, ``-`` for a section.

    Returns
    -------
    str
    """
    return f"{text}\n{line * len(text)}\n"


def plain(text: str) -> str:
    """Escape what would be taken for a mark, except backticks, which mean the same in a docstring.

    Parameters
    ----------
    text : str
        Words of a docstring or of a help text.

    Returns
    -------
    str
    """
    return re.sub(r"([\\*|_])", r"\\\1", text)


def indented(text: str) -> str:
    """Indent every line that is not empty.

    Parameters
    ----------
    text : str
        What stands below a directive or a term.

    Returns
    -------
    str
    """
    return re.sub(r"^(?=.)", "   ", text, flags=re.MULTILINE)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], widths: str) -> str:
    """Return a table.

    Parameters
    ----------
    heads : sequence of str
        The titles of the columns.
    rows : iterable of sequence of str
        The cells, in marked-up text.
    widths : str
        Shares of the width, as in ``"30 70"``.

    Returns
    -------
    str
    """
    lines = [".. list-table::", "   :header-rows: 1", f"   :widths: {widths}", ""]
    for row in [heads, *rows]:
        lines += [f"   {'* -' if i == 0 else '  -'} {cell}" for i, cell in enumerate(row)]
    return "\n".join([*lines, ""])


def emptied(folder: Path) -> Path:
    """Return a folder for generated pages without those of an earlier build.

    Parameters
    ----------
    folder : Path
        The folder; it is made where there is none.

    Returns
    -------
    Path
    """
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    return folder
