"""The clock through every reader: text with and without a format file, Parquet, tables in memory."""

from decimal import Decimal

import numpy as np
import pandas as pd
import pytest

from shipid.foundation.errors import UnknownNameError
from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.logs.format import read_format
from shipid.trials.logs.reading import read_trial
from shipid.trials.trial import Trial

N = 40
SECONDS = np.arange(N) * 0.5
STAMPS = pd.Series(pd.Timestamp("2026-05-04 23:59:50") + pd.to_timedelta(SECONDS, unit="s"))
PSI = 10 + 0.3 * np.arange(N)


def table(**columns):
    return pd.DataFrame({**columns, "psi [deg]": PSI})


def csv(frame, **options):
    return frame.to_csv(index=False, **options)


ISO = STAMPS.dt.strftime("%Y-%m-%dT%H:%M:%S.%f")


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_text(log, separator):
    trial = read_trial(log(csv(table(timestamp=ISO), sep=separator)))
    np.testing.assert_allclose(trial["t"], SECONDS)
    assert trial.source.start == "2026-05-04T23:59:50" == trial.source.to_dict()["start"]
    assert trial.window(2, 6).source.start == trial.source.start
    assert any("The clock is 'timestamp'" in note for note in trial.source.notes)


def test_text_with_decimal_commas(log):
    frame = table(Datum=STAMPS.dt.strftime("%d.%m.%Y"), Uhrzeit=STAMPS.dt.strftime("%H:%M:%S,%f"))
    trial = read_trial(log(csv(frame, sep=";", decimal=",")))
    np.testing.assert_allclose(trial["t"], SECONDS)
    assert trial.source.start == "2026-05-04T23:59:50" and trial["psi"][1] == pytest.approx(np.radians(10.3))


def test_a_cell_that_is_no_stamp_is_named_by_its_line(log):
    cells = ISO.copy()
    cells[7] = "rubbish"
    path = log("# head\n" + csv(table(timestamp=cells)))
    with pytest.raises(e.TextInColumnError, match="row 10, column 'timestamp': 'rubbish'"):
        read_trial(path)
    found = check_trial(path)
    assert found.trial == "log"


def test_a_broken_number_beside_a_clock(log):
    with pytest.raises(e.TextInColumnError, match="line 9, column 'psi"):
        read_trial(log(csv(table(timestamp=ISO)).replace("12.1", "north")))


def test_rows_written_twice_are_not_spread(log):
    twice = table(time=STAMPS.dt.strftime("%H:%M:%S"))[::2].loc[lambda f: f.index.repeat(2)]
    with pytest.raises(e.ClockError, match="repeats"):
        read_trial(log(csv(twice)))


FORMAT = """
separator = "comma"
header_lines = 1
[columns.t]
column = "when"
[columns.psi]
column = "Heading"
unit = "deg"
"""


@pytest.fixture
def fmt(tmp_path):
    def write(text):
        path = tmp_path / "format.toml"
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize(
    "cells, clock, start",
    [
        (ISO, "", "2026-05-04T23:59:50"),
        (ISO, "[clock]\nzone = 'Europe/Oslo'", "2026-05-04T23:59:50+02:00"),
        (STAMPS.dt.strftime("%d/%m/%Y %H:%M:%S.%f"), "[clock]\nlayout = 'day first'", "2026-05-04T23:59:50"),
        (STAMPS.dt.strftime("%Hh%M'%S.%f %d.%m.%y"), "[clock]\nlayout = \"%Hh%M'%S.%f %d.%m.%y\"", "2026-05-04T23:59:50"),
        ((STAMPS - pd.Timestamp(0)).dt.total_seconds(), "", "2026-05-04T23:59:50Z"),
        ((STAMPS - pd.Timestamp(0)).dt.total_seconds() / 86400 + 25569, "[clock]\nlayout = 'excel'", "2026-05-04T23:59:50"),
        (STAMPS.dt.strftime("%H:%M:%S.%f"), "[clock]\ndate = 'Heading'", None),
    ],
)  # fmt: skip
def test_format_files(log, fmt, cells, clock, start):
    frame = pd.DataFrame({"when": cells, "Heading": PSI})
    if "date" in clock:
        frame.insert(0, "day", STAMPS.dt.strftime("%Y-%m-%d"))
        clock, start = clock.replace("Heading", "day"), "2026-05-04T23:59:50"
    trial = read_trial(log(csv(frame)), fmt(FORMAT + clock))
    np.testing.assert_allclose(trial["t"], SECONDS, atol=2e-5)
    assert trial.source.start == start and trial.has("psi")


@pytest.mark.parametrize(
    "text, words",
    [
        ("[clock]\nlayout = 'first day'", "'layout' is 'first day'. Write one of year first"),
        ("[clock]\nzone = 'Atlantis/North'", "'zone' is 'Atlantis/North'"),
        ("[clock]\nsone = 'UTC'", "'sone'"),
    ],
)
def test_format_files_that_mean_nothing(fmt, text, words):
    with pytest.raises(e.FormatFileError, match=words):
        read_format(fmt(FORMAT + text))


