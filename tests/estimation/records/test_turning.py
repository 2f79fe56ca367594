"""A record without a rate of turn, for a model that it drives: the slope of the heading stands in, and the run says so."""

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.trials.filling import slope


def record(t, **more):
    """A ship that turns at 0.5 deg/s at 8 m/s."""
    w = np.radians(0.5)
    psi = w * t
    columns = {"t [s]": t, "psi [deg]": np.degrees(psi), "u [m/s]": np.full_like(t, 8.0)}
    columns |= {"x [m]": 8 * np.sin(psi) / w, "y [m]": 8 * (1 - np.cos(psi)) / w}
    return shipid.Trial.from_frame(pd.DataFrame(columns | more), name="turn")


@pytest.fixture(scope="module")
def position_filter():
    return shipid.ExtendedKalmanFilter("position-filter", "soesterberg")


def test_the_slope_of_the_heading_drives_the_filter(position_filter):
    t = np.arange(0, 120.0)
    run = position_filter.filter(record(t))
    known = position_filter.filter(record(t, **{"r [deg/s]": np.full_like(t, 0.5)}))
    word = "r is not recorded: what drives the model is the slope of psi over 2 s."
    assert word in run.arranged.words and word not in known.arranged.words
    np.testing.assert_allclose(run["x"], known["x"], atol=1e-6)


def test_slope_of_a_line_and_across_a_hole():
    t = np.arange(0, 60, 0.5)
    values = 3 * t
    values[[10, 11]] = np.nan
    found = slope(t, values, 2.0)
    assert np.isnan(found[[10, 11]]).all()
    np.testing.assert_allclose(found[np.isfinite(values)], 3.0)
    values[40:80] = np.nan
    found = slope(t, values, 2.0)
    assert np.isnan(found[38:82]).all() and np.isfinite(found[[37, 82]]).all()
    assert np.isnan(slope(t, np.full_like(t, np.nan), 2.0)).all()
