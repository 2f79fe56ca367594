"""Logs in zip archives: the one that is named, or the only one that can be a log."""

import io
import zipfile

import numpy as np
import pytest

from shipid.foundation.errors import ShipidError
from shipid.trials.errors import ChoiceError, FileSizeError, ForeignFileError
from shipid.trials.logs.drafting.draft import draft_format
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.tables import opening

NMEA = "".join(f"$GPZDA,{120000 + k:06d},01,05,2026,00,00\n$HEHDT,{10 + k / 10:.1f},T\n" for k in range(30))


def zipped(**members: str | bytes) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return made.getvalue()


def test_a_log_of_several_is_named_behind_the_archive(log, table):
    path = log(
        zipped(**{"trials/one.csv": table, "trials/two.csv": table.replace(",5\n", ",7\n"), "gps.nmea": NMEA}),
        "all.zip",
    )
    assert read_trial(f"{path}#two.csv")["delta"][-1] == pytest.approx(np.radians(7))
    assert read_trial(f"{path}#trials/one.csv@2:8")["delta"][-1] == pytest.approx(np.radians(5))
    assert "r" not in read_trial(f"{path}#gps.nmea")
    assert read_trial(f"{path}#gps.nmea")["psi"][0] == pytest.approx(np.radians(10))
    assert "two.csv" in draft_format(f"{path}#two.csv").text
    with pytest.raises(
        ForeignFileError,
        match=r"archive of 3 files: .* Name one of them behind the file, as in .*all.zip#trials/one.csv",
    ):
        read_trial(path)
    with pytest.raises(ChoiceError, match=r"holds no file 'tow\.csv'\. Did you mean"):
        read_trial(f"{path}#tow.csv")


def test_what_is_packed_beside_a_log_is_passed_over(log, table):
    path = log(zipped(**{"log.csv": table, "README.txt": "read me", "plot.png": b"\x89PNG"}), "trial.zip")
    trial = read_trial(path)
    assert len(trial) == 20
    assert any("'log.csv' of 3 files" in str(note) for note in trial.source.notes)


def test_a_sheet_of_a_workbook_in_an_archive(log, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    for title, slope in (("First", 1), ("Second", 2)):
        sheet = book.create_sheet(title)
        sheet.append(["t [s]", "psi [deg]"])
        for k in range(20):
            sheet.append([k, slope * k])
    book.save(tmp_path / "book.xlsx")
    path = log(zipped(**{"book.xlsx": (tmp_path / "book.xlsx").read_bytes(), "b.csv": "x"}), "all.zip")
    assert read_trial(f"{path}#book.xlsx#Second")["psi"][-1] == pytest.approx(np.radians(38))
    with pytest.raises(ChoiceError, match=r"all\.zip#book\.xlsx#"):
        read_trial(f"{path}#book.xlsx")


def test_a_member_that_expands_to_too_much(log, table, monkeypatch):
    monkeypatch.setattr(opening, "LARGEST", 100_000)
    with pytest.raises(FileSizeError, match="expands to something"):
        read_trial(f"{log(zipped(**{'a.csv': b'0' * 200_000, 'b.csv': table}), 'all.zip')}#a.csv")


def test_arrays_of_numpy_are_named(log):
    made = io.BytesIO()
    np.savez(made, t=np.arange(9.0), psi=np.arange(9.0))
    with pytest.raises(ShipidError, match=r"arrays of NumPy \(\.npz\): t, psi\. Write them as one table"):
        read_trial(log(made.getvalue(), "log.npz"))