def test_format_files_that_do_not_fit(log, fmt):
    path = log(csv(pd.DataFrame({"when": SECONDS, "Heading": PSI})))
    with pytest.raises(e.NoUnitError, match="column 't' says no unit"):
        read_trial(path, fmt(FORMAT))
    with pytest.raises(
        e.UnknownColumnError, match="no column 'day', which the format file 'format' names for the date"
    ):
        read_trial(path, fmt(FORMAT + "[clock]\ndate = 'day'"))
    text = log(csv(pd.DataFrame({"when": ISO, "Heading": PSI})))
    with pytest.raises(e.TextInColumnError, match="by the layout '%d"):
        read_trial(text, fmt(FORMAT + "[clock]\nlayout = '%d/%m/%Y'"))


@pytest.mark.parametrize("zone", [None, "UTC", "America/New_York"])
def test_parquet(tmp_path, fmt, zone):
    pytest.importorskip("pyarrow")
    stamps = STAMPS if zone is None else STAMPS.dt.tz_localize(zone)
    for frame in (table(time=stamps), table().set_index(pd.DatetimeIndex(stamps, name="time"))):
        frame.to_parquet(tmp_path / "log.parquet")
        trial = read_trial(tmp_path / "log.parquet")
        np.testing.assert_allclose(trial["t"], SECONDS)
        assert trial.source.start == {None: "2026-05-04T23:59:50", "UTC": "2026-05-04T23:59:50Z"}.get(
            zone, "2026-05-04T23:59:50-04:00"
        )
    table(when=stamps).rename(columns={"psi [deg]": "Heading"}).to_parquet(tmp_path / "log.parquet")
    trial = read_trial(tmp_path / "log.parquet", fmt(FORMAT))
    np.testing.assert_allclose(trial["t"], SECONDS)


@pytest.mark.parametrize(
    "frame",
    [
        table().set_index(pd.DatetimeIndex(STAMPS)),
        table().set_index(pd.DatetimeIndex(STAMPS, tz="UTC", name="stamp")),
        table().set_index(pd.TimedeltaIndex(pd.to_timedelta(SECONDS, unit="s"))),
        table().set_index(pd.PeriodIndex(STAMPS, freq="500ms")),
        table().set_index(pd.Index(SECONDS, name="t [s]")),
        table(**{"t [s]": [Decimal(str(s)) for s in SECONDS]}),
        table(**{"t [s]": SECONDS.astype(object)}),
        table(**{"t [s]": pd.array(SECONDS, dtype="Float64")}),
        table(**{"t [ms]": pd.array((SECONDS * 1000).astype(int), dtype="Int64")}),
        table(**{"time [s]": [f"{s}" for s in SECONDS]}),
        table(time=STAMPS),
        pd.DataFrame({("t", "s"): SECONDS, ("psi", "deg"): PSI}),
    ],
)
def test_tables_in_memory(frame):
    trial = Trial.from_frame(frame)
    np.testing.assert_allclose(trial["t"], SECONDS)
    np.testing.assert_allclose(trial["psi"], np.radians(PSI))


def test_tables_in_memory_with_holes():
    frame = table(**{"t [s]": SECONDS, "n [rpm]": pd.array([None, *range(1, N)], dtype="Int64")})
    frame["u [m/s]"] = [None, *[Decimal(k) for k in range(1, N)]]
    trial = Trial.from_frame(frame)
    assert np.isnan(trial["n"][0]) and np.isnan(trial["u"][0]) and trial["u"][-1] == N - 1


def test_units_beside_the_table():
    frame = pd.DataFrame({"time": SECONDS, "psi": PSI})
    np.testing.assert_allclose(Trial.from_frame(frame, units={"time": "s", "psi": "deg"})["t"], SECONDS)
    with pytest.raises(UnknownNameError, match="'tim'"):
        Trial.from_frame(frame, units={"tim": "s", "psi": "deg"})


def test_two_columns_of_one_name_are_told(log, fmt):
    frame = pd.DataFrame(np.column_stack((SECONDS, PSI, PSI)), columns=["t [s]", "psi [deg]", "psi [deg]"])
    with pytest.raises(e.HeaderError, match="two columns are named 'psi \\[deg\\]'"):
        Trial.from_frame(frame)
    with pytest.raises(e.HeaderError, match="names 'psi' twice"):
        Trial.from_frame(frame.set_axis(["t [s]", "psi [deg]", "psi [rad]"], axis=1))
    with pytest.raises(e.HeaderError, match="names 'psi' twice"):
        read_trial(log(csv(frame.set_axis(["t [s]", "psi [deg]", "psi [rad]"], axis=1))))
