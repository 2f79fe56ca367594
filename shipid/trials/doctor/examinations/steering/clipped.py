"""A rudder angle whose sensor stops short: the gear goes on beyond what the log shows, and comes back before it moves again there.

Two marks are left: the ship answers what is not in the log, and a sensor that scatters amidships repeats one value at its stop.
"""

from __future__ import annotations

from collections.abc import Sequence

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
from shipid.trials.doctor.working_copy import WorkingCopy

_PLAIN = 1.3
"""The ship's answer is explained so many times as well by a rudder that goes on, however it is explained otherwise: sound records of
zig-zags and circles, simulated and real, reach 1.01."""

_LEVEL, _FAST = 0.03, 0.2
"""Part of its reach within which a rudder stands at its stop, and of its fastest rate from which it moves."""

_RESTS, _FEWEST, _AMIDSHIPS = 10, 5, 0.3
"""Samples amidships, and at a stop, that tell whether the sensor scatters, and the part of its reach up to which it is amidships."""

_NEVER, _ALWAYS = 0.05, 0.8
"""A sensor that scatters repeats a value for less than the first share of its samples; one at its stop for more than the second."""

_SHIFTS, _TRIED = 10, 60
"""Samples by which the rudder is shifted instead, and lengths of the way beyond the stop that are tried."""


def examine_clipped(p: WorkingCopy) -> None:
    """Find a rudder that goes further than its sensor.

    Parameters
    ----------
    p : WorkingCopy
        The record, signs put right; whether rudder and ship are apart in time has been looked at.
    """
    name = "delta"
    if not p.has(name) or p.found("no-rudder-movement"):
        return
    effect = "Executes are read too late and overshoots too small; gain and time constant come out wrong."
    repair = "Use the order if it is logged, or a record of smaller angles; what the rudder did beyond the stop is not in the log."
    if (silent := _repeats(p[name][p.own(name)])) is not None:
        stop, scatter = silent
        p.add(
            "clipped", name, 0.95,
            f"delta repeats {angle(stop, 3)} exactly while it is held, and scatters by {angle(scatter, 2)} amidships: its sensor shows no "
            "more, and the rudder goes further", effect, repair,
        )  # fmt: skip
        return
    if any(p.found(k) for k in ("order-not-feedback", "closed-loop", "latency")):
        return
    found = _beyond(p, name)
    if found is None:
        return
    stop, further, gain, step = found
    p.add(
        "clipped", name, robust.confidence_of(gain, 1.1, 1.5),
        f"delta stops at {angle(stop, 3)}, and the ship answers a rudder that goes on to some {angle(stop + further, 2)} and comes back "
        f"before it moves in the log (her answer is explained {brief(gain, 2)} times as well, to {angle(step, 2)})",
        effect, repair,
    )  # fmt: skip


def _repeats(delta: np.ndarray) -> tuple[float, float] | None:
    """The stop of a sensor that can show no more, and its scatter, in rad: it scatters where the rudder rests amidships, and not at its stop."""
    stands, stop = _at_stop(delta)
    over = np.flatnonzero(np.abs(delta) > _AMIDSHIPS * stop)
    rest = delta[: over[0]] if over.size else delta[:0]
    if not stands or len(rest) < _RESTS:
        return None
    steps = np.abs(np.diff(rest))
    scatter = 1.4826 * float(np.median(steps)) / float(np.sqrt(2))
    still = robust.spread(rest)
    between = np.diff(delta[np.abs(delta) < 0.5 * stop])
    if scatter == 0 or still > 2 * scatter or float(np.mean(between == 0)) > _NEVER:
        return None
    held = [delta[a : b + 1] for _, a, b in stands]
    ends = [one[np.abs(one) > np.median(np.abs(one)) - 3 * scatter] for one in held if len(one) >= _FEWEST]
    if any(np.abs(end).max() > np.median(np.abs(end)) for end in ends):
        return None  # it has shown more
    repeats = [len(end) >= _FEWEST and float(np.mean(np.diff(end) == 0)) > _ALWAYS for end in ends]
    return (stop, scatter) if repeats and all(repeats[:-1] or repeats) else None


