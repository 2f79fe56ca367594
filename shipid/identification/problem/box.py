"""Bounds and first values of the estimated parameters: the box within which they are searched."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

#: Share of its size by which a value that is known without a standard deviation may be off, and multiple of it for a value that is
#: not known.
_USUAL, _LOOSE = 0.1, 1e3
_SMALL = 1e-6


@dataclass(frozen=True)
class Box:
    """Bounds and first value of each estimated parameter.

    Attributes
    ----------
    start, low, high : ndarray, shape (parameters,)
        First values and bounds, SI; bounds may be infinite.
    spread : ndarray, shape (parameters,), or None
        Standard deviation with which a first value is known, SI: infinite where it is only declared as a start, NaN where it is
        known without one. None where nothing is known of any.
    """

    start: np.ndarray
    low: np.ndarray
    high: np.ndarray
    spread: np.ndarray | None = None

    @property
    def in_log(self) -> np.ndarray:
        """Which are searched by their logarithm: those that are positive, shape (parameters,)."""
        return self.low > 0

    @property
    def reach(self) -> np.ndarray:
        """How far each may lie from its first value, in the coordinates of the search, shape (parameters,).

        Where no data decide, coefficients move in proportion to its square: one that is known moves less than one that is not.
        """
        size = np.where(self.in_log, 1.0, np.maximum(np.abs(self.start), _SMALL))
        if self.spread is None:
            return size
        own = self.spread / np.where(self.in_log, self.start, 1.0)
        return np.where(np.isnan(own), _USUAL * size, np.minimum(np.maximum(own, _SMALL * size), _LOOSE * size))


#: Of a problem without parameters.
EMPTY = Box(np.zeros(0), np.zeros(0), np.zeros(0))


def box_of(bounds: Mapping[str, tuple[float, float, float]], spread: Mapping[str, float] | None = None) -> Box:
    """Return a box from start, low and high of each parameter.

    Parameters
    ----------
    bounds : mapping of str to (float, float, float)
        ``{name: (start, low, high)}``, SI.
    spread : mapping of str to float, optional
        Standard deviation of each first value, see `Box`.

    Returns
    -------
    Box
        Its first values lie within the bounds.
    """
    if not bounds:
        return EMPTY
    start, low, high = (np.array(c, dtype=float) for c in zip(*bounds.values()))
    known = None if spread is None else np.array([spread[n] for n in bounds])
    return Box(np.clip(start, low, high), low, high, known)
