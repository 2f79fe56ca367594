"""A rudder that follows the heading: under an autopilot the disturbances of the ship are in its input, too."""

from __future__ import annotations

import numpy as np

from shipid.foundation.numbers import brief, percent
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.steering.delay import answer_to
from shipid.trials.doctor.examinations.steering.filtered import Signals, filtered, regular_signals, settled, squares
from shipid.trials.doctor.examinations.steering.rudder import executes
from shipid.trials.doctor.working_copy import WorkingCopy

_FOLLOWS = 0.45
"""The helm law has to explain this share of the rudder's movements."""
_DETERMINED = 0.9
"""From this share of the turning explained by the rudder on, what disturbs the ship misleads little."""
_KEPT = 0.9
"""From this share of the rudder explained by heading and rate of turn on, no order to change the course is left in it."""
_CHANGED = np.deg2rad(10)
"""A heading that moves by more than this, and does not come back, was ordered to: the same law explains nearly all of one long change."""
_AT_LIMIT, _SELDOM = 0.97, 0.25
"""A rudder at this share of its largest angle may stand at its limit; a zig-zag does so for more of the time than this share."""
_REMEMBERS = 3
"""A filter has forgotten all but a twentieth of what was so many of its time constants ago."""

_WIDTHS = (3, 6, 12, 24)
"""Time constants of the filter in samples."""
_BRISK = 0.2
"""A rudder that is put over takes less than this share of the time until it is put over again."""
_BESIDE = 0.4
"""Such a filter is shorter than this share of that time."""

_SELDOM_PUT, _STILL = 4, 0.03
"""A rudder that is put over so many times at the most, and stays within this share of its range in between, follows nothing."""


def examine_closed_loop(p: WorkingCopy) -> None:
    """Find a rudder that is a function of heading and rate of turn; it spoils a fit where disturbances turn the ship.

    Parameters
    ----------
    p : WorkingCopy
        The record, units put right.
    """
    name = "delta_order" if p.has("delta_order") and float(np.ptp(p["delta_order"])) > 0 else p.rudder
    if name is None or p.found("no-rudder-movement"):
        return
    signals = regular_signals(p, name)
    if signals is None or _put_over_and_left(signals.delta):
        return
    share, stiffness, damping = max(_law(signals, width * signals.step) for width in _widths(signals))
    if share < _FOLLOWS:
        return
    answer = answer_to(p, name)
    if answer is None:
        return
    # The orders of a zig-zag or a turn are steps, and no law of heading and rate explains them: the law alone tells.
    disturbed = answer.explained < _DETERMINED
    p.add(
        "closed-loop", name, robust.confidence_of(share, 0.35, 0.65),
        f"the rudder follows the heading (about {brief(stiffness, 2)} deg a degree off course and {brief(damping, 2)} deg per deg/s): an autopilot "
        f"steers, and the rudder explains {'only ' if disturbed else ''}{percent(max(answer.explained, 0))} of the turning; the rest is "
        "disturbance that the rudder reacts to, or what a simple model of the ship leaves out",
        "Output error is biased: rudder and disturbance are correlated, the gain comes out far too small or with the wrong sign, "
        "and its interval does not say so."
        if disturbed
        else "Rudder and disturbance are correlated: a fit is biased by a little more than its interval says.",
        "Sail a zig-zag or a turn for it, or identify with --method prediction-error, which models the disturbance.", spoils=disturbed,
    )  # fmt: skip
    kept = _share_of_feedback(signals)
    if disturbed and kept > _KEPT and _wanders(signals):
        p.add(
            "course-keeping", name, robust.confidence_of(kept, 0.85, 0.95),
            f"heading and rate of turn alone explain {percent(kept)} of the rudder angle: the course is kept, and nothing but disturbances moves "
            "the rudder",
            "Rudder and disturbance are one signal: no method tells the answer to the rudder from the disturbance, and intervals hold only "
            "if the disturbance is exactly what the method takes it for.",
            "Change the course a few times, by 10 degrees and more: the orders move the rudder by themselves.",
        )  # fmt: skip


