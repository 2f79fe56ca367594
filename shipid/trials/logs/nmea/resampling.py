"""Signals with clocks of their own, brought to one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from shipid.trials.filling import GAP

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
    """

    name: str
    t: np.ndarray
    values: np.ndarray
    notes: tuple[str, ...] = ()

    @property
    def interval(self) -> float:
        """Median interval [s]."""
        return float(np.median(np.diff(self.t)))


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
                f"{limits[name]:.3g} s are not interpolated)."
            )
    whole = np.all([known[name] for name in kept], axis=0) if grid.size else keep
    for name in kept:
        inside = (grid >= signals[name].t[0]) & (grid <= signals[name].t[-1])
        lost = int((inside & ~known[name]).sum())
        if lost:
            notes.append(
                f"{lost} samples were left out because {name} has gaps of more than {limits[name]:.3g} s, which are not "
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
