"""Residuals of a trial as series without holes, for their spectrum.

Signals of a regular trial are one series, sample by sample; of long records several samples in a row are taken together. Where
samples are missing, or signals keep their own clocks, those that are near each other make one entry of the series, at least one
sample of each signal: correlations from entry to entry are those of the noise as it was sampled. What a signal shows in a hole of
another, and a signal that is sampled much less often, are series of their own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.identification.problem.trial_data import TrialData
from shipid.trials.filling import interpolated

#: Samples of a record that are enough for its spectrum: of longer ones several in a row are taken together, which loses nothing
#: at the frequencies at which a ship answers.
_ENOUGH = 1000
#: A signal whose usual interval is this many times the median one of all has a series of its own.
_SLOW = 3.0


@dataclass(frozen=True, eq=False)
class ResidualGroup:
    """Signals of one trial in one series; N entries.

    Attributes
    ----------
    trial : int
        Which trial.
    signals : tuple of int
        Which signals.
    residual : ndarray, shape (signals, N)
        Weighted residuals.
    jacobian : ndarray, shape (signals, N, used unknowns)
        Their derivatives.
    powers : ndarray, shape (signals,)
        Mean squares of the residuals, sample by sample.
    used : ndarray of int
        Unknowns that the trial depends on.
    """

    trial: int
    signals: tuple[int, ...]
    residual: np.ndarray
    jacobian: np.ndarray
    powers: np.ndarray
    used: np.ndarray


def groups_of(
    data: TrialData, trial: int, residual: np.ndarray, jacobian: np.ndarray, used: np.ndarray
) -> list[ResidualGroup]:
    """Return the residuals of a trial in series.

    Parameters
    ----------
    data : TrialData
        The trial.
    trial : int
        Its number.
    residual : ndarray, shape (signals, N)
        Weighted residuals; zero where a sample is missing.
    jacobian : ndarray, shape (signals, N, used unknowns)
        Their derivatives; zero where a sample is missing.
    used : ndarray of int
        Unknowns that the trial depends on.
    """
    signals = tuple(range(len(residual)))
    if data.regular:
        entries = [(signals, residual, jacobian)]
    else:
        entries = [(rows, *_series(cells, residual[list(rows)], jacobian[list(rows)])) for rows, cells in _cells(data)]
    counts = data.there.sum(axis=1)
    powers = np.where(counts > 0, (residual**2).sum(axis=1) / np.maximum(counts, 1), 1.0)
    groups = []
    for rows, errors, slopes in entries:
        every = max(1, errors.shape[1] // _ENOUGH)
        groups.append(
            ResidualGroup(trial, rows, gathered(errors, every), gathered(slopes, every), powers[list(rows)], used)
        )
    return groups


def _cells(data: TrialData) -> list[tuple[tuple[int, ...], np.ndarray]]:
    """Series by their signals: the number of the entry that each sample belongs to, -1 for none, shape (signals, N)."""
    shown = [j for j, there in enumerate(data.there) if there.any()]
    steps = {j: data.step_of(j) for j in shown}
    usual = sorted(steps.values())[(len(steps) - 1) // 2] if steps else 0.0
    together = [j for j in shown if steps[j] < _SLOW * usual]
    series, alone = [], {j: data.there[j] for j in shown if j not in together}
    if len(together) > 1:
        # Outside its samples, and in a hole, a signal is not near the others.
        near = np.all([np.isfinite(interpolated(data.t, data.measured[j])) for j in together], axis=0)
        there = data.there[together] & near
        if there.any(axis=1).all():
            series.append((tuple(together), _numbered(data.t, there)))
        else:
            near = np.zeros_like(near)
        alone |= {j: data.there[j] & ~near for j in together}
    else:
        alone |= {j: data.there[j] for j in together}
    for j, there in sorted(alone.items()):
        if there.any():
            series.append(((j,), np.where(there, np.cumsum(there) - 1, -1)[None]))
    return series


def _numbered(t: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Entries around the samples of the signal that has the fewest; one that lacks a signal is joined to the next."""
    anchors = t[there[np.argmin(there.sum(axis=1))]]
    cell = np.searchsorted(0.5 * (anchors[1:] + anchors[:-1]), t)
    full = np.ones(anchors.size, dtype=bool)
    for row in there:
        full &= np.bincount(cell[row], minlength=anchors.size) > 0
    number = np.cumsum(full) - full
    last = max(int(np.count_nonzero(full)) - 1, 0)
    return np.where(there, np.minimum(number, last)[cell], -1)


def _series(cells: np.ndarray, residual: np.ndarray, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sums of the samples of each entry, scaled as by `gathered`."""
    errors, slopes = [], []
    for cell, row, slope in zip(cells, residual, jacobian):
        own = cell >= 0
        _, starts, counts = np.unique(cell[own], return_index=True, return_counts=True)
        root = np.sqrt(counts)
        errors.append(np.add.reduceat(row[own], starts) / root)
        slopes.append(np.add.reduceat(slope[own], starts, axis=0) / root[:, None])
    return np.array(errors), np.array(slopes)


def gathered(rows: np.ndarray, every: int) -> np.ndarray:
    """Return sums of so many samples in a row, along the second axis, scaled to the same sum of products.

    Parameters
    ----------
    rows : ndarray, shape (signals, N, ...)
        Samples along the second axis.
    every : int
        How many are taken together.
    """
    if every == 1:
        return rows
    starts = np.arange(0, rows.shape[1], every)
    counts = np.diff(starts, append=rows.shape[1])
    sums = np.add.reduceat(rows, starts, axis=1)
    return np.asarray(sums / np.sqrt(counts).reshape(1, -1, *(1,) * (rows.ndim - 2)))
