"""Delay between rudder and ship: the shift of the rudder at which the ship's answer is explained best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.foundation.numbers import brief, percent
from shipid.trials.doctor import robust_statistics as robust
from shipid.trials.doctor.examinations.steering.filtered import (
    damping,
    filtered,
    regular_signals,
    settled,
    squares,
    squares_of_each,
)
from shipid.trials.doctor.examinations.steering.order_alone import examine_order_alone
from shipid.trials.doctor.examinations.steering.rudder import executes
from shipid.trials.doctor.working_copy import WorkingCopy

_PLAIN, _LEAST = 5.0, 1.5
"""An answer that is explained so many times as well by a shift shows one of so many samples; ships of second order reach 2.3."""

_FEW = 2.2
"""Where there are two executes only, it is explained so many times as well, whatever else is allowed for."""

SINE = 0.95
"""A rudder whose bend is its angle to this part moves as one sine."""


@dataclass(frozen=True)
class Answer:
    """How the ship's rate of turn answers the rudder.

    Attributes
    ----------
    half : float
        Usual time between two executes [s].
    executes : int
        How many there are.
    delay : float
        Shift at which the answer is explained best: how long before it acts the rudder is logged [s]; negative where the ship
        answers before the rudder moves.
    gain : float
        Misfit without the shift over the one with it.
    slow : float
        Misfit of a slow, second-order answer without a shift, over the one of a first-order answer with it.
    free : float
        As `slow`, the rate of the rudder allowed for as well: it explains small shifts of either sign.
    explained : float
        Share of the acceleration in turning that rudder and damping explain at the best shift.
    step : float
        Interval of the shifts that were tried [s].
    single : float
        Share of the bend of the rudder's course that its angle explains: all of it for a rudder that moves as one sine, whose shift
        is the same as another time constant of the ship.
    """

    half: float
    executes: int
    delay: float
    gain: float
    slow: float
    free: float
    explained: float
    step: float
    single: float


def answer_to(p: WorkingCopy, name: str) -> Answer | None:
    """Fit ``r' = a delta(t - delay) - b r - b2 r|r| - b3 r^3 + c`` over a range of delays, all signals filtered alike.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs and units put right.
    name : str
        The column of the rudder.

    Returns
    -------
    Answer or None
        None where there are too few samples, or nothing moves.
    """
    signals = regular_signals(p, name)
    if signals is None or float(np.ptp(signals.delta)) == 0 or float(np.ptp(signals.r)) == 0:
        return None
    start, _, _ = executes(signals.delta)
    span = float(signals.t[-1] - signals.t[0])
    half = float(np.median(np.diff(signals.t[start]))) if len(start) > 2 else span / 4
    # Short holds of an irregular helm do not make a delay long.
    usual = float(np.quantile(np.diff(signals.t[start]), 0.8)) if len(start) > 2 else half
    constant = max(2 * signals.step, half / 40)
    use = settled(signals, constant)
    if int(use.sum()) < 30:
        return None
    common, target = (values[use] for values in damping(signals, constant))
    bend = filtered(signals, signals.r, constant)[2]
    smooth, rate, turned = filtered(signals, signals.delta, constant)
    delta = smooth[use]
    # Accelerations below 1e-160 differ, but their squares do not.
    total = float(np.sum((target - target.mean()) ** 2))
    if total == 0:
        return None

    def misfit(*columns: np.ndarray) -> float:
        return squares(np.column_stack([*columns, common]), target)

    step = max(signals.step / 2, half / 200)
    shifts = step * np.arange(-int(0.3 * half / step), int(0.3 * half / step) + 1)
    shifted = np.interp(signals.t[use, None] - shifts, signals.t, smooth)
    best = int(np.argmin(squares_of_each(shifted, common, target)))
    least = max(misfit(shifted[:, best]), 1e-300)
    return Answer(
        usual,
        len(start), float(shifts[best]), misfit(delta) / least, misfit(delta, bend[use]) / least,
        misfit(delta, bend[use], rate[use]) / least, 1 - least / total, step, _explained_by(delta, turned[use]),
    )  # fmt: skip


def _explained_by(cause: np.ndarray, effect: np.ndarray) -> float:
    """Share of the variance of one column that another explains; none of one that does not change."""
    total = float(np.sum((effect - effect.mean()) ** 2))
    return 1 - squares(np.column_stack([cause, np.ones_like(cause)]), effect) / total if total > 0 else 0.0


def examine_delay(p: WorkingCopy) -> None:
    """Find a rudder that moves after the ship has answered, or long before, and one that the ship does not answer.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs put right.
    """
    name = p.rudder
    if name is None or p.found("no-rudder-movement") or examine_order_alone(p):
        return
    answer = answer_to(p, name)
    if answer is None:
        return
    if answer.explained < 0.1:
        _unanswered(p, name, answer)
        return
    if answer.single > SINE:
        return
    # Two executes, of which one is a reversal, show a delay that nothing else explains.
    few = answer.executes == 2 and min(answer.gain, answer.slow, answer.free) > _FEW
    if (answer.executes < 3 and not few) or answer.explained < 0.5:
        return
    share = answer.delay / answer.half
    if answer.delay < 0:
        # A ship with a fast second mode seems to answer a little before a first-order one would.
        clear = answer.free > 1.3 and answer.gain > 1.5
        plain = answer.gain > _PLAIN
        least = _LEAST if plain else 2.5
        limit = max(least * p.sampling, 2 * answer.step, (0.02 if clear or plain else 0.06) * answer.half)
        if -answer.delay >= limit and answer.gain > (1.25 if clear else 2.0):
            _rudder_late(p, name, answer, limit)
        return
    clear = answer.free > 1.3 and answer.gain > 1.5
    likely = answer.slow > 1.8 and answer.gain > 2
    plain = answer.gain > _PLAIN and answer.slow > 2
    least = _LEAST if plain else 2.5
    limit = max(least * p.sampling, 2 * answer.step, 0.015 * answer.half)
    if answer.delay < limit or not (clear or likely or (share > 0.08 and answer.gain > 2)):
        return
    sure = max(
        robust.confidence_of(answer.free, 1.1, 2.0) if clear else 0.0,
        min(
            robust.confidence_of(answer.slow, *((1.0, 2.5) if plain else (1.3, 3.0))),
            robust.confidence_of(answer.gain, 1.5, 4.0),
        ),
    )
    ordered = p.found("order-not-feedback") or name == "delta_order"
    p.add(
        "latency", name, min(sure, robust.confidence_of(answer.delay / limit, 0.9, 1.5)),
        f"the rudder is logged about {brief(answer.delay, 3)} s before it acts (the ship's answer is explained {brief(answer.gain, 3)} times "
        "as well with it that much later): the rudder is early, it is an order, or heading and rate are late",
        "The delay is taken for a slower ship: the time constant comes out too long by about as much, the gain with it.",
        f"Identify with a dead time (-delay after the name of the model, about {brief(answer.delay, 3)} s) or a lag (-lag), or find the "
        f"clock of the rudder; shift delta by {answer.delay:+.3g} s if it is the rudder that is early.",
        spoils=not ordered and share > 0.02,
    )  # fmt: skip


def _rudder_late(p: WorkingCopy, name: str, answer: Answer, limit: float) -> None:
    late = -answer.delay
    precise = answer.free > 1.3
    confidence = min(
        robust.confidence_of(answer.gain, 1.2, 2.5),
        robust.confidence_of(late / limit, 0.9, 1.5 if answer.gain > _PLAIN else 2),
    )
    applied = p.add(
        "latency", name, confidence if precise else min(confidence, 0.89),
        f"the rudder moves about {brief(late, 3)} s after the ship has answered it",
        "The delay is taken for a quicker ship: time constants come out wrong by about as much.",
        f"Shift the rudder by {answer.delay:+.3g} s.", fix={"action": "shift", "column": name, "seconds": answer.delay},
    )  # fmt: skip
    if applied:
        p.shift(name, late)


def _unanswered(p: WorkingCopy, name: str, answer: Answer) -> None:
    """Say that the rate of turn has nothing to do with the rudder, where no other shift in time does better by chance."""
    signals = regular_signals(p, name)
    if signals is None or len(signals.t) < 200:
        return
    constant = max(2 * signals.step, answer.half / 40)
    use = settled(signals, constant)
    r, slope, _ = filtered(signals, signals.r, constant)
    delta = filtered(signals, signals.delta, constant)[0]
    chance = [
        _explained(np.roll(delta, k), r, slope, use) for k in (np.linspace(0.1, 0.9, 40) * len(delta)).astype(int)
    ]
    own = max(_explained(np.interp(signals.t - s, signals.t, delta), r, slope, use) for s in (0.0, answer.delay))
    if own <= float(np.quantile(chance, 0.9)):
        p.add(
            "no-response", name, 0.9,
            f"the rate of turn does not answer the rudder: they explain {percent(max(own, 0), 1)} of the turning acceleration, and no less "
            "where one is shifted at random",
            "Nothing can be identified: any gain explains the record as well as any other.",
            "Use a record of a manoeuvre, or find the columns that hold rudder and rate of turn.",
        )  # fmt: skip


def _explained(delta: np.ndarray, r: np.ndarray, slope: np.ndarray, use: np.ndarray) -> float:
    one = np.ones_like(r)
    without = squares(np.column_stack([r, one])[use], slope[use])
    return 1 - squares(np.column_stack([delta, r, one])[use], slope[use]) / max(without, 1e-300)
