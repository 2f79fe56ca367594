"""Parquet files as loggers, pandas and databases write them, and those that expand to more than a machine has."""

import decimal

import numpy as np
import pandas as pd
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.tables.files import parquet

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")


@pytest.fixture
def frame(sample, units):
    return sample.rename(columns={name: f"{name} [{unit}]" for name, unit in units.items()})


def test_kinds_of_columns(frame, tmp_path, same):
    frame["psi [deg]"] = pd.array(frame["psi [deg]"], dtype="Float64")
    frame["r [deg/s]"] = [decimal.Decimal(f"{value:.6f}") for value in frame["r [deg/s]"]]
    frame["delta [deg]"] = frame["delta [deg]"].map(str)
    frame["place"] = pd.Categorical(["north"] * len(frame))
    frame["many"] = [[1, 2]] * len(frame)
    frame["pos"] = [{"x": 1.0}] * len(frame)
    frame.to_parquet(tmp_path / "log.parquet")
    trial = read_trial(tmp_path / "log.parquet")
    assert same(trial) and "Columns of text were left out: 'place'." in trial.source.notes
    assert any("'many' (list<element: int64>), 'pos' (struct<x: double>)" in note for note in trial.source.notes)


def test_whatever_its_name(frame, tmp_path, same):
    frame.to_parquet(tmp_path / "log.parquet")
    assert same(read_trial((tmp_path / "log.parquet").rename(tmp_path / "log.csv")))


def test_stamps_in_the_index(frame, tmp_path):
    frame.index = pd.Timestamp("2026-05-01T12:00Z") + pd.to_timedelta(frame.pop("t [s]"), unit="s")
    frame.index.name = None
    frame.to_parquet(tmp_path / "log.parquet")
    trial = read_trial(tmp_path / "log.parquet")
    assert trial["t"][-1] == 19.5 and trial.source.start == "2026-05-01T12:00:00Z"


def test_missing_samples_are_not_zeros(frame, tmp_path):
    frame.loc[3, "r [deg/s]"] = None
    frame["delta [deg]"] = pd.array([None, *frame["delta [deg]"].astype(int)[1:]], dtype="Int64")
    frame.to_parquet(tmp_path / "log.parquet")
    trial = read_trial(tmp_path / "log.parquet")
    assert np.flatnonzero(np.isnan(trial["r"])).tolist() == [3] and np.isnan(trial["delta"][0])


def test_rows_that_expand_to_more_than_is_read(tmp_path):
    zeros = pa.array(np.zeros(2_000_000))
    schema = pa.schema([("t [s]", pa.float64()), ("psi [deg]", pa.float64())])
    with pq.ParquetWriter(tmp_path / "log.parquet", schema) as writer:
        for _ in range(10):
            writer.write_table(pa.table([zeros, zeros], schema=schema))
    assert (tmp_path / "log.parquet").stat().st_size < 1_000_000
    with pytest.raises(e.FileSizeError, match="expands to 20000000 rows of 2 columns"):
        read_trial(tmp_path / "log.parquet")


def test_long_texts_are_left_out(frame, tmp_path, same):
    frame["note"] = "x" * (parquet._LONGEST + 1)  # noqa: SLF001
    frame["short"] = "x" * parquet._LONGEST  # noqa: SLF001
    frame.to_parquet(tmp_path / "log.parquet")
    trial = read_trial(tmp_path / "log.parquet")
    assert same(trial)
    assert {"Columns of long texts were left out: 'note'.", "Columns of text were left out: 'short'."} <= set(
        trial.source.notes
    )


def test_damage_and_no_columns(frame, tmp_path, log):
    frame.to_parquet(tmp_path / "a.parquet")
    data = bytearray((tmp_path / "a.parquet").read_bytes())
    data[60:90] = bytes(30)
    for broken in (bytes(data), bytes(data[:-8]), b"PAR1 not really"):
        with pytest.raises(
            e.DamagedFileError, match=r"is not a readable Parquet file: .* Check that it was copied completely"
        ):
            read_trial(log(broken, "log.parquet"))
    pd.DataFrame({"many": [[1, 2]] * 20}).to_parquet(tmp_path / "b.parquet")
    with pytest.raises(e.EmptyFileError, match="no column of numbers, times or text"):
        read_trial(tmp_path / "b.parquet")


def test_a_table_cannot_be_named_in_a_file_that_holds_one(frame, tmp_path, log, table):
    frame.to_parquet(tmp_path / "log.parquet")
    with pytest.raises(e.ChoiceError, match="Parquet file: it holds one table, and 'Run 1' names one of several"):
        read_trial(f"{tmp_path / 'log.parquet'}#Run 1")
    with pytest.raises(e.ChoiceError, match="text file: it holds one table"):
        read_trial(f"{log(table)}#Run 1")
    assert len(read_trial(log(table, "log#1.csv"))) == 20
