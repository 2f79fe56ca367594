"""Frozen values: a channel that stays at one number while the ship says it moves."""

from __future__ import annotations

import numpy as np

from shipid.foundation.numbers import brief
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.motion import rate_of_turn as rates
from shipid.trials.doctor.working_copy import WorkingCopy

_MOST = 20
"""Stretches that are looked at: the longest."""
_SCATTERS = 3.0
"""A channel that stands where it else scatters counts as one that should have moved so many times what passes unnoticed."""


def examine_frozen(p: WorkingCopy) -> None:
    """Find channels that stay at one value while the ship says they move.

    Parameters
    ----------
    p : WorkingCopy
        The record, its rates and headings put right.
    """
    _frozen(p, ("u", "v", "U", "x", "y", "delta"))
    _drawn(p, "delta")


def examine_frozen_rates(p: WorkingCopy) -> None:
    """Find a heading or a rate of turn that stays at one value while the other moves.

    Parameters
    ----------
    p : WorkingCopy
        The record, heading and rate in the same unit and sign.
    """
    _frozen(p, ("psi", "r"))
    _drawn(p, "psi")


def _drawn(p: WorkingCopy, name: str) -> None:
    """Find a channel that scatters and lies on a straight line meanwhile: what was drawn across a gap shows no peak and no execute."""
    index = p.own(name) if p.has(name) else np.empty(0, int)
    values = p[name][index] if index.size else np.empty(0)
    lines = [
        (int(a), int(b))
        for a, b in robust.straight_runs(p.t[index], values)
        if values[a] != values[b] and b - a >= 0.015 * len(index)
    ]
    if not lines:
        return
    a, b = max(lines, key=lambda line: line[1] - line[0])
    p.add(
        "frozen", name, 0.95,
        f"{name} lies on one straight line for {b - a + 1} samples ({brief(p.t[index[b]] - p.t[index[a]], 4)} s) and scatters elsewhere: the line "
        "was drawn across a gap",
        "The model is fitted to a motion that was not measured: peaks are cut off, and executes are not where they seem.",
        "The motion meanwhile is unknown: identify from the stretches on either side.",
        at=np.concatenate([index[a : b + 1] for a, b in lines]),
    )  # fmt: skip


def _frozen(p: WorkingCopy, names: tuple[str, ...]) -> None:
    t = p.t
    for name in names:
        index = p.own(name) if p.has(name) else np.empty(0, int)
        if len(index) < 30:
            continue
        d = np.diff(p[name][index]) == 0
        if d.all() or not d.any():
            continue
        held = robust.runs(d)
        lengths = held[:, 1] - held[:, 0]
        # Coarse digits make many short runs; a frozen sensor makes one that is far longer.
        usual = float(np.median(lengths)) if len(lengths) > 20 else 0.0
        long = np.flatnonzero(lengths >= max(8, 5 * usual, 0.015 * len(index)))
        if not len(long):
            continue
        longest = long[np.argsort(lengths[long])[::-1][:_MOST]]
        rated = [(_missed(p, name, int(index[held[k, 0]]), int(index[held[k, 1]])), int(k)) for k in longest]
        if (
            name in ("psi", "x", "y")
            and not p.found("written-on-change")
            and robust.never_repeats(p[name][index], held[long])
        ):
            # A heading that scatters, and stands at its extremes: a sensor at the end of its range, or one that is held; or positions.
            rated = [(max(missed, _SCATTERS), k) for missed, k in rated]
        missed, k = max(rated)
        a, b = int(index[held[k, 0]]), int(index[held[k, 1]])
        if missed > 1:
            found = [k for share, k in rated if share > 1]
            often = "" if len(found) == 1 else f" {len(found)} times, here"
            p.add(
                "frozen", name, robust.confidence_of(missed, 1, 3),
                f"{name} stands at one value{often} for {held[k, 1] - held[k, 0] + 1} samples ({brief(t[b] - t[a], 4)} s) while the ship moves",
                "The model is fitted to a standstill that did not happen: the gain comes out too small and the time "
                "constant too long.",
                "The motion meanwhile is unknown: identify from the stretches on either side.",
                at=np.concatenate([np.arange(int(index[held[j, 0]]), int(index[held[j, 1]]) + 1) for j in found]),
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
    if name == "psi":
        return 0.0 if p.found("written-on-change") else _stopped_short(t, values, a, b) / unnoticed
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


def _stopped_short(t: np.ndarray, values: np.ndarray, a: int, b: int) -> float:
    """How far a heading alone should have moved while it stands: it leaps behind, or it turns until it stands and at once again.

    A steady course begins and ends slowly.
    """
    before, after = slice(max(a - 6, 0), a + 1), slice(b + 1, b + 8)
    if a < 4 or len(values) - b < 6:
        return 0.0
    usual = float(np.quantile(np.abs(np.diff(values)), 0.98))
    leap = max(0.0, abs(float(values[b + 1] - values[b])) - 2 * usual)
    slopes = [abs(float(np.polyfit(t[part] - t[part][0], values[part], 1)[0])) for part in (before, after)]
    return max(leap, 0.25 * min(slopes) * float(t[b] - t[a]))


def _drift(p: WorkingCopy) -> float:
    """What the rate of turn lacks of the slope of the heading throughout [rad/s]: the bias of the gyro."""
    found = rates.relation(p.t, p["psi"], p["r"])
    return 0.0 if found is None else float(found.value[1])


def _travel(p: WorkingCopy) -> float:
    """Twice the time the rudder takes over its whole range [s], from its fastest tenth."""
    rate = np.abs(np.diff(p["delta"])) / np.diff(p.t)
    moving = rate[rate > 0]
    return 2 * float(np.ptp(p["delta"])) / float(np.quantile(moving, 0.9)) if moving.size else 0.0
