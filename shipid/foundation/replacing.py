"""Writing files whole or not at all: under a temporary name beside their place, then renamed."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from shipid.foundation.errors import MissingFileError, OverwriteError, UsageError
from shipid.foundation.processes.stopping import undisturbed
from shipid.foundation.scratch import alone_in, scratch_file


def check_place(path: Path, overwrite: bool) -> None:
    """Check that a file can and may be written, before its content is computed.

    Parameters
    ----------
    path : Path
        The file to write.
    overwrite : bool
        Whether it may exist.

    Raises
    ------
    OverwriteError
        If the file exists and `overwrite` is not set, or is something else than a file: a device, a pipe.
    MissingFileError
        If it is a folder, or its folder does not exist.
    UsageError
        If the name is ``-``.
    """
    check_kind(path)
    if path.exists() and not overwrite:
        raise OverwriteError(f"'{path}' exists already. Choose another name, or ask for it to be overwritten.")
    if not path.parent.is_dir():
        raise MissingFileError(f"there is no folder '{path.parent}' to write '{path.name}' into. Make it first.")


def check_kind(path: Path) -> None:
    """Refuse to put a file in the place of something else.

    Parameters
    ----------
    path : Path
        The file to write. A link is none: put in its place, a file would not come to where it leads, and ``/dev/stdout`` is one.

    Raises
    ------
    OverwriteError
        If there is a device, a pipe, a socket, or a link.
    UsageError
        If the name is ``-``.
    MissingFileError
        If there is a folder.
    """
    if str(path) == "-":
        raise UsageError("'-' is standard output for most programs, and a file is written here: give it another name.")
    if path.is_dir():
        raise MissingFileError(f"'{path}' is a folder. Name the file to write.")
    if os.path.lexists(path) and (path.is_symlink() or not path.is_file()):
        raise OverwriteError(
            f"'{path}' is {_kind(path)}, and only a file is replaced. Name another file; without one a result is printed."
        )


def _kind(path: Path) -> str:
    mode = path.lstat().st_mode
    if stat.S_ISLNK(mode):
        return "a link"
    if stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode):
        return "a pipe"
    return "a device"


@contextmanager
def replacing(path: Path, overwrite: bool = True) -> Iterator[Path]:
    """Give a temporary name to write to; it is renamed to the file at the end, or removed if anything fails.

    Parameters
    ----------
    path : Path
        The file to write. It keeps the rights it has.
    overwrite : bool
        Whether it may have come to exist meanwhile.

    Yields
    ------
    Path
        The temporary name, in the same folder; no other process has it.

    Raises
    ------
    MissingFileError
        If the folder cannot be written to, or the path is a folder.
    OverwriteError
        If the path is something else than a file, or exists at the end and may not.
    """
    check_kind(path)
    with ExitStack() as stack:
        try:
            temporary = stack.enter_context(scratch_file(path.parent))
        except OSError as error:
            raise MissingFileError(
                f"'{path}' cannot be written: {error.strerror}. Check the folder's permissions."
            ) from None
        yield temporary
        put_in_place({temporary: path}, overwrite)


def put_in_place(files: Mapping[Path, Path], overwrite: bool) -> None:
    """Rename finished files to their names, all of them: a signal waits, and so does another process that writes there.

    Parameters
    ----------
    files : mapping of Path to Path
        From the temporary name to the file; all lie on one disk, and the files in one folder.
    overwrite : bool
        Whether the files may exist.

    Raises
    ------
    OverwriteError
        If one exists that may not, or is something else than a file; then none is put in place.
    MissingFileError
        If one is a folder; then none is put in place.
    """
    for temporary, path in files.items():
        if path.is_file():
            os.chmod(temporary, stat.S_IMODE(path.stat().st_mode))
        _flush(temporary)
    folder = next(iter(files.values())).parent
    with alone_in(folder), undisturbed():
        for path in files.values():
            check_place(path, overwrite)
        for temporary, path in files.items():
            os.replace(temporary, path)
    with suppress(OSError):  # not every system knows how to flush a folder
        _flush(folder)


def _flush(path: Path) -> None:
    """Have the system write a file or a folder to the disk, so that a power cut leaves no empty file under its name."""
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all, in UTF-8.

    Parameters
    ----------
    path : Path
        The file; it is replaced in one step.
    text : str
        Its content.
    """
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
