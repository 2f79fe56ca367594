"""The cache folder: compiled code, parsed unit definitions and typeset equations are kept there between runs."""

from __future__ import annotations

import os
from pathlib import Path

import platformdirs

from shipid.foundation.errors import ShipidError
from shipid.foundation.replacing import replacing


def cache_folder() -> Path:
    """Return the folder: ``$SHIPID_CACHE``, or the user's cache folder."""
    chosen = os.environ.get("SHIPID_CACHE")
    return Path(chosen) if chosen else Path(platformdirs.user_cache_dir("shipid", appauthor=False))


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
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
    except (OSError, ShipidError):
        return


def kept(name: str) -> str | None:
    """Return the content of a file of the cache, or None.

    Parameters
    ----------
    name : str
        Name of the file.

    Returns
    -------
    str or None
    """
    try:
        return (cache_folder() / name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return None
