"""A clock that was set while the log ran: the stamps jump on or back, and the motion goes on as if nothing had been."""

from __future__ import annotations

import numpy as np

from shipid.foundation.numbers import moment
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.working_copy import WorkingCopy

#: A step of the clock longer than so many usual ones may be a jump.
_LONG = 2.5
#: A clock is set now and then; more jumps are another fault.
_MOST = 10
#: Samples on either side from which the motion is continued.
_NEAR = 6
#: The motion meanwhile, had the time passed, is so many times its noise.
_CLEAR = 8.0
#: Share of that motion that may be seen all the same, and share of the range by which what the ship does may change in a sample.
_SEEN, _STEP = 0.2, 0.05


def examine_clock_set(p: WorkingCopy) -> None:
    """Find jumps of the clock across which the motion goes on, and take them out of the working copy.

    Parameters
    ----------
    p : WorkingCopy
        The record, in the order of its rows.
    """
    steps = np.diff(p.t)
    if len(p) < 4 * _NEAR or not (steps > 0).any():
        return
    usual = float(np.median(steps[steps > 0]))
    odd = np.flatnonzero((steps > _LONG * usual) | (steps < 0))
    if not odd.size or odd.size > _MOST or robust.spread(steps) > 0.2 * usual:
        return
    found = [int(k) for k in odd if _goes_on(p, int(k), usual)]
    if not found:
        return
    jumps = steps[found] - usual
    largest = float(jumps[np.argmax(np.abs(jumps))])
    times = "once" if len(found) == 1 else f"{len(found)} times"
    p.add(
        "clock-set", "t", 0.95,
        f"the clock jumps {times}, by {largest:+.4g} s at {moment(p.t[found[0]])} s, and the ship goes on as if no time had passed: it was set "
        "(summer time, or a correction)",
        "Times behind the jump, periods and rates across it are wrong; a jump on looks like a gap, a jump back mixes the rows.",
        "Take the jump out of the stamps behind it, or log in UTC.",
        at=np.unique(np.concatenate([found, np.add(found, 1)])), fix={"action": "shift-stamps", "seconds": -largest},
    )  # fmt: skip
    t = p.t.copy()
    for k, jump in zip(found, jumps):
        t[k + 1 :] -= jump
    p["t"] = t


def _goes_on(p: WorkingCopy, k: int, usual: float) -> bool:
    """Whether heading and positions go on across the step behind sample `k` as in one usual interval, and not as in the time it says."""
    before, after = np.arange(max(k - _NEAR + 1, 0), k + 1), np.arange(k + 1, min(k + 1 + _NEAR, len(p)))
    if min(len(before), len(after)) < 4:
        return False
    if any(np.any(np.abs(np.diff(p.t[part]) - usual) > 0.5 * usual) for part in (before, after)):
        return False
    jump = float(p.t[k + 1] - p.t[k]) - usual
    clear = 0
    for name in [c for c in ("psi", "x", "y") if p.has(c)]:
        y = p[name][np.r_[before, after]]
        if not np.isfinite(y).all():
            return False
        y = np.unwrap(y) if name == "psi" else y
        place = np.arange(len(y))
        slopes = [
            float(np.polyfit(place[part], y[part], 1)[0]) for part in (slice(len(before)), slice(len(before), None))
        ]
        slope = 0.5 * sum(slopes)
        noise = robust.noise(p[name][np.isfinite(p[name])]) + 1e-9
        meanwhile = abs(slope) * abs(jump) / usual
        off = abs(float(y[len(before)] - y[len(before) - 1]) - slope)
        if meanwhile > _CLEAR * noise:
            if off > max(_SEEN * min(meanwhile, 10 * abs(slope)), 3 * noise):
                return False
            clear += 1
        elif off > 5 * noise + abs(slope):
            return False
    for name in [c for c in ("r", "delta", "u") if p.has(c)]:
        values = p[name]
        sound = values[np.isfinite(values)]
        if not sound.size or not np.isfinite(values[[k, k + 1]]).all():
            continue
        # A rudder that is under way moves as it did in the samples around.
        around = np.r_[np.diff(values[before]), np.diff(values[after])]
        usual_step = max(_STEP * float(np.ptp(sound)), float(np.nanmax(np.abs(around))))
        if abs(float(values[k + 1] - values[k])) > 2 * usual_step + 5 * robust.noise(sound):
            return False
    return clear > 0
