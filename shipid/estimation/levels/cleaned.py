"""A record without its wild samples, in pieces: what noise levels are learnt from."""

from __future__ import annotations

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import FilterRecord, columns_of
from shipid.trials.speed import speed_before_in

#: A sample so many robust standard deviations off the median of seven is wild, if it is also so many times the standard level off.
_WILD, _LEVELS = 10.0, 5.0
_NORMAL, _WIDE = 1.4826, 7
#: Longer records are learnt from in so many pieces of so many samples, evenly spaced.
_PIECES, _SAMPLES = 6, 1000


def cleaned(design: FilterDesign, record: FilterRecord) -> dict[str, np.ndarray]:
    """Return the columns of a record, SI, with NaN where a sensor shows a wild value.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    """
    columns, _ = columns_of(record)
    result = dict(columns)
    for name, level in zip(design.measured, design.r):
        column = design.instruments.column_of(name, columns)
        if column is not None:
            values = columns[column].copy()
            values[wild(values, float(level))] = np.nan
            result[column] = values
    if "cruise" in design.model.inputs and "cruise" not in result:
        # Each piece of the record belongs to the speed before the manoeuvre of the whole.
        before = speed_before_in(result, design.instruments.scale.unit_time)
        if before is not None and "cruise" not in design.instruments.inputs:
            result["cruise"] = np.full(columns["t"].shape, before.value)
    return result


def wild(values: np.ndarray, level: float) -> np.ndarray:
    """Return which values stand off their neighbours, bool, shape (N,).

    Parameters
    ----------
    values : ndarray, shape (N,)
        A sensor; NaN where a sample is missing.
    level : float
        Its usual standard deviation.
    """
    there = np.flatnonzero(np.isfinite(values))
    found = np.zeros(values.size, dtype=bool)
    if there.size < _WIDE:
        return found
    shown = values[there]
    # Mirrored at its ends, so that a wild first sample is alone among its neighbours.
    around = np.lib.stride_tricks.sliding_window_view(np.pad(shown, _WIDE // 2, mode="reflect"), _WIDE)
    off = np.abs(shown - np.median(around, axis=1))
    found[there[off > np.maximum(_WILD * _NORMAL * np.median(off), _LEVELS * level)]] = True
    return found


def pieces(columns: dict[str, np.ndarray]) -> list[dict[str, np.ndarray]]:
    """Return a record in the pieces that levels are learnt from: whole where it is short.

    Parameters
    ----------
    columns : dict of str to ndarray
        SI.
    """
    count = columns["t"].size
    if count <= _PIECES * _SAMPLES:
        return [columns]
    starts = np.linspace(0, count - _SAMPLES, _PIECES).astype(int)
    return [{n: c[a : a + _SAMPLES] for n, c in columns.items()} for a in starts]


def resolution(values: np.ndarray) -> float:
    """Return the step in which a sensor shows its values; 0 for fewer than two different ones.

    Parameters
    ----------
    values : ndarray
        What it shows.
    """
    steps = np.diff(np.unique(values[np.isfinite(values)]))
    steps = steps[steps > 1e-9 * steps.max(initial=0.0)]
    return float(steps.min()) if steps.size else 0.0
