"""The cache folder: compiled code and typeset equations are kept there between runs, with a checksum.

What lies there is loaded as machine code, so that the folder is used only where nobody else can write to it. No entry is an
object that runs code when it is read.
"""

from __future__ import annotations

import functools
import hashlib
import os
import stat
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import platformdirs

from shipid.foundation.errors import ShipidError
from shipid.foundation.replacing import replacing
from shipid.foundation.scratch import scratch_folder


class CacheNotice(UserWarning):
    """The cache folder cannot be used."""


def cache_folder() -> Path:
    """Return where the cache lies: ``$SHIPID_CACHE``, or the user's cache folder.

    A relative path would be another folder in each working directory, where anybody may have put code: it counts as not set.
    """
    chosen = os.environ.get("SHIPID_CACHE", "")
    if Path(chosen).is_absolute():
        return Path(chosen)
    if chosen:
        _notice_once(f"SHIPID_CACHE is '{chosen}', which is no absolute path; it is left aside")
    usual = os.environ.get("XDG_CACHE_HOME", "")
    if usual and not Path(usual).is_absolute():
        return Path.home() / ".cache" / "shipid"
    return Path(platformdirs.user_cache_dir("shipid", appauthor=False))


def safe_cache_folder() -> Path | None:
    """Return the cache folder, made where it is missing; None where it cannot be used, with one notice that says why."""
    folder = cache_folder()
    why = _why_unusable(folder)
    if why is None:
        return folder
    _notice_once(f"the cache folder {folder} is not used: {why}. Nothing is kept between runs")
    return None


def _why_unusable(folder: Path) -> str | None:
    if not folder.is_absolute():
        return "its path is not absolute"
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        found = folder.stat()
    except OSError as error:
        return error.strerror or str(error)
    if not hasattr(os, "geteuid"):
        return None
    if found.st_uid != os.geteuid():
        return "it belongs to another user. Choose a folder of your own with SHIPID_CACHE"
    if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return f"other users can write to it. If nobody has: chmod 700 {folder}"
    if not os.access(folder, os.R_OK | os.W_OK | os.X_OK):
        return "it cannot be written to"
    return None


@functools.cache
def _notice_once(words: str) -> None:
    warnings.warn(f"{words}.", CacheNotice, stacklevel=2)


@contextmanager
def workshop(folder: Path | None) -> Iterator[Path]:
    """Give a folder to make an entry in, and remove it: in the cache, or among the temporary files of this user.

    Parameters
    ----------
    folder : Path or None
        The cache folder, as `safe_cache_folder` returned it.

    Yields
    ------
    Path
    """
    if folder is not None:
        with scratch_folder(folder) as scratch:
            yield scratch
        return
    with TemporaryDirectory(prefix="shipid-", ignore_cleanup_errors=True) as name:
        yield Path(name)


def digest(content: bytes) -> str:
    """Return the checksum of an entry.

    Parameters
    ----------
    content : bytes
        What it holds.
    """
    return hashlib.sha256(content).hexdigest()


def keep(name: str, text: str) -> None:
    """Write a file of the cache in one step, behind its checksum; where the folder cannot be written, nothing is kept.

    Parameters
    ----------
    name : str
        Name of the file.
    text : str
        Its content.
    """
    folder = safe_cache_folder()
    if folder is None:
        return
    content = text.encode()
    with suppress(OSError, ShipidError), replacing(folder / name) as temporary:
        temporary.write_bytes(f"{digest(content)}\n".encode() + content)


def kept(name: str) -> str | None:
    """Return the content of a file of the cache, or None where there is none or it is damaged.

    Parameters
    ----------
    name : str
        Name of the file.

    Returns
    -------
    str or None
    """
    folder = safe_cache_folder()
    if folder is None or not (folder / name).is_file():
        return None
    try:
        said, _, content = (folder / name).read_bytes().partition(b"\n")
        return content.decode() if said == digest(content).encode() else None
    except (OSError, UnicodeDecodeError):
        return None
