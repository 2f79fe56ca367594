"""From a record to the rows of a filter: inputs, intervals, what each sensor shows and when it is there.

A gap is bridged in steps no longer than a few samples, so that the integration stays accurate; the treatment of time stamps that
cannot be right is explained in `shipid.estimation.records.clock`. Inputs are filled between their samples by the rule of
`shipid.trials.stretches`; samples in a hole that is too long for it are left out, and the filter starts anew behind it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import ClassVar

import numpy as np

from shipid.declaration.delays import shifted_rows
from shipid.estimation.errors import NotMeasurableError, SensorRateError
from shipid.estimation.records.clock import LONGEST_GAP, LONGEST_STEP, filter_time, steps
from shipid.estimation.settings.inputs import filled_inputs, hold_last, input_table, names_of, never_known, ruled
from shipid.estimation.settings.instruments import Instruments
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief, moment
from shipid.foundation.result import Result
from shipid.trials.filling import slope
from shipid.trials.fitness import check_column_units
from shipid.trials.logs.conversion import unwrapped
from shipid.trials.logs.reading import trials_of
from shipid.trials.stretches import is_order
from shipid.trials.trial import Trial

_TURN = 2.0
"""The slope of the heading is taken over so long [s]: headings are printed to 0.1 deg, and ships turn slowly."""

#: What can be filtered: a trial, or SI columns with ``t`` in which NaN stands for a sample that is missing.
FilterRecord = Trial | Mapping[str, np.ndarray]


@dataclass(frozen=True)
class Hole:
    """A hole of an input, in which there are no estimates.

    Attributes
    ----------
    begin, end : float
        Times in s of the last sample before it and the first behind it.
    row : int
        The row of that first sample.
    inputs : tuple of str
        What is not known in it.
    """

    begin: float
    end: float
    row: int
    inputs: tuple[str, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Arrangement(Result):
    """A record as the filter takes it: N rows, of which `shown` are samples and the others bridge gaps.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Time of each row in s; it runs on where the record's own clock was set back.
    intervals : ndarray, shape (N,)
        Time since the row before, in s; zero for the first.
    inputs : ndarray, shape (N, inputs)
        SI.
    z : ndarray, shape (N, sensors)
        What the sensors show; zero where they show nothing.
    there : ndarray of bool, shape (N, sensors)
        Where they show something.
    lost : ndarray of bool, shape (N, inputs)
        Where an input is missing and its last value stands in, as its uncertainty was given.
    shown : ndarray of bool, shape (N,)
        Which rows are samples of the record.
    limited : ndarray of int, shape (sensors,)
        Samples left out because they are outside the sensor's range.
    forward : ndarray of bool, shape (samples,)
        Which samples of the record are used; the others have a time stamp that cannot be right, or lie in a hole of an input.
    unknown : ndarray of bool, shape (samples,)
        Which samples lie in a hole of an input.
    holes : tuple of Hole
        Where the filter starts anew, behind the hole.
    filled : mapping of str to int
        Samples between those of an input, by input.
    turned : bool
        Whether the rate of turn that drives the model is the slope of the heading.
    """

    TABLE: ClassVar[str] = "t"
    UNITS: ClassVar[Mapping[str, str]] = {
        "t": "s",
        "intervals": "s",
        "inputs": "SI",
        "z": "SI",
        "there": "",
        "lost": "",
        "shown": "",
        "limited": "",
        "forward": "",
        "unknown": "",
    }

    t: np.ndarray
    intervals: np.ndarray
    inputs: np.ndarray
    z: np.ndarray
    there: np.ndarray
    lost: np.ndarray
    shown: np.ndarray
    limited: np.ndarray
    forward: np.ndarray
    unknown: np.ndarray
    holes: tuple[Hole, ...] = ()
    filled: Mapping[str, int] = field(default_factory=dict)
    turned: bool = False

    @property
    def pieces(self) -> list[slice]:
        """The rows of each stretch between holes."""
        edges = [0, *(hole.row for hole in self.holes), self.t.size]
        return [slice(a, b) for a, b in pairwise(edges)]

    @property
    def words(self) -> tuple[str, ...]:
        """What was filled and left out, one sentence each."""
        rows = self.forward.size
        said = [
            f"{name} is {'held' if is_order(name) else 'interpolated'} between its samples at {count} of {rows} times."
            for name, count in self.filled.items()
        ]
        if self.turned:
            said.insert(0, f"r is not recorded: what drives the model is the slope of psi over {_TURN:g} s.")
        if self.unknown.any():
            count = int(self.unknown.sum())
            said.append(
                f"{count} of {rows} samples lie in holes of an input that are too long to fill, and are left out."
            )
        said += [
            f"No {', '.join(hole.inputs)} from {moment(hole.begin)} to {moment(hole.end)} s: no estimates there; what it drives starts anew."
            for hole in self.holes
        ]
        return tuple(said)

    def to_dict(self) -> dict[str, Plain]:
        """Return what was filled and left out as plain values."""
        return {
            "filled": dict(self.filled),
            "samples_left_out": int(self.unknown.sum()),
            "holes": [{"begin": h.begin, "end": h.end, "inputs": list(h.inputs)} for h in self.holes],
        }

    @property
    def sample(self) -> np.ndarray:
        """The sample that each row belongs to, among those used, shape (N,): rows that bridge a gap belong to the one that ends it."""
        found = np.searchsorted(np.flatnonzero(self.shown), np.arange(self.t.size))
        return np.asarray(np.minimum(found, np.count_nonzero(self.shown) - 1))

    @property
    def back(self) -> int:
        """How many samples were left out because their time stamp cannot be right."""
        return int(np.count_nonzero(~self.forward & ~self.unknown))


def loaded(record: FilterRecord | str | Path) -> FilterRecord:
    """Return what is filtered; the file of a log is read.

    Parameters
    ----------
    record : Trial, mapping of str to ndarray, str or Path
        As a user gives it.
    """
    if isinstance(record, str | Path):
        [record] = trials_of(record)
    return record


def columns_of(record: FilterRecord) -> tuple[dict[str, np.ndarray], str]:
    """Return the SI columns of a record, and its name.

    Parameters
    ----------
    record : Trial or mapping of str to ndarray
        What is filtered.

    Raises
    ------
    UsageError
        If it has no times, or its columns are not of one length.
    """
    if isinstance(record, Trial):
        columns = {n: record[n] for n in record.table.columns}
        # What a trial states of its loading, as its format file does; a column says more.
        stated = {n: np.full(len(record), v) for n, v in record.source.conditions.loading.items() if n not in columns}
        return columns | stated, record.name
    if not isinstance(record, Mapping):
        raise UsageError(
            f"a record to filter is a trial, as shipid.read_trial returns it, or a dictionary of arrays; this is a {type(record).__name__}."
        )
    if "t" not in record:
        raise UsageError(f"a record to filter needs its times 't'; it has {', '.join(record)}.")
    columns = {n: np.asarray(c, dtype=float) for n, c in record.items()}
    count = columns["t"].size
    for name, column in columns.items():
        if column.shape != (count,):
            raise UsageError(
                f"column '{name}' of the record has {column.size} samples, and 't' has {count}: give one value for each time."
            )
    return columns, "record"


def arrange(instruments: Instruments, record: FilterRecord, *, filled: bool = False) -> Arrangement:
    """Arrange a record for a filter.

    Parameters
    ----------
    instruments : Instruments
        Sensors and inputs of the filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    filled : bool
        Whether its inputs are known to be whole.

    Returns
    -------
    Arrangement

    Raises
    ------
    NotMeasurableError
        If the record lacks a sensor.
    UnstatedInputError
        If it lacks an input that declares no default.
    SensorRateError
        If a sensor is to be read more often than the record is sampled.
    ColumnUnitError
        If a column has another unit than the sensor or the input.
    UsageError
        If its time stamps cannot be used.
    NoStretchError
        If no sample lies between samples of every input.
    """
    columns, name = columns_of(record)
    if isinstance(record, Trial):
        check_column_units(record, instruments.model, (*instruments.model.inputs, *instruments.sensors))
    forward, t = filter_time(columns["t"])
    if not t.size or (t.size == 1 < forward.size):
        raise UsageError(
            f"the times 't' of record {name} do not increase: of {forward.size} stamps {t.size} can be used. They must be in s, "
            f"increase, and lie no more than {LONGEST_GAP:g} s apart."
        )
    columns = {n: np.asarray(c, dtype=float)[forward] for n, c in columns.items()} | {"t": t}
    z, there, limited = _sensor_table(instruments, columns, name)
    turned = _turned(instruments, columns)
    if turned:
        columns["r"] = slope(t, unwrapped(columns["psi"]), _TURN)
    table = input_table(instruments, columns, name)
    whole = table if filled or np.isfinite(table).all() else filled_inputs(instruments, t, table)
    known = np.isfinite(whole[:, ruled(instruments)]).all(axis=1)
    if not known.any():
        raise never_known(instruments, table, name)
    unknown = np.zeros(forward.size, dtype=bool)
    unknown[forward] = ~known
    counts = (np.isfinite(whole) & ~np.isfinite(table)).sum(axis=0)
    counted = {n: int(c) for n, c in zip(instruments.model.inputs, counts) if c}
    used = np.flatnonzero(known)
    behind = used[1:][np.diff(used) > 1]
    before = used[:-1][np.diff(used) > 1]
    gone = [names_of(instruments, ~np.isfinite(whole[a + 1 : b]).all(axis=0)) for a, b in zip(before, behind)]
    ends = list(zip(t[before], t[behind], gone))
    t, z, there, table, whole = t[known], z[known], there[known], table[known], whole[known]
    rows = _bridged(t)
    at = np.searchsorted(rows, t)
    shown = np.zeros(rows.size, dtype=bool)
    shown[at] = True
    full_z, full_there = np.zeros((rows.size, z.shape[1])), np.zeros((rows.size, z.shape[1]), dtype=bool)
    full_z[at], full_there[at] = np.where(there, z, 0.0), there
    held = hold_last(whole)
    inputs = np.column_stack([np.interp(rows, t, c) for c in held.T]) if held.shape[1] else np.empty((rows.size, 0))
    if instruments.delays:
        inputs = shifted_rows(instruments.model, rows, inputs.T, instruments.delays)[0].T
    # Rows that bridge a gap belong to the sample that ends it.
    lost = ~np.isfinite(table)[np.searchsorted(t, rows)]
    holes = tuple(Hole(float(a), float(b), int(np.searchsorted(rows, b)), names) for a, b, names in ends)
    intervals = _intervals(rows, t, at)
    # The first sample behind a hole is the first of a new stretch: nothing is predicted to it.
    intervals[[hole.row for hole in holes]] = 0.0
    forward = forward & ~unknown
    return Arrangement(
        rows, intervals, inputs, full_z, full_there, lost, shown, limited, forward, unknown, holes, counted, turned
    )


def _turned(instruments: Instruments, columns: Mapping[str, np.ndarray]) -> bool:
    """Whether a rate of turn drives the model that the record does not hold, and of which it holds the integral."""
    missing = "r" not in columns or not np.isfinite(columns["r"]).any()
    wanted = "r" in instruments.model.inputs and "r" not in instruments.inputs and "r" not in instruments.lost
    return missing and wanted and "psi" in columns


def _sensor_table(
    instruments: Instruments, columns: Mapping[str, np.ndarray], record: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the sensors show, where they are read within their range, and how many samples were outside."""
    t, sensors = columns["t"], instruments.sensors
    z = np.column_stack([columns[_column(instruments, s, columns, record)] for s in sensors])
    there = np.isfinite(z)
    limited = np.zeros(len(sensors), dtype=int)
    for j, name in enumerate(sensors):
        if name in instruments.rates:
            there[:, j] = read_every(t, there[:, j], instruments.rates[name], name, record)
        if name in instruments.ranges:
            low, high = instruments.ranges[name]
            with np.errstate(invalid="ignore"):
                outside = there[:, j] & ((z[:, j] < low) | (z[:, j] > high))
            limited[j] = np.count_nonzero(outside)
            there[:, j] &= ~outside
    return z, there, limited


