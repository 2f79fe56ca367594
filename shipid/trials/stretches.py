"""Stretches of a record in which the inputs of a model are whole.

A model can be run past a sample that is missing from what it predicts, and not past one that is missing from what drives it.
Between its samples an input follows a stated rule: an order is held, a feedback runs in a straight line, over holes no longer than
`shipid.trials.filling.GAP` times its own usual interval. A longer hole splits the record: what happened in it is not known, and
the model starts anew behind it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.foundation.numbers import brief, moment
from shipid.trials.checks import FEWEST_SAMPLES
from shipid.trials.errors import NoStretchError
from shipid.trials.filling import GAP, held, interpolated, usual_interval
from shipid.trials.speed import speed_before_in
from shipid.trials.trial import Trial


def is_order(name: str) -> bool:
    """Return whether an input is an order, which holds until the next one: revolutions, and every name that ends in ``_order``.

    Parameters
    ----------
    name : str
        The input.
    """
    return name == "n" or name.endswith("_order")


#: How the notes begin that say what was filled and left out.
_FILLED, _SPLIT, _SHORT, _LEFT = "Filled input ", "Holes in ", "Too short between holes: ", "Rows of the record: "


def is_note(text: str) -> bool:
    """Return whether a note of a trial's source says what was filled and left out for the sake of its inputs.

    Parameters
    ----------
    text : str
        The note.
    """
    return text.startswith((_FILLED, _SPLIT, _SHORT, _LEFT))


def is_split(text: str) -> bool:
    """Return whether a note of a trial's source says that holes split its record, and into which stretches.

    Parameters
    ----------
    text : str
        The note.
    """
    return text.startswith(_SPLIT)


@dataclass(frozen=True, eq=False)
class FilledInput:
    """An input between its samples; N rows.

    Attributes
    ----------
    values : ndarray, shape (N,)
        By the rule; NaN where it does not reach.
    filled : int
        Rows between samples that the rule reaches.
    begins : ndarray of int
        Rows at which the samples go on behind a hole.
    """

    values: np.ndarray
    filled: int
    begins: np.ndarray


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
    """
    there = np.flatnonzero(np.isfinite(column))
    values = (held if order else interpolated)(t, column) if there.size < t.size else column
    usual = usual_interval(t[there])
    behind = there[1:][np.diff(t[there]) > GAP * usual] if there.size > 1 else there[:0]
    return FilledInput(values, int(np.isfinite(values).sum() - there.size), behind)


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
        known &= np.isfinite(one.values)
        begins[one.begins] = 1
    labels = np.where(known, np.cumsum(begins), -1)
    labels[known] = np.unique(labels[known], return_inverse=True)[1]
    return labels


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
    if not labels.any() and not any(one.filled for one in found.values()):
        return (trial,)
    spans = [np.flatnonzero(labels == k) for k in range(labels.max() + 1)]
    kept = [rows for rows in spans if rows.size >= FEWEST_SAMPLES and t[rows[-1]] - t[rows[0]] >= least]
    if not kept:
        raise _no_stretch(trial, inputs, spans, least)
    table = trial.table.assign(**{n: one.values for n, one in found.items()})
    before = _speed_before(trial, unit_time) if labels.any() else None
    if before is not None:
        table = table.assign(cruise=before)
    source = replace(trial.source, notes=(*trial.source.notes, *_notes(trial, found, spans, kept)))
    whole = replace(trial, table=table, source=source)
    return tuple(_cut(whole, rows, named=len(kept) > 1) for rows in kept)


def _cut(trial: Trial, rows: np.ndarray, named: bool) -> Trial:
    t = trial["t"]
    cut = trial.window(float(t[rows[0]]), float(t[rows[-1]])) if named else trial
    return cut if len(cut) == rows.size else replace(cut, table=trial.table.iloc[rows].reset_index(drop=True))


def _speed_before(trial: Trial, unit_time: float | None) -> float | None:
    if trial.has("cruise"):
        return None
    found = speed_before_in({n: trial[n] for n in trial.table.columns}, unit_time)
    return None if found is None else found.value


def _notes(trial: Trial, found: dict[str, FilledInput], spans: list[np.ndarray], kept: list[np.ndarray]) -> list[str]:
    """What was filled, and what was left out, in words."""
    t, notes = trial["t"], []
    for name, one in found.items():
        if one.filled:
            how = "held" if is_order(name) else "interpolated"
            samples = np.count_nonzero(np.isfinite(trial[name]))
            notes.append(f"{_FILLED}{name}: {how} between its {samples} samples, in {one.filled} of {len(trial)} rows.")
    names = ", ".join(found)
    if len(spans) > 1:
        notes.append(
            f"{_SPLIT}{names} split the record; {len(kept)} stretches are used, each with an initial state of its own: "
            f"{_listed(t, kept)}."
        )
    if len(kept) < len(spans):
        short = [rows for rows in spans if not any(rows is k for k in kept)]
        notes.append(f"{_SHORT}{len(short)} stretches are left out, {_listed(t, short)}.")
    left = len(trial) - sum(rows.size for rows in kept)
    if left:
        notes.append(
            f"{_LEFT}{len(trial)}, of which {len(trial) - left} are used; in {left} {names} is not known, or for too short a time."
        )
    return notes


def _listed(t: np.ndarray, spans: list[np.ndarray]) -> str:
    """Stretches by their times; the first of many."""
    parts = [f"{moment(t[rows[0]])} to {moment(t[rows[-1]])} s" for rows in spans[:6]]
    return ", ".join(parts) + (f" and {len(spans) - 6} more" if len(spans) > 6 else "")


def _no_stretch(trial: Trial, inputs: Sequence[str], spans: list[np.ndarray], least: float) -> NoStretchError:
    t = trial["t"]
    longest = max((float(t[rows[-1]] - t[rows[0]]) for rows in spans), default=0.0)
    counts = ", ".join(f"{n} {np.count_nonzero(np.isfinite(trial[n]))}" for n in inputs)
    wanted = f"{FEWEST_SAMPLES} samples" + (f" and {brief(least, 3)} s" if least else "")
    return NoStretchError(
        f"trial '{trial.name}': what drives the model has too many holes. The longest stretch without one lasts {brief(longest, 3)} s, "
        f"and at least {wanted} are needed. Samples there in {len(trial)} rows: {counts}. A hole of more than {GAP:g} usual "
        "intervals of a column is not filled: use a log in which it is recorded."
    )
