"""Where a trial begins: a first guess of each initial state from the samples that are there, and how far it may be off."""

from __future__ import annotations

import numpy as np

from shipid.declaration.model import Model
from shipid.trials.trial import Trial


def first_guess(
    model: Model, trial: Trial, whole: Trial, name: str, before: float | None, first: int
) -> tuple[float, float]:
    """Return a first guess of one initial state and its standard error.

    A straight line through the first samples that are there, or the sample of the whole record that is nearest to the
    beginning. By the time that lies between, the state has gone on, nobody knows where to: as fast as it ever does.

    Parameters
    ----------
    model : Model
        The model.
    trial, whole : Trial
        The trial, and the record of which it is a stretch (itself, where it is none).
    name : str
        The state.
    before : float or None
        The speed before the manoeuvre in m/s, where it is known.
    first : int
        How many rows make the first seconds.

    Returns
    -------
    tuple of float
        The guess and its standard error, SI. Zero where nothing shows the state: what is believed of it then is not for here.
    """
    t, column = trial["t"], trial[name] if trial.has(name) else np.zeros(0)
    samples = np.flatnonzero(np.isfinite(column))
    count = max(int(np.searchsorted(samples, first)), min(4, samples.size))
    # Of a slow signal the first few, as long as they are near the beginning.
    over = float(t[first - 1] - t[0])
    at = samples[:count][t[samples[:count]] <= t[0] + 4 * over]
    if len(at) >= 4:
        design = np.column_stack([np.ones(len(at)), t[at] - t[0]])
        found, *_ = np.linalg.lstsq(design, column[at], rcond=None)
        scatter = float(np.std(column[at] - design @ found)) * np.sqrt(len(at) / (len(at) - 2))
        error = float(scatter * np.sqrt(np.linalg.inv(design.T @ design)[0, 0]))
        late = t[at[0]] - t[0]
        return float(found[0]), float(np.hypot(error, _fastest(whole, name, over) * late)) if late else error
    if whole.has(name) and np.isfinite(record := whole[name]).any():
        known = np.isfinite(record)
        distance = np.abs(whole["t"][known] - t[0])
        near = int(np.argmin(distance))
        away = float(distance[near])
        return float(record[known][near]), _fastest(whole, name, over) * away if away else 0.0
    if name == "u" and before is not None:
        return before, 0.0
    return model[name].number("start") or 0.0, 0.0


def _fastest(trial: Trial, name: str, over: float) -> float:
    """How fast a signal changes over a time of `over` s, at the most but for one time in twenty; over less, noise would count."""
    t, column = trial["t"], trial[name]
    known = np.isfinite(column)
    t, column = t[known], column[known]
    later = np.searchsorted(t, t + over)
    there = later < t.size
    if not there.any():
        return 0.0
    at = later[there]
    return float(np.percentile(np.abs((column[at] - column[there]) / (t[at] - t[there])), 95))
