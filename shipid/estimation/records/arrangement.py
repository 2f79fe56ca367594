"""From a trial to the controls of a filter: inputs, intervals, what each sensor shows and when it is there.

A gap is bridged in steps no longer than a few samples, so that the integration stays accurate; what becomes of time stamps that
cannot be right is told in `shipid.estimation.records.clock`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.errors import NotMeasurableError, SensorRateError
from shipid.estimation.records.clock import LONGEST_GAP, LONGEST_STEP, own_time, steps
from shipid.foundation.errors import UsageError


@dataclass(frozen=True, eq=False)
class Arrangement:
    """A record as the filter takes it: N rows, of which `shown` are samples and the others bridge gaps.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Time of each row in s; it runs on where the record's own clock was set back.
    intervals : ndarray, shape (N,)
        Time since the row before, in s; zero for the first.
    inputs : ndarray, shape (N, inputs)
    z : ndarray, shape (N, sensors)
        What the sensors show; zero where they show nothing.
    there : ndarray of bool, shape (N, sensors)
        Where they show something.
    lost : ndarray of bool, shape (N, inputs)
        Where an input is missing and its last value stands in.
    shown : ndarray of bool, shape (N,)
        Which rows are samples of the record.
    limited : ndarray of int, shape (sensors,)
        Samples left out because they are outside the sensor's range.
    forward : ndarray of bool, shape (samples,)
        Which samples of the record were let through; the others have a time stamp that cannot be right.
    """

    t: np.ndarray
    intervals: np.ndarray
    inputs: np.ndarray
    z: np.ndarray
    there: np.ndarray
    lost: np.ndarray
    shown: np.ndarray
    limited: np.ndarray
    forward: np.ndarray

    @property
    def back(self) -> int:
        """How many samples were left out because their time stamp cannot be right."""
        return int(np.count_nonzero(~self.forward))


def column_of(model: Model, name: str, columns: Collection[str]) -> str | None:
    """Return the column that holds what a sensor shows: its own name, or the quantity it measures; None if neither.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The measured quantity.
    columns : collection of str
        What the record has.
    """
    return next((n for n in (name, model[name].quantity.measures) if n and n in columns), None)


def arrange(
    model: Model,
    columns: Mapping[str, np.ndarray],
    record: str,
    sensors: tuple[str, ...],
    inputs: Mapping[str, float],
    needed: tuple[str, ...],
    every: Mapping[str, float],
    ranges: Mapping[str, tuple[float, float]],
    speed: float | None = None,
) -> Arrangement:
    """Arrange a trial for a filter.

    Parameters
    ----------
    model : Model
        The model.
    columns : mapping of str to ndarray
        The record, SI: ``t`` and what was sampled; NaN where a sample is missing.
    record : str
        Its name, for messages.
    sensors : tuple of str
        Measured quantities.
    inputs : mapping of str to float
        Constant values of inputs, SI; they go before the record's columns.
    needed : tuple of str
        Inputs without which nothing can be predicted.
    every : mapping of str to float
        Seconds between the samples a sensor uses, where it is read less often than the record is sampled.
    ranges : mapping of str to tuple of float
        Smallest and largest value a sensor can show, SI.
    speed : float, optional
        The ship's speed in m/s, where the record tells no speed.

    Raises
    ------
    NotMeasurableError
        If the record lacks a sensor or an input.
    SensorRateError
        If a sensor is to be read more often than the record is sampled.
    UsageError
        If its time stamps cannot be used.
    """
    forward, t = own_time(columns["t"])
    if not t.size or (t.size == 1 < forward.size):
        raise UsageError(
            f"the times 't' of record {record} do not run forward: of {forward.size} stamps {t.size} can be used. They are in s, "
            f"rise, and lie no more than {LONGEST_GAP:g} s apart."
        )
    columns = {n: np.asarray(c, dtype=float)[forward] for n, c in columns.items()} | {"t": t}
    z = np.column_stack([columns[_column(model, s, columns, record)] for s in sensors])
    there = np.isfinite(z)
    limited = np.zeros(len(sensors), dtype=int)
    for j, name in enumerate(sensors):
        if name in every:
            there[:, j] = read_every(t, there[:, j], every[name], name, record)
        if name in ranges:
            low, high = ranges[name]
            with np.errstate(invalid="ignore"):
                outside = there[:, j] & ((z[:, j] < low) | (z[:, j] > high))
            limited[j] = np.count_nonzero(outside)
            there[:, j] &= ~outside
    table = input_table(model, columns, record, inputs, needed, speed)
    lost = ~np.isfinite(table)
    table = _held(table)
    rows = _bridged(t)
    shown = np.zeros(rows.size, dtype=bool)
    shown[np.searchsorted(rows, t)] = True
    at = np.searchsorted(rows, t)
    full_z, full_there = np.zeros((rows.size, len(sensors))), np.zeros((rows.size, len(sensors)), dtype=bool)
    full_z[at], full_there[at] = np.where(there, z, 0.0), there
    full_inputs = (
        np.column_stack([np.interp(rows, t, c) for c in table.T]) if table.shape[1] else np.empty((rows.size, 0))
    )
    # Rows that bridge a gap belong to the sample that ends it.
    full_lost = lost[np.searchsorted(t, rows)]
    gaps = np.minimum(np.diff(t, prepend=t[0]), LONGEST_GAP)
    intervals = np.diff(rows, prepend=rows[0])
    # A pause longer than the longest one is shortened to it, whatever the clock says.
    long = np.diff(t, prepend=t[0]) > LONGEST_GAP
    if long.any():
        share = np.ones(rows.size)
        for k in np.flatnonzero(long):
            share[at[k - 1] + 1 : at[k] + 1] = gaps[k] / (t[k] - t[k - 1])
        intervals = intervals * share
    return Arrangement(rows, intervals, full_inputs, full_z, full_there, full_lost, shown, limited, forward)


def _column(model: Model, name: str, columns: Mapping[str, np.ndarray], record: str) -> str:
    found = column_of(model, name, columns)
    if found is None:
        measures = model[name].quantity.measures
        what = f"'{name}'" + (f", which measures '{measures}'," if measures else "")
        raise NotMeasurableError(
            f"{what} is measured, and trial {record} has no such column. Its columns: {', '.join(columns)}."
        )
    return found


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
            f"'{name}' is to be read every {seconds:g} s, and trial {trial} is sampled every {sampling:.4g} s. Give an interval "
            "that is no shorter, or a record that is sampled finely enough."
        )
    # Half a sample of slack: clocks are not exact multiples of each other.
    shows = np.flatnonzero(there)
    number = np.floor((t[shows] - t[0] + 0.5 * sampling) / seconds)
    read = np.zeros(t.size, dtype=bool)
    read[shows[np.diff(number, prepend=-1) > 0]] = True
    return read


def input_table(
    model: Model,
    columns: Mapping[str, np.ndarray],
    record: str,
    inputs: Mapping[str, float],
    needed: tuple[str, ...],
    speed: float | None = None,
) -> np.ndarray:
    """Return the inputs of a model along a record, SI, shape (N, inputs).

    Parameters
    ----------
    model, columns, record, inputs, needed, speed
        See `arrange`.
    """
    table = np.empty((columns["t"].size, len(model.inputs)))
    for i, name in enumerate(model.inputs):
        default = model[name].number("default")
        if name in inputs:
            table[:, i] = inputs[name]
        elif name in columns:
            table[:, i] = columns[name]
        elif name == "cruise" and "u" in columns:
            table[:, i] = np.nanmedian(columns["u"][:10])
        elif name in ("cruise", "u") and speed is not None:
            table[:, i] = speed
        elif default is not None or name not in needed:
            table[:, i] = 0.0 if default is None else default
        else:
            raise NotMeasurableError(
                f"model {model.name} reads '{name}' ({model[name].quantity.meaning}), which trial {record} does not "
                f"record. Give it, as in inputs={{'{name}': ...}}. The trial's columns: {', '.join(columns)}."
            )
    return table


def _held(table: np.ndarray) -> np.ndarray:
    """Let the last value stand in where one is missing; the first one before it, zero where there is none."""
    finite = np.isfinite(table)
    if finite.all():
        return table
    index = np.where(finite, np.arange(len(table))[:, None], -1)
    index = np.maximum.accumulate(index, axis=0)
    first = np.argmax(finite, axis=0)
    index = np.where(index < 0, first[None, :], index)
    held = np.take_along_axis(table, index, axis=0)
    return np.where(np.isfinite(held), held, 0.0)


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
