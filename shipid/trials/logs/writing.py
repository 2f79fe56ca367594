"""Write trials: CSV or Parquet with units in the header, whole or not at all."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO

import pandas as pd

from shipid.foundation.errors import MissingExtraError, UsageError
from shipid.foundation.replacing import check_place, replacing
from shipid.foundation.result import csv_of, rested
from shipid.trials.source import origin_in, origin_words
from shipid.trials.trial import Trial

#: Endings of files of other kinds: a table under such a name could not be read back.
_OTHERS = {
    ".gz", ".bz2", ".xz", ".zip", ".xls", ".xlsx", ".mat", ".h5", ".hdf5", ".json", ".toml", ".nmea", ".html", ".pdf",
}  # fmt: skip


def write_trial(
    trial: Trial,
    path: str | Path,
    units: Mapping[str, str] | str | None = None,
    *,
    overwrite: bool = False,
    comment: str | None = None,
) -> Path:
    """Write a trial so that `read_trial` reads it back: header ``t [s],psi [deg],...``.

    The file appears under its name only when it is complete.

    Parameters
    ----------
    trial : Trial
        What to write.
    path : str or Path
        Where; ``.parquet`` writes Parquet, everything else CSV.
    units : Mapping of str to str, or "SI", optional
        Units by column (`Trial.to_frame`).
    overwrite : bool
        Whether a file of that name may be replaced.
    comment : str, optional
        Lines to put before the header, each behind a ``#``; by default those the trial was read with, and where x and y are 0. A first line
        with the word "simulated" marks a simulation.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    UsageError
        If the name is that of another kind of file.
    OverwriteError
        If the file exists and `overwrite` is not set.
    MissingFileError
        If the folder does not exist or cannot be written to.
    """
    if Path(path).suffix.lower() in _OTHERS:
        raise UsageError(f"a trial is written as CSV or Parquet: let the name of {path} end in .csv or .parquet.")
    frame = trial.to_frame(units)
    if Path(path).suffix.lower() not in (".parquet", ".pq"):
        with text_file(trial, path, overwrite, comment) as file:
            file.write(csv_of(frame))
        return Path(path)
    check_place(Path(path), overwrite)
    with replacing(Path(path), overwrite) as temporary:
        _parquet(rested(frame), temporary, _comment_of(trial) if comment is None else comment)
    return Path(path)


@contextlib.contextmanager
def text_file(trial: Trial, path: str | Path, overwrite: bool, comment: str | None) -> Iterator[IO[str]]:
    """Open a text file for a trial, its comment written; it appears under its name when the block is left.

    Parameters
    ----------
    trial : Trial
        Its comment is written where none is given.
    path : str or Path
        Where.
    overwrite : bool
        Whether a file of that name may be replaced.
    comment : str or None
        Lines to put first, each behind a ``#``.

    Yields
    ------
    file object
        To write the samples to.

    Raises
    ------
    OverwriteError
        If the file exists and `overwrite` is not set.
    MissingFileError
        If the folder does not exist or cannot be written to.
    """
    check_place(Path(path), overwrite)
    comment = _comment_of(trial) if comment is None else comment
    with replacing(Path(path), overwrite) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        file.writelines(f"# {line}\n" for line in comment.splitlines())
        yield file


def _comment_of(trial: Trial) -> str:
    """The comment the trial was read with, and where its x and y are 0."""
    said, origin = trial.source.comment, trial.source.origin
    if origin is None or origin_in(said) is not None:
        return said
    return f"{said}\n{origin_words(origin)}" if said else origin_words(origin)


def _parquet(frame: pd.DataFrame, temporary: Path, comment: str) -> None:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingExtraError("a Parquet file", "pyarrow", "parquet", "A CSV file needs nothing else.") from None
    table = pyarrow.Table.from_pandas(frame, preserve_index=False)
    metadata = {**(table.schema.metadata or {}), b"comment": comment.encode()}
    pyarrow.parquet.write_table(table.replace_schema_metadata(metadata), temporary)
