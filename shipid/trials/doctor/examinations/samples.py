"""Samples that are no measurements: missing ones, empty rows at the end, outliers, frozen values."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations import rate_of_turn as rates
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.missing_marks import LARGEST

_HOLE = 5
"""Up to this many missing samples in a row are interpolated linearly; over more of them the motion is unknown."""


def examine_holes(p: WorkingCopy) -> None:
    """Find samples that are empty, NaN, infinite or stand for a missing one; drop or interpolate them.

    Parameters
    ----------
    p : WorkingCopy
        The record.
    """
    bad = {name: ~(np.abs(values) <= LARGEST) for name, values in p.values.items()}
    empty = [name for name, mask in bad.items() if mask.all() and name != "t"]
    for name in empty:
        p.add(
            "not-finite", name, 0.99, f"the column {name} holds no number at all",
            "The column cannot be used.", "Leave the column out.", fix={"action": "drop-column", "column": name},
        )  # fmt: skip
        del p.values[name], bad[name]
    anywhere = np.any(list(bad.values()), axis=0)
    if not anywhere.any():
        return
    sound = np.flatnonzero(~anywhere)
    n = len(p)
    keep = int(sound[-1]) + 1 if sound.size else 0
    if keep < n and keep > 0 and n - keep >= 1:
        names = ", ".join(name for name, mask in bad.items() if mask[keep:].any())
        p.add(
            "trailing-empty", names, 0.99, f"the last {n - keep} rows are empty or not finite",
            "Every integral over them is NaN; read_trial refuses the record.",
            "Drop the rows; in a format file: [repairs] trailing = 'drop'.",
            at=np.arange(keep, n), fix={"action": "drop-trailing", "rows": n - keep},
        )  # fmt: skip
        p.keep(np.arange(n) < keep)
        bad = {name: mask[:keep] for name, mask in bad.items()}
    unstamped = bad.pop("t")
    if unstamped.any():
        few = bool(unstamped.mean() < 0.05)
        p.add(
            "not-finite", "t", 0.99, f"{int(unstamped.sum())} rows have no time stamp",
            "The time of these rows is unknown.",
            "Drop these rows." if few else "Find out the clock; in a format file: [clock] interval.",
            at=np.flatnonzero(unstamped), fix={"action": "drop-rows"} if few else None,
        )  # fmt: skip
        p.keep(~unstamped)
        bad = {name: mask[~unstamped] for name, mask in bad.items()}
    for name, mask in bad.items():
        if not mask.any():
            continue
        index = np.flatnonzero(mask)
        longest = int(np.diff(robust.runs(mask)).max())
        short = longest <= _HOLE
        p.add(
            "not-finite", name, 0.99,
            f"{len(index)} samples of {name} are empty, NaN, infinite or beyond {LARGEST:g}; the longest run has "
            f"{longest} samples" + (f" ({p.record.text_fault})" if p.record.text_fault else ""),
            "There is no residual at these samples; one NaN makes the whole sum of squares NaN.",
            "Interpolate linearly between their neighbours." if short else
            "Identify from the stretches on either side (FILE@A:B); the run is too long to interpolate.",
            at=index, fix={"action": "bridge", "column": name} if short else None,
        )  # fmt: skip
        p[name] = bridged(p[name], mask)


def bridged(values: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Return a channel whose masked samples are interpolated linearly.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    mask : ndarray of bool, shape (n,)
        Samples to replace.
    """
    index = np.arange(len(values))
    return np.where(mask, np.interp(index, index[~mask], values[~mask]), values) if (~mask).any() else values


