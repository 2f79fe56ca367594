"""Sentences of docstrings and messages on a page: what stands between backticks is set as code, and a minus sign as one."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

#: A hyphen that is the sign of a number: the number follows it, and a space or a bracket goes before it; not that of an entry to be
#: typed, as in ``sign = -1``.
_MINUS = re.compile(r"(?:(?<=[\s(\[±])(?<!= )|^)-(?=\d)")
_CODE = re.compile(r"(`{1,2})(.+?)\1", re.DOTALL)


def prose(value: object) -> object:
    """Return a text with backticks turned into ``code`` elements and a minus sign before numbers; no text, or markup, as it is.

    Parameters
    ----------
    value : object
        What a template shows.
    """
    if not isinstance(value, str) or isinstance(value, Markup):
        return value
    value = _MINUS.sub("−", value)
    if "`" not in value:
        return value
    marked = _CODE.sub(r"<code>\2</code>", str(escape(value)))
    return Markup(marked.replace("`", "‘"))
