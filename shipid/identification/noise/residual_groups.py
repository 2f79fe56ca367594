"""Residuals of a trial at regular times, for their spectrum: several samples in a row are taken together.

Signals that keep their own clocks, and signals with holes, are laid on a common grid; where a signal has no sample the grid has
none. A signal that is sampled much less often than the others has a grid of its own, and its correlation with them is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.identification.problem.trial_data import TrialData

#: Samples of a record that are enough for its spectrum: of longer ones several in a row are taken together, which loses nothing
#: at the frequencies at which a ship answers.
_ENOUGH = 1000
#: Share of the times of a grid at which a signal has a sample, if it is to be on it.
_ON_THE_GRID = 0.4


@dataclass(frozen=True, eq=False)
class ResidualGroup:
    """Signals of one trial on one grid; N times.

    Attributes
    ----------
    trial : int
        Which trial.
    signals : tuple of int
        Which signals.
    residual : ndarray, shape (signals, N)
        Weighted residuals; zero where a sample is missing.
    jacobian : ndarray, shape (signals, N, used unknowns)
        Their derivatives; zero where a sample is missing.
    there : ndarray of bool, shape (signals, N), or None
        Which samples are there; None where all are.
    powers : ndarray, shape (signals,)
        Mean squares of the residuals, sample by sample.
    used : ndarray of int
        Unknowns that the trial depends on.
    """

    trial: int
    signals: tuple[int, ...]
    residual: np.ndarray
    jacobian: np.ndarray
    there: np.ndarray | None
    powers: np.ndarray
    used: np.ndarray


def groups_of(
    data: TrialData, trial: int, residual: np.ndarray, jacobian: np.ndarray, used: np.ndarray
) -> list[ResidualGroup]:
    """Return the residuals of a trial on grids of regular times.

    Parameters
    ----------
    data : TrialData
        The trial.
    trial : int
        Its number.
    residual : ndarray, shape (signals, N)
        Weighted residuals.
    jacobian : ndarray, shape (signals, N, used unknowns)
        Their derivatives.
    used : ndarray of int
        Unknowns that the trial depends on.
    """
    signals = tuple(range(len(residual)))
    if data.regular:
        every = max(1, residual.shape[1] // _ENOUGH)
        powers = np.mean(residual**2, axis=1)
        whole = gathered(residual, every), gathered(jacobian, every)
        return [ResidualGroup(trial, signals, *whole, None, powers, used)]
    counts = data.there.sum(axis=1)
    powers = np.where(counts > 0, (residual**2).sum(axis=1) / np.maximum(counts, 1), 1.0)
    least = float(data.t[-1]) / _ENOUGH
    shown = [j for j in signals if counts[j]]
    step = max(least, float(np.median([data.step_of(j) for j in shown]))) if shown else least
    common = _on_grid(data, shown, residual, jacobian, step)
    on = common[2].mean(axis=1) >= _ON_THE_GRID
    groups = []
    if on.any():
        at = [j for j, is_on in zip(shown, on) if is_on]
        rows, slopes, there = (part[on] for part in common)
        groups.append(ResidualGroup(trial, tuple(at), rows, slopes, there, powers[at], used))
    for j in (j for j, is_on in zip(shown, on) if not is_on):
        own = _on_grid(data, [j], residual, jacobian, max(least, data.step_of(j)))
        groups.append(ResidualGroup(trial, (j,), *own, powers[[j]], used))
    return groups


def _on_grid(
    data: TrialData, signals: list[int], residual: np.ndarray, jacobian: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sums of the samples nearest to each time of a grid, scaled as by `gathered`, and at which times there are any."""
    cell = np.floor(data.t / step + 0.5).astype(int)
    count = int(cell[-1]) + 1
    rows, slopes = np.zeros((len(signals), count)), np.zeros((len(signals), count, jacobian.shape[2]))
    there = np.zeros((len(signals), count), dtype=bool)
    for k, j in enumerate(signals):
        own = data.there[j]
        cells, starts, counts = np.unique(cell[own], return_index=True, return_counts=True)
        root = np.sqrt(counts)
        rows[k, cells] = np.add.reduceat(residual[j, own], starts) / root
        slopes[k, cells] = np.add.reduceat(jacobian[j, own], starts, axis=0) / root[:, None]
        there[k, cells] = True
    return rows, slopes, there


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
