"""A folder of results: checked before the work, written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path


def results_folder(out: str | None, overwrite: bool, files: tuple[str, ...]) -> Path | None:
    """Return the folder for results, or None where none is asked for; what stands in the way is found before the work.

    Parameters
    ----------
    out : str or None
        The folder.
    overwrite : bool
        Whether files may be replaced.
    files : tuple of str
        What will be written.
    """
    from shipid.declaration.errors import UsageError

    if out is None:
        return None
    folder = Path(out)
    there = [n for n in files if (folder / n).exists()]
    if there and not overwrite:
        raise UsageError(f"{folder} holds {', '.join(there)} already. Choose another --out, or add --overwrite.")
    nearest = next(p for p in (folder, *folder.absolute().parents) if p.exists())
    if not nearest.is_dir():
        raise UsageError(f"{nearest} is a file; --out wants a folder.")
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise UsageError(f"{nearest} cannot be written to. Choose another --out, or ask for its permissions.")
    return folder


def write_results(folder: Path, writers: Mapping[str, Callable[[Path], object]]) -> None:
    """Write files beside their places first, so that an interruption leaves no half of them.

    Parameters
    ----------
    folder : Path
        Where; it is made.
    writers : mapping of str to callable
        File name, and what writes it to a path.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix=".shipid-") as scratch:
        parts = [Path(scratch) / n for n in writers]
        for part, write in zip(parts, writers.values()):
            write(part)
        for part in parts:
            part.replace(folder / part.name)
