"""Text that came out of a file, made fit for a terminal: what steers a terminal is replaced."""

from __future__ import annotations

import re

#: Control characters (C0 but for tab and new line, delete, C1), surrogates, and the marks that turn the direction of text.
_STEERING = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\u061c\u200b-\u200f\u2028-\u202e\u2060-\u2069\ufeff\ufff9-\ufffb]"
)


def printable(text: str) -> str:
    """Return a text with a question mark for each character that would steer a terminal instead of being printed.

    Parameters
    ----------
    text : str
        A message, or part of one; tabs and ends of lines stay.

    Returns
    -------
    str
    """
    return _STEERING.sub("?", text)


def escaped(json: str) -> str:
    r"""Return a JSON text with ``\u`` escapes for the characters that would steer a terminal; it means the same.

    Parameters
    ----------
    json : str
        A JSON text.

    Returns
    -------
    str
    """
    return _STEERING.sub(lambda match: f"\\u{ord(match.group()):04x}", json)
