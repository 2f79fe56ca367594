"""What the residuals of tracks say of their covariances: a track that its own plots contradict is wider than its filter says.

A residual is a plot less what was expected of it, divided by the square root of its covariance. Of a consistent filter it has the
power one and no memory (Mehra, 1970; Bar-Shalom, Li and Kirubarajan, 2001, section 5.4). Positions that are late, smoothed before
they are sent, or bent by a manoeuvre leave residuals on one side again and again, and the mean over a track does not get better
by the square root of their number.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from shipid.encounter.tracking.filters.target_filters import Expected

#: Plots after which an old residual counts for little, and how many agreeing ones are taken as seen at the start.
_MEMORY, _BEFORE = 30.0, 10.0
#: The serial correlation is never taken for certain. Powers of one track and of all tracks of a sensor below these may be chance.
_MOST_SERIAL, _CHANCE, _CHANCE_OF_ALL = 0.9, 1.5, 1.2
#: Agreeing residuals of a sensor that are taken as seen at the start.
_OF_SENSOR = 40.0
#: Share of a plot that is surely a track's.
_SURELY = 0.8


@dataclass
class TrackResiduals:
    """The residuals of every track, and of every sensor over all tracks that are confirmed.

    Attributes
    ----------
    sensors : int
        How many there are.
    power, serial, count : ndarray, shape (n,)
        Of each track: sums of squares for one axis and of products with the residual before, and the number of residuals in them.
    last : ndarray, shape (n, sensors, 2)
        The residual of the last plot of each sensor; NaN where there is none.
    of_sensor : ndarray, shape (sensors, 3)
        Power, serial products and number for each sensor.
    """

    sensors: int
    power: np.ndarray = field(default_factory=lambda: np.zeros(0))
    serial: np.ndarray = field(default_factory=lambda: np.zeros(0))
    count: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        """Begin without a track."""
        self.last = np.zeros((0, self.sensors, 2))
        self.of_sensor = np.zeros((self.sensors, 3))

    def begin(self, new: int) -> None:
        """Take in new tracks, after the others.

        Parameters
        ----------
        new : int
            How many.
        """
        self.power = np.concatenate([self.power, np.full(new, _BEFORE)])
        self.serial = np.concatenate([self.serial, np.zeros(new)])
        self.count = np.concatenate([self.count, np.full(new, _BEFORE)])
        self.last = np.concatenate([self.last, np.full((new, self.sensors, 2), np.nan)])

    def select(self, rows: np.ndarray) -> None:
        """Keep some of the tracks.

        Parameters
        ----------
        rows : ndarray
            Indices, or True and False.
        """
        for name in ("power", "serial", "count", "last"):
            setattr(self, name, getattr(self, name)[rows])

    def learn(self, k: int, mu: np.ndarray, expected: Expected, shares: np.ndarray, held: np.ndarray) -> None:
        """Take in the plots of a scan that surely belong to a track.

        Parameters
        ----------
        k : int
            Index of the sensor.
        mu : ndarray, shape (n, modes)
            Mode probabilities before the scan.
        expected : Expected
            Of the plots.
        shares : ndarray, shape (n, m + 1)
            Probability of no plot and of each.
        held : ndarray of bool, shape (n,)
            The confirmed tracks, which speak of the sensor.
        """
        if not shares.shape[1] > 1:
            return
        which = np.flatnonzero(shares[:, 1:].max(axis=1) > _SURELY)
        if not which.size:
            return
        plot = shares[which, 1:].argmax(axis=1)
        weight, by_mode = mu[which], expected.e[which, :, plot]
        e = np.einsum("nk,nki->ni", weight, by_mode)
        apart = by_mode - e[:, None]
        S = np.einsum("nk,nkij->nij", weight, expected.S[which, :, plot])
        S = S + np.einsum("nk,nki,nkj->nij", weight, apart, apart)
        r = np.linalg.solve(np.linalg.cholesky(S), e[..., None])[..., 0]
        square = 0.5 * (r**2).sum(axis=1)
        product = 0.5 * np.nan_to_num((r * self.last[which, k]).sum(axis=1))
        keep = 1 - 1 / _MEMORY
        self.power[which] = keep * self.power[which] + square
        self.serial[which] = keep * self.serial[which] + product
        self.count[which] = keep * self.count[which] + 1
        self.last[which, k] = r
        sure = held[which]
        self.of_sensor[k] += [square[sure].sum(), product[sure].sum(), sure.sum()]

    @property
    def widening(self) -> np.ndarray:
        """By how much the covariance of each track is too small, shape (n,); one where no residual contradicts it.

        What its own residuals say, or those of all tracks of a sensor that it is seen by, whichever is more.
        """
        own = power_over_time(self.power, self.serial, self.count)
        power, serial, count = self.of_sensor.T
        of_all = power_over_time(power + _OF_SENSOR, serial, count + _OF_SENSOR)
        seen = np.isfinite(self.last[:, :, 0])
        more = np.where(seen & (of_all > _CHANCE_OF_ALL), of_all, 1.0).max(axis=1, initial=1.0)
        return np.asarray(np.maximum(np.where(own > _CHANCE, own, 1.0), more))


def power_over_time(power: np.ndarray, serial: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Return the power of residuals over long times: theirs, times (1 + rho) / (1 - rho) where they are correlated.

    Parameters
    ----------
    power, serial, count : ndarray, shape (n,)
        Sums of squares for one axis, of products with the residual before, and the number of residuals.
    """
    rho = np.clip(serial / np.maximum(power, 1e-300), 0.0, _MOST_SERIAL)
    return np.asarray(power / np.maximum(count, 1e-300) * (1 + rho) / (1 - rho))
