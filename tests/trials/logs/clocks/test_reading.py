"""Any clock: seconds since the first stamp, the moment that is, and how it was read."""

import datetime as dt

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.clocks.reading import read_clock, with_clock
from shipid.trials.logs.clocks.settings import ClockFormat
from shipid.trials.logs.reading import read_trial

SECONDS = np.arange(0, 40, 0.5)
STAMPS = pd.Series(pd.Timestamp("2026-05-04 23:59:50") + pd.to_timedelta(SECONDS, unit="s"))
EPOCH = (STAMPS - pd.Timestamp(0)).dt.total_seconds()
WEEK = (EPOCH - 315964800.0) % 604800


def clocked(stated=None, **columns):
    """Read a table of columns."""
    table = {name: pd.Series(column) for name, column in columns.items()}
    return with_clock(table, "'log.csv'", stated)


def text(pattern, stamps=STAMPS):
    return stamps.dt.strftime(pattern)


@pytest.mark.parametrize(
    "columns, start",
    [
        ({"time": STAMPS}, "2026-05-04T23:59:50"),
        ({"time": STAMPS.dt.tz_localize("Europe/Oslo")}, "2026-05-04T23:59:50+02:00"),
        ({"when": STAMPS.dt.tz_localize("UTC")}, "2026-05-04T23:59:50Z"),
        ({"datetime": [s.to_pydatetime() for s in STAMPS]}, "2026-05-04T23:59:50"),
        ({"date": [dt.datetime(s.year, s.month, s.day) for s in STAMPS], "time": [s.time() for s in STAMPS]}, "2026-05-04T23:59:50"),
        ({"timestamp": text("%Y-%m-%dT%H:%M:%S.%f")}, "2026-05-04T23:59:50"),
        ({"Zeit": text("%d.%m.%Y %H:%M:%S,%f")}, "2026-05-04T23:59:50"),
        ({"UTC": text("%Y-%m-%d %H:%M:%S.%fZ")}, "2026-05-04T23:59:50Z"),
        ({"time_utc": text("%Y-%m-%d %H:%M:%S.%f")}, "2026-05-04T23:59:50Z"),
        ({"t [s]": text("%Y-%m-%dT%H:%M:%S.%f+02:00")}, "2026-05-04T23:59:50+02:00"),
        ({"Date": text("%d/%m/%Y"), "Time": text("%H:%M:%S.%f")}, "2026-05-04T23:59:50"),
        ({"Date": text("%m/%d/%Y"), "Time": text("%I:%M:%S.%f %p")}, "2026-05-04T23:59:50"),
        ({"Date (dd/mm/yyyy)": ["04/05/2026"] * 80, "Time (UTC)": text("%H:%M:%S.%f")}, "2026-05-04T23:59:50Z"),
        ({"date": [20260504] * 20 + [20260505] * 60, "time": text("%H:%M:%S.%f")}, "2026-05-04T23:59:50"),
        ({"Time": text("%H:%M:%S.%f")}, None),
        ({"Heure UTC": text("%H:%M:%S.%f"), "ETA": ["01:02:03"] * 80}, None),
        ({"time": text("%I:%M:%S.%f %p")}, None),
        ({"time": text("%H:%M:%S")}, None),
        ({"time": text("%Y-%m-%d %H:%M:%S")}, "2026-05-04T23:59:50"),
        ({"timestamp": EPOCH}, "2026-05-04T23:59:50Z"),
        ({"t [s]": EPOCH}, "2026-05-04T23:59:50Z"),
        ({"timestamp": EPOCH * 1e3}, "2026-05-04T23:59:50Z"),
        ({"time [ms]": EPOCH * 1e3}, "2026-05-04T23:59:50Z"),
        ({"timestamp": (EPOCH * 1e6).astype("int64")}, "2026-05-04T23:59:50Z"),
        ({"time": STAMPS.astype("datetime64[ns]").astype("int64")}, "2026-05-04T23:59:50Z"),
        ({"timestamp": np.floor(EPOCH)}, "2026-05-04T23:59:50Z"),
        ({"time": EPOCH / 86400 + 25569}, "2026-05-04T23:59:50"),
        ({"t [d]": EPOCH / 86400 + 25569}, "2026-05-04T23:59:50"),
        ({"datenum": EPOCH / 86400 + 719529, "t": EPOCH / 86400 + 719529}, "2026-05-04T23:59:50"),
        ({"tow": WEEK}, None),
        ({"TOW [s]": WEEK}, None),
        ({"iTOW [ms]": WEEK * 1000}, None),
        ({"iTOW": WEEK * 1000}, None),
        ({"week": [2417] * 80, "tow": WEEK}, "2026-05-04T23:59:50"),
    ],
)  # fmt: skip
def test_any_clock(columns, start):
    found = clocked(**columns)
    assert not found.faults
    assert found.start == start
    np.testing.assert_allclose(found.columns["t [s]"], SECONDS, atol=2e-5)
    assert len([n for n in found.notes if "t = 0 is" in n]) == 1


