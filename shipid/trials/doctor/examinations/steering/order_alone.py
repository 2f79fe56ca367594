"""An order with no rudder angle beside it: when the rudder sets out after it, by the ship's answer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.numbers import brief
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.steering.filtered import (
    damping,
    filtered,
    regular_signals,
    settled,
    squares_of_each,
)
from shipid.trials.doctor.examinations.steering.rudder import executes
from shipid.trials.doctor.working_copy import WorkingCopy
from shipid.trials.signals.order import GEAR

_LONGEST, _RATES = 0.6, 14
"""A rudder takes up to this share of the time between two orders for its way; so many rates are tried."""
_STEP = 0.05
"""An order is given where it steps by this share of its range."""
_WORSE = 1.5
"""Delays whose misfit is up to this many times the least are possible: no ship is quite of the first order."""
_EXPLAINED = 0.8
"""Rudder and damping explain this share of the turning acceleration at least, where the answer tells a delay."""


@dataclass(frozen=True)
class LateAnswer:
    """When the rudder sets out after its order, by the ship's answer.

    Attributes
    ----------
    delay : float
        How long after it [s]; negative where it is before.
    earliest, latest : float
        Between which it lies [s].
    rate : float
        Rate of the rudder that goes with it [rad/s], infinite where it steps.
    """

    delay: float
    earliest: float
    latest: float
    rate: float

    @property
    def late(self) -> bool:
        """Whether no steering gear starts so late."""
        return self.earliest > GEAR


def late_answer(p: WorkingCopy, name: str) -> LateAnswer | None:
    """Fit ``r' = a delta(t - delay) - b r - b2 r|r| - b3 r^3 + c`` over delays and rates of a rudder that follows its order.

    A rudder that takes its time bends the rate of turn from the moment at which it sets out; one that sets out late bends it
    later. So the two are told apart, without the rudder angle.

    Parameters
    ----------
    p : WorkingCopy
        The record, units put right.
    name : str
        The column of the order, which steps.

    Returns
    -------
    LateAnswer or None
        None where there are too few samples or orders, or the ship's answer does not tell.
    """
    signals = regular_signals(p, name)
    if signals is None or float(np.ptp(signals.delta)) == 0 or float(np.ptp(signals.r)) == 0:
        return None
    start, _, reach = executes(signals.delta)
    if len(start) < 4:
        return None
    half = float(np.median(np.diff(signals.t[start])))
    constant = max(2 * signals.step, half / 40)
    use = settled(signals, constant)
    if int(use.sum()) < 30:
        return None
    common, target = (values[use] for values in damping(signals, constant))
    total = float(np.sum((target - target.mean()) ** 2))
    if total == 0:
        return None
    step = max(signals.step / 2, half / 200)
    shifts = step * np.arange(-int(0.1 * half / step), int(0.3 * half / step) + 1)
    travels = np.concatenate(([0.0], np.geomspace(max(0.02 * half, signals.step), _LONGEST * half, _RATES)))
    misfits = []
    for travel in travels:
        rudder = _followed(signals.t, signals.delta, reach / travel if travel else np.inf)
        smooth = filtered(signals, rudder, constant)[0]
        misfits.append(squares_of_each(np.interp(signals.t[use, None] - shifts, signals.t, smooth), common, target))
    found = np.array(misfits)
    rated, best = np.unravel_index(int(np.argmin(found)), found.shape)
    least = max(float(found.min()), 1e-12 * total)
    if 1 - least / total < _EXPLAINED:
        return None
    possible = shifts[found.min(axis=0) <= _WORSE * least]
    return LateAnswer(
        float(shifts[best]),
        float(possible.min()) - step,
        float(possible.max()) + step,
        float(reach / travels[rated]) if travels[rated] else np.inf,
    )


def _followed(t: np.ndarray, order: np.ndarray, rate: float) -> np.ndarray:
    """A rudder that follows an order in steps at a constant rate."""
    if not np.isfinite(rate):
        return order
    steps = np.flatnonzero(np.abs(np.diff(order)) > _STEP * float(np.ptp(order)))
    given = 0.5 * (t[steps] + t[steps + 1])
    times, angles = [float(t[0])], [float(order[0])]
    for k, begin, end in zip(steps, given, np.append(given[1:], t[-1])):
        now, wanted = angles[-1], float(order[k + 1])
        there = min(begin + abs(wanted - now) / rate, end)
        times += [begin, there]
        angles += [now, now + float(np.clip(wanted - now, -rate * (there - begin), rate * (there - begin)))]
    return np.asarray(np.interp(t, times, angles))


def examine_order_alone(p: WorkingCopy) -> bool:
    """Find an order that the ship answers only after a while, where no rudder angle stands beside it.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs put right.

    Returns
    -------
    bool
        Whether it was found.
    """
    name = p.rudder
    if name is None or not (name == "delta_order" or p.found("order-not-feedback")):
        return False
    answer = late_answer(p, name)
    if answer is None or not answer.late:
        return False
    gear = "" if np.isinf(answer.rate) else f", at {angle(answer.rate, 2)}/s"
    p.add(
        "order-early", name, robust.confidence_of(answer.earliest / GEAR, 0.5, 2.0),
        f"the ship answers {name} as one whose rudder sets out {brief(answer.delay, 3)} s after it ({brief(answer.earliest, 2)} to "
        f"{brief(answer.latest, 2)} s{gear}): the steering gear has a dead time, the order is stamped early, or heading and rate are late",
        "Overshoots counted from the order are too large, by the heading turned in that time, if the stamps are wrong; the time is taken "
        "for the ship's where a model is steered by the order.",
        f"Find out which it is; shift {name} by {answer.delay:+.3g} s if its stamps are early.",
    )  # fmt: skip
    return True
