"""Rhumb lines and great circles on the WGS84 ellipsoid: course, length, and the points between.

Angles are in rad, lengths in m, courses clockwise from north; everything takes arrays. A great circle stands for the geodesic of
the ellipsoid, its shortest line.

References
----------
Bennett, G. G. (1996). Practical rhumb line calculations on the spheroid. Journal of Navigation 49(1), 112-119.

Vincenty, T. (1975). Direct and inverse solutions of geodesics on the ellipsoid with application of nested equations. Survey
Review 23(176), 88-93. His equations are written here for differences of latitude, so that short legs lose no digits.
"""

from __future__ import annotations

import numpy as np

from shipid.trials.logs.geodesy import FLATTENING, SEMI_MAJOR

_E2 = FLATTENING * (2 - FLATTENING)
_E = np.sqrt(_E2)
_SEMI_MINOR = SEMI_MAJOR * (1 - FLATTENING)
#: Third flattening, and the series in it of the length of a meridian (Bessel 1825; exact to a micrometre).
_N = FLATTENING / (2 - FLATTENING)
_RECTIFYING = SEMI_MAJOR / (1 + _N) * (1 + _N**2 / 4 + _N**4 / 64)
_SERIES = SEMI_MAJOR / (1 + _N) * np.array(
    [-3 / 2 * (_N - _N**3 / 8), 15 / 16 * (_N**2 - _N**4 / 4), -35 / 48 * _N**3, 315 / 512 * _N**4]
)  # fmt: skip
#: Differences of latitude [rad] below which a leg counts as a piece of a parallel.
_PARALLEL = 1e-5
_ROUNDS = 60


def turned(angle: np.ndarray | float) -> np.ndarray:
    """Return an angle between -pi and pi.

    Parameters
    ----------
    angle : ndarray or float
        In rad.
    """
    return np.asarray(np.pi - np.remainder(np.pi - np.asarray(angle, dtype=float), 2 * np.pi))


def counted_eastward(lon: np.ndarray) -> np.ndarray:
    """Return longitudes that are counted eastward to 360 deg over the date line between -180 and 180 deg; others as they are.

    Parameters
    ----------
    lon : ndarray, shape (waypoints,)
        As they are written, in rad. One that lies far from its neighbours is a mistake, and stays.
    """
    beyond = (lon > np.pi) & (lon <= 2 * np.pi)
    if not beyond.any() or lon.size < 2 or not np.abs(np.diff(lon)).max() < np.pi / 2:
        return lon
    return np.where(beyond, lon - 2 * np.pi, lon)


def isometric_latitude(lat: np.ndarray) -> np.ndarray:
    """Return the latitude of the Mercator chart, in rad of the equator.

    Parameters
    ----------
    lat : ndarray
        Latitude in rad, away from the poles.
    """
    return np.asarray(np.arcsinh(np.tan(lat)) - _E * np.arctanh(_E * np.sin(lat)))


def _meridian(lat: np.ndarray) -> np.ndarray:
    """Length of the meridian from the equator in m."""
    return np.asarray(
        _RECTIFYING * lat + np.einsum("k,k...->...", _SERIES, [np.sin(2 * k * lat) for k in (1, 2, 3, 4)])
    )