def examine_outliers(p: WorkingCopy) -> None:
    """Find samples that differ from their neighbours by far more than noise, curvature and resolution.

    Parameters
    ----------
    p : WorkingCopy
        The record; the heading is left to `examine_heading`, which has the rate of turn to compare with.
    """
    for name in ("r", "p", "u", "v", "U", "x", "y", "delta", "delta_order", "n", "phi"):
        if not p.has(name) or len(p) < 30:
            continue
        mask = outliers(p[name])
        if mask.any():
            index = np.flatnonzero(mask)
            size = float(np.max(np.abs(p[name] - median_filter(p[name], 5, mode="nearest"))[mask]))
            share = size / max(robust.noise(p[name]), 0.003 * float(np.ptp(np.delete(p[name], index))), 1e-12)
            p.add(
                "outlier", name, robust.confidence_of(share, 7, 20),
                f"{len(index)} samples of {name} differ from their neighbours by up to {share:.0f} times the noise",
                "Least squares weighs each with the square of its size: gains and damping follow the outliers.",
                "Replace them by the line between their neighbours.",
                at=index, fix={"action": "bridge", "column": name} if share > 7 else None,
            )  # fmt: skip
            if share > 7:
                p[name] = bridged(p[name], mask)


def outliers(values: np.ndarray) -> np.ndarray:
    """Return the mask of isolated outliers (up to two in a row).

    Parameters
    ----------
    values : ndarray, shape (n,)
        The channel.
    """
    rest = np.abs(values - median_filter(values, 5, mode="nearest"))
    step = np.abs(np.diff(values, prepend=values[0]))
    # What the channel usually does around here, by the larger half of its steps and of its residuals.
    near = max(25, 1) | 1
    local = median_filter(step, near, mode="nearest") + 2 * median_filter(rest, near, mode="nearest")
    grid, still = robust.resolution(values)
    floor = max(6.5 * robust.noise(values), 6 * spread_of(rest), 3 * grid if still > 0.3 else 0.0)
    body = np.quantile(values, [0.01, 0.99])
    floor = max(floor, 0.01 * float(body[1] - body[0]), 1e-9 * float(np.abs(values).max()))
    moving = step[step > 0]
    if moving.size:
        floor = max(floor, 3 * float(np.quantile(moving, 0.8)))
    mask: np.ndarray = rest > np.maximum(10 * local, floor)
    if not mask.any():
        return mask
    # The channel goes on as it was: what is before and what is behind agree, unlike at a step that overshoots.
    padded = np.pad(values, 4, mode="edge")
    window = np.lib.stride_tricks.sliding_window_view(padded, 9)[mask]
    before, after = np.median(window[:, :3], axis=1), np.median(window[:, -3:], axis=1)
    mask[np.flatnonzero(mask)] = np.abs(after - before) < 0.5 * rest[mask]
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


def examine_frozen(p: WorkingCopy) -> None:
    """Find channels that stay at one value while the ship says they move.

    Parameters
    ----------
    p : WorkingCopy
        The record, its rates and headings put right.
    """
    _frozen(p, ("u", "v", "U", "x", "y", "delta"))


def examine_frozen_rates(p: WorkingCopy) -> None:
    """Find a heading or a rate of turn that stays at one value while the other moves.

    Parameters
    ----------
    p : WorkingCopy
        The record, heading and rate in the same unit and sign.
    """
    _frozen(p, ("psi", "r"))


def _frozen(p: WorkingCopy, names: tuple[str, ...]) -> None:
    t = p.t
    for name in names:
        if not p.has(name) or len(p) < 30:
            continue
        values = p[name]
        d = np.diff(values) == 0
        if d.all() or not d.any():
            continue
        held = robust.runs(d)
        lengths = held[:, 1] - held[:, 0]
        # Coarse digits make many short runs; a frozen sensor makes one that is far longer.
        usual = float(np.median(lengths)) if len(lengths) > 20 else 0.0
        long = np.flatnonzero(lengths >= max(8, 5 * usual, 0.015 * len(p)))
        if not len(long):
            continue
        longest = long[np.argsort(lengths[long])[::-1][:5]]
        rated = [(_missed(p, name, int(held[k, 0]), int(held[k, 1])), int(k)) for k in longest]
        missed, k = max(rated)
        a, b = int(held[k, 0]), int(held[k, 1])
        if missed > 1:
            p.add(
                "frozen", name, robust.confidence_of(missed, 1, 3),
                f"{name} stands at one value for {b - a + 1} samples ({t[b] - t[a]:.4g} s) while the ship moves",
                "The model is fitted to a standstill that did not happen: the gain comes out too small and the time "
                "constant too long.",
                "The motion meanwhile is unknown: identify from the stretches on either side.",
                at=np.arange(a, b + 1),
            )  # fmt: skip