def _beyond(p: WorkingCopy, name: str) -> tuple[float, float, float, float] | None:
    """The stop, how far the rudder goes beyond it, by how much that explains the answer better, and the step of the search, in rad.

    ``r' = a delta - b r - b2 r|r| - b3 r^3 + c``, and the same with the bend of the rate and the rate of the rudder, which allow for
    ships of higher order: a rudder that goes on has to explain more than each of them, and than a rudder that is shifted in time.
    """
    signals = regular_signals(p, name)
    if signals is None or float(np.ptp(signals.delta)) == 0 or float(np.ptp(signals.r)) == 0:
        return None
    delta, t = signals.delta, signals.t
    stands, stop = _at_stop(delta)
    # Beside a hole nobody knows when the rudder came to its stop, or left it.
    stands = [(side, a, b) for side, a, b in stands if signals.known[max(0, a - 1) : b + 2].all()]
    if not stands:
        return None
    rate = np.abs(np.gradient(delta, signals.step))
    moving = rate > _FAST * rate.max()
    for _, a, b in stands:
        moving[max(0, a - 1) : b + 2] = False
    constant = max(2 * signals.step, float(np.median([t[b] - t[a] + signals.step for _, a, b in stands])) / 40)
    use = settled(signals, constant)
    if int(moving.sum()) < 3 or int(use.sum()) < 30:
        return None
    steepest = float(np.median(rate[moving]))
    further = np.linspace(0.0, 1.5, _TRIED + 1) * stop
    gone_on = [filtered(signals, _gone_on(t, delta, stands, steepest, e), constant)[0][use] for e in further]
    smooth, speed, _ = filtered(signals, delta, constant)
    shifts = signals.step / 2 * np.arange(-2 * _SHIFTS, 2 * _SHIFTS + 1)
    shifted = np.interp(t[use, None] - shifts, t, smooth)
    common, target = (values[use] for values in damping(signals, constant))
    bend, columns = filtered(signals, signals.r, constant)[2][use], np.column_stack(gone_on)
    gains, best = [], 0
    for extra in ([bend, speed[use]], [bend], []):
        design = np.column_stack([common, *extra])
        left = squares_of_each(columns, design, target)
        best = int(np.argmin(left))
        other = min(float(left[0]), float(squares_of_each(shifted, design, target).min()))
        gains.append(other / max(float(left[best]), 1e-300) if best else 1.0)
    gain = min(gains)
    return (stop, float(further[best]), gain, float(further[1])) if gain > _PLAIN else None


def _at_stop(delta: np.ndarray) -> tuple[list[tuple[float, int, int]], float]:
    """Where the rudder stands at the ends of its range: side, first and last sample; and how far over that is."""
    low, high = np.quantile(delta, [0.005, 0.995])
    reach = max(float(high), -float(low))
    found = []
    for side, level in ((1.0, float(high)), (-1.0, -float(low))):
        if level > reach / 4:
            stands = robust.runs(side * delta >= level - _LEVEL * (high - low) / 2)
            found += [(side, int(a), int(b) - 1) for a, b in stands]
    return found, reach


def _gone_on(
    t: np.ndarray, delta: np.ndarray, stands: Sequence[tuple[float, int, int]], rate: float, further: float
) -> np.ndarray:
    """The rudder that goes on at its rate for so far beyond each stop, and is back when it moves again in the log."""
    whole = delta.copy()
    for side, a, b in stands:
        there = slice(a, b + 1)
        since = rate * (t[there] - t[a]) if a > 0 else np.inf
        until = rate * (t[b] - t[there]) if b < len(t) - 1 else np.inf
        whole[there] += side * np.minimum(further, np.minimum(since, until))
    return whole
