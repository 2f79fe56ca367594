"""Covariances of one scan's sensors as the cycle takes them: independent sums of the sensors, one after the other."""

from __future__ import annotations

import numpy as np


def whitened(covariances: np.ndarray, there: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return variances, and the sums of sensors they belong to.

    With R = L D L', the errors of inv(L) z are independent and have the variances D. A sensor that shows nothing has no part in it.

    Parameters
    ----------
    covariances : ndarray, shape (N, sensors, sensors)
        Covariance R of each scan.
    there : ndarray of bool, shape (N, sensors)
        Which sensors show something.

    Returns
    -------
    variances : ndarray, shape (N, sensors)
        Diagonal of D; 1 where a sensor shows nothing.
    below : ndarray, shape (N, sensors (sensors - 1) / 2)
        Entries of inv(L) below its diagonal, row by row.
    """
    count, sensors = there.shape
    both = there[:, :, None] & there[:, None, :]
    root = np.linalg.cholesky(np.where(both, covariances, np.eye(sensors)))
    scale = np.einsum("kii->ki", root)
    inverse = np.linalg.inv(root / scale[:, None, :])
    rows, columns = np.tril_indices(sensors, -1)
    return scale**2, inverse[:, rows, columns].reshape(count, -1)


def polar_to_cartesian(
    distance: np.ndarray, bearing: np.ndarray, distance_std: float, bearing_std: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return radar plots as positions with their covariance, to first order in the errors.

    Semerdjiev and Mihaylova (2000), section 4.3, after Farina and Studer (1986); its X is east and its Y north.

    Parameters
    ----------
    distance : ndarray, shape (N,)
        Range in m.
    bearing : ndarray, shape (N,)
        In rad, clockwise from north.
    distance_std, bearing_std : float
        Standard deviations in m and rad.

    Returns
    -------
    x, y : ndarray, shape (N,)
        North and east of the radar, in m.
    covariance : ndarray, shape (N, 2, 2)
        Of north and east, in m^2.
    """
    north, east = np.cos(bearing), np.sin(bearing)
    along, across = distance_std**2, (distance * bearing_std) ** 2
    covariance = np.empty((*np.shape(bearing), 2, 2))
    covariance[..., 0, 0] = along * north**2 + across * east**2
    covariance[..., 1, 1] = along * east**2 + across * north**2
    covariance[..., 0, 1] = covariance[..., 1, 0] = (along - across) * north * east
    return distance * north, distance * east, covariance
