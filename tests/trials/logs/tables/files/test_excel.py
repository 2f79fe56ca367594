"""Sheets of Excel workbooks: found, named, and read as they were saved."""

import datetime
import io
import zipfile

import numpy as np
import pytest

from shipid.foundation.errors import MissingExtraError
from shipid.trials import errors as e
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.tables import opening
from shipid.trials.logs.tables.files import excel

openpyxl = pytest.importorskip("openpyxl")


@pytest.fixture
def book(tmp_path):
    """Write a workbook of sheets, each a list of rows."""

    def write(**sheets):
        made = openpyxl.Workbook()
        made.remove(made.active)
        for title, rows in sheets.items():
            sheet = made.create_sheet(title.replace("_", " "))
            for row in rows:
                sheet.append(list(row))
        path = tmp_path / "log.xlsx"
        made.save(path)
        return path

    return write


@pytest.fixture
def rows(sample):
    return [list(map(float, row)) for row in sample.to_numpy()]


HEADER = ["t [s]", "psi [deg]", "r [deg/s]", "delta [deg]"]


@pytest.mark.parametrize(
    "above",
    [
        [HEADER],
        [["Sea trial"], [], HEADER],
        [["t", "psi", "r", "delta"], ["s", "deg", "deg/s", "deg"]],
        [["Trial 7", "MV Alpha"], ["Clock", "Gyro", None, "Rudder"], ["t", "psi", "r", "delta"], ["[s]", "[deg]", "[deg/s]", "[deg]"]],
    ],
)  # fmt: skip
def test_the_header_is_found_in_the_sheet(book, rows, above, same):
    assert same(read_trial(book(Sheet=[*above, *rows])))


def test_a_table_that_begins_beside_the_first_column(book, rows, same):
    assert same(read_trial(book(Sheet=[[], [None, None, *HEADER], *([None, None, *row] for row in rows)])))


def test_a_remark_beside_the_table_does_not_hide_its_header(book, rows, same):
    wide = [[*row, *([None] * 5), "remark"] if k == 1 else row for k, row in enumerate(rows)]
    assert same(read_trial(book(Sheet=[HEADER, *wide])))


def test_a_hidden_sheet_counts_only_where_it_is_named(book, rows, same):
    path = book(Old=[HEADER, *([t, -psi, r, delta] for t, psi, r, delta in rows)], Run=[HEADER, *rows])
    made = openpyxl.load_workbook(path)
    made["Old"].sheet_state = "hidden"
    made.save(path)
    trial = read_trial(path)
    assert same(trial)
    assert "Hidden and passed over: sheet 'Old'." in trial.source.notes
    assert read_trial(f"{path}#Old")["psi"][5] == pytest.approx(-trial["psi"][5])


def test_the_only_sheet_that_looks_like_a_trial_is_taken_and_noted(book, rows, same):
    trial = read_trial(
        book(
            Info=[["ship", "A"], ["draught", 5.7]],
            Loads=[["case", "mass [t]"], [1, 3.5], [2, 4.5]],
            Run=[HEADER, *rows],
        )
    )
    assert same(trial)
    assert any("sheet 'Run' was read: 'Loads' look less like a trial" in note for note in trial.source.notes)


def test_one_of_several_sheets_has_to_be_named(book, rows, bare, same):
    port = [[t, psi, r, -delta] for t, psi, r, delta in rows]
    path = book(Run_1=[HEADER, *rows], Run_2=[HEADER, *port])
    with pytest.raises(
        e.ChoiceError, match=r"2 tables: 'Run 1', 'Run 2'\. Name the sheet behind the file, as in .*log.xlsx#Run 1"
    ):
        read_trial(path)
    assert same(read_trial(f"{path}#Run 1"))
    assert read_trial(f"{path}#run 2")["delta"][-1] == pytest.approx(-np.radians(5.5))
    windowed = read_trial(f"{path}#Run 2@2:8")
    assert windowed["t"][0] == 2 and windowed.name == "log@2:8"
    assert same(read_trial(path, bare('[table]\nsheet = "Run 1"\n')))
    assert read_trial(f"{path}#Run 2", bare('[table]\nsheet = "Run 1"\n'))["delta"][-1] < 0
    with pytest.raises(e.ChoiceError, match=r"no sheet 'Run 3'.*Run 2 or Run 1"):
        read_trial(f"{path}#Run 3")


