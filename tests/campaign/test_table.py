"""The runs as a table: every kind holds the same numbers, with provenance and without NaN as text."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from shipid.campaign.run_campaign import run_campaign
from shipid.campaign.table import read_runs, write_table
from shipid.foundation.errors import UnknownNameError


@pytest.fixture
def stored(studies, tmp_path):
    run_campaign(studies.darts, 50, seed=8, folder=tmp_path / "runs")
    return tmp_path / "runs"


def test_npz(stored, tmp_path):
    write_table(stored, 50, tmp_path / "t.npz", "npz")
    with np.load(tmp_path / "t.npz", allow_pickle=False) as table:
        for name, column in read_runs(stored).items():
            assert_array_equal(table[name], column)
        assert json.loads(str(table["provenance"]))["seed"] == 8


def test_parquet(stored, tmp_path):
    pq = pytest.importorskip("pyarrow.parquet")
    write_table(stored, 50, tmp_path / "t.parquet", "parquet")
    table, rows = pq.read_table(tmp_path / "t.parquet"), read_runs(stored)
    assert table.num_rows == 50
    assert_array_equal(np.array(table["course"].to_pylist()), rows["course"])
    assert table["time"].null_count == np.isnan(rows["time"]).sum() > 0
    assert json.loads(table.schema.metadata[b"shipid"])["campaign"] == "darts"


def test_text(stored, tmp_path):
    write_table(stored, 50, tmp_path / "t.csv", "csv")
    text, rows = (tmp_path / "t.csv").read_text(), read_runs(stored)
    assert "nan" not in text
    with (tmp_path / "t.csv").open(newline="") as stream:
        table = list(csv.DictReader(stream))
    assert [float(r["miss [m]"]) for r in table] == rows["miss"].tolist()
    assert [r["time [s]"] == "" for r in table] == np.isnan(rows["time"]).tolist()
    assert float(table[4]["course_2 [rad]"]) == rows["course"][4, 2]


def test_another_kind_is_refused(stored, tmp_path):
    with pytest.raises(UnknownNameError, match="kind of table 'doc'"):
        write_table(stored, 50, tmp_path / "t.doc", "doc")
