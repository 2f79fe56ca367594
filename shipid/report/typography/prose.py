"""Sentences of docstrings and messages on a page: what stands between backticks is set as code."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

_CODE = re.compile(r"(`{1,2})(.+?)\1", re.DOTALL)


def prose(value: object) -> object:
    """Return a text with its backticks turned into ``code`` elements; what is no text, or markup already, as it is.

    Parameters
    ----------
    value : object
        What a template shows.
    """
    if not isinstance(value, str) or isinstance(value, Markup) or "`" not in value:
        return value
    marked = _CODE.sub(r"<code>\2</code>", str(escape(value)))
    return Markup(marked.replace("`", "‘"))
