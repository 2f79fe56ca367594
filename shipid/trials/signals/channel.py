"""One column of a trial by its own samples: where it has holes, and where it is silent because its value holds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter

from shipid.trials.filling import GAP, usual_interval
from shipid.trials.signals.coarse import threshold_of
from shipid.trials.trial import Trial

#: Share of the steps of a sensor that are one digit, where it writes only on change.
_SINGLE = 0.85
#: A sample this many times the noise, and three times the usual step, away from its neighbours is a spike.
_SPIKE = 8.0


@dataclass(frozen=True, eq=False)
class Channel:
    """The samples of one column.

    Attributes
    ----------
    name : str
        The column.
    t, y : ndarray, shape (n,)
        Times [s] and values of the samples that are there.
    holes : tuple of (float, float)
        Intervals [s] without a sample, longer than `shipid.trials.filling.GAP` usual ones.
    interval : float
        Usual interval [s].
    digit : float or None
        The step of a sensor that writes only on change; None for one that writes regularly.
    spikes : tuple of float
        Times [s] of single wild samples that were left out.
    grain : float or None
        The step of a sensor of coarse digits that repeats a value until the next, or the threshold of one that is written again
        when it has moved by more than that; None where values seldom repeat.
    """

    name: str
    t: np.ndarray
    y: np.ndarray
    holes: tuple[tuple[float, float], ...]
    interval: float
    digit: float | None = None
    spikes: tuple[float, ...] = ()
    grain: float | None = None

    def hole(self, start: float, end: float | None = None, longest: float = 0.0) -> tuple[float, float] | None:
        """Return the first hole longer than `longest` that a stretch of time touches, or None.

        Parameters
        ----------
        start, end : float
            The stretch [s]; a moment where there is no end.
        longest : float
            Holes up to this long do not count [s].
        """
        end = start if end is None else end
        for a, b in self.holes:
            if b - a > longest and a < end + 1e-9 and b > start - 1e-9:
                return a, b
        return None

    def bridged(self, longest: float) -> Channel:
        """Return the channel with its short holes filled by a cubic through the samples on both sides.

        Parameters
        ----------
        longest : float
            Holes up to this long are filled [s].
        """
        times, values, left = [self.t], [self.y], []
        for a, b in self.holes:
            filled = _cubic(self.t, self.y, a, b, self.interval) if b - a <= longest else None
            if filled is None:
                left.append((a, b))
            else:
                times.append(filled[0])
                values.append(filled[1])
        if len(times) == 1:
            return self
        t, y = np.concatenate(times), np.concatenate(values)
        t, order = np.unique(t, return_index=True)
        return replace(self, t=t, y=y[order], holes=tuple(left))


def channel_of(trial: Trial, name: str, wrong: np.ndarray | None = None, *, spikes: bool = True) -> Channel:
    """Return one column of a trial by its own samples.

    Parameters
    ----------
    trial : Trial
        The trial; a missing sample is NaN.
    name : str
        The column.
    wrong : ndarray of bool, shape (samples,), optional
        Samples that count as missing.
    spikes : bool
        Whether single wild samples are left out; not wanted for an order, which steps.

    Returns
    -------
    Channel
    """
    column = trial[name]
    there = np.isfinite(column)
    if wrong is not None:
        there &= ~wrong
    t, y = trial["t"][there], column[there]
    wild = spikes_of(y) if spikes else np.zeros(len(y), dtype=bool)
    out = tuple(float(when) for when in t[wild])
    t, y = t[~wild], y[~wild]
    grain = _grain(y) or threshold_of(y, np.flatnonzero(there)[~wild])
    usual = usual_interval(t)
    long = np.flatnonzero(np.diff(t) > GAP * usual) if len(t) > 1 else np.empty(0, dtype=int)
    digit = _digit(y) if long.size else None
    holes = [(float(t[k]), float(t[k + 1])) for k in long]
    if digit is not None:
        # A sensor that writes only on change is silent while its value holds: the next one is a digit away.
        silent = np.abs(np.diff(y))[long] < 1.5 * digit
        holes = [hole for hole, held in zip(holes, silent) if not held]
        t, y = _held(t, y, long[silent], usual)
    return Channel(name, t, y, tuple(holes), usual, digit, out, grain)


def spikes_of(y: np.ndarray) -> np.ndarray:
    """Return which samples are spikes: up to three in a row, far from the median of the seven around them.

    Parameters
    ----------
    y : ndarray, shape (n,)
        A continuous series.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    if len(y) < 15:
        return np.zeros(len(y), dtype=bool)
    step = float(np.quantile(np.abs(np.diff(y)), 0.95))
    noise = 1.4826 * float(np.median(np.abs(np.diff(y, 2)))) / np.sqrt(6)
    away = np.abs(y - median_filter(y, 7, mode="nearest"))
    # The median of the ends is that of few samples.
    away[:3] = away[-3:] = 0
    return np.asarray(away > max(_SPIKE * noise, 3 * step, 1e-9))


def _digit(y: np.ndarray) -> float | None:
    """The step of a sensor that writes only on change: no value repeats the one before, most are one digit away."""
    steps = np.abs(np.diff(y))
    if len(steps) < 5 or np.mean(steps > 0) < 0.98:
        return None
    digit = float(np.quantile(steps[steps > 0], 0.2))
    return digit if float(np.mean(steps < 1.5 * digit)) >= _SINGLE and digit > 0 else None


def _grain(y: np.ndarray) -> float | None:
    """The step of coarse digits: many samples repeat the one before, and all others are a whole number of steps away."""
    steps = np.abs(np.diff(y))
    moves = steps[steps > 0]
    if len(moves) < 10 or len(moves) > 0.8 * len(steps):
        return None
    grain = float(np.quantile(moves, 0.02))
    if float(np.median(moves)) >= 10 * grain:
        return None
    count = moves / grain
    return grain if float(np.mean(np.abs(count - np.round(count)) < 0.02)) > 0.95 else None


def _held(t: np.ndarray, y: np.ndarray, silent: np.ndarray, usual: float) -> tuple[np.ndarray, np.ndarray]:
    """Samples at the usual interval where the value holds."""
    times = [np.arange(t[k] + usual, t[k + 1] - 0.5 * usual, usual) for k in silent]
    values = [np.full(len(times[i]), y[k]) for i, k in enumerate(silent)]
    everything = np.concatenate([t, *times])
    everything, order = np.unique(everything, return_index=True)
    return everything, np.concatenate([y, *values])[order]


def _cubic(t: np.ndarray, y: np.ndarray, a: float, b: float, usual: float) -> tuple[np.ndarray, np.ndarray] | None:
    count = int(np.clip(np.ceil((b - a) / usual), 4, 40))
    first, last = int(np.searchsorted(t, a, side="right")), int(np.searchsorted(t, b))
    near = slice(max(0, first - count), min(len(t), last + count))
    if first - near.start < 3 or near.stop - last < 3:
        return None
    middle, half = 0.5 * (a + b), 0.5 * (t[near.stop - 1] - t[near.start])
    fit = np.polynomial.polynomial.polyfit((t[near] - middle) / half, y[near], 3)
    at = np.arange(a + usual, b - 0.5 * usual, usual)
    return at, np.polynomial.polynomial.polyval((at - middle) / half, fit)
