"""What all plots of a target have in common does not average out: a sensor out of place or out of true, and the length of a ship.

A filter takes the errors of plots as independent, so that its covariance shrinks with their number. An offset that stays goes into
the estimate as it is. Its covariance is therefore added to that of the filter (Schmidt, 1966, with the gains left as they are).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.encounter.plots.plots import Scan, Sensor


@dataclass
class SensorBias:
    """How much the offset of each sensor is in each track.

    Attributes
    ----------
    sensors : tuple of Sensor
        With the standard deviations of their offsets.
    """

    sensors: tuple[Sensor, ...]

    def __post_init__(self) -> None:
        """Begin without a track."""
        self.share = np.zeros((0, len(self.sensors)))
        self._own = np.zeros((len(self.sensors), 4))
        self._t = np.full(len(self.sensors), np.nan)

    @property
    def known(self) -> bool:
        """Whether a sensor is said to have an offset."""
        return any(s.bias_std > 0 or s.bearing_bias_std > 0 for s in self.sensors)

    def begin(self, k: int, new: int) -> None:
        """Take in new tracks of a sensor, after the others.

        Parameters
        ----------
        k : int
            Index of the sensor.
        new : int
            How many.
        """
        first = np.zeros((new, len(self.sensors)))
        first[:, k] = 1.0
        self.share = np.concatenate([self.share, first])

    def select(self, rows: np.ndarray) -> None:
        """Keep some of the tracks.

        Parameters
        ----------
        rows : ndarray
            Indices, or True and False.
        """
        self.share = self.share[rows]

    def learn(self, k: int, scan: Scan, before: np.ndarray, after: np.ndarray) -> None:
        """Take note of how much of each track a scan has made new, and of how the sensor moves.

        Parameters
        ----------
        k : int
            Index of the sensor.
        scan : Scan
            What it saw.
        before, after : ndarray, shape (n, 4, 4)
            Covariances before and after the scan.
        """
        left = np.linalg.det(after[:, :2, :2]) / np.maximum(np.linalg.det(before[:, :2, :2]), 1e-300)
        new = 1 - np.sqrt(np.clip(left, 0.0, 1.0))
        self.share *= 1 - new[:, None]
        self.share[:, k] += new
        if len(scan.z) and np.isfinite(scan.own).all():
            passed = scan.t - self._t[k]
            if passed > 0:
                self._own[k, 2:] = (scan.own - self._own[k, :2]) / passed
            self._own[k, :2], self._t[k] = scan.own, scan.t

    def covariance(self, x: np.ndarray) -> np.ndarray:
        """Return what the offsets add to the covariance of each track, shape (n, 4, 4).

        A wrong direction turns the position about the sensor and the velocity relative to it by one angle.

        Parameters
        ----------
        x : ndarray, shape (n, 4)
            North and east position and velocity, m and m/s.
        """
        found = np.zeros((len(x), 4, 4))
        for k, sensor in enumerate(self.sensors):
            away = x - self._own[k]
            turned = np.stack([-away[:, 1], away[:, 0], -away[:, 3], away[:, 2]], axis=1)
            one = sensor.bearing_bias_std**2 * turned[:, :, None] * turned[:, None, :]
            one[:, [0, 1], [0, 1]] += sensor.bias_std**2
            found += self.share[:, k, None, None] ** 2 * one
        return found
