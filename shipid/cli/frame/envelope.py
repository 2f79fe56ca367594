"""The form of everything that ``--json`` prints and ``result.json`` holds.

::

    {"schema_version": 2, "command": "identify",
     "provenance": {"shipid": "...", "inputs": [{"name": "trial.csv", "sha256": "..."}], ...},
     "warnings": [{"kind": "...", "serious": false, "message": "...", ...}],
     ... what the command answers, by names of its own ...}

A number with a unit is ``{"value": ..., "unit": "..."}``, with ``std`` and ``interval_95`` (two ends) where they are known.
What is not known is null: there is no NaN and no infinity.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import click

from shipid.foundation.aliases import Plain
from shipid.foundation.printable import escaped

#: Counts up when a name or a form that a program may read changes its meaning or goes.
SCHEMA_VERSION = 2
#: Parameters of commands that name what is written, or what grows while it is read.
_NOT_READ = ("output", "out", "follow")
#: Significant digits of a number in JSON: more than any result has.
_DIGITS = 12


def envelope(data: dict[str, Plain], inputs: list[dict[str, Plain]]) -> dict[str, Plain]:
    """Return the result of the running command in the form of all commands.

    Parameters
    ----------
    data : dict
        The result. Its ``warnings`` and its ``provenance`` become those of the envelope.
    inputs : list of dict
        See `inputs_given`.
    """
    context = click.get_current_context()
    own = {key: value for key, value in data.items() if key not in ("warnings", "provenance")}
    head: dict[str, Plain] = {
        "schema_version": SCHEMA_VERSION,
        "command": context.info_name,
        "provenance": {"shipid": version("shipid"), "inputs": inputs, **data.get("provenance", {})},
        "warnings": data.get("warnings", []),
    }
    assert not head.keys() & own.keys(), f"names of the envelope: {sorted(head.keys() & own.keys())}"
    return head | own


def inputs_given() -> list[dict[str, Plain]]:
    """Return the files that the running command was given, each as it was named, with the SHA-256 of its content."""
    context = click.get_current_context(silent=True)
    if context is None:
        return []
    found: dict[str, Plain] = {}
    for name, value in context.params.items():
        for text in _texts(value) if name not in _NOT_READ else ():
            file = _file_of(text)
            if file is not None:
                found.setdefault(str(file), _hash_of(file))
    return [{"name": name, "sha256": hashed} for name, hashed in found.items()]


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
        yield from value.split(",")
    elif isinstance(value, tuple):
        for part in value:
            yield from _texts(part)


def _file_of(text: str) -> Path | None:
    """The file of ``FILE``, ``FILE@part``, ``FILE#sheet`` or ``FILE:NAME``; None where there is none."""
    while text:
        try:
            if Path(text).is_file():
                return Path(text)
        except (OSError, ValueError):  # too long for a name, or with a zero byte
            return None
        shorter = re.match(r"(.+)[@#:]", text, re.DOTALL)
        text = shorter.group(1) if shorter else ""
    return None


def _hash_of(file: Path) -> str | None:
    try:
        with file.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:  # whoever reads it says so
        return None


def json_text(value: Plain, *, indent: int | None = 1) -> str:
    """Return a result as JSON, which holds no NaN and no infinity, with numbers of twelve digits and no negative zero.

    Parameters
    ----------
    value : dict or list
        The result.
    indent : int or None
        Spaces a level; None for one line.
    """
    return escaped(json.dumps(_rounded(value), indent=indent, allow_nan=False, ensure_ascii=False))


def _rounded(value: Plain) -> Plain:
    """The same with the noise of the last digits left out: 15.0 for 14.999999999999998."""
    if isinstance(value, dict):
        return {name: _rounded(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(one) for one in value]
    if not isinstance(value, float) or not math.isfinite(value):
        return value
    # What arithmetic leaves of zero, such as 4e-318, has no digits that mean anything.
    return float(f"{value:.{_DIGITS}g}") + 0.0 if abs(value) > sys.float_info.min else 0.0
