"""The limits of a judgement: of a margin from below, of an overshoot or an error from above."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from shipid.declaration.units import to_si
from shipid.declaration.vocabulary import to_display
from shipid.foundation.errors import UnknownNameError, UsageError

#: The limits of this project, which are none of a standard: margins in degrees where they are angles, the overshoot as a share of
#: the course change, the error in degrees. The report shows them beside the numbers.
LIMITS: Mapping[str, float] = MappingProxyType(
    {
        "disk margin": 0.5,
        "gain margin": 2.0,
        "phase margin": 30.0,
        "overshoot": 0.1,
        "steady error in wind": 3.0,
    }
)
#: Limits that are angles, in degrees.
ANGLES = ("phase margin", "steady error in wind")


def stated_limits(stated: Mapping[str, str | float]) -> dict[str, float]:
    """Return the limits with some of them stated.

    Parameters
    ----------
    stated : mapping of str to str or float
        By name, with hyphens or spaces: ``{"disk-margin": "0.6", "phase-margin": "40 deg", "overshoot": "5 %"}``; a number
        without a unit counts as in `LIMITS`.

    Raises
    ------
    UnknownNameError
        If there is no such limit.
    UsageError
        If a limit is not greater than zero.
    """
    found = dict(LIMITS)
    for name, value in stated.items():
        known = name.strip().replace("-", " ")
        if known not in LIMITS:
            raise UnknownNameError("limit", name, LIMITS)
        if isinstance(value, str):
            number = to_si(value, "rad" if known in ANGLES else "1", f"the limit of the {known}")
            found[known] = to_display(number, "psi") if known in ANGLES else number
        else:
            found[known] = float(value)
        if not 0 < found[known] < float("inf"):
            raise UsageError(f"a limit of {value} for the {known} is none: give one greater than zero.")
    return found