@pytest.mark.parametrize(
    "name, unit", [("Time (s)", "s"), ("tvec [s]", "s"), ("elapsed [ms]", "ms"), ("t [min]", "min")]
)
def test_plain_numbers_keep_their_unit(name, unit):
    found = clocked(**{name: SECONDS + 1600, "psi [deg]": SECONDS})
    assert list(found.columns) == [f"t [{unit}]", "psi [deg]"] and found.start is None and not found.notes
    np.testing.assert_array_equal(found.columns[f"t [{unit}]"], SECONDS + 1600)


@pytest.mark.parametrize("numbers", [SECONDS, SECONDS + 45000, SECONDS * 1e6 + 1.7e9, SECONDS * 1e3 + 86400e3])
def test_plain_numbers_without_a_unit_are_no_clock(numbers):
    assert list(clocked(time=numbers).columns) == ["time"]


def test_durations_keep_their_count():
    found = clocked(elapsed=pd.to_timedelta(SECONDS + 3, unit="s"))
    np.testing.assert_allclose(found.columns["t [s]"], SECONDS + 3)


def test_gaps_stay_and_empty_cells_are_missing():
    stamps = text("%H:%M:%S.%f", STAMPS.drop(index=range(30, 50)).reset_index(drop=True))
    stamps[5] = ""
    found = clocked(time=stamps).columns["t [s]"].to_numpy()
    assert np.isnan(found[5]) and found[-1] == SECONDS[-1] and np.nanmax(np.diff(found)) == 10.5


def test_a_date_that_stays_over_midnight():
    found = clocked(date=["2026-05-04"] * 80, time=text("%H:%M:%S.%f"))
    np.testing.assert_allclose(found.columns["t [s]"], SECONDS)
    assert any("date stays the same" in note for note in found.notes)


def test_leap_seconds():
    for cells in (
        ["23:59:59", "23:59:60", "00:00:00", "00:00:01"],
        ["2016-12-31T23:59:59Z", "2016-12-31T23:59:60Z", "2017-01-01T00:00:00Z", "2017-01-01T00:00:01Z"],
    ):
        found = clocked(time=cells)
        assert found.columns["t [s]"].tolist() == [0, 1, 2, 3] and not found.faults


def test_the_end_of_summer_time():
    moments = pd.Series(pd.date_range("2026-10-25 00:59:20Z", periods=160, freq="500ms"))
    wall = moments.dt.tz_convert("Europe/Oslo").dt.tz_localize(None)  # 02:59:59.5 is followed by 02:00:00
    elapsed = np.arange(160) * 0.5
    found = clocked(time=text("%Y-%m-%d %H:%M:%S.%f", wall))
    np.testing.assert_allclose(found.columns["t [s]"], elapsed)
    assert any(note.startswith("WARNING: the clock goes back by an hour at row 80") for note in found.notes)
    zoned = clocked(ClockFormat(zone="Europe/Oslo"), time=text("%Y-%m-%d %H:%M:%S.%f", wall))
    np.testing.assert_allclose(zoned.columns["t [s]"], elapsed)
    assert zoned.start == "2026-10-25T02:59:20+02:00" and not any("WARNING" in note for note in zoned.notes)
    undated = clocked(time=text("%H:%M:%S.%f", wall))
    assert isinstance(undated.faults[0], e.ClockError) and "jumps back by an hour at row 80" in str(undated.faults[0])


