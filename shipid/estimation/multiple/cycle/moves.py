"""How the parameter of the modes moves from scan to scan, as expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import casadi as ca
import numpy as np

from shipid.foundation.aliases import Expression


class Moves(Protocol):
    """What moves the parameter of the modes before the interaction of a scan."""

    @property
    def parameter(self) -> str:
        """The input of the models that moves."""

    def move(self, estimates: list[Expression], mu: Expression, theta: Expression, moving: Expression) -> Expression:
        """Return the parameter of each mode for this scan; displacements among the estimates may change in place.

        Parameters
        ----------
        estimates : list of casadi.SX
            States of each mode after the last scan.
        mu, theta : casadi.SX, shape (modes,)
            Probabilities of the modes and their parameter there.
        moving : casadi.SX
            Whether time passes; where it does not, nothing moves.
        """

    def shown(self, estimates: list[Expression], theta: Expression) -> Expression:
        """Return the parameter of each mode with what its estimate says of it, after a scan.

        Parameters
        ----------
        estimates : list of casadi.SX
            States of each mode.
        theta : casadi.SX, shape (modes,)
            The parameter of this scan.
        """


@dataclass(frozen=True, eq=False)
class DisplacedMoves:
    """Moves of augmented modes, see `shipid.estimation.multiple.structures.Displaced`.

    Attributes
    ----------
    parameter : str
        The input.
    places : tuple of int
        Where the displacement stands among the states of each mode.
    low, high : ndarray, shape (modes,)
        Bounds of parameter and displacement together, infinite where there are none.
    variable : bool
        Whether the parameter itself moves.
    """

    parameter: str
    places: Sequence[int]
    low: np.ndarray
    high: np.ndarray
    variable: bool

    def move(self, estimates: list[Expression], mu: Expression, theta: Expression, moving: Expression) -> Expression:
        """Return the parameter of each mode: Semerdjiev and Mihaylova (2000), eq. (34) and (35), and the bounds below (33).

        Parameters
        ----------
        estimates, mu, theta, moving
            See `Moves.move`.
        """
        result = theta + 0
        for j, (x, at) in enumerate(zip(estimates, self.places)):
            there = theta[j] + x[at]
            if np.isfinite(self.low[j]):
                there = ca.fmax(there, self.low[j])
            if np.isfinite(self.high[j]):
                there = ca.fmin(there, self.high[j])
            if self.variable:
                result[j] = ca.if_else(moving, there, theta[j])
                x[at] = ca.if_else(moving, 0.0, x[at])
            elif np.isfinite(self.low[j]) or np.isfinite(self.high[j]):
                x[at] = ca.if_else(moving, there - theta[j], x[at])
        return result

    def shown(self, estimates: list[Expression], theta: Expression) -> Expression:
        """Return parameter and displacement together.

        Parameters
        ----------
        estimates, theta
            See `Moves.shown`.
        """
        return theta + ca.vertcat(*(x[at] for x, at in zip(estimates, self.places)))


@dataclass(frozen=True, eq=False)
class GridMoves:
    """Moves of an adaptive grid, see `shipid.estimation.multiple.structures.AdaptiveGrid`.

    Attributes
    ----------
    parameter : str
        The input.
    order : tuple of int
        The modes with the largest, the middle and the smallest value.
    closest, widest, limit : float
        Distances of neighbours and largest magnitude, SI.
    improbable, dominant : float
        The probabilities t1 and t2.
    """

    parameter: str
    order: tuple[int, int, int]
    closest: float
    widest: float
    limit: float
    improbable: float
    dominant: float

    def move(self, estimates: list[Expression], mu: Expression, theta: Expression, moving: Expression) -> Expression:
        """Return the parameter of each mode: Semerdjiev, Mihaylova and Li (2000), section 5.1.

        Parameters
        ----------
        estimates, mu, theta, moving
            See `Moves.move`.
        """
        upper, middle, lower = self.order
        centre = sum(mu[j] * theta[j] for j in range(len(estimates)))
        result = theta + 0
        result[middle] = centre
        side = {upper: theta[upper] - theta[middle], lower: theta[middle] - theta[lower]}
        for j, other in ((upper, lower), (lower, upper)):
            holds = ca.logic_and(mu[j] > mu[middle], mu[j] >= mu[other])
            quiet = ca.logic_and(mu[middle] >= mu[upper], mu[middle] >= mu[lower])
            closer = ca.if_else(ca.logic_and(quiet, mu[j] < self.improbable), 0.5, 1.0)
            distance = side[j] * ca.if_else(ca.logic_and(holds, mu[j] > self.dominant), 2.0, closer)
            distance = ca.fmin(ca.fmax(distance, self.closest), self.widest)
            result[j] = centre + (distance if j == upper else -distance)
        result = ca.fmin(ca.fmax(result, -self.limit), self.limit)
        return ca.if_else(moving, result, theta)

    def shown(self, estimates: list[Expression], theta: Expression) -> Expression:
        """Return the parameter: the estimates say nothing of it.

        Parameters
        ----------
        estimates, theta
            See `Moves.shown`.
        """
        return theta
