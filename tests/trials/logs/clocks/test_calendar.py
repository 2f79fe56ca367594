"""Day first or month first: decided by what decides, stated, or left open."""

import numpy as np
import pytest

from shipid.trials.logs.clocks.calendar import read_dates
from shipid.trials.logs.clocks.stamps import read_stamps

MAY_4 = (np.datetime64("2026-05-04") - np.datetime64("1970-01-01")).astype(int)


def dates(cells, order=None, hint=""):
    return read_dates(read_stamps(cells), order, hint)


@pytest.mark.parametrize(
    "cells, words",
    [
        (["25/12/2025 10:00:00", "25/12/2025 10:00:01"], "day first: the numbers 25 12 2025 show it"),
        (["12/25/2025 10:00:00", "12/25/2025 10:00:01"], "month first: the numbers 12 25 2025 show it"),
        (["04.05.2026 10:00:00", "04.05.2026 10:00:01"], "day first: points"),
        (["04/05/2026 23:59:59", "05/05/2026 00:00:00"], "day first: the clock runs on over midnight"),
        (["05/04/2026 23:59:59", "05/05/2026 00:00:00"], "month first: the clock runs on over midnight"),
        (["25-12-99 10:00:00", "25-12-99 10:00:01"], "day first: the numbers 25 12 99 show it"),
    ],
)
def test_what_decides(cells, words):
    found = dates(cells)
    assert len(found.possible) == 1 and words in found.notes[0]


def test_one_garbled_cell_decides_nothing():
    found = dates(["04/05/2026 10:00:00", "99/99/2026 10:00:01", *["25/05/2026 10:00:02"] * 3])
    assert found.possible == ("day first",) and np.isnan(found.days[1])


def test_seconds_that_do_not_depend_on_it_are_read_and_the_day_is_left_open():
    found = dates(["04/05/2026 10:00:00", "04/05/2026 10:00:01"])
    assert found.possible == ("day first", "month first") and found.agree
    assert "nothing decides" in found.notes[0]
    apart = dates(["04/05/2026 10:00:00", "06/05/2026 10:00:00"])
    assert len(apart.possible) == 2 and not apart.agree


def test_header_and_format_file_decide():
    assert dates(["04/05/2026 10:00:00"], hint="dmy").days[0] == MAY_4
    assert dates(["05/04/2026 10:00:00"], order="mdy").days[0] == MAY_4
    assert dates(["4 May 26"]).days[0] == MAY_4


@pytest.mark.parametrize("cell, sound", [("29/02/2024", True), ("29/02/2026", False), ("31/04/2026", False)])
def test_days_of_the_calendar(cell, sound):
    assert np.isfinite(dates([cell], order="dmy").days[0]) == sound
