"""The cache folder: where it lies, whose it is, and that nothing depends on it."""

import os
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest

from shipid.foundation import cache
from shipid.foundation.cache import CacheNotice, cache_folder, keep, kept, safe_cache_folder, workshop

needs_users = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="no users of POSIX")


@pytest.fixture(autouse=True)
def nothing_said() -> Iterator[None]:
    cache._notice_once.cache_clear()  # noqa: SLF001 - each test hears its own notice
    yield
    cache._notice_once.cache_clear()  # noqa: SLF001


def test_where_the_cache_lies(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "own"))
    assert cache_folder() == tmp_path / "own"
    monkeypatch.delenv("SHIPID_CACHE")
    assert cache_folder().name == "shipid" or cache_folder().parent.name == "shipid"  # Windows adds a folder
    assert cache_folder().is_absolute()


@pytest.mark.parametrize("path", ["", ".", "cache", "../cache"])
def test_a_path_that_is_not_absolute_counts_as_not_set(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, path: str
) -> None:
    """It would be another folder in each working directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("SHIPID_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", path)
    assert cache_folder() == tmp_path / "home" / ".cache" / "shipid"
    monkeypatch.setenv("SHIPID_CACHE", path)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert cache_folder() == tmp_path / "home" / ".cache" / "shipid"
    assert [w.category for w in caught] == ([CacheNotice] if path else [])


def test_a_home_that_is_not_absolute_gives_no_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("SHIPID_CACHE", raising=False)
    monkeypatch.setenv("HOME", "home")
    monkeypatch.setenv("XDG_CACHE_HOME", "cache")
    with pytest.warns(CacheNotice, match="its path is not absolute"):
        assert safe_cache_folder() is None
    assert list(tmp_path.iterdir()) == []


def test_what_is_kept_is_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "new"))
    assert kept("equations") is None
    keep("equations", "r = ü\nv = 2")
    assert kept("equations") == "r = ü\nv = 2"
    assert [p.name for p in (tmp_path / "new").iterdir()] == ["equations"]


@needs_users
def test_a_new_folder_is_its_owners_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "new"))
    before = os.umask(0)
    try:
        assert safe_cache_folder() == tmp_path / "new"
    finally:
        os.umask(before)
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o700


def test_a_folder_that_cannot_be_used_is_no_failure(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "file"))
    with pytest.warns(CacheNotice, match=r"file is not used: File exists\. Nothing is kept between runs"):
        keep("equations", "lost")
    assert kept("equations") is None


@needs_users
@pytest.mark.parametrize("mode", [0o770, 0o777, 0o1777, 0o702])
def test_a_folder_that_others_can_write_to_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, mode: int
) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "open"))
    keep("equations", "of another user")
    (tmp_path / "open").chmod(mode)
    with pytest.warns(CacheNotice, match="other users can write to it. If nobody has: chmod 700"):
        assert kept("equations") is None
    keep("more", "lost")
    assert [p.name for p in (tmp_path / "open").iterdir()] == ["equations"]
    (tmp_path / "open").chmod(0o700)
    assert kept("equations") == "of another user"


@needs_users
def test_a_folder_of_another_user_is_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "theirs"))
    keep("equations", "theirs")
    if os.geteuid() == 0:
        os.chown(tmp_path / "theirs", 12345, -1)
    else:
        monkeypatch.setattr(os, "geteuid", lambda: 12345)
    with pytest.warns(CacheNotice, match="it belongs to another user. Choose a folder of your own with SHIPID_CACHE"):
        assert kept("equations") is None


@pytest.mark.parametrize("harm", ["cut", "edited", "emptied", "without a checksum", "a folder", "not text"])
def test_a_damaged_entry_counts_as_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, harm: str) -> None:
    monkeypatch.setenv("SHIPID_CACHE", str(tmp_path / "c"))
    keep("equations", '["r = 1"]')
    entry = tmp_path / "c" / "equations"
    whole = entry.read_bytes()
    if harm == "a folder":
        entry.unlink()
        entry.mkdir()
    else:
        harmed = {"cut": whole[:-2], "edited": whole.replace(b"1", b"2"), "emptied": b"", "not text": b"\xff\xfe"}
        entry.write_bytes(harmed.get(harm, b'["r = 1"]'))
    assert kept("equations") is None
    keep("equations", "new")
    assert kept("equations") == (None if harm == "a folder" else "new")


def test_without_a_cache_an_entry_is_made_among_the_temporary_files() -> None:
    with workshop(None) as scratch:
        (scratch / "code.c").write_text("")
        if hasattr(os, "geteuid"):
            assert scratch.stat().st_mode & 0o777 == 0o700
    assert not scratch.exists()
