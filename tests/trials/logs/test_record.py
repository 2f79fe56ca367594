"""The lenient log: every column and row is kept, and what a trial may not have is noted in the order it was found."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials import errors as e
from shipid.trials.logs.format import read_format
from shipid.trials.logs.reading import read_record, read_trial
from shipid.trials.logs.record import inside


def lines(count=20, header="t [s],psi [deg],heading,psi (rad)"):
    return [header, *(f"{0.5 * k},{10 + k},{k},{k}" for k in range(count))]


@pytest.fixture
def log(tmp_path):
    def write(rows, name="log.csv"):
        path = tmp_path / name
        path.write_text("\n".join(rows) + "\n")
        return path

    return write


def test_everything_is_kept_as_printed_and_every_fault_noted(log):
    rows = lines()
    rows[5] = "2.0,north,4,4"
    record = read_record(log(rows))
    assert list(record.values) == ["t", "psi", "heading"] and len(record) == 20
    assert record.stated == {"t": "s", "psi": "deg"}
    np.testing.assert_array_equal(record.values["psi"][[0, 1, 4]], [10, 11, np.nan])
    assert [type(fault) for fault in record.faults] == [e.NoUnitError, e.HeaderError, e.TextInColumnError]
    assert "line 6, column 'psi [deg]': 'north'" in str(record.faults[-1])
    assert record.words == {"psi": {4: "north"}}
    with pytest.raises(e.NoUnitError, match="line 1, column 'heading'"):
        read_trial(log(rows))


def test_a_sound_log_has_no_fault(log):
    record = read_record(log([row.rpartition(",")[0].rpartition(",")[0] for row in lines()]))
    assert record.faults == () and record.words == {}
    record.refuse()


def test_columns_that_an_interval_replaces_are_kept(log, tmp_path):
    (tmp_path / "format.toml").write_text(
        'header_lines = 1\n[clock]\ninterval = "0.5 s"\n[columns.psi]\nindex = 1\nunit = "deg"\n'
    )
    record = read_record(log(lines()), tmp_path / "format.toml")
    assert list(record.values) == ["psi"] and list(record.unused) == [0, 2, 3]
    np.testing.assert_array_equal(record.unused[0], 0.5 * np.arange(20))


def test_rows_keep_the_line_they_stand_in(log):
    record = read_record(log(["# a comment", *lines()]))
    kept = record.keep(np.arange(len(record)) % 3 == 1)
    assert [kept.line(k) for k in range(3)] == [4, 7, 10]
    np.testing.assert_array_equal(kept.values["psi"][:3], [11, 14, 17])


@pytest.mark.parametrize(
    ("window", "within"),
    [((None, None), [0, 1, 2]), ((1.0, None), [1, 2]), ((None, 1.0), [0, 1]), ((0.5, 1.5), [1]), ((5.0, 6.0), [])],
)
def test_samples_of_a_window(window, within):
    t = np.array([0.0, 1.0, 2.0, np.nan])
    assert np.flatnonzero(inside(t, window)).tolist() == within


@pytest.mark.parametrize(
    ("text", "repairs"),
    [("", False), ("sign = -1\n", True), ("scale = 2\n", True), ("[repairs]\ntrailing = 'drop'\n", True)],
)
def test_whether_a_format_repairs_anything(tmp_path, text, repairs):
    path = tmp_path / "format.toml"
    path.write_text('[columns.t]\nindex = 0\nunit = "s"\n[columns.psi]\nindex = 1\nunit = "deg"\n' + text)
    assert read_format(path).repairs is repairs
