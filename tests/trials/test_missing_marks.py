"""Numbers that stand for a missing sample, and numbers that only look like them."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.missing_marks import marks_of_missing

T = np.arange(200.0)
SWING = 30 * np.sin(T / 15)
FULL = 360.0


def marked(values, at, full=None):
    return np.flatnonzero(marks_of_missing(np.asarray(values, float), full)).tolist() == list(at)


@pytest.mark.parametrize("mark", [-9999, 9999, -999, 999, 511, -32768, 32767, 65535, 1e36, np.inf, -np.inf, 99999])
@pytest.mark.parametrize("at", [[0], [1], [60, 61, 62], [198], [199]])
def test_marks_in_a_heading(mark, at):
    values = SWING.copy()
    values[at] = mark
    assert marked(values, at, FULL)


def test_a_heading_that_wraps_never_shows_511():
    values = np.mod(200 + SWING * 8, 360)
    values[[20, 90]] = 511
    assert marked(values, [20, 90], FULL)


def test_an_unwrapped_heading_passes_511():
    assert marked(np.arange(0, 754.0), [], FULL)  # a turning circle of two turns
    assert marked(-np.arange(0.0, 1200.0), [], FULL)  # through -999
    assert marked(np.arange(0.0, 11000.0), [])  # a position through 9999


def test_a_mark_inside_the_range_of_a_position():
    values = np.linspace(-8000, 8000, 200)
    values[50] = -9999
    assert marked(values, [50])


def test_a_steady_channel_that_is_changed_is_no_mark():
    rpm = np.full(200, 950.0)
    rpm[120:] = 999  # ordered
    assert marked(rpm, [])
    assert marked(np.r_[np.zeros(100), np.full(100, 91.0)][:0], [])


def test_a_column_of_one_mark():
    assert marked(np.full(20, -9999.0), range(20))
    assert marked(np.full(20, 999.0), [])  # a shaft may turn at 999 rpm all the time
    assert marked(np.full(5, np.nan), [])


@pytest.mark.parametrize("mark", [327.67, -327.68, -99, 99.9, 655.35])
def test_scaled_ends_of_short_integers_in_a_rudder(mark):
    rudder = np.where(np.arange(200) % 80 < 40, 20.0, -20.0)
    rudder[50:54] = mark
    assert marked(rudder, [50, 51, 52, 53], FULL)


def test_a_heading_within_a_circle_is_never_negative():
    values = 200 + 2 * SWING
    values[[20, 90]] = -99
    assert marked(values, [20, 90], FULL)
    assert marked(SWING * 4, [], FULL)


def test_no_heading_of_ais_in_one_that_is_counted_on():
    heading = np.linspace(340.0, 560.0, 440)
    assert not marks_of_missing(heading, 360.0).any()
    heading[[60, 61, 62, 200]] = 511.0
    np.testing.assert_array_equal(np.flatnonzero(marks_of_missing(heading, 360.0)), [60, 61, 62, 200])
