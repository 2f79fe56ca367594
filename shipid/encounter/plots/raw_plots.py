"""What a file says of its plots, SI, before they are put into one frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from shipid.encounter.plots.plots import Sensor
from shipid.foundation.errors import MissingFileError
from shipid.trials import columns as spelling
from shipid.trials.errors import ClockError, EmptyFileError, NoUnitError
from shipid.trials.logs.positions import pair_of
from shipid.trials.logs.record import LenientRecord

#: Seconds of a day, and how far a time of day jumps back at least where midnight has passed.
_DAY, _MOST_OF_DAY = 86400.0, 43200.0
#: What a column may be called.
NAMES = {
    "range": ("range", "distance", "rng", "dist"),
    "bearing": ("bearing", "azimuth", "brg"),
    "relative_bearing": ("relative_bearing", "relative bearing", "bearing_relative", "bearing relative"),
    "x": ("x", "north", "n"),
    "y": ("y", "east", "e"),
}
OWN = {
    "own_x": ("own_x", "own_north"),
    "own_y": ("own_y", "own_east"),
    "own_lat": ("own_lat",),
    "own_lon": ("own_lon",),
    "own_psi": ("own_psi", "own_heading"),
}


@dataclass(frozen=True, eq=False)
class RawPlots:
    """Plots as a file holds them.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Seconds of 1970, of the day, or of a beginning of the log's own.
    columns : dict of str to ndarray, shape (N,)
        ``range`` and ``bearing`` [m, rad], ``x`` and ``y`` [m], or ``lat`` and ``lon`` [rad]; ``own_x`` and ``own_y``, or
        ``own_lat`` and ``own_lon``, where own ship is known. Bearings from the bow are ``relative_bearing``, and own ship's heading
        ``own_psi`` [rad].
    sensor : ndarray of int, shape (N,)
        Which sensor.
    looks, looks_sensor : ndarray, shape (K,)
        When a sensor looked and saw nothing, and which.
    one_by_one : bool
        Whether plots may come one after the other, as an antenna turns.
    sensors : tuple of Sensor
        What the file tells of the sensors; empty where it tells nothing.
    notes : tuple of str
        What was done to it.
    """

    t: np.ndarray
    columns: dict[str, np.ndarray]
    sensor: np.ndarray
    looks: np.ndarray = field(default_factory=lambda: np.zeros(0))
    looks_sensor: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    one_by_one: bool = True
    sensors: tuple[Sensor, ...] = ()
    notes: tuple[str, ...] = ()


def file_of(path: str | Path) -> Path:
    """Return a file that is there and holds something.

    Parameters
    ----------
    path : str or Path
        Of a log.

    Raises
    ------
    MissingFileError
        If it is not there, or a folder.
    EmptyFileError
        If it has no bytes.
    """
    file = Path(path)
    if not file.is_file():
        what = "is a folder" if file.is_dir() else "is not there"
        raise MissingFileError(f"'{file}' {what}. Name a log of plots.")
    if not file.stat().st_size:
        raise EmptyFileError(f"'{file}' is empty (0 bytes). Check that the log was written and copied completely.")
    return file


def columns_of(record: LenientRecord) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return times that count from where the log's clock does, and the columns, SI.

    Parameters
    ----------
    record : LenientRecord
        The table.

    Raises
    ------
    ShipidError
        If a column that plots need has no unit, or the table is no log.
    """
    for fault in record.faults:
        # A trial may not have a time that stands still, nor a column without a unit; plots may, where it is not theirs.
        if not isinstance(fault, (ClockError, NoUnitError)):
            raise fault
    pair = pair_of(record.values) or ()
    known = {"t", *pair, *(n for names in (NAMES | OWN).values() for n in names)}
    bare = next((n for n in record.values if n not in record.stated and (n in pair or n.lower() in known)), None)
    if bare is not None:
        raise spelling.no_unit(bare, f"{record.where}, ")
    values = {
        name: column * spelling.to_inside(name, record.stated[name], f"{record.where}: ")
        for name, column in record.values.items()
        if name in record.stated
    }
    t = values.get("t", record.values["t"])
    t = t + _DAY * midnights(t)
    if record.source.start:
        moment = datetime.fromisoformat(record.source.start)
        t = t + (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    return t, values


def named(columns: dict[str, np.ndarray], names: Sequence[str]) -> np.ndarray | None:
    """Return the column of one of several names in any case; None where there is none.

    Parameters
    ----------
    columns : dict of str to ndarray
        By name.
    names : sequence of str
        The first that is there counts.
    """
    lowered = {name.lower(): values for name, values in columns.items()}
    return next((lowered[name] for name in names if name in lowered), None)


def midnights(t: np.ndarray) -> np.ndarray:
    """Return how many midnights have passed at each time of day, shape (N,); none where the times are no times of day.

    Parameters
    ----------
    t : ndarray, shape (N,)
        In the order of the log, s.
    """
    known = np.flatnonzero(np.isfinite(t))
    days = np.zeros(t.size)
    if known.size > 1 and t[known].min() >= 0 and t[known].max() <= _DAY:
        step = np.diff(t[known])
        # A wrong time jumps ahead, and the next one back: that is no midnight.
        back = step < -_MOST_OF_DAY
        back[1:] &= ~(step[:-1] > _MOST_OF_DAY)
        days[known[1:]] = np.cumsum(back)
    return days
