"""Between the samples of a channel: straight lines or the last value, and nothing across a hole."""

from __future__ import annotations

import numpy as np

from shipid.trials.filling import held, interpolated, usual_interval

T = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 13.0, 14.0, 15.0])
X = np.array([0.0, np.nan, 4.0, 6.0, 8.0, np.nan, 28.0, 30.0])


def test_straight_lines_between_the_samples():
    got = interpolated(T, X, np.array([0.0, 0.5, 1.0, 2.5, 4.0, 14.5, 15.0]))
    np.testing.assert_allclose(got, [0, 1, 2, 5, 8, 29, 30])
    np.testing.assert_allclose(interpolated(T, X)[1], 2.0)


def test_the_last_order_holds():
    np.testing.assert_allclose(held(T, X, np.array([0.0, 1.9, 2.0, 3.5, 8.9, 14.9, 15.5])), [0, 0, 4, 6, 8, 28, 30])


def test_nothing_across_a_hole_or_outside():
    """The usual interval is 1 s: from 4 to 14 s there is a hole, five intervals of holding included."""
    assert usual_interval(T, X) == 1.0
    assert np.isnan(interpolated(T, X, np.array([-1.0, 5.0, 13.0, 15.1]))).all()
    assert np.isnan(held(T, X, np.array([-1.0, 9.5, 13.0, 21.0]))).all()


def test_no_sample_and_one_sample():
    empty, one = np.full(3, np.nan), np.array([np.nan, 2.0, np.nan])
    t = np.arange(3.0)
    assert np.isnan(interpolated(t, empty)).all() and np.isnan(held(t, empty)).all()
    np.testing.assert_array_equal(interpolated(t, one), one)
    assert np.isnan(usual_interval(t, one))
