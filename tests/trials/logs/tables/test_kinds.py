"""A file that is no table is named for what it is, and its bytes stay where they are."""

import io
import zipfile

import pytest

from shipid.cli import run
from shipid.trials.errors import ForeignFileError
from shipid.trials.logs.reading import read_trial

FOREIGN = {
    "a PDF document": b"%PDF-1.4\n1 0 obj\n",
    "a PNG picture": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
    "a JPEG picture": b"\xff\xd8\xff\xe0\0\x10JFIF",
    "an SQLite database": b"SQLite format 3\0\x10\0",
    r"a program \(ELF\)": b"\x7fELF\x02\x01\x01\0",
    "a program for Windows": b"MZ\x90\0\x03\0\0\0",
    "a ROS bag": b"#ROSBAG V2.0\nE\0\0\0",
    "a recording|an MCAP recording": b"\x89MCAP0\r\n\x01",
    "a measurement file of ASAM": b"MDF     4.10    CANape  ",
    "a measurement file of LabVIEW": b"TDSm\x0e\0\0\0",
    r"an Excel workbook of the old kind \(\.xls\)": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600) + "Workbook".encode("utf-16-le"),
    "a document of the old Office": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600),
    "a pickle of Python, which can run programs and is never opened": b"\x80\x04\x95\x10\0\0\0\0\0\0\0",
    r"an array of NumPy \(\.npy\)": b"\x93NUMPY\x01\0v\0",
    "a Feather file": b"ARROW1\0\0\xff\xff",
    "a NetCDF file of the old kind": b"CDF\x01\0\0\0\0",
    "a web page": b"\n<!DOCTYPE html>\n<html><body>",
    "an XML file": b'<?xml version="1.0"?>\n<gpx>',
    "a JSON file": b'{"t": [0, 1], "psi": [3, 4]}',
    "a JSON file ": b'[\n {"t": 0, "psi": 3}\n]',
    "a script": b"% made by hand\nfunction y = f(x)\n",
    "a script ": b"#!/bin/sh\necho 1,2,3\n",
    "a format file": b'separator = "comma"\n[columns.t]\nindex = 0\nunit = "s"\n',
    "a tar archive": b"log.csv" + bytes(250) + b"ustar\x0000" + bytes(300),
    "a 7z archive": b"7z\xbc\xaf\x27\x1c\0\x04",
    "a file of zeros": bytes(4096),
    "a binary file of a kind that is not known": bytes(range(256)) * 20,
    "a damaged zip archive|a zip archive that cannot be opened": b"PK\x03\x04" + bytes(200),
}  # fmt: skip


@pytest.mark.parametrize("what", FOREIGN)
def test_it_is_named_for_what_it_is(log, what):
    path = log(FOREIGN[what])
    with pytest.raises(ForeignFileError, match=f"log.csv' is ({what.strip()})") as caught:
        read_trial(path)
    assert str(caught.value).endswith(".") and caught.value.exit_code == 3


@pytest.mark.parametrize(
    ("member", "what"),
    [
        ("word/document.xml", "a document of Word"),
        ("ppt/presentation.xml", "a presentation"),
        ("xl/workbook.bin", "a binary Excel workbook"),
        ("mimetype", "a sheet of LibreOffice"),
        ("other/part.xml", "a document that is packed as a zip archive"),
    ],
)
def test_documents_that_are_archives(log, member, what):
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("[Content_Types].xml", "<Types/>")
        archive.writestr(member, "application/vnd.oasis.opendocument.spreadsheet")
    with pytest.raises(ForeignFileError, match=what):
        read_trial(log(made.getvalue(), "log.xlsx"))


def test_a_script_of_matlab_is_known_by_its_suffix(log):
    with pytest.raises(ForeignFileError, match="a script of MATLAB"):
        read_trial(log("t = 0:0.5:10;\nplot(t, sin(t))\n", "log.m"))


@pytest.mark.parametrize("command", ["check", "measure"])
@pytest.mark.parametrize(
    "data",
    [
        *FOREIGN.values(),
        b"\x1b[31mt [s],\x1b]0;title\x07psi [deg]\n" + b"1,2\n2,3\n" * 9,
        "t [s],psi\u202e [deg],\x9b2J [m]\n1,2,3\n2,north\x9b2J\u202e,4\n".encode(),
    ],
)
def test_nothing_of_it_steers_the_terminal(log, capsys, command, data):
    assert run([command, str(log(data))]) == 3
    said = capsys.readouterr()
    printed = said.out + said.err
    assert "log" in printed and not {c for c in printed if ord(c) < 32 and c not in "\n\t"}
    assert not {"\x7f", "\x9b", "\u202e", "\ufffd"} & set(printed)
