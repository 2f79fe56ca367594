"""What a cell of S-57 says of itself: it is complete, or it is refused; GDAL is not needed."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from shipid.prediction.charts.errors import ChartFileError
from shipid.prediction.charts.s57_records import check_records, updates_of

CELL = (Path(__file__).parent / "cases" / "synthetic.000").read_bytes()
#: It states no counts: the maker's zeros are replaced by those of its records.
ZEROS = struct.pack("<3B8I", 2, *[0] * 10)
STATED = CELL.replace(ZEROS, struct.pack("<3B8I", 2, 0, 0, 0, 0, 6, 0, 10, 2, 0, 0))


def test_a_complete_cell():
    assert STATED != CELL
    check_records(CELL, "'a.000'")
    check_records(STATED, "'a.000'")


@pytest.mark.parametrize(
    ("end", "says"), [(4186, "states 6 features, and holds 5"), (2654, "features, and holds 1"), (2232, "holds 0")]
)
def test_a_cell_that_was_cut_between_two_records(end, says):
    check_records(CELL[:end], "'a.000'")
    with pytest.raises(ChartFileError, match=f"'a.000' is not complete: it .*{says}"):
        check_records(STATED[:end], "'a.000'")


@pytest.mark.parametrize(
    "data", [STATED[:-1], STATED + b"\0" * 50, STATED[:2076] + b"00000" + STATED[2081:2090], b"00010 D" + STATED[7:]]
)
def test_a_damaged_file(data):
    with pytest.raises(ChartFileError, match="is damaged"):
        check_records(data, "'a.000'")


def test_updates_in_a_row(tmp_path):
    cell = tmp_path / "a[1].000"
    assert updates_of(cell) == ([], []) == updates_of(tmp_path / "a.030")
    for number, data in ((1, CELL), (2, b"no update"), (3, CELL)):
        (tmp_path / f"a[1].{number:03d}").write_bytes(data)
    applied, (told,) = updates_of(cell)
    assert [f.name for f in applied] == ["a[1].001"]
    assert told.kind == "chart-not-updated" and "a[1].002 is no update of S-57, so that 2 updates" in told
