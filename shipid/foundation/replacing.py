"""Writing a file whole or not at all: under a temporary name beside its place, then renamed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from shipid.foundation.errors import MissingFileError, OverwriteError


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
        If the file exists and `overwrite` is not set.
    MissingFileError
        If it is a folder, or its folder does not exist.
    """
    if path.is_dir():
        raise MissingFileError(f"'{path}' is a folder. Name the file to write.")
    if path.exists() and not overwrite:
        raise OverwriteError(f"'{path}' exists already. Choose another name, or ask for it to be overwritten.")
    if not path.parent.is_dir():
        raise MissingFileError(f"there is no folder '{path.parent}' to write '{path.name}' into. Make it first.")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary name to write to; it is renamed to the file at the end, or removed if anything fails.

    Parameters
    ----------
    path : Path
        The file to write.

    Yields
    ------
    Path
        The temporary name, in the same folder; no other process has it.

    Raises
    ------
    MissingFileError
        If the folder cannot be written to.
    """
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    except OSError as error:
        raise MissingFileError(
            f"'{path}' cannot be written: {error.strerror}. Check the folder's permissions."
        ) from None
    try:
        os.close(handle)
        yield Path(temporary)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)  # mkstemp makes files that only their owner reads
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


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
