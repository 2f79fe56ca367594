"""The folder a command writes its results to: looked at before the work, filled after it, whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path


def result_folder(out: str | None, names: tuple[str, ...], overwrite: bool) -> Path | None:
    """Return the folder of ``--out``, refused before the work is done where it cannot be used.

    Parameters
    ----------
    out : str or None
        The option.
    names : tuple of str
        Files that are going to be written.
    overwrite : bool
        Whether they may be replaced.

    Raises
    ------
    UsageError
        If files are there already, or the place is a file or cannot be written to.
    """
    from shipid.foundation.errors import UsageError

    if out is None:
        return None
    folder = Path(out)
    there = [n for n in names if (folder / n).exists()]
    if there and not overwrite:
        raise UsageError(f"{folder} holds {', '.join(there)} already. Choose another --out, or add --overwrite.")
    nearest = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not nearest.is_dir():
        raise UsageError(f"{nearest} is a file; --out wants a folder.")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise UsageError(f"{nearest} cannot be written to. Choose another --out, or ask for its permissions.")
    return folder


def fill(folder: Path, writers: Mapping[str, Callable[[Path], object]]) -> None:
    """Write files beside their places first, so that an interruption leaves no half of them.

    Parameters
    ----------
    folder : Path
        Made where it is not there.
    writers : mapping of str to callable
        By file name: what writes the file to the path it is given.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".shipid-") as scratch:
        for name, write in writers.items():
            write(Path(scratch) / name)
        for name in writers:
            (Path(scratch) / name).replace(folder / name)
