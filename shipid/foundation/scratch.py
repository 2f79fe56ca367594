"""Scratch files and folders: their names cannot be guessed, and those of a process that was killed are swept by the next one.

A scratch is locked as long as its process runs; the system lets go of the lock of a process that has ended in whatever way.
Where the system has no such locks nothing is swept.
"""

from __future__ import annotations

import os
import re
import secrets
import shutil
import stat
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform != "win32":
    import fcntl

_NAME = re.compile(r"\.shipid-[0-9a-f]{16}\.part")
_HERE = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0)
#: Folders that this process has swept; a folder holds what others left there before, once.
_swept: set[Path] = set()
#: Scratch folders of this process, which are locked as long as they exist.
_own: set[Path] = set()
#: How long one process waits for another that is putting files in place, which takes it milliseconds, and how often it looks; in s.
_LONGEST, _AGAIN = 10.0, 0.01


@contextmanager
def scratch_folder(beside: Path) -> Iterator[Path]:
    """Give a folder of this process's own, which nobody else reads, and remove it with what it holds.

    Parameters
    ----------
    beside : Path
        The folder to make it in; what killed processes left there is removed first.

    Yields
    ------
    Path

    Raises
    ------
    OSError
        If it cannot be made.
    """
    sweep(beside)
    path, handle = _made(beside, folder=True)
    _own.add(path)
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)
        _own.discard(path)
        _let_go(handle)


@contextmanager
def scratch_file(beside: Path) -> Iterator[Path]:
    """Give an empty file of this process's own, and remove it where it was not renamed.

    Parameters
    ----------
    beside : Path
        The folder to make it in; what killed processes left there is removed first.

    Yields
    ------
    Path

    Raises
    ------
    OSError
        If it cannot be made.
    """
    sweep(beside)
    path, handle = _made(beside, folder=False)
    try:
        yield path
    finally:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        _let_go(handle)


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Wait until no other process is putting files into a folder, and keep the others waiting.

    Parameters
    ----------
    folder : Path
        The folder.

    Yields
    ------
    None
    """
    if folder in _own:
        yield
        return
    handle = _opened(folder)
    _lock(handle, wait=True)
    try:
        yield
    finally:
        _let_go(handle)


def sweep(folder: Path) -> None:
    """Remove the scratch files and folders of processes that were killed.

    Parameters
    ----------
    folder : Path
        Where they lie; looked at once in the life of a process.
    """
    if folder in _swept:
        return
    _swept.add(folder)
    with suppress(OSError):
        for name in os.listdir(folder):
            if _NAME.fullmatch(name):
                _remove_if_abandoned(folder / name)


def _remove_if_abandoned(path: Path) -> None:
    with suppress(OSError):
        kind = path.lstat().st_mode
        if not (stat.S_ISDIR(kind) or stat.S_ISREG(kind)):
            return
        handle = _opened(path)
        if handle is not None and _lock(handle, wait=False):
            if stat.S_ISDIR(kind):
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
        _let_go(handle)


def _made(beside: Path, folder: bool) -> tuple[Path, int | None]:
    """Make a scratch and lock it."""
    while True:
        path = beside / f".shipid-{secrets.token_hex(8)}.part"
        if folder:
            path.mkdir(mode=0o700)
        else:
            # The rights of any new file, less what the user's mask takes away.
            os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY | _HERE, 0o666))
        handle = _opened(path)
        _lock(handle, wait=True)
        # Between the two lines above another process may have taken it for abandoned, and removed it.
        if path.exists():
            return path, handle
        _let_go(handle)


def _opened(path: Path) -> int | None:
    """A handle to lock by; a folder has none on Windows."""
    if sys.platform == "win32":
        return None
    try:
        return os.open(path, os.O_RDONLY | os.O_NONBLOCK | _HERE)
    except OSError:
        return None


def _lock(handle: int | None, wait: bool) -> bool:
    """Whether this process has the lock now. A process that stands still while it has it must not stop the others for good."""
    if sys.platform == "win32" or handle is None:
        return False
    waited = 0.0
    while True:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        except BlockingIOError:
            if not wait or waited >= _LONGEST:
                return False
        except OSError:
            return False
        time.sleep(_AGAIN)
        waited += _AGAIN


def _let_go(handle: int | None) -> None:
    if handle is not None:
        os.close(handle)
