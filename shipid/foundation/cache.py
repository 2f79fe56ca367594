"""The folder of what is worth keeping between runs: compiled code, parsed unit definitions, typeset equations."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def cache_folder() -> Path:
    """Return the folder: ``$SHIPID_CACHE``, or the user's cache folder."""
    chosen = os.environ.get("SHIPID_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "shipid"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "shipid"
    return Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "shipid"


def keep(name: str, text: str) -> None:
    """Write a file of the cache in one step; where the folder cannot be written, nothing is kept.

    Parameters
    ----------
    name : str
        Name of the file.
    text : str
        Its content.
    """
    folder = cache_folder()
    temporary = folder / f".{name}.{os.getpid()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        temporary.write_text(text, encoding="utf-8")
        temporary.replace(folder / name)
    except OSError:
        temporary.unlink(missing_ok=True) if folder.is_dir() else None


def kept(name: str) -> str | None:
    """Return the content of a file of the cache, or None.

    Parameters
    ----------
    name : str
        Name of the file.
    """
    try:
        return (cache_folder() / name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
