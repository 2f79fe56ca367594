"""Bounds and first values of the estimated parameters: the box within which they are searched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Box:
    """Bounds and first value of each estimated parameter.

    Attributes
    ----------
    start, low, high : ndarray, shape (parameters,)
        First values and bounds, SI; bounds may be infinite.
    """

    start: np.ndarray
    low: np.ndarray
    high: np.ndarray

    @property
    def in_log(self) -> np.ndarray:
        """Which are searched by their logarithm: those that are positive, shape (parameters,)."""
        return self.low > 0


#: Of a problem without parameters.
EMPTY = Box(np.zeros(0), np.zeros(0), np.zeros(0))


def box_of(bounds: Mapping[str, tuple[float, float, float]]) -> Box:
    """Return a box from start, low and high of each parameter.

    Parameters
    ----------
    bounds : mapping of str to (float, float, float)
        ``{name: (start, low, high)}``, SI.

    Returns
    -------
    Box
        Its first values lie within the bounds.
    """
    if not bounds:
        return EMPTY
    start, low, high = (np.array(c, dtype=float) for c in zip(*bounds.values()))
    return Box(np.clip(start, low, high), low, high)
