"""How close two ships come on their present courses and speeds, when, and how sure that is: CPA and TCPA."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from shipid.declaration.vocabulary import shown_estimate
from shipid.encounter.errors import EncounterRequestError, TargetError
from shipid.foundation.result import Result, table
from shipid.foundation.statistics import plain

if TYPE_CHECKING:
    import pandas as pd

#: Below this relative speed in m/s the range of two ships does not change: by 1 m in eleven days.
_STEADY = 1e-6
#: With a relative speed of fewer standard deviations than this, first derivatives do not tell the spread.
_LINEAR = 10.0
#: With a relative speed of fewer standard deviations than this nothing says which way the ships move past each other.
_SURELY = 2.5
_DRAWS = 8192
_SIZE = 4

#: Whether the closest approach lies ahead in time, is past, the range does not change, or that is not known.
Motion = Literal["closing", "opening", "steady", "unsure"]
_UNITS = {"range": "m", "relative_speed": "m/s", "cpa": "m", "tcpa": "s", "nearest": "m", "domain": "m", "chance": "1"}


@dataclass(frozen=True, repr=False)
class ClosestApproach(Result):
    """The closest approach of two ships that keep course and speed.

    Attributes
    ----------
    range : float
        Their distance now, m.
    relative_speed : float
        m/s.
    cpa : float
        Distance at the closest point of approach, m, also where it is past; the range where that does not change; NaN where the motion
        is not sure.
    tcpa : float
        Time to it in s; negative where it is past, NaN where the range does not change or the motion is not sure.
    nearest : float
        The smallest distance from now to the horizon, m; NaN where the motion is not sure.
    motion : {"closing", "opening", "steady", "unsure"}
        Whether the closest approach lies ahead, is past, or the range does not change; unsure where the relative speed may well be
        none: then only the intervals are known.
    miss : tuple of float or None
        Position of the other ship relative to own ship at the closest approach, north and east in m; None where that is not known.
    cpa_std, tcpa_std : float or None
        Standard deviations by first derivatives, m and s. That of `cpa` belongs to the distance with the sign of the
        side. None where no covariance is given, and where the relative speed has fewer than ten standard deviations.
    cpa_interval, tcpa_interval, nearest_interval : tuple of float or None
        95 % intervals from draws of the covariance, m, s and m; None where no covariance is given.
    domain : float or None
        The distance to be kept, m.
    chance : float or None
        Probability that the ships come closer than `domain` before the horizon, from the same draws.
    """

    range: float
    relative_speed: float
    cpa: float
    tcpa: float
    nearest: float
    motion: Motion
    miss: tuple[float, float] | None
    cpa_std: float | None = None
    tcpa_std: float | None = None
    cpa_interval: tuple[float, float] | None = None
    tcpa_interval: tuple[float, float] | None = None
    nearest_interval: tuple[float, float] | None = None
    domain: float | None = None
    chance: float | None = None

    def to_dict(self) -> dict[str, float | str | list[float] | None]:
        """Return plain values, NaN as None; intervals are lists of two."""
        return {
            name: (
                value
                if value is None or isinstance(value, str)
                else [float(v) for v in value]
                if isinstance(value, tuple)
                else plain(value)
            )
            for name, value in vars(self).items()
        }

    def to_frame(self) -> pd.DataFrame:
        """Return the numbers as a pandas table, SI: value, standard deviation and 95 % interval, where they are known."""
        rows = (
            {
                "name": n,
                "value": getattr(self, n),
                "std": getattr(self, f"{n}_std", None),
                "unit": u,
                "interval_95": getattr(self, f"{n}_interval", None),
            }
            for n, u in _UNITS.items()
        )
        return table(rows, "name")

    def text(self) -> str:
        """Return the result in lines of text."""
        lines = []
        for name, unit in _UNITS.items():
            value, ends = getattr(self, name), getattr(self, f"{name}_interval", None)
            if value is None:
                continue  # no domain was asked for
            shown = shown_estimate(plain(value), getattr(self, f"{name}_std", None), name, unit)
            lines.append(
                f"  {name:<16s} {shown}" + ("" if ends is None else f", 95 %: {ends[0]:.0f} to {ends[1]:.0f} {unit}")
            )
        return "\n".join([f"closest approach, {self.motion}", *lines])


def closest_approach(
    target: ArrayLike,
    own: ArrayLike = (0.0, 0.0, 0.0, 0.0),
    *,
    covariance: ArrayLike | None = None,
    own_covariance: ArrayLike | None = None,
    domain: float | None = None,
    horizon: float = 3600.0,
) -> ClosestApproach:
    """Return the closest approach of another ship to own ship, both on straight courses with steady speed.

    Parameters
    ----------
    target, own : array_like, shape (4,)
        North and east position in m, north and east velocity in m/s, in one frame and at one instant. Without `own`, the
        target is taken relative to own ship.
    covariance, own_covariance : array_like, shape (4, 4), optional
        Of the errors of both in that order; the two are independent of each other.
    domain : float, optional
        The distance to be kept in m; it asks for `chance`.
    horizon : float
        How far ahead `nearest` and `chance` look, s.

    Returns
    -------
    ClosestApproach

    Raises
    ------
    TargetError
        If a motion or a covariance has another shape, a number that is missing, or is no covariance.
    EncounterRequestError
        If the domain or the horizon is not positive.
    """
    for what, value in (("domain", domain), ("horizon", horizon)):
        if value is not None and not value > 0:
            raise EncounterRequestError(f"the {what} is {value:g}; give a positive number.")
    relative = _motion(target, "the target") - _motion(own, "own ship")
    tcpa, signed = (float(a) for a in _approach(relative))
    speed = float(np.hypot(*relative[2:]))
    nearest = float(nearest_distance(relative, horizon))
    north, east = relative[:2] + (0.0 if speed < _STEADY else tcpa * relative[2:])
    motion: Motion = "steady" if speed < _STEADY else "closing" if tcpa > 0 else "opening"
    found = ClosestApproach(
        float(np.hypot(*relative[:2])),
        speed,
        abs(signed),
        tcpa,
        nearest,
        motion,
        (float(north), float(east)),
        domain=domain,
    )
    if covariance is None and own_covariance is None:
        return found
    both = sum(
        _covariance(c, w) for c, w in ((covariance, "the target"), (own_covariance, "own ship")) if c is not None
    )
    root = _root(np.asarray(both))
    drawn = relative + _normal_draws() @ root.T
    times, distances = _approach(drawn)
    near = nearest_distance(drawn, horizon)
    if _STEADY <= speed < _SURELY * float(np.linalg.norm(relative[2:] / speed @ root[2:])):
        # What hardly moves goes any way at all: the approach of its mean motion lies outside its own interval.
        found = replace(found, cpa=np.nan, tcpa=np.nan, nearest=np.nan, motion="unsure", miss=None)
    cpa_std, tcpa_std = _first_order(relative, root)
    return replace(
        found,
        cpa_std=cpa_std,
        tcpa_std=tcpa_std,
        cpa_interval=_interval(np.abs(distances)),
        tcpa_interval=_interval(times),
        nearest_interval=_interval(near),
        chance=None if domain is None else float(np.mean(near < domain)),
    )


def nearest_distance(relative: np.ndarray, horizon: float | np.ndarray) -> np.ndarray:
    """Return the smallest distance from now to a horizon for steady relative motions.

    Parameters
    ----------
    relative : ndarray, shape (..., 4)
        Position and velocity of the other ship relative to own ship, north and east, m and m/s.
    horizon : float or ndarray, shape (...)
        s.

    Returns
    -------
    ndarray, shape (...)
        In m.
    """
    position, velocity = relative[..., :2], relative[..., 2:]
    squared = np.sum(velocity**2, axis=-1)
    # Without relative motion every instant is the nearest; that of a hardly moving target is cut at the horizon.
    time = np.clip(-np.sum(position * velocity, axis=-1) / np.maximum(squared, np.finfo(float).tiny), 0.0, horizon)
    north, east = np.moveaxis(position + time[..., None] * velocity, -1, 0)
    return np.asarray(np.hypot(north, east))


def _approach(relative: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """TCPA and CPA with the sign of the side; where the range does not change, NaN and the range."""
    x, y, vx, vy = np.moveaxis(relative, -1, 0)
    speed = np.hypot(vx, vy)
    still = speed < _STEADY
    divisor = np.where(still, 1.0, speed)
    tcpa = np.where(still, np.nan, -(x * vx + y * vy) / divisor**2)
    return tcpa, np.where(still, np.hypot(x, y), (x * vy - y * vx) / divisor)


def _first_order(relative: np.ndarray, root: np.ndarray) -> tuple[float | None, float | None]:
    """Standard deviations of CPA and TCPA by their gradients, or None where the relative speed is not sure enough."""
    position, velocity = relative[:2], relative[2:]
    speed = float(np.hypot(*velocity))
    widest = float(np.linalg.norm(root[2:], 2))
    if speed < _STEADY or speed < _LINEAR * widest:
        return None, None
    tcpa, signed = (float(a) for a in _approach(relative))
    along = velocity / speed
    of_cpa = np.array([along[1], -along[0], -position[1], position[0]])
    of_cpa[2:] = of_cpa[2:] / speed - signed * along / speed
    of_tcpa = -np.concatenate([velocity, position + 2 * tcpa * velocity]) / speed**2
    return float(np.linalg.norm(of_cpa @ root)), float(np.linalg.norm(of_tcpa @ root))


def _interval(values: np.ndarray) -> tuple[float, float] | None:
    known = values[np.isfinite(values)]
    if not known.size:
        return None
    low, high = np.quantile(known, (0.025, 0.975))
    return float(low), float(high)


@functools.cache
def _normal_draws() -> np.ndarray:
    """Standard normal draws with mean zero: each with its opposite. The same in every call, so that a result is too."""
    half = np.random.default_rng(np.random.SeedSequence(1)).standard_normal((_DRAWS // 2, _SIZE))
    draws: np.ndarray = np.concatenate([half, -half])
    draws.setflags(write=False)
    return draws


def _motion(values: ArrayLike, whose: str) -> np.ndarray:
    motion = np.asarray(values, float)
    if motion.shape != (_SIZE,) or not np.isfinite(motion).all():
        raise TargetError(
            f"the motion of {whose} is {np.array2string(motion, threshold=8)}; "
            "give north and east position and north and east velocity, four finite numbers."
        )
    return motion


def _covariance(values: ArrayLike, whose: str) -> np.ndarray:
    matrix = np.asarray(values, float)
    if matrix.shape != (_SIZE, _SIZE) or not np.isfinite(matrix).all():
        raise TargetError(f"the covariance of {whose} is not a matrix of 4 rows and 4 columns of finite numbers.")
    size = np.sqrt(np.abs(np.diagonal(matrix)))
    # Positions and velocities have sizes of their own: a covariance is judged by its correlations.
    scaled = matrix / np.outer(np.where(size > 0, size, 1.0), np.where(size > 0, size, 1.0))
    if not np.allclose(scaled, scaled.T, rtol=0, atol=1e-8) or np.linalg.eigvalsh(scaled)[0] < -1e-8:
        raise TargetError(f"the covariance of {whose} is not symmetric, or has a variance below zero.")
    return np.asarray(0.5 * (matrix + matrix.T))


def _root(covariance: np.ndarray) -> np.ndarray:
    """A matrix whose product with its transpose is the covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
