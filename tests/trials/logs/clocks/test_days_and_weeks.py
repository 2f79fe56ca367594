"""Clocks that count days of a year, or seconds of a GPS week."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials.errors import ClockError
from shipid.trials.logs.clocks.reading import read_clock, with_clock
from shipid.trials.logs.clocks.settings import ClockFormat

SECONDS = np.arange(0, 40, 0.5)


def clocked(stated=None, **columns):
    return with_clock({name: pd.Series(column) for name, column in columns.items()}, "'log.csv'", stated)


@pytest.mark.parametrize("name", ["doy", "Day of Year", "yday", "jday", "DOY [d]"])
def test_decimal_day_of_a_year(name):
    read = clocked(**{name: 245.53125 + SECONDS / 86400, "psi [deg]": SECONDS})
    np.testing.assert_allclose(read.columns["t [s]"], SECONDS, atol=1e-4)
    assert read.start is None
    assert "12:45:00 on day 245 of a year that nothing names" in read.notes[0]


@pytest.mark.parametrize(("year", "days"), [("leap", 366), ("common", 365)])
def test_the_end_of_a_year(year, days):
    numbers = (days + 1 - 20 / 86400 + SECONDS / 86400 - 1) % days + 1
    read = clocked(doy=numbers)
    np.testing.assert_allclose(read.columns["t [s]"], SECONDS, atol=1e-4)
    assert "The clock passes the end of the year once." in read.notes


def test_the_day_of_a_year_has_to_be_named_or_stated():
    numbers = 245.53125 + SECONDS / 86400
    with pytest.raises(
        ClockError, match=r'look like days. Write .time \[d\]., or .* layout = "day of year" in \[clock\]'
    ):
        clocked(time=numbers, psi=SECONDS)
    read = read_clock({"time": pd.Series(numbers)}, "'log.csv'", ClockFormat(layout="day of year"))
    np.testing.assert_allclose(read.seconds, SECONDS, atol=1e-4)
    # Seconds of a fast logger, without a unit, are still refused by the name of the unit alone.
    assert list(clocked(time=SECONDS / 500).columns) == ["time"]


@pytest.mark.parametrize("name", ["SOW", "GPS seconds of week", "tow [s]", "gps_sow [s]"])
@pytest.mark.parametrize("week", [None, "counts", "stays"])
def test_seconds_of_a_gps_week(name, week):
    """The week ends in the log; its number may count on, stay, or not be there."""
    seconds = (604790 + SECONDS) % 604800
    beside = {} if week is None else {"GPS week": 2290 + (SECONDS >= 10) * (week == "counts")}
    read = clocked(**{name: seconds, **beside, "psi [deg]": SECONDS})
    np.testing.assert_allclose(read.columns["t [s]"], SECONDS)
    assert list(read.columns) == ["t [s]", "psi [deg]"]
    assert (read.start is None) == (week is None)


@pytest.mark.parametrize(("unit", "count"), [("ms", 1e3), ("us", 1e6)])
def test_a_counter_of_32_bits_begins_again(unit, count):
    """As millis() and micros() of a microcontroller do; a record that begins again elsewhere is not let run on."""
    ticks = (2**32 - 20 * count + SECONDS * count) % 2**32
    read = clocked(**{f"t [{unit}]": ticks, "psi [deg]": SECONDS})
    np.testing.assert_allclose(np.diff(read.columns[f"t [{unit}]"]) / count, 0.5, rtol=1e-9)
    assert read.notes == ("The counter of the clock begins again after 32 bits once.",)
    again = np.r_[500 * count + SECONDS * count, SECONDS * count]
    assert (np.diff(clocked(**{f"t [{unit}]": again, "psi [deg]": again}).columns[f"t [{unit}]"]) < 0).any()
