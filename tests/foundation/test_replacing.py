"""Files written whole or not at all."""

import os
import threading
from pathlib import Path

import pytest

from shipid.foundation.errors import MissingFileError, OverwriteError, UsageError
from shipid.foundation.replacing import check_place, replacing, write_text


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "ship.toml"
    path.write_text("old")
    with pytest.raises(RuntimeError), replacing(path) as temporary:
        temporary.write_text("half of the new")
        raise RuntimeError
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["ship.toml"]


def test_writers_at_the_same_time_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "state.json"
    texts = [str(i) * 50_000 for i in range(8)]
    threads = [threading.Thread(target=write_text, args=(path, text)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert path.read_text() in texts
    assert os.listdir(tmp_path) == ["state.json"]


def test_a_new_file_has_the_rights_of_any_other(tmp_path: Path) -> None:
    write_text(tmp_path / "new", "ü")
    (tmp_path / "usual").write_text("")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode
    assert (tmp_path / "new").read_bytes() == b"\xc3\xbc"


def test_places_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("")
    with pytest.raises(OverwriteError, match="exists already"):
        check_place(tmp_path / "there", overwrite=False)
    check_place(tmp_path / "there", overwrite=True)
    with pytest.raises(MissingFileError, match="is a folder"):
        check_place(tmp_path, overwrite=True)
    with pytest.raises(UsageError, match="'-' is standard output"):
        check_place(Path("-"), overwrite=True)
    with pytest.raises(MissingFileError, match="there is no folder"):
        check_place(tmp_path / "no" / "file", overwrite=False)
    with pytest.raises(MissingFileError, match="cannot be written"), replacing(tmp_path / "no" / "file"):
        pass


def test_a_link_is_no_file_to_replace(tmp_path: Path) -> None:
    """``/dev/stdout`` leads to a file where the output of a shell goes to one: replaced, it would be a file for every program."""
    (tmp_path / "kept").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "kept")
    with pytest.raises(OverwriteError, match="is a link, and only a file is replaced"), replacing(tmp_path / "link"):
        pass
    assert (tmp_path / "link").is_symlink() and (tmp_path / "kept").read_text() == "old"
