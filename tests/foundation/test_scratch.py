"""Scratch files and folders: those of a process that was killed are swept, those of one that runs are not."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from shipid.foundation import scratch
from shipid.foundation.replacing import write_text
from shipid.foundation.scratch import alone_in, scratch_file, scratch_folder

HOLDER = """
import sys
from pathlib import Path
from shipid.foundation.scratch import scratch_file, scratch_folder
with scratch_folder(Path(sys.argv[1])) as folder, scratch_file(Path(sys.argv[1])) as file:
    (folder / "half").write_text("half")
    file.write_text("half")
    print("ready", flush=True)
    sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def not_swept_yet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scratch, "_swept", set())


def holder(folder: Path) -> subprocess.Popen[str]:
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", HOLDER, str(folder)], **pipes)  # type: ignore[call-overload]
    assert process.stdout.readline() == "ready\n"
    return process


@pytest.mark.skipif(sys.platform == "win32", reason="no locks of POSIX")
def test_only_what_a_killed_process_left_is_swept(tmp_path: Path) -> None:
    killed, alive = holder(tmp_path), holder(tmp_path)
    try:
        killed.kill()
        killed.wait()
        assert len(os.listdir(tmp_path)) == 4
        write_text(tmp_path / "result", "whole")
        assert len(os.listdir(tmp_path)) == 3
    finally:
        alive.communicate("")
    assert os.listdir(tmp_path) == ["result"]


def test_what_is_not_ours_is_left_alone(tmp_path: Path) -> None:
    names = (
        ".shipid-notes",
        ".shipid-0123456789abcdef",
        ".shipid-0123456789abcdeg.part",
        "shipid-0123456789abcdef.part",
    )
    for name in names:
        (tmp_path / name).mkdir()
    (tmp_path / ".shipid-0123456789abcdef.part").symlink_to(tmp_path / ".shipid-notes")
    (tmp_path / ".shipid-notes" / "kept").write_text("kept")
    write_text(tmp_path / "result", "whole")
    assert {p.name for p in tmp_path.iterdir()} == {*names, ".shipid-0123456789abcdef.part", "result"}
    assert (tmp_path / ".shipid-notes" / "kept").read_text() == "kept"


def test_names_cannot_be_guessed_and_a_folder_is_private(tmp_path: Path) -> None:
    with scratch_folder(tmp_path) as one, scratch_folder(tmp_path) as other, scratch_file(tmp_path) as file:
        assert len({one.name, other.name, file.name}) == 3
        if os.name != "nt":
            assert one.stat().st_mode & 0o777 == 0o700
        with alone_in(one):  # of this process already: it does not wait for itself
            (one / "held").touch()
    assert list(tmp_path.iterdir()) == []


def test_a_file_keeps_its_rights(tmp_path: Path) -> None:
    write_text(tmp_path / "private", "old")
    (tmp_path / "private").chmod(0o600)
    write_text(tmp_path / "private", "new")
    assert (tmp_path / "private").stat().st_mode & 0o777 == 0o600 and (tmp_path / "private").read_text() == "new"
