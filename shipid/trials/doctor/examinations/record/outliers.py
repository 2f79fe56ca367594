"""Wild samples: single values far from their neighbours, the first and the last of the record included."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import counted
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.steering.rudder import fastest_gear
from shipid.trials.doctor.working_copy import WorkingCopy

#: The least that counts as wild, by the unit inside a trial: below it nobody cares.
_LEAST = {"rad": np.radians(0.2), "rad/s": np.radians(0.005), "m": 0.05, "rps": 0.005}
_FARTHER = 3.0
"""A jump at either end of a record is wild where it is so many times the largest step in between."""


def examine_outliers(p: WorkingCopy) -> None:
    """Find samples that differ from their neighbours by far more than noise, curvature and resolution.

    Parameters
    ----------
    p : WorkingCopy
        The record. Small glitches of the heading are left to `examine_heading`, which has the rate of turn to compare with.
    """
    known = ("psi", "r", "p", "u", "v", "U", "SOG", "x", "y", "delta", "delta_order", "n", "phi")
    for name in known:
        if not p.has(name) or len(p.own(name)) < 30:
            continue
        index = p.own(name)
        values = p[name][index]
        mask = wild(values) | (outliers(values) | ends(values) if name != "psi" or not p.has("r") else False)
        if name in ("delta", "delta_order"):
            mask &= ~_on_ramp(p, index, values)
        if not mask.any() or mask.mean() > 0.1:
            continue
        size = np.abs(values - median_filter(values, 5, mode="mirror"))[mask]
        scale = max(robust.noise(values), 0.003 * float(np.ptp(values[~mask])), 1e-12)
        if float(size.max()) < _LEAST.get(p.unit(name), 0.0) and name not in ("u", "v", "U"):
            continue
        share = float(size.max()) / scale
        bad = np.zeros(len(p), dtype=bool)
        bad[index[mask]] = True
        kind = "heading-glitch" if name == "psi" else "outlier"
        amount = f"by up to {angle(float(size.max()), 3)}" if name == "psi" else f"by {_times(share)} the noise"
        applied = p.add(
            kind, name, robust.confidence_of(share, 7, 20),
            f"{counted(int(mask.sum()), f'sample of {name} differs from its', f'samples of {name} differ from their')} neighbours {amount}",
            "Least squares weighs each with the square of its size: gains and damping follow the outliers.",
            "Empty these cells: such a sample is a missing one.",
            at=np.flatnonzero(bad), fix={"action": "empty", "column": name},
        )  # fmt: skip
        if applied:
            p.void(name, bad)


def _times(share: float) -> str:
    """How many times, in words: of noise next to nothing, the number of times says nothing."""
    return f"up to {share:.0f} times" if share < 1000 else "more than 1000 times"


def _on_ramp(p: WorkingCopy, index: np.ndarray, values: np.ndarray) -> np.ndarray:
    """First and last samples of a rudder that its gear can have reached: the record begins or ends on a ramp."""
    mask = np.zeros(len(values), dtype=bool)
    covered = fastest_gear(p) * np.abs(np.diff(p.t[index]))
    possible = np.abs(np.diff(values)) <= covered
    mask[:2], mask[-2:] = possible[0], possible[-1]
    return mask


def wild(values: np.ndarray) -> np.ndarray:
    """Return the mask of isolated samples (up to two in a row) far beyond the range of all others.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    """
    low, high = np.quantile(values, [0.01, 0.99])
    reach = float(high - low)
    over = 8 * robust.noise(values)
    beyond = np.maximum(low - values, values - high)
    mask: np.ndarray = beyond > max(0.5 * reach, over, 1e-9 * float(np.abs(values).max()))
    if not mask.any():
        return mask
    for a, b in robust.runs(mask):
        inner = values[np.r_[max(a - 3, 0) : a, b : min(b + 3, len(values))]]
        # A channel on its way out there goes by its neighbours; a wild sample stands alone.
        level = float(np.median(inner))
        alone = b - a <= 2 and np.all(np.abs(values[a:b] - level) > 2 * np.ptp(inner) + 0.25 * reach)
        mask[a:b] = bool(alone)
    return mask


def outliers(values: np.ndarray) -> np.ndarray:
    """Return the mask of isolated outliers (up to two in a row).

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    """
    # Mirrored at the ends: the first and the last sample have neighbours on one side, and are judged by them.
    rest = np.abs(values - median_filter(values, 5, mode="mirror"))
    step = np.abs(np.diff(values, prepend=values[0]))
    # What the channel usually does around here, by the larger half of its steps and of its residuals.
    local = median_filter(step, 25, mode="mirror") + 2 * median_filter(rest, 25, mode="mirror")
    grid, still = robust.resolution(values)
    floor = max(6.5 * robust.noise(values), 6 * spread_of(rest), 3 * grid if still > 0.3 else 0.0)
    body = np.quantile(values, [0.01, 0.99])
    floor = max(floor, 0.01 * float(body[1] - body[0]), 1e-9 * float(np.abs(body).max()))
    moving = step[step > 0]
    if moving.size:
        floor = max(floor, 3 * float(np.quantile(moving, 0.8)))
    mask: np.ndarray = rest > np.maximum(10 * local, floor)
    if not mask.any():
        return mask
    # The channel goes on as it was: what is before and what is behind agree, unlike at a step that overshoots.
    padded = np.pad(values, 4, mode="reflect")
    window = np.lib.stride_tricks.sliding_window_view(padded, 9)[mask]
    before, after = np.median(window[:, :3], axis=1), np.median(window[:, -3:], axis=1)
    mask[np.flatnonzero(mask)] = np.abs(after - before) < 0.5 * rest[mask]
    return mask


def ends(values: np.ndarray) -> np.ndarray:
    """Return the mask of a first or last sample that jumps farther than the channel does anywhere else.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    """
    mask = np.zeros(len(values), dtype=bool)
    step = np.abs(np.diff(values))
    usual = float(step[1:-1].max())
    if usual > 0:
        mask[0], mask[-1] = step[0] > _FARTHER * usual, step[-1] > _FARTHER * usual
    return mask


def spread_of(values: np.ndarray) -> float:
    """Return the robust spread of the values that are not zero.

    Parameters
    ----------
    values : ndarray
        Any values.
    """
    some = values[values > 0]
    return 1.4826 * float(np.median(some)) if some.size > 0.2 * values.size else 0.0
