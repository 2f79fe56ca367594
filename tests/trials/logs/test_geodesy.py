"""Local metres against two formulas that were not used: earth-centred coordinates in 40 digits, and geodesics."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mpmath import cos, mp, mpf, radians, sin, sqrt
from scipy.integrate import quad

from shipid.trials.logs.geodesy import to_geographic, to_local

E2 = 0.00669437999014132


def centred(lat, lon):
    n = mpf(6378137) / sqrt(1 - E2 * sin(lat) ** 2)
    return n * cos(lat) * cos(lon), n * cos(lat) * sin(lon), n * (1 - E2) * sin(lat)


@given(
    st.floats(-85, 85),
    st.floats(-180, 180),
    st.floats(-0.03, 0.03),
    st.floats(-0.03, 0.03),
)
def test_against_earth_centred_coordinates(lat0, lon0, dlat, dlon):
    mp.dps = 40
    a, b, c, d = (np.radians(v) for v in (lat0, lon0, lat0 + dlat, lon0 + dlon))
    x, y, z = (p - q for p, q in zip(centred(mpf(c), mpf(d)), centred(mpf(a), mpf(b))))
    lat, lon = mpf(a), mpf(b)
    north = -sin(lat) * cos(lon) * x - sin(lat) * sin(lon) * y + cos(lat) * z
    east = -sin(lon) * x + cos(lon) * y
    found = to_local(c, d, (a, b))
    assert abs(found[0] - float(north)) < 1e-7 and abs(found[1] - float(east)) < 1e-7


@pytest.mark.parametrize("lat0", [0.0, 35.0, 63.45, -54.0])
def test_along_the_meridian_and_the_parallel(lat0):
    """Arcs by quadrature: a few kilometres agree to a millimetre."""
    a = float(radians(lat0))
    to = a + 4000 / 6.37e6
    arc = quad(lambda p: 6378137 * (1 - E2) / (1 - E2 * np.sin(p) ** 2) ** 1.5, a, to, epsabs=1e-9)[0]
    north, east = to_local(to, 0.3, (a, 0.3))
    assert abs(north - arc) < 1e-3 and abs(east) < 1e-9
    turned = 4000 / 6.38e6 / np.cos(a)
    ring = 6378137 / np.sqrt(1 - E2 * np.sin(a) ** 2) * np.cos(a) * turned
    assert abs(to_local(a, 0.3 + turned, (a, 0.3))[1] - ring) < 2e-3  # a parallel is not the shortest way


def test_across_the_date_line():
    north, east = to_local(np.radians(10.0), np.radians(-179.99), (np.radians(10.0), np.radians(179.99)))
    assert east == pytest.approx(2192.6, abs=1) and abs(north) < 1


@given(st.floats(-80, 80), st.floats(-1e5, 1e5), st.floats(-1e5, 1e5))
def test_there_and_back(lat0, north, east):
    origin = (np.radians(lat0), 0.2)
    x, y = to_local(*to_geographic(north, east, origin), origin)
    assert abs(x - north) < 1e-6 and abs(y - east) < 1e-6
