"""Values as JSON can hold them: numbers that are not finite become null."""

from __future__ import annotations

import json
import math
from contextlib import suppress

from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError


def number(value: float | None, digits: int = 8) -> float | None:
    """Return a number for JSON with so many significant digits; None where it is not finite.

    Parameters
    ----------
    value : float or None
        The number.
    digits : int
        Significant digits.
    """
    if value is None or not math.isfinite(value):
        return None
    return float(f"{value:.{digits}g}") + 0.0


def number_given(value: Plain, name: str) -> float:
    """Return a number that a page has sent.

    Parameters
    ----------
    value : plain values
        What was sent.
    name : str
        What it is.

    Raises
    ------
    UsageError
        If it is no finite number.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        # JSON has whole numbers that no float holds.
        with suppress(OverflowError):
            given = float(value)
            if math.isfinite(given):
                return given
    raise UsageError(f"'{name}' is a finite number, SI.")


def strict_json(value: Plain) -> str:
    """Return a value as JSON without NaN and infinity, which UTF-8 can hold; a number that is not finite is null.

    Parameters
    ----------
    value : plain values
        Dicts, lists, texts, numbers.
    """
    try:
        text = json.dumps(value, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    except ValueError:
        text = json.dumps(_finite(value), allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    # Half a character, as JSON can hold it, would end the connection it is sent on.
    return text if text.isascii() else text.encode("utf-8", "replace").decode("utf-8")


def _finite(value: Plain) -> Plain:
    if isinstance(value, dict):
        return {k: _finite(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
