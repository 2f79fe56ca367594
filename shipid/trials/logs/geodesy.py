"""Latitude and longitude to local metres, and back: the tangent plane of the WGS84 ellipsoid at an origin.

The plane touches the ellipsoid at the origin; a point of the ellipsoid is projected onto it at right angles. A distance
d from the origin comes out shorter by about d³/6R², which is 0.1 mm at 3 km, 4 mm at 10 km and 4 m at 100 km.
"""

from __future__ import annotations

import numpy as np

#: WGS84 (NGA.STND.0036): semi-major axis [m] and flattening.
SEMI_MAJOR = 6378137.0
FLATTENING = 1 / 298.257223563
_E2 = FLATTENING * (2 - FLATTENING)


def _radii(lat: np.ndarray | float) -> tuple[np.ndarray | float, np.ndarray | float]:
    """Radii of curvature [m] in the prime vertical and in the meridian."""
    w = 1 - _E2 * np.sin(lat) ** 2
    return SEMI_MAJOR / np.sqrt(w), SEMI_MAJOR * (1 - _E2) / w**1.5


def to_local(
    lat: np.ndarray | float, lon: np.ndarray | float, origin: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return north and east [m] of points on the ellipsoid.

    Parameters
    ----------
    lat, lon : ndarray or float
        Latitude and longitude [rad], positive to north and east.
    origin : tuple of float
        Latitude and longitude of the origin [rad].

    Returns
    -------
    north, east : ndarray
        Of the shape of `lat`.
    """
    lat0, lon0 = origin
    turned = np.asarray(lon, dtype=float) - lon0
    lat = np.asarray(lat, dtype=float)
    n0, n = _radii(lat0)[0], _radii(lat)[0]
    # Differences are written as products, so that nothing is lost to the size of the earth.
    half = 2 * np.sin(turned / 2) ** 2
    ring = n * np.cos(lat)
    rise = (1 - _E2) * (n * np.sin(lat) - n0 * np.sin(lat0))
    widen = ring - n0 * np.cos(lat0)
    north = rise * np.cos(lat0) - (widen - ring * half) * np.sin(lat0)
    return north, ring * np.sin(turned)


def to_geographic(
    north: np.ndarray | float, east: np.ndarray | float, origin: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return latitude and longitude [rad] of points of the local plane: the inverse of `to_local`.

    Parameters
    ----------
    north, east : ndarray or float
        In the plane [m], within some hundred kilometres.
    origin : tuple of float
        Latitude and longitude of the origin [rad].

    Returns
    -------
    lat, lon : ndarray
        Of the shape of `north`.
    """
    north, east = np.asarray(north, dtype=float), np.asarray(east, dtype=float)
    lat, lon = np.full(north.shape, origin[0]), np.full(north.shape, origin[1])
    for _ in range(30):  # Newton with the radii of curvature: each round gains a factor tan(lat) d/R
        x, y = to_local(lat, lon, origin)
        vertical, meridian = _radii(lat)
        lat = lat + (north - x) / meridian
        lon = lon + (east - y) / (vertical * np.cos(lat))
        if max(np.abs(north - x).max(initial=0.0), np.abs(east - y).max(initial=0.0)) < 1e-7:
            break
    return lat, lon
