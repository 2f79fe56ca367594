"""The recording of a voyage: a trial file (CSV) that every sample is added to, whole rows only, so that a kill loses none."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path

import shipid
from shipid.declaration.vocabulary import FIELDS, display_unit, to_display
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import MissingFileError
from shipid.trials.columns import header
from shipid.trials.source import origin_words

#: The columns of a recording; what is not measured stays empty.
COLUMNS = (
    "psi", "r", "u", "v", "delta", "delta_order", "x", "y", "SOG", "COG", "wind_speed", "wind_direction", "wind_speed_relative",
    "wind_direction_relative",
)  # fmt: skip


class Recorder:
    """Adds samples to a trial file.

    Parameters
    ----------
    path : Path
        The file; what it held before is lost, so ask before.
    ship : str
        Name of the ship, for the comment.
    source : str
        Where the samples come from, for the comment.
    simulated : bool
        Whether the samples are simulated; the file says so in its first line.
    origin : tuple of float, optional
        Latitude and longitude in rad of the place where x and y are 0, where it is known.

    Attributes
    ----------
    path : Path
        The file.
    samples : int
        Rows so far.
    message : str
        Why nothing more is recorded; empty while it is.

    Raises
    ------
    MissingFileError
        If the file cannot be written.
    """

    def __init__(
        self, path: Path, ship: str, source: str, *, simulated: bool, origin: tuple[float, float] | None = None
    ) -> None:
        self.path, self.samples, self.message = path, 0, ""
        first = "Simulated, not measured" if simulated else "Recorded"
        place = "" if origin is None else f"# {origin_words(origin)}\n"
        heads = [header(n, display_unit(n, FIELDS[n].unit)) for n in ("t", *COLUMNS)]
        try:
            self._file = open(path, "wb", buffering=0)  # noqa: SIM115 - it stays open as long as the bridge does
            self._file.write(
                f"# {first}: shipid {shipid.__version__}, bridge, ship {ship}, source {source}\n{place}{','.join(heads)}\n".encode()
            )
        except OSError as error:
            raise MissingFileError(f"'{path}' cannot be recorded to: {error.strerror}.") from None

    def add(self, t: float, values: Mapping[str, float]) -> None:
        """Add a sample; a disk that is full ends the recording, and not the voyage.

        Parameters
        ----------
        t : float
            In s.
        values : mapping of str to float
            By the names of a trial's columns, SI; what is not there stays empty.
        """
        if self.message:
            return
        cells = [f"{t:.3f}"]
        for name in COLUMNS:
            value = values.get(name, math.nan)
            cells.append(f"{to_display(value, name, FIELDS[name].unit):z.9g}" if math.isfinite(value) else "")
        try:
            # One write a row: the system has it, whatever becomes of this process.
            row = (",".join(cells) + "\n").encode()
            written = self._file.write(row)
            if written < len(row):
                # A disk that becomes full takes a part of the row, without an error: no half row stays.
                self._file.truncate(self._file.tell() - written)
                self.message = "the recording has stopped: the disk is full"
                return
        except OSError as error:
            self.message = f"the recording has stopped: {error.strerror}"
            return
        self.samples += 1

    def close(self) -> None:
        """Close the file, its rows on the disk."""
        try:
            os.fsync(self._file.fileno())
        except OSError as error:
            self.message = self.message or f"the recording may be incomplete: {error.strerror}"
        self._file.close()

    def to_dict(self) -> dict[str, Plain]:
        """Return file, samples and message."""
        return {"file": str(self.path), "samples": self.samples, "message": self.message or None}
