"""Observed positions of a target brought onto a smooth curve before they are extrapolated: Song et al. (2018), equations 8 to 14.

The positions are turned into a frame along the target's way, a polynomial is fitted across it, and the two middle ones of four
points on it are moved along so that the acceleration changes least.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from shipid.encounter.errors import EncounterRequestError, TargetError
from shipid.encounter.smoothest_points import MOST_DEGREE, MiddleProblem, exact_middle, swarm_middle
from shipid.foundation.errors import UnknownNameError

#: Which positions the curve is fitted to: the four that are predicted from, as printed, or every scan between them.
Reading = Literal["sampled", "all scans"]
#: How the middle points are found.
Solver = Literal["exact", "swarm"]
#: Points that are predicted from, and the intervals between them.
POINTS, INTERVALS = 4, 3


@dataclass(frozen=True)
class Mitigation:
    """Settings of the method; those that the paper does not print are choices.

    Attributes
    ----------
    reading : {"sampled", "all scans"}
        "sampled" fits the curve to the four points as printed, "all scans" to every scan from the first of them to the last.
    solver : {"exact", "swarm"}
        Of the two middle points.
    degree : int
        Of the polynomial, 1 or 2; not printed.
    radius : float
        Largest error of a position, m; 30 in the paper.
    seed : int
        Of the swarm.
    """

    reading: Reading = "sampled"
    solver: Solver = "exact"
    degree: int = 2
    radius: float = 30.0
    seed: int = 0

    def __post_init__(self) -> None:
        for what, name, known in (("reading", self.reading, Reading), ("solver", self.solver, Solver)):
            if name not in get_args(known):
                raise UnknownNameError(what, name, get_args(known))
        if not 1 <= self.degree <= MOST_DEGREE:
            raise EncounterRequestError(
                f"a polynomial of degree {self.degree} is not fitted here; give 1 or {MOST_DEGREE}."
            )
        if not self.radius > 0:
            raise EncounterRequestError(f"the radius of the error is {self.radius:g} m; give a positive number.")


def scans_between(radar_range: float, fastest: float) -> int:
    """Return how many scans lie from one point that is used to the next: equation 8, at least one.

    Parameters
    ----------
    radar_range : float
        Radius that the radar observes, m.
    fastest : float
        Largest relative speed of the target so far, in m per scan: with m/s the printed equation is a time and no number.

    Raises
    ------
    EncounterRequestError
        If one is not positive.
    """
    if not (radar_range > 0 and fastest > 0):
        raise EncounterRequestError(
            f"a range of {radar_range:g} m and {fastest:g} m a scan give no period; both are positive."
        )
    return max(1, int(radar_range / (10 * fastest)))


def mitigated_points(scans: np.ndarray, every: int, settings: Mitigation) -> np.ndarray:
    """Return four points at equal intervals with their errors reduced, to be predicted from.

    A target whose ends lie nearer to each other than twice the radius has no known direction: the points are then those of the
    straight line through all scans.

    Parameters
    ----------
    scans : ndarray, shape (..., M, 2)
        Observed positions at every scan, the last one now; M is ``3 every + 1`` or more.
    every : int
        Scans from one point to the next.
    settings : Mitigation
        How.

    Returns
    -------
    ndarray, shape (..., 4, 2)
        In the frame of the scans, the last one now.

    Raises
    ------
    TargetError
        If there are too few scans, or one is missing.
    """
    count = INTERVALS * every + 1
    if every < 1 or scans.ndim < 2 or scans.shape[-2] < count or scans.shape[-1] != 2:
        raise TargetError(f"scans of shape {scans.shape} do not hold {count} positions for points {every} scans apart.")
    used = scans[..., -count:, :]
    if not np.isfinite(used).all():
        raise TargetError("a scan has no position; mitigate errors of positions that are there.")
    middle = used.mean(axis=-2, keepdims=True)
    turn = _along(used)
    local = (used - middle) @ turn
    points = local[..., ::every, :]
    fitted = points if settings.reading == "sampled" else local
    curve = _fitted(fitted, settings.degree)
    problem = MiddleProblem(curve, points[..., [-1, 0], 0], points[..., [-2, 1], :], settings.radius)
    found = exact_middle(problem) if settings.solver == "exact" else swarm_middle(problem, settings.seed)
    x = np.stack([points[..., 0, 0], found[..., 1], found[..., 0], points[..., -1, 0]], axis=-1)
    smooth = np.stack([x, problem.height(x)], axis=-1)
    back = smooth @ np.swapaxes(turn, -1, -2) + middle
    moves = np.hypot(*np.moveaxis(used[..., -1, :] - used[..., 0, :], -1, 0)) > 2 * settings.radius
    return np.where(moves[..., None, None], back, straight_points(used, every))


def straight_points(scans: np.ndarray, every: int) -> np.ndarray:
    """Return the same four points on the straight course with steady speed that fits the scans best.

    Parameters
    ----------
    scans : ndarray, shape (..., M, 2)
        Observed positions at every scan, the last one now.
    every : int
        Scans from one point to the next.

    Returns
    -------
    ndarray, shape (..., 4, 2)
        The last one now.
    """
    time = np.arange(scans.shape[-2]) - (scans.shape[-2] - 1) / 2
    velocity = np.einsum("k,...kc->...c", time, scans) / (time @ time)
    ahead = time[-1] - every * np.arange(POINTS - 1, -1, -1)
    return np.asarray(scans.mean(axis=-2)[..., None, :] + ahead[:, None] * velocity[..., None, :])


def _along(scans: np.ndarray) -> np.ndarray:
    """The matrix whose first column is the direction in which the scans spread most, from the first towards the last."""
    centred = scans - scans.mean(axis=-2, keepdims=True)
    sxx, syy = np.sum(centred**2, axis=-2)[..., 0], np.sum(centred**2, axis=-2)[..., 1]
    sxy = np.sum(centred[..., 0] * centred[..., 1], axis=-1)
    angle = 0.5 * np.arctan2(2 * sxy, sxx - syy)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    towards = np.sum(direction * (scans[..., -1, :] - scans[..., 0, :]), axis=-1, keepdims=True)
    direction = np.where(towards < 0, -direction, direction)
    normal = np.stack([-direction[..., 1], direction[..., 0]], axis=-1)
    return np.stack([direction, normal], axis=-1)


def _fitted(points: np.ndarray, degree: int) -> np.ndarray:
    """Coefficients of the least-squares polynomial, the constant first: equation 11."""
    x = points[..., 0]
    size = np.maximum(np.max(np.abs(x), axis=-1, keepdims=True), 1e-9)
    powers = (x / size)[..., None] ** np.arange(degree + 1)
    scaled = np.einsum("...cm,...m->...c", np.linalg.pinv(powers), points[..., 1])
    return np.asarray(scaled / size ** np.arange(degree + 1))