def test_what_is_refused():
    cells = text("%H:%M:%S.%f")
    cells[7] = "rubbish"
    (fault,) = clocked(time=cells).faults
    assert isinstance(fault, e.TextInColumnError) and "row 7, column 'time': 'rubbish'" in str(fault)
    (fault,) = clocked(datetime=["04/05/2026 10:00:00", "06/05/2026 10:00:00"]).faults
    assert isinstance(fault, e.DateOrderError) and "'day first' or 'month first'" in str(fault)
    (fault,) = clocked(time=["10:00", "10:01"]).faults
    assert isinstance(fault, e.ClockError) and "'hh:mm' or 'mm:ss'" in str(fault)
    (fault,) = clocked(time=["2026-05-04 10:00:00Z", "2026-05-04 10:00:01"]).faults
    assert "'2026-05-04 10:00:01' is no date or time" in str(fault)


def test_minutes_and_seconds():
    found = clocked(time=["59:58", "59:59", "60:00"])
    assert found.columns["t [s]"].tolist() == [0, 1, 2] and not found.faults


def test_a_second_clock_is_left_out():
    found = clocked(**{"t [s]": SECONDS, "timestamp": text("%Y-%m-%dT%H:%M:%S"), "psi [deg]": SECONDS})
    assert list(found.columns) == ["t [s]", "psi [deg]"]
    assert found.notes == ("Not used beside the clock 't [s]': 'timestamp'.",)


@pytest.mark.parametrize(
    "layout, cells",
    [
        ("%d.%m.%y %Hh%M %S.%f", text("%d.%m.%y %Hh%M %S.%f")),
        ("day first", text("%d-%m-%y %H:%M:%S.%f")),
        ("month first", text("%m-%d-%y %H:%M:%S.%f")),
        ("epoch ms", EPOCH * 1e3),
        ("excel", EPOCH / 86400 + 25569),
        ("excel 1904", EPOCH / 86400 + 24107),
        ("julian", EPOCH / 86400 + 2440587.5),
        ("modified julian", EPOCH / 86400 + 40587),
    ],
)
def test_a_layout_that_is_stated(layout, cells):
    found = read_clock({"stamp": cells}, "'log.csv'", ClockFormat(layout=layout, zone="+02:00"))
    np.testing.assert_allclose(found.seconds, SECONDS, atol=5e-5)
    assert found.start[:16] == "2026-05-04T23:59" and found.start.endswith("Z" if "epoch" in layout else "+02:00")


def test_hours_minutes_and_seconds_side_by_side():
    numbers = STAMPS.dt.hour * 10000 + STAMPS.dt.minute * 100 + STAMPS.dt.second + STAMPS.dt.microsecond / 1e6
    found = read_clock({"UTC": numbers}, "'log.csv'", ClockFormat(layout="hhmmss"))
    np.testing.assert_allclose(found.seconds, SECONDS, atol=1e-6)
    long = pd.Series(pd.Timestamp("2026-05-04 09:50:00") + pd.to_timedelta(np.arange(600), unit="s"))
    numbers = long.dt.hour * 10000 + long.dt.minute * 100 + long.dt.second
    np.testing.assert_allclose(clocked(UTC=numbers).columns["t [s]"], np.arange(600))


def test_a_week_beside_seconds_of_the_week_with_their_unit(log):
    """The unit says that they are seconds, not that they count from a beginning of their own."""
    rows = "".join(f"{2417 + (k > 4)},{(604795 + k) % 604800:.1f},{k}\n" for k in range(12))
    trial = read_trial(log("GPS Week,TOW [s],psi [deg]\n" + rows))
    assert trial["t"].tolist() == list(range(12))
    assert trial.source.start.startswith("2026-05-09T23:59:55")


@pytest.mark.parametrize("names", ["YYYY,MM,DD,hh,mm,ss", "DD,MM,YYYY,hh,mm,ss"])
def test_month_and_minute_by_their_capitals(log, names):
    """Read as the same, May would be the fifth minute of every hour."""
    stamps = [pd.Timestamp("2026-05-04 09:58") + pd.Timedelta(seconds=7 * k) for k in range(40)]
    layout = {"YYYY": "%Y", "MM": "%m", "DD": "%d", "hh": "%H", "mm": "%M", "ss": "%S"}
    form = ",".join(layout[name] for name in names.split(","))
    trial = read_trial(log(f"{names},psi [deg]\n" + "".join(f"{d.strftime(form)},{k}\n" for k, d in enumerate(stamps))))
    assert trial["t"].tolist() == [7 * k for k in range(40)]
    assert trial.source.start.startswith("2026-05-04T09:58:00")
