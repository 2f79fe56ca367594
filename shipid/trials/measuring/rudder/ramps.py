"""The ramp of the rudder as a straight line, and when that line meets an angle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

_NOISY = 0.01
"""Scatter of the samples, as a share of the way, from which on the whole ramp is drawn through, not its first half."""

_STRAIGHT = 1.25
"""The whole ramp is a line where its samples scatter so many times as much as those of the first half, at most."""

_WILD = 8.0
"""Samples so many times the median deviation off the line, and 5 % of the way, are left out."""

_FROM, _HALF = 0.05, 0.6
"""Shares of the way between which the first half of a ramp is drawn through."""


@dataclass(frozen=True)
class RampLine:
    """A line through the samples of a ramp.

    Attributes
    ----------
    middle, angle : float
        Time [s] and angle [rad] of the middle of the samples.
    slope : float
        Slope [rad/s].
    scatter : float
        Standard deviation of the samples about the line [rad].
    count : int
        Number of samples.
    spread : float
        Sum of the squared distances of their times from the middle [s2].
    """

    middle: float
    angle: float
    slope: float
    scatter: float
    count: int
    spread: float

    def reaches(self, angle: float, scatter: float) -> tuple[float, float]:
        """Return when the line meets an angle, and the 95 % uncertainty of that time [s].

        Parameters
        ----------
        angle : float
            The angle [rad].
        scatter : float
            Its standard deviation [rad].
        """
        away = (angle - self.angle) / self.slope
        own = self.scatter**2 * (1 / self.count + away**2 / self.spread)
        return self.middle + away, 2 * float(np.sqrt(own + scatter**2)) / abs(self.slope)

    def at(self, t: np.ndarray) -> np.ndarray:
        """Return the angle of the line [rad].

        Parameters
        ----------
        t : ndarray
            Times [s].
        """
        return self.angle + self.slope * (t - self.middle)


def line_through(t: np.ndarray, y: np.ndarray) -> RampLine | None:
    """Return the line through samples; None where they do not show one.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and angle [rad].
    """
    if len(t) < 2:
        return None
    x = t - t.mean()
    spread = float(x @ x)
    slope = float(x @ y) / spread if spread > 0 else 0.0
    if slope == 0:
        return None
    left = y - y.mean() - slope * x
    scatter = float(np.sqrt(left @ left / max(len(t) - 2, 1)))
    return RampLine(float(t.mean()), float(y.mean()), slope, scatter, len(t), spread)


def ramp_line(
    t: np.ndarray, y: np.ndarray, ramp: np.ndarray, held: float, size: float, reach: float
) -> RampLine | None:
    """Return the line of a falling ramp.

    Samples chosen by their angle would lie on one side of the line where they scatter, so they are chosen again by their time.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and rudder angle [rad].
    ramp : ndarray of int
        Samples on the ramp, as found by their angle.
    held, size : float
        The angle that is left, and the way to the next [rad].
    reach : float
        Share of the way at which the ramp ends.

    Returns
    -------
    RampLine or None
        None where the samples do not fall.
    """
    line = line_through(t[ramp], y[ramp])
    if line is None or line.slope >= 0:
        return None
    if line.scatter < 1e-3 * _NOISY * size or ramp.size < 5:
        return line
    one = _chosen(t, y, line, held, size, _HALF) or line
    if one.scatter < _NOISY * size:
        return one
    whole = _chosen(t, y, one, held, size, 0.9 * reach)
    return whole if whole is not None and whole.scatter <= _STRAIGHT * one.scatter else one


def _chosen(t: np.ndarray, y: np.ndarray, line: RampLine, held: float, size: float, share: float) -> RampLine | None:
    """The line through the samples between two shares of the way, by their times."""
    for _ in range(3):
        begins, ends = (line.reaches(held - part * size, 0.0)[0] for part in (_FROM, share))
        inside = (t >= begins) & (t <= ends)
        away = np.abs(y - line.at(t))
        # A wild sample is no part of a ramp.
        inside &= away <= max(_WILD * float(np.median(away[inside])) if inside.any() else 0.0, 0.05 * size)
        found = line_through(t[inside], y[inside]) if inside.sum() >= 4 else None
        if found is None or found.slope >= 0:
            return None
        line = found
    return line
