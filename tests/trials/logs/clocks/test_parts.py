"""Clocks in several columns, and clocks in forms that begin again or stand in other places."""

import numpy as np
import pandas as pd
import pytest

import shipid
from shipid.trials import errors as e
from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.logs.reading import read_trial

N = 60
MOMENTS = pd.Timestamp("2026-05-04 23:59:50") + pd.to_timedelta(0.5 * np.arange(N), unit="s")
BESIDE = {"psi [deg]": 10 + 0.1 * np.arange(N), "delta [deg]": np.where(np.arange(N) > 20, 5.0, 0.0)}


def written(tmp_path, **clock):
    path = tmp_path / "log.csv"
    pd.DataFrame({**{name.replace("__", " "): cells for name, cells in clock.items()}, **BESIDE}).to_csv(
        path, index=False
    )
    return path


def seconds(moments=MOMENTS):
    return moments.second + moments.microsecond / 1e6


CLOCKS = {
    "six columns": {
        "Year": MOMENTS.year, "Month": MOMENTS.month, "Day": MOMENTS.day,
        "Hour": MOMENTS.hour, "Minute": MOMENTS.minute, "Second": seconds(),
    },
    "hours, minutes and seconds": {"HH": MOMENTS.hour, "MM": MOMENTS.minute, "SS": seconds()},
    "with milliseconds": {
        "Hour": MOMENTS.hour, "Min": MOMENTS.minute, "Sec": MOMENTS.second, "ms": MOMENTS.microsecond // 1000,
    },
    "milliseconds beside a time": {
        "Time": MOMENTS.strftime("%H:%M:%S"), "Milliseconds": MOMENTS.microsecond // 1000,
    },
    "seconds of the day": {"t_s": (86390 + 0.5 * np.arange(N)) % 86400},
    "milliseconds by name": {"time_ms": 500 * np.arange(N)},
    "decimal hours": {"time [h]": ((86390 + 0.5 * np.arange(N)) % 86400) / 3600},
    "days of Julius": {"JD": 2461165.5 + 0.5 * np.arange(N) / 86400},
    "durations of pandas": {"time": [f"0 days 00:00:{s:04.1f}" for s in 0.5 * np.arange(N)]},
    "a zone in brackets": {"time": MOMENTS.strftime("%Y-%m-%d %H:%M:%S.%f (GMT)")},
    "the zone from the middle on": {
        "time": [f"{m:%Y-%m-%dT%H:%M:%S.%f}" + ("Z" if k > 25 else "") for k, m in enumerate(MOMENTS)]
    },
}  # fmt: skip


@pytest.mark.parametrize("form", CLOCKS)
def test_every_form_gives_the_same_seconds(tmp_path, form):
    trial = read_trial(written(tmp_path, **CLOCKS[form]))
    np.testing.assert_allclose(trial["t"] - trial["t"][0], 0.5 * np.arange(N), atol=1e-4)
    assert not trial.has("Day") and not trial.has("ms")


@pytest.mark.parametrize(
    "cells",
    [
        MOMENTS[::2].strftime("%a %b %d %H:%M:%S %Y"),
        MOMENTS[::2].strftime("%a %b %d %H:%M:%S CEST %Y"),
        MOMENTS[::2].strftime("%Y%m%d%H%M%S").astype("int64"),
    ],
)
def test_whole_seconds_with_a_date(tmp_path, cells):
    path = tmp_path / "log.csv"
    pd.DataFrame({"Timestamp": cells, **{name: values[::2] for name, values in BESIDE.items()}}).to_csv(
        path, index=False
    )
    trial = read_trial(path)
    np.testing.assert_allclose(trial["t"], np.arange(N // 2), atol=1e-6)
    assert trial.source.start.startswith("2026-05-04T") and "59:50" in trial.source.start


def test_a_time_stamp_goes_before_its_parts(tmp_path):
    clock = {
        "timestamp": MOMENTS.strftime("%Y-%m-%dT%H:%M:%S.%f"),
        "Hour": MOMENTS.hour,
        "Minute": MOMENTS.minute,
        "Second": 7,
    }
    path = written(tmp_path, **clock)
    table = (
        pd.read_csv(path)
        .drop(columns=["Hour", "Minute", "Second"])
        .assign(**{f"{n} [1]": clock[n] for n in ("Hour", "Minute", "Second")})
    )
    table.to_csv(path, index=False)
    np.testing.assert_allclose(read_trial(path)["t"], 0.5 * np.arange(N), atol=1e-6)


def test_a_date_of_six_digits_beside_a_time_is_not_the_clock(tmp_path):
    whole = MOMENTS[::2]
    path = tmp_path / "log.csv"
    table = {"Date": whole.strftime("%d%m%y"), "Time": whole.strftime("%H:%M:%S")}
    pd.DataFrame({**table, **{name: values[::2] for name, values in BESIDE.items()}}).to_csv(path, index=False)
    trial = read_trial(path)
    np.testing.assert_allclose(trial["t"], np.arange(N // 2), atol=1e-6)
    assert any("Not used beside the clock 'Time': 'Date'" in note for note in trial.source.notes)


def test_times_and_dates_of_parquet(tmp_path):
    pytest.importorskip("pyarrow")
    for name, clock in (
        ("time", {"time": MOMENTS.time}),
        ("both", {"date": MOMENTS.date, "time": MOMENTS.time}),
    ):
        path = tmp_path / f"{name}.parquet"
        pd.DataFrame({**clock, **BESIDE}).to_parquet(path)
        np.testing.assert_allclose(read_trial(path)["t"], 0.5 * np.arange(N), atol=1e-6)


def test_a_clock_that_is_not_understood_is_named_with_its_cell(tmp_path):
    path = written(tmp_path, elapsed=[f"T+{0.5 * k}" for k in range(N)])
    # The doctor, which reads what it can, ended in a fault of its own here.
    for read in (read_trial, check_trial):
        with pytest.raises(
            e.ClockError, match=r"column 'elapsed': 'T\+0.0' is no date or time in a form that is known. State"
        ):
            read(path)


def test_a_record_in_reverse_order_is_named(tmp_path):
    with pytest.raises(
        e.ClockError, match="The last sample stands first: sort the rows by time, or let 'shipid check --fix'"
    ):
        read_trial(written(tmp_path, **{"t__[s]": 0.5 * np.arange(N)[::-1]}))


def test_columns_without_a_name(tmp_path):
    from scipy.io import savemat

    savemat(tmp_path / "log.mat", {"data": np.column_stack([0.5 * np.arange(N), *BESIDE.values()])})
    with pytest.raises(e.UnknownColumnError, match="its columns have no names"):
        shipid.read_trial(tmp_path / "log.mat")