def test_dates_times_and_numbers_as_text(book, rows):
    start = datetime.datetime(2026, 5, 1, 23, 59, 50)
    dated = [[start + datetime.timedelta(seconds=t), psi, r, str(delta).replace(".", ",")] for t, psi, r, delta in rows]
    trial = read_trial(book(Sheet=[["Date/Time", *HEADER[1:]], *dated]))
    assert trial["t"][-1] == pytest.approx(19.5) and trial.source.start.startswith("2026-05-01T23:59:50")
    assert trial["delta"][-1] == pytest.approx(np.radians(5.5))
    assert "The numbers are written with a decimal comma." in trial.source.notes
    timed = [[(start + datetime.timedelta(seconds=t)).time(), psi, r, delta] for t, psi, r, delta in rows]
    assert read_trial(book(Sheet=[["Time", *HEADER[1:]], *timed]))["t"][-1] == pytest.approx(19.5)


def test_holes_marks_and_cells_that_are_no_numbers(book, rows):
    rows[3][2], rows[5][2], rows[9][1] = None, "#N/A", "n/a"
    trial = read_trial(book(Sheet=[HEADER, [], *rows]))
    assert np.flatnonzero(np.isnan(trial["r"])).tolist() == [3, 5] and np.flatnonzero(
        np.isnan(trial["psi"])
    ).tolist() == [9]
    for cell, said in (("broken", "'broken'"), (True, "'True'")):
        rows[7][3] = cell
        with pytest.raises(
            e.TextInColumnError, match=rf"sheet 'Sheet', row 10, column 'delta \[deg\]': {said} is not a number"
        ):
            read_trial(book(Sheet=[HEADER, [], *rows]))


def test_sheets_without_a_table(book):
    with pytest.raises(e.EmptyFileError, match="no sheet with a table of numbers under a header: 'Info'"):
        read_trial(book(Info=[["ship", "A"]]))


def parts(path, change):
    """Write a workbook anew with some of its parts changed."""
    made = io.BytesIO()
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
        for member in old.infolist():
            new.writestr(member.filename, change(member.filename, old.read(member)))
    path.write_bytes(made.getvalue())
    return path


def test_the_size_that_a_sheet_claims_is_not_believed(book, rows, same):
    path = book(Sheet=[HEADER, *rows])
    claim = lambda name, data: data.replace(b'ref="A1:D41"', b'ref="A1:XFD1048576"')  # noqa: E731
    assert same(read_trial(parts(path, claim)))
    far = lambda name, data: data.replace(b'"D41"', b'"XFD41"').replace(b'r="41"', b'r="1048576"')  # noqa: E731
    with pytest.raises(e.FileSizeError, match="more than 8000000 cells, or more than 10000 columns"):
        read_trial(parts(path, far))


def test_workbooks_are_judged_by_what_they_expand_to(book, rows, monkeypatch):
    path = book(Sheet=[HEADER, *rows])
    monkeypatch.setattr(excel, "LARGEST", 10_000)
    with pytest.raises(e.FileSizeError, match="expands to 0 MB"):
        read_trial(path)
    monkeypatch.undo()
    assert opening.LARGEST == excel.LARGEST


def test_damaged_workbooks_are_named(book, rows):
    path = book(Sheet=[HEADER, *rows])
    cut = lambda name, data: data[: len(data) // 2] if "sheet1" in name else data  # noqa: E731
    with pytest.raises(e.DamagedFileError, match="damaged Excel workbook"):
        read_trial(parts(path, cut))


def test_without_openpyxl_it_says_what_to_install(book, rows, monkeypatch):
    path = book(Sheet=[HEADER, *rows])
    monkeypatch.setitem(__import__("sys").modules, "openpyxl", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'shipid\[excel\]'"):
        read_trial(path)
