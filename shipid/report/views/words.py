"""Counts and lists in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib import metadata

import numpy as np
from markupsafe import Markup

import shipid
from shipid.declaration.units import pretty
from shipid.estimation.estimate import Estimate
from shipid.foundation.notices import notice_of
from shipid.foundation.numbers import fixed
from shipid.report.typography.prose import prose

_NUMBERS = ("no", "one", "two", "three", "four", "five", "six")


def count(n: int, what: str) -> str:
    """Return ``two trials``.

    Parameters
    ----------
    n : int
        How many.
    what : str
        Of what, in the singular.
    """
    return f"{_NUMBERS[n] if n < len(_NUMBERS) else n} {what}{'' if n == 1 else 's'}"


def listed(items: Sequence[str]) -> str:
    """Return ``a, b and c``.

    Parameters
    ----------
    items : sequence of str
        At least one.
    """
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def sentence(text: str) -> str:
    """Return a text with its first letter in upper case.

    Parameters
    ----------
    text : str
        Words.
    """
    return text[:1].upper() + text[1:]


def past_north(degrees: np.ndarray) -> str:
    """Return how a heading is drawn that turns through north, which a table has in compass degrees; empty where none does.

    Parameters
    ----------
    degrees : ndarray
        The heading as it is drawn.
    """
    there = degrees[np.isfinite(degrees)]
    ends = [round(float(v)) for v in (there.min(), there.max())] if there.size else []
    outside = next((v for v in ends if not 0 <= v < 360), None)
    if outside is None:
        return ""
    return f" The heading is drawn without a jump at north: {fixed(outside, 0)} deg is {fixed(outside % 360, 0)} deg."


def with_unit(text: str, unit: str) -> str:
    """Return a number with its unit, which is left out where it is one.

    Parameters
    ----------
    text : str
        The number.
    unit : str
        As declared.
    """
    return text if pretty(unit) == "1" else f"{text} {pretty(unit)}"


def standing_remark(estimate: Estimate) -> Markup | str:
    """Return why the data do not determine a coefficient, for the line below its row; empty where they do.

    Parameters
    ----------
    estimate : Estimate
        The coefficient.
    """
    if not estimate.why:
        return ""
    return Markup('<span class="no">{}:</span> {} ').format(estimate.standing.capitalize(), prose(estimate.why))


def boxes(told: Iterable[str], write: Callable[[str], str] = str) -> tuple[list[str], list[str]]:
    """Return what stands in a box "Warning", where the command ends with exit code 5, and what in a box "Note".

    Parameters
    ----------
    told : iterable of str or Notice
        What a result says beside its numbers.
    write : callable
        How it is written: `sentence` where none begins with a name.
    """
    notices = [notice_of(words) for words in told]
    return [write(n) for n in notices if n.serious], [write(n) for n in notices if not n.serious]


def versions_now() -> str:
    """Return the versions of shipid and of the libraries that compute for it: ``shipid 0.1.0, casadi 3.7.0, ...``."""
    found = {"shipid": shipid.__version__, **{n: metadata.version(n) for n in ("casadi", "numpy", "scipy")}}
    return ", ".join(f"{name} {version}" for name, version in found.items()) + "."
