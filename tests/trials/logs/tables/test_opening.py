"""Compressed files are opened within bounds."""

import bz2
import gzip
import io
import lzma
import zipfile

import pytest

from shipid.trials.errors import FileSizeError, ForeignFileError
from shipid.trials.logs.reading import read_trial
from shipid.trials.logs.tables import opening
from shipid.trials.logs.tables.opening import opened


def zipped(**members: str) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in members.items():
            archive.writestr(f"{name}.csv", text)
    return made.getvalue()


COMPRESSED = {
    "gzip": lambda data: gzip.compress(data),
    "two gzip streams": lambda data: gzip.compress(data[:50]) + gzip.compress(data[50:]),
    "gzip with zeros behind": lambda data: gzip.compress(data) + b"\0" * 512,
    "bzip2": bz2.compress,
    "xz": lzma.compress,
    "zip": lambda data: zipped(log=data.decode()),
    "zip of macOS": lambda data: zipped(**{"__MACOSX/._log": "x", "log": data.decode()}),
    "gzip in zip": lambda data: gzip.compress(zipped(log=data.decode())),
}


@pytest.mark.parametrize("kind", COMPRESSED)
def test_compressed_files_are_read_whatever_their_name(log, table, kind):
    trial = read_trial(log(COMPRESSED[kind](table.encode()), "log.csv"))
    assert len(trial) == 20 and trial["t"][-1] == 9.5
    assert any("was expanded" in note for note in trial.source.notes)


@pytest.mark.parametrize("kind", ["gzip", "bzip2", "xz", "zip"])
def test_damaged_compressed_files_are_named(log, table, kind):
    data = COMPRESSED[kind](table.encode() * 50)
    for broken in (data[: len(data) // 2], data[:20] + bytes(40) + data[60:], data[:12]):
        with pytest.raises(ForeignFileError, match=f"damaged {kind} file|zip archive that cannot be opened"):
            opened(log(broken))


def test_what_follows_a_compressed_stream_is_not_dropped_without_a_word(log, table):
    with pytest.raises(ForeignFileError, match="damaged gzip file"):
        opened(log(gzip.compress(table.encode()) + b"rubbish"))


def test_an_archive_of_several_files_is_listed(log, table):
    with pytest.raises(ForeignFileError, match=r"zip archive of 2 files: a\.csv, b\.csv\. Name one"):
        opened(log(zipped(a=table, b=table)))


@pytest.mark.parametrize("kind", ["gzip", "bzip2", "xz", "zip"])
def test_compressed_files_are_judged_by_what_they_expand_to(log, monkeypatch, kind):
    monkeypatch.setattr(opening, "LARGEST", 100_000)
    with pytest.raises(FileSizeError, match="expands to something larger than 0 MB"):
        opened(log(COMPRESSED[kind](b"0" * 200_000)))
    assert opened(log(COMPRESSED[kind](b"0" * 100_000)))[0] == b"0" * 100_000


def test_a_file_that_is_too_large_is_refused(log, monkeypatch):
    monkeypatch.setattr(opening, "LARGEST", 100)
    assert len(opened(log("0" * 100))[0]) == 100
    with pytest.raises(FileSizeError, match="is larger than 0 MB"):
        opened(log("0" * 101))