def rhumb_line(
    lat: np.ndarray, lon: np.ndarray, to_lat: np.ndarray, to_lon: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return length and course of rhumb lines, the shorter way round the earth (Bennett 1996).

    Parameters
    ----------
    lat, lon, to_lat, to_lon : ndarray
        Where they begin and end, in rad, away from the poles.

    Returns
    -------
    length, course : ndarray
        In m and rad.
    """
    east, rise = turned(to_lon - lon), to_lat - lat
    north = _meridian(to_lat) - _meridian(lat)
    flat = np.abs(rise) < _PARALLEL
    mercator = np.where(flat, 1.0, isometric_latitude(to_lat) - isometric_latitude(lat))
    middle = (lat + to_lat) / 2
    ring = SEMI_MAJOR * np.cos(middle) / np.sqrt(1 - _E2 * np.sin(middle) ** 2)
    # North over difference of isometric latitude is a mean radius of the parallels that are crossed.
    departure = np.where(flat, ring, north / mercator) * east
    return np.hypot(north, departure), np.remainder(np.arctan2(departure, north), 2 * np.pi)


def along_rhumb_line(
    lat: np.ndarray, lon: np.ndarray, to_lat: np.ndarray, to_lon: np.ndarray, share: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return latitude and longitude of points on rhumb lines.

    Parameters
    ----------
    lat, lon, to_lat, to_lon : ndarray
        Where they begin and end, in rad, away from the poles.
    share : ndarray
        From 0 at the beginning to 1 at the end.

    Returns
    -------
    lat, lon : ndarray
        In rad.
    """
    at = lat + share * (to_lat - lat)
    begin, end = isometric_latitude(lat), isometric_latitude(to_lat)
    flat = np.abs(to_lat - lat) < _PARALLEL
    gone = np.where(flat, share, (isometric_latitude(at) - begin) / np.where(flat, 1.0, end - begin))
    return at, lon + gone * turned(to_lon - lon)


def angle_between(lat: np.ndarray, lon: np.ndarray, to_lat: np.ndarray, to_lon: np.ndarray) -> np.ndarray:
    """Return the angle between places seen from the centre of a sphere, in rad (haversine formula).

    Parameters
    ----------
    lat, lon, to_lat, to_lon : ndarray
        In rad.
    """
    half = np.sin((to_lat - lat) / 2) ** 2 + np.cos(lat) * np.cos(to_lat) * np.sin((to_lon - lon) / 2) ** 2
    return np.asarray(2 * np.arcsin(np.sqrt(np.minimum(half, 1.0))))


def great_circle(
    lat: np.ndarray, lon: np.ndarray, to_lat: np.ndarray, to_lon: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return length, first and last course of the shortest lines (Vincenty 1975, inverse).

    Parameters
    ----------
    lat, lon, to_lat, to_lon : ndarray
        Where they begin and end, in rad; not nearly on opposite sides of the earth.

    Returns
    -------
    length, course, last : ndarray
        In m and rad.
    """
    u1, u2 = _reduced(lat), _reduced(to_lat)
    rise = u2 - u1
    c1, s1, c2, s2 = np.cos(u1), np.sin(u1), np.cos(u2), np.sin(u2)
    east = turned(to_lon - lon)
    on_sphere = east
    for _ in range(_ROUNDS):
        half = 2 * np.sin(on_sphere / 2) ** 2
        across, ahead = c2 * np.sin(on_sphere), np.sin(rise) + s1 * c2 * half
        sin_arc, cos_arc = np.hypot(across, ahead), np.cos(rise) - c1 * c2 * half
        arc = np.arctan2(sin_arc, cos_arc)
        there = sin_arc > 0
        sin_equator = np.where(there, c1 * across / np.where(there, sin_arc, 1.0), 0.0)
        square = np.maximum(1 - sin_equator**2, 0.0)
        oblique = square > 1e-15
        middle = np.where(oblique, cos_arc - 2 * s1 * s2 / np.where(oblique, square, 1.0), 0.0)
        c = FLATTENING / 16 * square * (4 + FLATTENING * (4 - 3 * square))
        wave = arc + c * sin_arc * (middle + c * cos_arc * (2 * middle**2 - 1))
        new = east + (1 - c) * FLATTENING * sin_equator * wave
        change, on_sphere = np.abs(new - on_sphere), new
        if change.max(initial=0.0) < 1e-14:
            break
    a, b = _series(square)
    length = _SEMI_MINOR * a * (arc - _wave(b, sin_arc, cos_arc, middle))
    half = 2 * np.sin(on_sphere / 2) ** 2
    last = np.arctan2(c1 * np.sin(on_sphere), np.sin(rise) - c1 * s2 * half)
    return length, np.remainder(np.arctan2(across, ahead), 2 * np.pi), np.remainder(last, 2 * np.pi)


def along_great_circle(
    lat: np.ndarray, lon: np.ndarray, course: np.ndarray, distance: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return where a shortest line leads (Vincenty 1975, direct).

    Parameters
    ----------
    lat, lon, course : ndarray
        Where it begins and how it leaves, in rad.
    distance : ndarray
        In m.

    Returns
    -------
    lat, lon : ndarray
        In rad.
    """
    u1 = _reduced(lat)
    c1, s1 = np.cos(u1), np.sin(u1)
    ahead, aside = np.cos(course), np.sin(course)
    begin = np.arctan2(s1, c1 * ahead)
    sin_equator = c1 * aside
    square = np.maximum(1 - sin_equator**2, 0.0)
    a, b = _series(square)
    straight = distance / (_SEMI_MINOR * a)
    arc = straight
    for _ in range(_ROUNDS):
        middle = np.cos(2 * begin + arc)
        new = straight + _wave(b, np.sin(arc), np.cos(arc), middle)
        change, arc = np.abs(new - arc), new
        if change.max(initial=0.0) < 1e-14:
            break
    sin_arc, cos_arc, middle = np.sin(arc), np.cos(arc), np.cos(2 * begin + arc)
    north = s1 * cos_arc + c1 * sin_arc * ahead
    inward = np.hypot(sin_equator, s1 * sin_arc - c1 * cos_arc * ahead)
    on_sphere = np.arctan2(sin_arc * aside, c1 * cos_arc - s1 * sin_arc * ahead)
    c = FLATTENING / 16 * square * (4 + FLATTENING * (4 - 3 * square))
    wave = arc + c * sin_arc * (middle + c * cos_arc * (2 * middle**2 - 1))
    return np.arctan2(north, (1 - FLATTENING) * inward), lon + on_sphere - (1 - c) * FLATTENING * sin_equator * wave


def _reduced(lat: np.ndarray) -> np.ndarray:
    """Reduced latitude."""
    return np.asarray(np.arctan2((1 - FLATTENING) * np.sin(lat), np.cos(lat)))


def _series(square: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vincenty's A and B (his equations 3 and 4)."""
    u = square * _E2 / (1 - _E2)
    return (
        1 + u / 16384 * (4096 + u * (-768 + u * (320 - 175 * u))),
        u / 1024 * (256 + u * (-128 + u * (74 - 47 * u))),
    )


def _wave(b: np.ndarray, sin_arc: np.ndarray, cos_arc: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """What the ellipsoid adds to the arc of the sphere (Vincenty's equation 6)."""
    inner = cos_arc * (2 * middle**2 - 1) - b / 6 * middle * (4 * sin_arc**2 - 3) * (4 * middle**2 - 3)
    return np.asarray(b * sin_arc * (middle + b / 4 * inner))
