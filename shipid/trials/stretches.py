"""Stretches of a record in which the inputs of a model are whole.

A model can be run past a sample that is missing from what it predicts, and not past one that is missing from what drives it.
Between its samples an input follows a stated rule: an order is held, a feedback runs in a straight line, over holes no longer than
`shipid.trials.checks.GAP` times its own usual interval. A longer hole splits the record: what happened in it is not known, and
the model starts anew behind it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.trials.checks import FEWEST_SAMPLES, GAP, usual_interval
from shipid.trials.errors import NoStretchError
from shipid.trials.speed import speed_before
from shipid.trials.trial import Trial


def is_order(name: str) -> bool:
    """Return whether an input is an order, which holds until the next one: revolutions, and every name that ends in ``_order``.

    Parameters
    ----------
    name : str
        The input.
    """
    return name == "n" or name.endswith("_order")


@dataclass(frozen=True, eq=False)
class FilledInput:
    """An input between its samples; N rows.

    Attributes
    ----------
    values : ndarray, shape (N,)
        By the rule; NaN where it does not reach.
    known : ndarray of bool, shape (N,)
        Where it reaches.
    filled : int
        Rows between samples.
    breaks : ndarray of int
        Samples after which there is a hole that is too long, as indices of rows.
    """

    values: np.ndarray
    known: np.ndarray
    filled: int
    breaks: np.ndarray


def fill_input(t: np.ndarray, column: np.ndarray, order: bool) -> FilledInput:
    """Fill an input between its samples.

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times in s, rising.
    column : ndarray, shape (N,)
        The input; NaN where it has no sample.
    order : bool
        Whether it is held; otherwise it runs in a straight line.

    Returns
    -------
    FilledInput
        Before the first sample, and after the last, the rule reaches one usual interval.
    """
    there = np.flatnonzero(np.isfinite(column))
    if not there.size:
        return FilledInput(np.full(t.size, np.nan), np.zeros(t.size, dtype=bool), 0, there)
    own = t[there]
    usual = usual_interval(own)
    # A whole number of intervals is not one more by rounding.
    long = np.diff(own) > GAP * usual * (1 + 1e-9)
    known = np.ones(t.size, dtype=bool)
    known[(t < own[0] - usual) | (t > own[-1] + usual)] = False
    if there.size < t.size:
        before = np.searchsorted(there, np.arange(t.size), side="right") - 1
        inside = (before >= 0) & (before < there.size - 1)
        known[inside] &= ~long[before[inside]] | (there[before[inside]] == np.flatnonzero(inside))
        values = column[there[np.maximum(before, 0)]] if order else np.interp(t, own, column[there])
        values = np.where(known, values, np.nan)
    else:
        values = column
    return FilledInput(values, known, int(known.sum() - there.size), there[:-1][long])


def stretch_labels(filled: Sequence[FilledInput], count: int) -> np.ndarray:
    """Return for each row the number of its stretch, -1 where an input is not known, shape (count,).

    Parameters
    ----------
    filled : sequence of FilledInput
        The inputs; none makes one stretch.
    count : int
        Number of rows.
    """
    known, begins = np.ones(count, dtype=bool), np.zeros(count, dtype=int)
    for one in filled:
        known &= one.known
        begins[one.breaks + 1] = 1
    return np.where(known, np.unique(np.cumsum(begins), return_inverse=True)[1], -1)


def stretches_of(
    trial: Trial, inputs: Sequence[str], *, least: float = 0.0, unit_time: float | None = None
) -> tuple[Trial, ...]:
    """Return the stretches of a trial in which its inputs are whole.

    Parameters
    ----------
    trial : Trial
        The trial.
    inputs : sequence of str
        Columns that have to be whole: what drives a model.
    least : float
        A stretch that is shorter, in s, is left out.
    unit_time : float, optional
        L/U in s, for the speed before the manoeuvre.

    Returns
    -------
    tuple of Trial
        The trial itself where nothing is missing from the inputs. Otherwise each stretch with its inputs filled, and notes on what
        was filled and left out; where there are several, each has the speed before the manoeuvre of the whole trial as a
        column ``cruise``, and its own seconds in its name.

    Raises
    ------
    NoStretchError
        If no stretch is long enough.
    """
    t = trial["t"]
    found = {n: fill_input(t, trial[n], is_order(n)) for n in inputs}
    labels = stretch_labels(list(found.values()), len(trial))
    if not any(one.filled for one in found.values()) and not labels.any():
        return (trial,)
    numbers = [k for k in range(labels.max(initial=-1) + 1) if np.any(labels == k)]
    spans = {k: np.flatnonzero(labels == k) for k in numbers}
    kept = {
        k: rows for k, rows in spans.items() if rows.size >= FEWEST_SAMPLES and t[rows[-1]] - t[rows[0]] >= least
    }
    if not kept:
        raise _no_stretch(trial, inputs, t, list(spans.values()), least)
    notes = [*trial.source.notes, *_notes(trial, found, t, spans, kept)]
    table = trial.table.assign(**{n: one.values for n, one in found.items()})
    several = len(kept) > 1 or next(iter(kept.values())).size < len(trial)
    before = _speed_before(trial, unit_time) if several else None
    if before is not None:
        table = table.assign(cruise=before)
    source = replace(trial.source, notes=tuple(notes))
    whole = replace(trial, table=table, source=source)
    if not several:
        return (whole,)
    return tuple(_cut(whole, rows) for rows in kept.values())


def _cut(trial: Trial, rows: np.ndarray) -> Trial:
    t = trial["t"]
    stretch = trial.window(float(t[rows[0]]), float(t[rows[-1]]))
    return replace(stretch, table=trial.table.iloc[rows].reset_index(drop=True))


def _speed_before(trial: Trial, unit_time: float | None) -> float | None:
    speed = next((trial[n] for n in ("u", "U") if trial.has(n)), None)
    if speed is None or trial.has("cruise"):
        return None
    found = speed_before(trial["t"], speed, trial["delta"] if trial.has("delta") else None, unit_time)
    return None if found is None else found.value


def _notes(
    trial: Trial,
    found: dict[str, FilledInput],
    t: np.ndarray,
    spans: dict[int, np.ndarray],
    kept: dict[int, np.ndarray],
) -> list[str]:
    """What was filled, and what was left out, in words."""
    notes = []
    for name, one in found.items():
        if one.filled:
            how = "held" if is_order(name) else "interpolated"
            samples = np.count_nonzero(np.isfinite(trial[name]))
            notes.append(f"{name}: {how} between its {samples} samples, in {one.filled} of {len(trial)} rows")
    if len(kept) > 1 or len(spans) > 1:
        parts = ", ".join(f"{t[rows[0]]:.5g} to {t[rows[-1]]:.5g} s" for rows in kept.values())
        notes.append(f"{', '.join(found)}: holes too long to fill; stretches that are used: {parts}")
    short = [rows for k, rows in spans.items() if k not in kept]
    if short:
        parts = ", ".join(f"{t[rows[0]]:.5g} to {t[rows[-1]]:.5g} s" for rows in short[:3]) + (
            ", ..." if len(short) > 3 else ""
        )
        notes.append(f"{len(short)} stretches between holes are too short and left out ({parts})")
    left = len(trial) - sum(rows.size for rows in kept.values())
    if left:
        notes.append(f"{len(trial)} rows, {len(trial) - left} used: {left} lie in holes of {', '.join(found)} or beside them")
    return notes


def _no_stretch(
    trial: Trial, inputs: Sequence[str], t: np.ndarray, spans: list[np.ndarray], least: float
) -> NoStretchError:
    longest = max((float(t[rows[-1]] - t[rows[0]]) for rows in spans), default=0.0)
    counts = ", ".join(f"{n} {np.count_nonzero(np.isfinite(trial[n]))} of {len(trial)}" for n in inputs)
    wanted = f"{FEWEST_SAMPLES} samples" + (f" and {least:.3g} s" if least else "")
    return NoStretchError(
        f"trial '{trial.name}': what drives the model has too many holes. The longest stretch without one lasts {longest:.3g} s, "
        f"and at least {wanted} are needed (samples there: {counts}). A hole of more than {GAP:g} usual intervals of a column is "
        "not filled: use a log in which it is recorded, or another column."
    )