def _column(instruments: Instruments, name: str, columns: Mapping[str, np.ndarray], record: str) -> str:
    found = instruments.column_of(name, columns)
    if found is None:
        measures = instruments.model[name].quantity.measures
        what = f"'{name}'" + (f", which measures '{measures}'," if measures else "")
        raise NotMeasurableError(
            f"{what} is measured, and trial {record} has no such column. Its columns: {', '.join(columns)}."
        )
    return found


def _intervals(rows: np.ndarray, t: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the interval before each row; a pause longer than the longest one is shortened to it, whatever the clock says."""
    intervals = np.diff(rows, prepend=rows[0])
    gaps = np.diff(t, prepend=t[0])
    long = np.flatnonzero(gaps > LONGEST_GAP)
    if long.size:
        share = np.ones(rows.size)
        for k in long:
            share[at[k - 1] + 1 : at[k] + 1] = LONGEST_GAP / (t[k] - t[k - 1])
        intervals = intervals * share
    return intervals


def read_every(t: np.ndarray, there: np.ndarray, seconds: float, name: str, trial: str) -> np.ndarray:
    """Return which samples are read: the first that shows something in each interval, bool, shape (N,).

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times in s.
    there : ndarray of bool, shape (N,)
        Which samples show something.
    seconds : float
        Interval between those that are read.
    name, trial : str
        What is read, and of which record, for the message.

    Raises
    ------
    SensorRateError
        If the record is sampled less often.
    """
    sampling = float(np.median(np.diff(t))) if t.size > 1 else 0.0
    if seconds < 0.999 * sampling:
        raise SensorRateError(
            f"'{name}' is to be read every {seconds:g} s, and trial {trial} is sampled every {brief(sampling, 4)} s. Give an interval "
            "that is no shorter, or a record that is sampled finely enough."
        )
    # Half a sample of slack: clocks are not exact multiples of each other.
    shows = np.flatnonzero(there)
    number = np.floor((t[shows] - t[0] + 0.5 * sampling) / seconds)
    read = np.zeros(t.size, dtype=bool)
    read[shows[np.diff(number, prepend=-1) > 0]] = True
    return read


def _bridged(t: np.ndarray) -> np.ndarray:
    """Times of the samples, and between those that are far apart times no further apart than a few samples."""
    gaps = np.diff(t)
    typical = float(np.median(gaps)) if gaps.size else 0.0
    pieces = [t]
    for k in np.flatnonzero(gaps > LONGEST_STEP * typical):
        count = steps(min(gaps[k], LONGEST_GAP), typical)
        if count > 1:
            pieces.append(np.linspace(t[k], t[k + 1], count + 1)[1:-1])
    return np.unique(np.concatenate(pieces)) if len(pieces) > 1 else t
