"""Date and time as text: taken apart, whatever a logger writes."""

import numpy as np
import pytest

from shipid.trials.logs.clocks.stamps import is_stamp, read_stamps

ALL = [
    ("2026-05-04T23:58:20.25", (2026, 5, 4), 86300.25, np.nan),
    ("2026-05-04 23:58:20Z", (2026, 5, 4), 86300, 0),
    ("2026-05-04T23:58:20+02:00", (2026, 5, 4), 86300, 7200),
    ("2026-05-04 23:58:20 -0330", (2026, 5, 4), 86300, -12600),
    ("2026-05-04 23:58:20 CEST", (2026, 5, 4), 86300, 7200),
    ("2026/05/04 10:00:00 UTC+2", (2026, 5, 4), 36000, 7200),
    ("2026-05-04T10:00:00.5+02:00[Europe/Oslo]", (2026, 5, 4), 36000.5, 7200),
    ("2026-05-04-10:00:00.123", (2026, 5, 4), 36000.123, np.nan),
    ("20260504T235820Z", (2026, 5, 4), 86300, 0),
    ("20260504235820.5", (2026, 5, 4), 86300.5, np.nan),
    ("25/12/2025 10:00:00 AM", (25, 12, 2025), 36000, np.nan),
    ("04.05.2026 10:00", (4, 5, 2026), 36000, np.nan),
    ("4 May 2026 10:00:00", (4, 5, 2026), 36000, np.nan),
    ("May 4, 2026 10:00", (5, 4, 2026), 36000, np.nan),
    ("04-Mai-26 10:00:00", (4, 5, 26), 36000, np.nan),
    ("8. März 2026 10:00:00", (8, 3, 2026), 36000, np.nan),
    ("Mon, 04 May 2026 10:00:00 GMT", (4, 5, 2026), 36000, 0),
    ("2026-05-04", (2026, 5, 4), 0, np.nan),
    ("23:58:20,5", None, 86300.5, np.nan),
    ("11:58:20 PM", None, 86300, np.nan),
    ("12:00:00 a.m.", None, 0, np.nan),
    ("12:30:00 PM", None, 45000, np.nan),
    ("10:00:00:500", None, 36000.5, np.nan),
    ("12:34.5", None, 754.5, np.nan),
    ("100:00:01", None, 360001, np.nan),
    ("23:59:60", None, 86400, np.nan),
]


@pytest.mark.parametrize("cell, date, time, offset", ALL)
def test_what_stands_in_a_cell(cell, date, time, offset):
    stamps = read_stamps([cell])
    assert not stamps.bad[0]
    assert stamps.time[0] == pytest.approx(time)
    np.testing.assert_equal(stamps.offset[0], offset)
    if date is None:
        assert not stamps.dated
    else:
        assert tuple(stamps.date[0]) == date


@pytest.mark.parametrize(
    "cell",
    ["nan", "1.5", "12", "-", "Monday", "13:00:00 PM", "10:61:00", "10:00:61", "2026-05-04 25:00:00", "4 Foo 2026 10:00:00", "1e5"],
)  # fmt: skip
def test_what_is_no_stamp(cell):
    assert read_stamps([cell]).bad[0]
    assert not is_stamp(cell)


def test_an_empty_cell_is_neither_a_stamp_nor_wrong():
    stamps = read_stamps(["10:00:00", "", "10:00:01"])
    assert not stamps.bad.any() and np.isnan(stamps.time[1])
    assert not is_stamp(" ")


def test_the_name_of_a_zone_is_kept_where_its_offset_is_not_known():
    assert read_stamps(["2026-05-04 10:00:00 EST"] * 2).zone == "EST"
    stamps = read_stamps(["2026-05-04 10:00:00 EST", "2026-05-04 10:00:01 Z"])
    assert stamps.zone == "" and stamps.bad.tolist() == [True, False]


@pytest.mark.parametrize(
    "cell",
    [
        "2026年11月30日 23时58分20秒",
        "2026年11月30日23時58分20秒",
        "30/11/2026 23h58m20s",
        "30/11/2026 23 h 58 min 20 s",
    ],
)
def test_units_behind_the_numbers(cell):
    found = read_stamps([cell])
    assert not found.bad[0] and found.time[0] == 86300.0 and set(found.date[0]) == {2026, 11, 30}
