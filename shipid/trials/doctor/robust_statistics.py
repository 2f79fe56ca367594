"""Robust statistics of a channel: noise, resolution, and regressions that a few bad samples do not turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import cumulative_trapezoid

from shipid.trials.filling import GAP, usual_interval

_MAD = 1.4826
#: Coefficients of a robust regression that move by less than this share of the largest of them have settled.
_SETTLED = 1e-6


def spread(values: np.ndarray) -> float:
    """Return the standard deviation of the bulk of some values: the median absolute deviation, scaled.

    Parameters
    ----------
    values : ndarray
        Any number of values.
    """
    return _MAD * float(np.median(np.abs(values - np.median(values)))) if values.size else 0.0


def noise(values: np.ndarray) -> float:
    """Return the standard deviation of white noise on a smooth channel, from its third differences.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    """
    return spread(np.diff(values, 3)) / np.sqrt(20.0) if len(values) > 8 else 0.0


def divided_noise(t: np.ndarray, values: np.ndarray) -> float:
    """Return the noise of a smooth channel by the stamps of its samples, from third divided differences.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time, rising.
    values : ndarray, shape (n,)
        The channel.

    Returns
    -------
    float
        Zero of fewer than ten samples.
    """
    if len(values) < 10:
        return 0.0
    times = np.stack([t[j : len(t) - 3 + j] for j in range(4)])
    weights = np.stack([1 / np.prod([times[j] - times[i] for i in range(4) if i != j], axis=0) for j in range(4)])
    divided = sum(weights[j] * values[j : len(values) - 3 + j] for j in range(4))
    return _MAD * float(np.median(np.abs(divided) / np.linalg.norm(weights, axis=0)))


def resolution(values: np.ndarray) -> tuple[float, float]:
    """Return the step in which a channel changes, and the share of samples at which it does not change.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.

    Returns
    -------
    step : float
        Median size of the changes that follow a sample without one; 0 where there is none.
    still : float
        Share of the samples, among those where the channel is under way, that repeat the one before.
    """
    d = np.diff(values)
    same = d == 0
    if same.all() or not same.any():
        return 0.0, float(same.all())
    # Under way: the next change is not far.
    index = np.flatnonzero(~same)
    gap = np.diff(index) - 1
    inside = gap[gap <= max(40, len(values) // 20)]
    still = float(inside.sum() / (inside.sum() + len(index)))
    after = np.abs(d[1:][same[:-1] & ~same[1:]])
    return (float(np.median(after)) if after.size else 0.0), still


@dataclass(frozen=True)
class RobustLine:
    """Coefficients of a robust regression with their standard deviations.

    Attributes
    ----------
    value, std : ndarray, shape (p,)
        Coefficients and standard deviations.
    sigma : float
        Robust standard deviation of the residuals.
    explained : float
        Share of the target's variance (about zero) that is explained, over the rows that count.
    """

    value: np.ndarray
    std: np.ndarray
    sigma: float
    explained: float


def _scale(design: np.ndarray) -> np.ndarray | None:
    """Return the size of each regressor; None where there are too few rows or the regressors cannot be told apart."""
    n, p = design.shape
    scale = np.sqrt(np.mean(design**2, axis=0))
    if n < 3 * p + 3 or np.any(scale == 0) or np.linalg.cond(design / scale) > 1e8:
        return None
    return np.asarray(scale)


def regress(design: np.ndarray, target: np.ndarray, rounds: int = 20) -> RobustLine | None:
    """Fit a linear model by iteratively reweighted least squares (Tukey's biweight).

    Parameters
    ----------
    design : ndarray, shape (n, p)
        Regressors.
    target : ndarray, shape (n,)
        What they explain.
    rounds : int
        Number of reweightings, at most.

    Returns
    -------
    RobustLine or None
        None where there are too few rows or the regressors cannot be told apart.
    """
    scale = _scale(design)
    if scale is None:
        return None
    scaled, (n, p) = design / scale, design.shape
    weight = np.ones(n)
    value = np.zeros(p)
    sigma = 0.0
    floor = 1e-12 * float(np.sqrt(np.mean(target**2)) or 1.0)
    for _ in range(rounds):
        root, before = np.sqrt(weight), value
        value = np.linalg.lstsq(scaled * root[:, None], target * root, rcond=None)[0]
        rest = target - scaled @ value
        sigma = max(_MAD * float(np.median(np.abs(rest))), floor)
        weight = np.clip(1 - (rest / (6 * sigma)) ** 2, 0, None) ** 2 + 1e-12
        if np.abs(value - before).max() <= _SETTLED * np.abs(value).max():
            break
    rest = target - scaled @ value
    counted = weight > 0.1
    count = max(int(counted.sum()) - p, 1)
    variance = max(float(np.sum(rest[counted] ** 2)) / count, floor**2)
    covariance = variance * np.linalg.pinv(scaled[counted].T @ scaled[counted])
    energy = float(np.sum(target[counted] ** 2))
    explained = 1 - float(np.sum(rest[counted] ** 2)) / energy if energy > 0 else 0.0
    return RobustLine(value / scale, np.sqrt(np.diag(covariance)) / scale, sigma, explained)


def least_squares(design: np.ndarray, target: np.ndarray) -> RobustLine | None:
    """Fit a linear model by plain least squares: for effects that only a few rows show.

    Parameters
    ----------
    design : ndarray, shape (n, p)
        Regressors.
    target : ndarray, shape (n,)
        What they explain.

    Returns
    -------
    RobustLine or None
        None where there are too few rows or the regressors cannot be told apart.
    """
    scale = _scale(design)
    if scale is None:
        return None
    n, p = design.shape
    value = np.linalg.lstsq(design / scale, target, rcond=None)[0]
    rest = target - design @ (value / scale)
    variance = max(float(rest @ rest) / (n - p), 1e-24 * float(target @ target) / n)
    std = np.sqrt(variance * np.diag(np.linalg.inv((design / scale).T @ (design / scale)))) / scale
    energy = float(target @ target)
    return RobustLine(value / scale, std, float(np.sqrt(variance)), 1 - float(rest @ rest) / energy if energy else 0.0)


def edges(n: int, count: int) -> np.ndarray:
    """Return about `count` + 1 indices that cut `n` samples into equal blocks.

    Parameters
    ----------
    n, count : int
        Number of samples and of blocks.
    """
    return np.unique(np.linspace(0, n - 1, min(count, n - 1) + 1).astype(int))


def whole(t: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return which blocks of samples have no gap of the clock in them: what an integral over a gap would be is unknown.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time [s].
    at : ndarray of int, shape (m + 1,)
        Edges of the blocks.

    Returns
    -------
    ndarray of bool, shape (m,)
    """
    if len(t) < 2:
        return np.ones(len(at) - 1, dtype=bool)
    step = np.diff(t)
    # Several sensors that write one after the other pause between their bursts.
    longest = GAP * max(usual_interval(t), float(np.quantile(step, 0.9)))
    gaps = np.concatenate(([0], np.cumsum(step > longest)))
    return np.asarray(np.diff(gaps[at]) == 0)


def integral(t: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the integral of a channel from the first sample on, by the trapezoidal rule.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and channel.
    """
    return np.asarray(cumulative_trapezoid(y, t, initial=0.0))


def runs(mask: np.ndarray) -> np.ndarray:
    """Return first and one-past-last index of every run of True.

    Parameters
    ----------
    mask : ndarray of bool, shape (n,)
        The mask.

    Returns
    -------
    ndarray of int, shape (m, 2)
    """
    padded = np.diff(np.concatenate(([0], mask.astype(np.int8), [0])))
    return np.column_stack([np.flatnonzero(padded == 1), np.flatnonzero(padded == -1)])


def confidence_of(ratio: float, low: float = 1.0, high: float = 3.0) -> float:
    """Return the confidence for the ratio of a statistic to its threshold: 0.5 at `low`, 0.99 at `high`.

    Parameters
    ----------
    ratio : float
        Statistic over threshold.
    low, high : float
        Ratios at which the confidence is 0.5 and 0.99.
    """
    share = (ratio - low) / (high - low)
    return float(0.5 + 0.49 * min(max(share, -0.5), 1.0))


#: Values that scatter repeat at this share of the samples at most, and go back at that share of them at least.
_REPEATS, _BACK_AND_FORTH = 0.05, 0.25
#: Noise of so many digits is seen in how a channel bends.
_GRAINS = 2.0
#: Of scattering values the slope stays within this share of its small changes for so many samples by no chance.
_STRAIGHT, _LINE = 0.02, 8
#: Values that stand do so for less than this share of the record.
_STANDING = 0.3


def never_repeats(values: np.ndarray, stands: np.ndarray) -> bool:
    """Return whether values scatter and seldom repeat, but for where they stand: there the sensor does.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    stands : ndarray of int, shape (k, 2)
        First and last sample of each stretch at one value.
    """
    standing = np.zeros(len(values) - 1, dtype=bool)
    for a, b in stands:
        standing[a:b] = True
    step = np.diff(values)[~standing]
    # Ramps do not repeat either, and do not come back; nor does a smooth channel bend to and fro, beyond its digits.
    back = _turns(step) if noise(values) < _GRAINS * _grain(values) else max(_turns(step), _turns(np.diff(step)) - 0.25)
    return float(np.mean(standing)) < _STANDING and back > _BACK_AND_FORTH and float(np.mean(step == 0)) < _REPEATS


def straight_runs(t: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return where values that else scatter lie on a straight line: somebody drew it across a gap.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Time, rising.
    values : ndarray, shape (n,)
        The channel.

    Returns
    -------
    ndarray of int, shape (k, 2)
        First and last sample of each such stretch; none of a channel whose scatter does not show beyond its digits.
    """
    digit = _grain(values) if len(values) >= 30 else np.inf
    if noise(values) < 2 * _GRAINS * digit:
        return np.empty((0, 2), dtype=int)
    slope = np.diff(values) / np.diff(t)
    bend = np.abs(np.diff(slope))
    # A line is printed with the digits of the rest.
    straight = bend < max(_STRAIGHT * float(np.quantile(bend, 0.25)), 1.01 * digit / float(np.median(np.diff(t))))
    found = runs(straight)
    found = found[found[:, 1] - found[:, 0] >= _LINE]
    if not len(found) or _turns(np.diff(slope)) < 0.5:
        return np.empty((0, 2), dtype=int)
    return np.column_stack([found[:, 0], found[:, 1] + 1])


def _turns(step: np.ndarray) -> float:
    """Share of steps that go back on the one before."""
    return float(np.mean(step[1:] * step[:-1] < 0)) if step.size > 2 else 0.0


def _grain(values: np.ndarray) -> float:
    """Least distance between values that differ: a digit, or of values that never repeat nearly nothing."""
    apart = np.diff(np.sort(values))
    # Less is the rounding of numbers in another unit.
    apart = apart[apart > 1e-9 * float(np.ptp(values))]
    return float(apart.min()) if apart.size else 0.0
