"""Rhumb lines against quadrature, great circles against geographiclib."""

import numpy as np
import pytest
from geographiclib.geodesic import Geodesic
from scipy.integrate import quad

from shipid.prediction.routes.sailings import (
    along_great_circle,
    along_rhumb_line,
    angle_between,
    great_circle,
    isometric_latitude,
    rhumb_line,
    turned,
)  # fmt: skip

E2 = 0.00669437999014132
A = 6378137.0


def test_angles_come_back_between_half_turns():
    assert turned(np.array([0.0, 3 * np.pi, -np.pi, 4.0])) == pytest.approx([0, np.pi, np.pi, 4 - 2 * np.pi])


def test_great_circles_agree_with_geographiclib():
    rng = np.random.default_rng(1)
    lat, lon, course = rng.uniform(-89, 89, 300), rng.uniform(-180, 180, 300), rng.uniform(0, 360, 300)
    distance = 10 ** rng.uniform(-1, 6.9, 300)
    found = [Geodesic.WGS84.Direct(*args) for args in zip(lat, lon, course, distance)]
    to_lat, to_lon, last = (np.radians([f[k] for f in found]) for k in ("lat2", "lon2", "azi2"))
    a, b, c = np.radians(lat), np.radians(lon), np.radians(course)
    length, first, end = great_circle(a, b, to_lat, to_lon)
    # Vincenty's series leave a tenth of a millimetre.
    assert np.abs(length - distance).max() < 2e-4
    assert np.abs(turned(first - c) * distance).max() < 2e-4
    assert np.abs(turned(end - last) * distance).max() < 2e-4
    at_lat, at_lon = along_great_circle(a, b, c, distance)
    assert np.abs(at_lat - to_lat).max() * A < 2e-4
    assert np.abs(turned(at_lon - to_lon) * np.cos(to_lat)).max() * A < 2e-4


def meridian_radius(lat):
    return A * (1 - E2) / (1 - E2 * np.sin(lat) ** 2) ** 1.5


def ring_radius(lat):
    return A * np.cos(lat) / np.sqrt(1 - E2 * np.sin(lat) ** 2)


@pytest.mark.parametrize(
    ("lat", "lon", "to_lat", "to_lon"),
    [
        (52.0, 4.0, 40.0, -70.0),
        (-30.0, 170.0, 25.0, -160.0),
        (80.0, 10.0, 85.0, 60.0),
        (10.0, 0.0, 10.001, 3.0),
        (60.0, 0.0, 60.4, 30.0),
    ],
)
def test_rhumb_lines_agree_with_quadrature(lat, lon, to_lat, to_lon):
    a, b, c, d = (np.radians(v) for v in (lat, lon, to_lat, to_lon))
    north = quad(meridian_radius, a, c, epsabs=1e-9, epsrel=1e-13)[0]
    mercator = quad(lambda p: meridian_radius(p) / ring_radius(p), a, c, epsabs=1e-15, epsrel=1e-13)[0]
    course = np.arctan2(turned(d - b), mercator)
    length, found = rhumb_line(a, b, c, d)
    assert turned(found - course) * length == pytest.approx(0, abs=1e-3)
    assert length == pytest.approx(north / np.cos(course), abs=1e-3)


def test_a_rhumb_line_along_a_parallel():
    a = np.radians(60.0)
    length, course = rhumb_line(a, 0.0, a, np.radians(20.0))
    assert length == pytest.approx(ring_radius(a) * np.radians(20.0), abs=1e-6)
    assert course == pytest.approx(np.pi / 2)
    # A hair off the parallel the other formula takes over: no step between them.
    near, _ = rhumb_line(a, 0.0, a + 1.01e-5, np.radians(20.0))
    below, _ = rhumb_line(a, 0.0, a + 0.99e-5, np.radians(20.0))
    assert near - below == pytest.approx(-2e-7 * np.sin(a) * A * np.radians(20.0) / 2, abs=1e-3)


def test_rhumb_lines_are_straight_on_the_mercator_chart_and_cross_the_date_line():
    share = np.linspace(0, 1, 11)
    a, b, c, d = (np.radians(v) for v in (10.0, 179.0, 50.0, -160.0))
    lat, lon = along_rhumb_line(a, b, c, d, share)
    assert np.degrees(lon[-1]) == pytest.approx(200.0) and np.degrees(lat[-1]) == pytest.approx(50.0)
    q = isometric_latitude(lat)
    assert lon == pytest.approx(b + (q - q[0]) / (q[-1] - q[0]) * np.radians(21.0), abs=1e-13)


def test_angle_between_places():
    assert angle_between(0.0, 0.0, 0.0, np.pi) == pytest.approx(np.pi)
    assert angle_between(0.1, 0.2, 0.1, 0.2) == 0
    assert angle_between(0.0, 0.0, np.pi / 2, 1.0) == pytest.approx(np.pi / 2)