def _put_over_and_left(delta: np.ndarray) -> bool:
    """Whether the rudder does nothing but go over a few times, and lies still in between.

    Any law of heading and rate of turn fits two or three steps: the ship turns after the one, and has turned before the other.
    """
    start, length, reach = executes(delta)
    if not 0 < len(start) <= _SELDOM_PUT:
        return False
    edges = [0, *np.column_stack([start, start + length]).ravel(), len(delta)]
    off = np.concatenate([np.abs(part - np.median(part)) for part in np.split(delta, edges[1:-1])[0::2] if len(part)])
    return float(np.quantile(off, 0.95)) < max(_STILL * reach, 4 * robust.noise(delta))


def _widths(signals: Signals) -> list[int]:
    """Widths of the filter in samples; where the rudder is put over in steps, short beside the time from one to the next.

    A wider filter makes a wave of the steps of a zig-zag, and that follows the heading.
    """
    start, length, _ = executes(signals.delta)
    apart = np.diff(start)
    stepped = apart.size > 2 and float(np.median(length[1:] / apart)) < _BRISK
    longest = _BESIDE * float(np.median(apart)) if stepped else np.inf
    return [width for width in _WIDTHS if width <= max(longest, _WIDTHS[0])]


def _law(signals: Signals, constant: float) -> tuple[float, float, float]:
    """Fit ``delta' = -k r - d r'``, which holds whatever the course is: share of the movements explained, k and d [s]."""
    use = settled(signals, constant) & _free(signals, constant)
    if int(use.sum()) < 60:
        return 0.0, 0.0, 0.0
    r, slope, _ = filtered(signals, signals.r, constant)
    rate = filtered(signals, signals.delta, constant)[1][use]
    design = np.column_stack([r, slope])[use]
    found = robust.regress(design, rate)
    if found is None:
        return 0.0, 0.0, 0.0
    stiffness, damping = -float(found.value[0]), -float(found.value[1])
    # Where the rudder is at rest every law of small gains explains it: its movements count.
    moving = np.abs(rate) > 0.05 * float(np.quantile(np.abs(rate), 0.99))
    if moving.mean() < 0.3 or stiffness < 5 * float(found.std[0]) or damping < -0.2 * stiffness * constant:
        return 0.0, 0.0, 0.0
    rest = np.abs(rate - design @ found.value)[moving]
    return float(np.mean(rest < 0.4 * np.abs(rate[moving]))), stiffness, max(damping, 0.0)


def _free(signals: Signals, constant: float) -> np.ndarray:
    """Where the rudder does not stand at its limit, nor did within the memory of the filter, shape (m,)."""
    size = np.abs(signals.delta - np.median(signals.delta))
    stands = size > _AT_LIMIT * float(size.max())
    if stands.mean() > _SELDOM:
        return np.ones(size.shape, dtype=bool)
    memory = np.ones(int(_REMEMBERS * constant / signals.step) + 1)
    after: np.ndarray = np.convolve(stands, memory)[: size.size] < 0.5
    return after


def _wanders(signals: Signals) -> bool:
    """Whether the heading moves little, or comes back to where it was; a few samples on either end of it are left out."""
    heading = robust.integral(signals.t, signals.r)
    low, high = np.quantile(heading, [0.01, 0.99])
    if high - low < _CHANGED:
        return True
    off = heading - 0.5 * (low + high)
    side = np.sign(off[np.abs(off) > 0.1 * (high - low)])
    return int(np.count_nonzero(np.diff(side))) > 1


def _share_of_feedback(signals: Signals) -> float:
    """Share of the rudder angle that heading, its integral, rate of turn and a slow change explain."""
    constant = 6 * signals.step
    use = settled(signals, constant)
    heading = robust.integral(signals.t, signals.r)
    seconds = signals.t - signals.t[0]
    columns = [heading, robust.integral(signals.t, heading - heading.mean()), signals.r]
    design = [filtered(signals, column, constant)[0] for column in columns]
    target = filtered(signals, signals.delta, constant)[0][use]
    total = float(np.sum((target - target.mean()) ** 2))
    left = squares(np.column_stack([*design, seconds, seconds**2, np.ones_like(seconds)])[use], target)
    return 1 - left / total if total > 0 else 0.0
