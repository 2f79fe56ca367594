"""Write a result as one HTML file that needs nothing else: no network, no scripts, no other file."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

from shipid.declaration.errors import UsageError
from shipid.identification.fit import Fit
from shipid.trials.errors import MissingFileError, OverwriteError


def write_report(result: Any, path: str | Path, *, overwrite: bool = True) -> Path:
    """Write a result as a self-contained HTML report.

    The file appears under its name only when it is complete. The same result gives the same bytes.

    Parameters
    ----------
    result : Fit
        What to report.
    path : str or Path
        The file to write.
    overwrite : bool
        Whether a file of that name may be replaced.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    OverwriteError
        If the file exists and `overwrite` is False.
    MissingFileError
        If the folder does not exist or cannot be written to.
    """
    path = Path(path)
    if path.is_dir():
        raise MissingFileError(f"'{path}' is a folder. Name the file to write.")
    if path.exists() and not overwrite:
        raise OverwriteError(f"'{path}' exists already. Choose another name, or ask for it to be overwritten.")
    if not path.parent.is_dir():
        raise MissingFileError(f"there is no folder '{path.parent}' to write '{path.name}' into. Make it first.")
    page = render(result)
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    except OSError as error:
        raise MissingFileError(
            f"'{path}' cannot be written: {error.strerror}. Check the folder's permissions."
        ) from None
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.write(page)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(temporary, 0o666 & ~mask)  # mkstemp makes files that only their owner reads
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path


def render(result: Any) -> str:
    """Return the report of a result as HTML text.

    Parameters
    ----------
    result : Fit
        What to report.

    Raises
    ------
    UsageError
        If there is no report for this kind of result.
    """
    if not isinstance(result, Fit):
        raise UsageError(f"there is no report for a {type(result).__name__}. Reports exist for: Fit.")
    from shipid.report.fit_view import fit_view

    return _environment().get_template("fit.html").render(view=fit_view(result))


def _environment() -> Any:
    import jinja2

    return jinja2.Environment(
        loader=jinja2.PackageLoader("shipid.report", ""),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
