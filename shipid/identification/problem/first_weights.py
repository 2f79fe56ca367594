"""Standard deviations by which the signals are weighted at the beginning of a search."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.declaration.units import to_si
from shipid.foundation.errors import UsageError
from shipid.parts.sensors import LARGEST_LEVEL, SMALLEST_LEVEL

#: First weights of signals whose noise is estimated; only their ratio matters. That of the rate of turn is r L/U.
_FIRST = {"psi": np.deg2rad(1.0), "r": 0.02, "u": 0.05, "v": 0.05, "x": 10.0, "y": 10.0}


def first_weights(signals: tuple[str, ...], unit_time: float) -> np.ndarray:
    """Return standard deviations with which a search may begin, SI, shape (signals,).

    Parameters
    ----------
    signals : tuple of str
        Fitted signals.
    unit_time : float
        L/U in s.
    """
    return np.array([_FIRST.get(s, 1.0) / (unit_time if s == "r" else 1.0) for s in signals])


def given_weights(signals: tuple[str, ...], noise: Mapping[str, str | float], units: Mapping[str, str]) -> np.ndarray:
    """Return the standard deviations that were given, SI, shape (signals,).

    Parameters
    ----------
    signals : tuple of str
        Fitted signals.
    noise : mapping of str to str
        Standard deviation of each, with its unit.
    units : mapping of str to str
        Unit of each inside.

    Raises
    ------
    UsageError
        If one is missing, or not greater than zero.
    UnitError
        If a unit does not fit.
    """
    lacking = [s for s in signals if s not in noise]
    if lacking:
        raise UsageError(
            f"noise levels are given, and none for {', '.join(lacking)}. Give one for every fitted signal."
        )
    levels = [to_si(noise[s], units[s], f"noise on {s}") for s in signals]
    if min(levels) <= 0:
        raise UsageError("a noise level of zero or less has no weight; give a positive standard deviation.")
    for name, level in zip(signals, levels):
        if level < SMALLEST_LEVEL:
            raise UsageError(
                f"the noise on {name} is {noise[name]}, smaller than any sensor's. Give the standard deviation of one sample."
            )
        if not level <= LARGEST_LEVEL:
            raise UsageError(
                f"the noise on {name} is {noise[name]}, larger than any sensor's. Leave the signal out, or give the standard deviation."
            )
    return np.array(levels)
