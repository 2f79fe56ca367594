"""The course of a clock: midnight, the end of summer time, stamps of low resolution."""

import numpy as np
import pytest

from shipid.trials.logs.clocks import course


def test_midnight_is_passed_and_gaps_stay():
    clock = np.array([86398, np.nan, 86399, 0, 1, 70000, 86399, 5])
    seconds, count = course.unrolled(clock, 86400)
    assert count == 2
    np.testing.assert_equal(seconds, [86398, np.nan, 86399, 86400, 86401, 156400, 172799, 172805])


def test_an_hour_back():
    clock = np.concatenate((np.arange(0, 100, 0.5), np.arange(100, 200, 0.5) - 3600))
    assert course.hour_back(clock) == 200
    assert course.hour_back(np.arange(10.0)) is None
    assert course.hour_back(np.concatenate((np.arange(50.0), np.arange(50.0) - 1800))) is None


@pytest.mark.parametrize(
    "moment, ends", [("2026-10-25T02:59:59", True), ("2026-10-24T02:59:59", False), ("2026-06-07T02:59:59", False)]
)
def test_when_summer_time_ends(moment, ends):
    assert course.ends_summer((np.datetime64(moment) - np.datetime64("1970-01-01")).astype(float)) == ends


@pytest.mark.parametrize("rate", [2, 5, 10])
@pytest.mark.parametrize("cut", [0, 1])
def test_samples_that_share_a_stamp_are_spread(rate, cut):
    # The log begins and ends within a second: its first and last stamps stand fewer times than the others.
    truth = np.arange(cut, 20 * rate + cut) / rate
    seconds, resolution = course.spread(np.floor(truth))
    assert resolution == 1.0
    np.testing.assert_allclose(seconds, truth, atol=1e-9)


def test_what_is_not_spread():
    falling = np.array([0, 0, 1, 1, 0.0, 0])
    twice = np.repeat(np.arange(20.0), 2)
    few = np.sort(np.append(np.arange(40.0), 7.0))
    for clock in (falling, few, np.arange(20.0)):
        assert course.spread(clock)[1] is None
    assert course.spread(twice, np.arange(40) % 2 == 1)[1] is None
    assert course.spread(twice)[1] == 1.0


def test_an_hour_on_at_the_full_hour():
    clock = 3600.0 * 2 - 100 + np.arange(300.0)
    jumped = np.where(np.arange(300) >= 100, clock + 3600, clock)
    assert course.hour_on(jumped) == 100
    assert course.hour_on(clock) is None
    assert course.hour_on(jumped + 30) is None, "a pause of an hour begins at any time"
