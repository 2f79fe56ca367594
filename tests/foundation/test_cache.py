"""The cache folder: where it lies, and that nothing depends on it."""

from pathlib import Path

import pytest

from shipid.foundation.cache import cache_folder, keep, kept


def test_where_the_cache_lies(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "own"))
    assert cache_folder() == tmp_path / "own"
    monkeypatch.delenv("SHIPID_CACHE")
    assert cache_folder().name == "shipid" or cache_folder().parent.name == "shipid"  # Windows adds a folder
    assert cache_folder().is_absolute()


def test_what_is_kept_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "new"))
    assert kept("equations") is None
    keep("equations", "r = ü")
    assert kept("equations") == "r = ü"
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["equations"]


def test_a_folder_that_cannot_be_used_is_no_failure(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "file"))
    keep("equations", "lost")
    assert kept("equations") is None
