"""Signals with clocks of their own, in one table: each at its own stamps, or interpolated onto one clock."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.foundation.numbers import brief, counted
from shipid.trials.filling import GAP

TOGETHER = 0.02
"""Stamps that follow each other by less than this share of the shortest usual interval are one row of the table."""
COVERAGE = 0.9
"""A signal that covers less of heading and rudder is left out, so that it does not cost the others their samples."""


@dataclass(frozen=True, eq=False)
class Signal:
    """What one source says, in SI units, before it has the clock of the trial.

    Attributes
    ----------
    name : str
        As in `shipid.trials.logs.nmea.settings.SIGNALS`.
    t : ndarray, shape (n,)
        Time [s], strictly increasing.
    values : ndarray, shape (n, k)
        What can be interpolated linearly: unwrapped angles, components of vectors.
    notes : tuple of str
        Where it comes from and what was converted.
    origin : tuple of float or None
        Of positions: latitude and longitude in rad of the place from which they count.
    """

    name: str
    t: np.ndarray
    values: np.ndarray
    notes: tuple[str, ...] = ()
    origin: tuple[float, float] | None = None

    @property
    def interval(self) -> float:
        """Median interval [s]."""
        return float(np.median(np.diff(self.t)))


#: Times [s] and values of a column, shapes (n,).
Channel = tuple[np.ndarray, np.ndarray]


def united(channels: Mapping[str, Channel]) -> tuple[np.ndarray, dict[str, np.ndarray], list[str]]:
    """Put channels that keep their own clocks into one table: the union of their stamps, NaN where a channel has no sample.

    Stamps that are less than `TOGETHER` of the shortest usual interval behind the first one of a row belong to it.

    Parameters
    ----------
    channels : Mapping of str to (ndarray, ndarray)
        Times [s], strictly increasing, and values.

    Returns
    -------
    t : ndarray, shape (m,)
        The first stamp of each row [s].
    columns : dict of str to ndarray, shape (m,)
        The channels.
    notes : list of str
        The rule, where it is needed, and the samples that have no row of their own.
    """
    stamps = np.unique(np.concatenate([t for t, _ in channels.values()]))
    together = TOGETHER * min(float(np.median(np.diff(t))) for t, _ in channels.values())
    # A run of stamps close together is cut into rows of that length.
    run = np.append(True, np.diff(stamps) > together)
    place = np.floor((stamps - stamps[run][np.cumsum(run) - 1]) / together)
    first = run | np.append(True, np.diff(place) != 0)
    row = np.cumsum(first) - 1
    columns, notes = {}, []
    for name, (t, values) in channels.items():
        columns[name] = np.full(int(first.sum()), np.nan)
        at = row[np.searchsorted(stamps, t)]
        columns[name][at] = values
        if twice := int(np.sum(np.diff(at) == 0)):
            notes.append(
                f"{counted(twice, 'sample')} of {name} within {brief(together, 2)} s of the next one left out."
            )
    if any(np.isnan(column).any() for column in columns.values()):
        notes.insert(
            0,
            f"Each signal keeps its own clock: a row is a stamp of any of them (stamps within {brief(together, 2)} s are one), and a "
            "signal is missing where it has no sample.",
        )
    return stamps[first], columns, notes


def resample(
    signals: Mapping[str, Signal], leading: Sequence[str], step: float, gap: float | None
) -> tuple[np.ndarray, dict[str, np.ndarray], list[str]]:
    """Interpolate signals linearly onto multiples of one interval, never across a gap and never beyond their ends.

    Parameters
    ----------
    signals : Mapping of str to Signal
        By name.
    leading : sequence of str
        The signals without which there is no trial: they say how long it is.
    step : float
        Sampling interval [s].
    gap : float or None
        Longest interval of a signal to interpolate across [s]; None is `shipid.trials.filling.GAP` of the signal's own
        intervals or of the trial's, whichever is longer.

    Returns
    -------
    t : ndarray, shape (m,)
        Multiples of `step` at which every signal is known; empty where the leading ones do not overlap.
    values : dict of str to ndarray, shape (m, k)
        The signals that were kept.
    notes : list of str
        What was left out.
    """
    begin = max(signals[name].t[0] for name in leading)
    end = min(signals[name].t[-1] for name in leading)
    grid = np.arange(int(np.ceil(begin / step - 1e-6)), int(np.floor(end / step + 1e-6)) + 1) * step
    notes: list[str] = []
    limits = {n: gap or GAP * max(s.interval, step) for n, s in signals.items()}
    known = {n: _known(grid, s.t, limits[n]) for n, s in signals.items()}
    keep = np.all([known[name] for name in leading], axis=0) if grid.size else np.zeros(0, dtype=bool)
    kept = list(leading)
    for name in signals:
        if name in leading or not keep.any():
            continue
        share = float(known[name][keep].mean())
        if share >= COVERAGE:
            kept.append(name)
        else:
            notes.append(
                f"WARNING: {name} was left out: it is known for {100 * share:.0f} % of the time only (gaps of more than "
                f"{brief(limits[name], 3)} s are not interpolated)."
            )
    whole = np.all([known[name] for name in kept], axis=0) if grid.size else keep
    for name in kept:
        inside = (grid >= signals[name].t[0]) & (grid <= signals[name].t[-1])
        lost = int((inside & ~known[name]).sum())
        if lost:
            notes.append(
                f"{counted(lost, 'sample was', 'samples were')} left out because {name} has gaps of more than {brief(limits[name], 3)} s, which are not "
                "interpolated."
            )
    t = grid[whole]
    values = {
        name: np.column_stack([np.interp(t, signals[name].t, column) for column in signals[name].values.T])
        for name in kept
    }
    return t, values, notes


def _known(grid: np.ndarray, t: np.ndarray, limit: float) -> np.ndarray:
    """Whether each instant lies on a sample, or between two that are no further apart than the limit."""
    slack = 1e-6 * limit
    at = np.clip(np.searchsorted(t, grid, side="right") - 1, 0, len(t) - 2)
    inside = (grid >= t[0] - slack) & (grid <= t[-1] + slack)
    on = (np.abs(grid - t[at]) <= slack) | (np.abs(grid - t[at + 1]) <= slack)
    return np.asarray(inside & ((t[at + 1] - t[at] <= limit + slack) | on))