def _missed(p: WorkingCopy, name: str, a: int, b: int) -> float:
    """How far the channel should have moved meanwhile, over what would pass unnoticed."""
    t, values = p.t, p[name]
    outside = np.concatenate([values[: max(a - 1, 0)], values[b + 2 :]])
    grid = robust.resolution(outside)[0]
    unnoticed = 8 * robust.noise(outside) + 3 * grid + 0.005 * float(np.ptp(values))
    if unnoticed == 0:
        return 0.0
    if name == "psi" and p.has("r"):
        turned = robust.integral(t[a : b + 1], p["r"][a : b + 1] + _drift(p))
        return float(np.ptp(turned)) / (unnoticed + 1e-3 * float(np.ptp(p["psi"])))
    if name == "r" and p.has("psi"):
        rate = np.gradient(p["psi"], t)[a : b + 1]
        size = max(3, (b - a) // 6) | 1
        smooth = np.convolve(rate, np.ones(size) / size, "valid")
        off = np.abs(smooth - values[a] - _drift(p))
        blur = 3 * robust.noise(p["psi"]) / (p.sampling * size)
        return float(off.max()) / (unnoticed + blur + 0.05 * float(np.quantile(np.abs(values), 0.9)))
    if name in ("x", "y") and p.has("psi") and p.has("u"):
        c, s = np.cos(p["psi"]), np.sin(p["psi"])
        sideways = p["v"] if p.has("v") else np.zeros_like(values)
        velocity = p["u"] * c - sideways * s if name == "x" else p["u"] * s + sideways * c
        way = robust.integral(t[a : b + 1], velocity[a : b + 1])
        # Coarse digits stand still for long, too, and then move by the steps they always move by.
        near = np.abs(np.diff(values)[max(a - 400, 0) : b + 401])
        steps = np.sort(near[near > 0])
        usual_step = float(np.quantile(steps, 0.9)) if steps.size > 3 else 0.0
        return float(np.ptp(way)) / (unnoticed + 2 * usual_step)
    rattle = robust.noise(outside)
    turning = p.has("r") and float(np.ptp(p["r"][a : b + 1])) > 0.2 * float(np.ptp(p["r"]))
    if name in ("u", "v", "U") and rattle > 0 and turning:
        usual = np.median(np.abs(np.diff(outside))) if outside.size > 10 else 0.0
        # A noisy channel that is silent for long; one that is smooth must have run on.
        return 0.1 * (b - a + 1) if usual > 0 and robust.noise(outside) > 1e-5 * float(np.ptp(values)) else 0.0
    if name == "delta" and p.has("delta_order"):
        off = np.abs(p["delta_order"][a : b + 1] - values[a])
        wrong = off > 0.25 * float(np.ptp(values))
        return float(np.diff(robust.runs(wrong)).max(initial=0)) * p.sampling / max(8 * p.sampling, _travel(p))
    return 0.0


def _drift(p: WorkingCopy) -> float:
    """What the rate of turn lacks of the slope of the heading throughout [rad/s]: the bias of the gyro."""
    found = rates.relation(p.t, p["psi"], p["r"])
    return 0.0 if found is None else float(found.value[1])


def _travel(p: WorkingCopy) -> float:
    """Twice the time the rudder takes over its whole range [s], from its fastest tenth."""
    rate = np.abs(np.diff(p["delta"])) / np.diff(p.t)
    moving = rate[rate > 0]
    return 2 * float(np.ptp(p["delta"])) / float(np.quantile(moving, 0.9)) if moving.size else 0.0
