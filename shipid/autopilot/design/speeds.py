"""The speeds of a schedule, read from text or numbers."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.autopilot.errors import DesignRequestError
from shipid.declaration.units import factor, split
from shipid.foundation.errors import ParameterSetError, UnitError

#: Most speeds of a schedule.
MOST_SPEEDS = 64


def parse_speeds(text: str | Sequence[float] | None, own: float | None) -> np.ndarray:
    """Read the speeds of a schedule.

    Parameters
    ----------
    text : str, sequence of float or None
        ``"4:12:1 m/s"``, ``"8,12,16 kn"``, numbers in m/s, or None for 0.5 to 1.2 of the ship's own speed.
    own : float or None
        That speed in m/s.

    Returns
    -------
    ndarray
        In m/s, rising.

    Raises
    ------
    DesignRequestError
        If it is no list of speeds greater than zero.
    ParameterSetError
        If there is neither a list nor a speed of the ship's own.
    """
    if text is None:
        if own is None:
            raise ParameterSetError("the ship has no speed of its own: give the speeds, as in --speeds '4:12:1 m/s'.")
        return np.round(own * np.arange(0.5, 1.25, 0.1), 6)
    found = _read(text) if isinstance(text, str) else np.array(sorted({float(v) for v in text}))
    if not len(found) or not np.isfinite(found).all() or found.min() <= 0:
        raise DesignRequestError(
            f"the speeds {text} are no speeds of a ship under way: give numbers greater than zero."
        )
    if len(found) > MOST_SPEEDS:
        raise DesignRequestError(
            f"{len(found)} speeds are more than a schedule holds ({MOST_SPEEDS}). Take a wider step."
        )
    return found


def _read(text: str) -> np.ndarray:
    refusal = DesignRequestError(
        f"the speeds '{text}' are neither FROM:TO:STEP nor a list, as in '4:12:1 m/s' or '8,12 kn'."
    )
    parts = text.split(":") if ":" in text else text.split(",")
    try:
        numbers, (last, unit) = [float(p) for p in parts[:-1]], split(parts[-1])
    except (ValueError, UnitError):
        raise refusal from None
    if unit is None:
        raise DesignRequestError(f"the speeds '{text}' have no unit. Write '{text} m/s': shipid does not guess.")
    scale = factor(unit, "m/s", "the speeds")
    if ":" not in text:
        return np.unique(np.array([*numbers, last]) * scale)
    if len(numbers) == 1:
        numbers, last = [*numbers, last], 0.1 * (last - numbers[0])
    if len(numbers) != 2 or not last > 0 or not numbers[1] >= numbers[0] or (numbers[1] - numbers[0]) / last > 1e4:
        raise refusal
    count = int(np.floor((numbers[1] - numbers[0]) / last + 1e-9)) + 1
    return (numbers[0] + last * np.arange(count)) * scale
