"""How unsure an estimated current is: by lasting errors of fixes, by moves of the estimate, and by errors of model and log that look like one."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from shipid.identification.problem.prior import STRUCTURE_ANGLE, STRUCTURE_SPEED
from shipid.prediction.situations.situation import Situation

#: Independent stretches that the filter itself counts as, and stretches that are remembered.
_BELIEVED, _REMEMBERED = 4.0, 20
CURRENT = ("current_north", "current_east")
#: Standard deviation of the error of the sway constant gamma* of an identified model: a turning ship drifts as much more, or less.
SWAY_CONSTANT = 0.1
#: For so long an error of a turn stays in the estimate of the current, in L/U.
TURN_REMEMBERED = 5.0
#: For so long a move of the estimated current makes it unsure, in L/U.
MOVE_REMEMBERED = 10.0


def widened_current(known: Situation, squares: np.ndarray, turning: float, moved: float = 0.0) -> Situation:
    """Return a situation whose current is as unsure as the errors of the fixes that it was estimated from, and of the model.

    Parameters
    ----------
    known : Situation
        What a filter knows.
    squares : ndarray, shape (stretches,)
        From `stretch_squares`, the last ones at the end.
    turning : float
        The largest rate of turn of late (`TURN_REMEMBERED`), |r| L/u.
    moved : float
        From `moved_of_late`, in m/s.

    Returns
    -------
    Situation

    Notes
    -----
    The variance of the filter counts as that of four stretches: with n of mean square m it is multiplied by (4 + n m) / (4 + n), and
    never made smaller. The standard deviation that is told beside the number holds as well by how much the estimate has moved of
    late, and what `identify` takes for the error of a good model of low order: 3 % of a speed, 1 degree of drift, and the sway constant.
    """
    if not set(CURRENT) <= set(known.values):
        return known
    recent = squares[-_REMEMBERED:]
    factor = np.sqrt(max(1.0, (_BELIEVED + recent.sum()) / (_BELIEVED + recent.size)))
    wider = np.array([factor if n in CURRENT else 1.0 for n in known.uncertain])
    found = replace(known, covariance=known.covariance * np.outer(wider, wider)) if factor > 1 else known
    by_filter = np.linalg.norm([found.std_of(n) for n in CURRENT]) / np.sqrt(2)
    by_model = known.values["u"] * np.linalg.norm([STRUCTURE_SPEED, STRUCTURE_ANGLE, SWAY_CONSTANT * turning])
    return replace(found, current_std=float(np.linalg.norm([by_filter, by_model, moved])))


def moved_of_late(t: np.ndarray, current: np.ndarray, variance: np.ndarray, drift: np.ndarray) -> float:
    """Return by how much an estimated current has moved to what it is now, beyond what its filter expects, in m/s.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Instants in s, the present one last.
    current, variance : ndarray, shape (N, 2)
        The estimates in m/s, and their variances.
    drift : ndarray, shape (2,)
        Variance by which the current itself drifts in a second.

    Returns
    -------
    float
        Root of the mean over instants and components; zero for a filter whose sensors err as it takes them to. The current has
        changed, or the fixes and the log do not fit each other: a filter does not know which.

    Notes
    -----
    The error of an optimal estimate is not correlated with the estimate, and the estimate of a random walk moves without direction:
    the variance of a move is therefore the drift, and what the variance of the estimate has lost meanwhile.
    """
    expected = drift * (t[-1] - t)[:, None] + variance - variance[-1]
    beyond = (current[-1] - current) ** 2 - expected
    return float(np.sqrt(max(0.0, beyond.mean())))


def stretch_squares(t: np.ndarray, off: np.ndarray, lasts: float) -> np.ndarray:
    """Return the squared means of stretches of a record in variances of such a mean, were the errors independent.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times of the fixes in s.
    off : ndarray, shape (N, 2)
        Distance of the fixes from the estimates to the north and to the east, in standard deviations of one fix.
    lasts : float
        Length of a stretch in s.

    Returns
    -------
    ndarray, shape (stretches,)
        Mean of both directions; 1 on average for independent errors. A stretch that is not full is left out.
    """
    if t.size < 2:
        return np.zeros(0)
    stretch = np.floor((t - t[0]) / lasts).astype(int)
    begins = np.flatnonzero(np.diff(stretch, prepend=-1))
    sums, counts = np.add.reduceat(off, begins, axis=0), np.diff(begins, append=t.size)
    return np.asarray(((sums**2).mean(axis=1) / counts)[:-1])


class FixErrors:
    """The same, fix by fix.

    Parameters
    ----------
    lasts : float
        Length of a stretch in s.
    """

    def __init__(self, lasts: float) -> None:
        self._lasts = lasts
        self._squares: deque[float] = deque(maxlen=_REMEMBERED)
        self._sum, self._count, self._began = np.zeros(2), 0, -np.inf

    @property
    def squares(self) -> np.ndarray:
        """The last stretches, shape (stretches,)."""
        return np.array(self._squares)

    def add(self, t: float, north: float, east: float) -> None:
        """Take a fix.

        Parameters
        ----------
        t : float
            Its time in s.
        north, east : float
            Its distance from the estimate in standard deviations of one fix.
        """
        if t - self._began >= self._lasts:
            if self._count:
                self._squares.append(float((self._sum**2).mean() / self._count))
            self._sum, self._count, self._began = np.zeros(2), 0, t
        self._sum += north, east
        self._count += 1


class CurrentMoves:
    """Estimates of the current of late.

    Parameters
    ----------
    lasts : float
        For how long they are remembered, in s.
    """

    #: So many are remembered.
    _COUNT = 20

    def __init__(self, lasts: float) -> None:
        self._apart = lasts / self._COUNT
        self._late: deque[tuple[float, np.ndarray, np.ndarray]] = deque(maxlen=self._COUNT)

    def add(self, known: Situation) -> float:
        """Return by how much the current has moved of late, in m/s, with what a filter knows now, which is kept.

        Parameters
        ----------
        known : Situation
            The current, as the filter states it.
        """
        now = known.t, np.array(known.current), np.array([known.std_of(n) for n in CURRENT]) ** 2
        t, current, variance = (np.stack(column) for column in zip(*self._late, now))
        if not self._late or known.t - self._late[-1][0] >= self._apart:
            self._late.append(now)
        return moved_of_late(t, current, variance, np.array([known.noise.get(n, 0.0) for n in CURRENT]) ** 2)
