"""Executes, read from the record of the rudder: the moments at which it leaves one plate for the next.

The execute is the order, as ITTC 7.5-04-02-01 and IMO MSC.137(76) mean it. Where the order is logged it is the step of the
order: a sample shows it up to one interval late, so the middle of the interval in which it stepped is taken. Where only the
rudder's own angle is logged, the order is read back from it: the ramp at constant rate is extended back to the plate that the
rudder leaves; a rudder that steps is read as an order.

The other reading, ``"moved"``, is the last sample at which the rudder is still within 15 % of its plate (in a turn: within
3 deg of midships). It assumes nothing of the steering gear, and its overshoots are smaller, by the rate of turn times the
time the rudder needs for these 15 %.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.measuring.rudder.levels import (
    Level,
    level_before,
    level_held,
    level_opposite,
    opposite_helm,
)
from shipid.trials.measuring.rudder.ramps import line_through, ramp_line
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.plates import Plate

LEFT = 0.15
"""Share of the plate's angle by which the rudder has left it."""

_OFF = 0.08
"""Share of the way at which a rudder is certainly on its ramp."""

_SEEN_FROM = 0.3
"""Share of the way from which on a ramp is seen behind a hole: the way back to the plate is longer than what is seen."""

_BEGUN = 0.02
"""Share of the plate's angle from which on a rudder at the first sample may be on its way."""

_SLOW = 0.6
"""A ramp slower than this share of the rate of the others was not sailed so."""

_STEPS = 0.3
"""A rudder or an order that goes more than this share of the way within one interval steps."""

_ALIKE = 0.05
"""Share by which one ramp of a gear is faster or slower than another."""


@dataclass(frozen=True)
class Execute:
    """The moment of an execute.

    Attributes
    ----------
    time : float
        When [s].
    within : float
        Half the width of the interval in which it lies [s].
    hole : tuple of float or None
        The hole of the rudder's record in which it lies [s]; the execute is not known then.
    """

    time: float
    within: float
    hole: tuple[float, float] | None = None


def leaves(steering: Steering, plate: Plate) -> Execute:
    """Return the execute at which the rudder leaves a plate for the other side.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    plate : Plate
        The plate that is left; it must not be the last.

    Returns
    -------
    Execute
    """
    # The plate and the ramp after it; a long record has hundreds of plates.
    near = slice(plate.first, min(len(steering.channel.t), 2 * plate.last - plate.first + 1))
    y = plate.side * steering.channel.y[near]
    found = _put_over(steering, near, y, plate.last - plate.first, level_held(steering, plate), 0.0, 1.8)
    return _refined(steering, found, plate, first=False)


def first_execute(steering: Steering, plate: Plate, moved: float | None = None) -> tuple[Execute, float] | None:
    """Return the execute at which the rudder sets out for its first plate, and the angle it leaves [rad].

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    plate : Plate
        The plate it goes to.
    moved : float, optional
        Rudder angle from midships that counts as moved [rad], instead of 15 % of the way.

    Returns
    -------
    tuple of Execute and float, or None
        None where the record begins with the rudder over already.
    """
    t, rudder = steering.channel.t, steering.channel.y
    opposite = opposite_helm(steering, plate) if moved is None or steering.reading == "order" else None
    if opposite is not None:
        held = level_opposite(steering, opposite)
        near = slice(opposite.first, min(len(t), plate.last))
        y = opposite.side * rudder[near]
        if opposite.first == 0 and _on_the_way_from_the_start(steering, t[: opposite.last], y[: opposite.last]):
            return None
        found = _put_over(steering, near, y, plate.first + 1 - near.start, held, -abs(plate.angle), 0.9)
        return _refined(steering, found, plate, first=True), opposite.side * held.angle
    before = plate.side * rudder[: plate.first]
    way = abs(plate.angle)
    calm = np.flatnonzero(np.abs(before) < 0.3 * way)
    if not calm.size or _on_ramp_from_the_start(steering, t[calm], before[calm], way):
        return None
    # The neutral angle: where the rudder stays before, over a stretch no longer than the plate is held.
    recent = calm[-max(5, plate.last - plate.first) :]
    level = level_before(steering, plate, recent)
    neutral = level.angle
    y = -plate.side * rudder
    share = plate.first + 1
    if moved is None or steering.reading == "order":
        near = slice(max(0, int(recent[0])), min(len(t), plate.last))
        found = _put_over(steering, near, y[near], share - near.start, Level(-neutral, level.scatter), -way, 0.9)
        return _refined(steering, found, plate, first=True), plate.side * neutral
    # From midships, unless the helm carried more than that before.
    still = np.flatnonzero(y[:share] > -(moved if neutral < moved else neutral + moved))
    k = int(still[-1])
    return _moved(steering.channel, k), plate.side * neutral


def _on_ramp_from_the_start(steering: Steering, t: np.ndarray, before: np.ndarray, way: float) -> bool:
    """Whether the record begins on the ramp: the rudder is off midships, and passes all of its small angles as fast as it moves."""
    if steering.rate is None or t[0] > steering.channel.t[0] or len(t) < 2 or before[0] < _BEGUN * way:
        return False
    return bool(before[-1] - before[0] >= 0.7 * steering.rate * (t[-1] - t[0]))


def _on_the_way_from_the_start(steering: Steering, t: np.ndarray, y: np.ndarray) -> bool:
    """Whether the record begins while the rudder already comes back from the other side, as fast as it moves."""
    if steering.rate is None or len(t) < 2:
        return False
    return bool(y[0] - y[-1] >= 0.7 * steering.rate * (t[-1] - t[0]))


def _refined(steering: Steering, found: Execute, plate: Plate, *, first: bool) -> Execute:
    """The execute within the interval of a logged step, by the ramp of the rudder that answers it, if it begins in there."""
    feedback = steering.feedback
    if feedback is None or feedback.rate is None or found.hole is not None or steering.reading != "order":
        return found
    slack = 1.5 * found.within + abs(plate.angle) / feedback.rate
    for answer in steering.answers:
        begins, ends = float(feedback.channel.t[answer.first]), feedback.after(answer)
        if answer.side != plate.side or not (begins if first else ends) >= found.time - found.within:
            continue
        if (begins if first else ends) > found.time + 2 * slack:
            break
        if first:
            start = first_execute(feedback, answer)
            read = None if start is None else start[0]
        else:
            read = leaves(feedback, answer) if answer.last < len(feedback.channel.t) else None
        if read is not None and read.hole is None and abs(read.time - found.time) <= found.within + read.within + 1e-9:
            # The order stepped within its interval, whatever the ramp says.
            within = max(read.within, abs(read.time - found.time) - found.within)
            time = float(np.clip(read.time, found.time - found.within, found.time + found.within))
            return Execute(time, min(within, found.within))
    return found


def _moved(channel: Channel, k: int) -> Execute:
    after = float(channel.t[min(k + 1, len(channel.t) - 1)])
    when = float(channel.t[k])
    return Execute(when, 0.5 * (after - when), channel.hole(0.5 * (when + after)))


def _put_over(
    steering: Steering, near: slice, y: np.ndarray, end: int, level: Level, towards: float, reach: float
) -> Execute:
    """Execute at which `y`, held until somewhere before sample `end`, sets out for `towards` (downwards)."""
    t, held = steering.channel.t[near], level.angle
    size = held - towards
    on = np.flatnonzero(y[:end] >= held - LEFT * size)
    k = int(on[-1]) if on.size else 0
    if k + 1 >= len(y):
        return Execute(float(t[k]), 0.0)
    if steering.reading == "moved":
        return _moved(steering.channel, near.start + k)
    while k > 0 and y[k] < held - _OFF * size and y[k - 1] > y[k] + 0.02 * size:
        k -= 1
    if steering.on_change:
        return Execute(float(t[k + 1]), 0.0)
    k = _step(y, k, held, size) if steering.logged else _foot(t, y, k, held, size, steering)
    ramp = _ramp(y[k + 1 :], held, size, reach) + k + 1
    hole = steering.channel.hole(0.5 * float(t[k] + t[k + 1]))
    if steering.logged or not ramp.size or (steering.rate is None and ramp.size > 1):
        return Execute(0.5 * float(t[k] + t[k + 1]), 0.5 * float(t[k + 1] - t[k]), hole)
    left, inaccuracy = _extended(t, y, ramp, level, (size, reach), steering.rate, k)
    if not np.isfinite(inaccuracy):
        return Execute(left, 0.5 * (float(t[ramp[-1]]) - left), (left, float(t[ramp[-1]])))
    if hole is not None and steering.rate is not None:
        usual = _at_usual_rate(t[ramp], y[ramp], held, steering.rate)
        left, inaccuracy = min(((left, inaccuracy), usual), key=lambda one: one[1])
    step = steering.channel.digit or steering.channel.grain or _digit_of_ramp(steering.channel.y[near][ramp])
    slack = 0.5 * step / (steering.rate or np.inf)
    # A ramp that is seen from the hole on gives the order all the same.
    known = hole is None or (ramp.size >= 2 and steering.rate is not None)
    return Execute(max(left, float(t[0])), inaccuracy + slack, None if known else hole)


def _at_usual_rate(t: np.ndarray, y: np.ndarray, held: float, rate: float) -> tuple[float, float]:
    """When a ramp behind a hole left its plate at the rate of the other ramps [s], and how far off that may be [s]."""
    left = float(np.mean(t - (held - y) / rate))
    return left, _ALIKE * (float(np.mean(t)) - left) + 2 * float(np.std(t - (held - y) / rate)) / float(np.sqrt(len(t)))


def _step(y: np.ndarray, k: int, held: float, size: float) -> int:
    """The last sample before the step of a logged order; a helm that was ordered about before it is passed over."""
    half = k + 1 + np.flatnonzero(y[k + 1 :] <= held - 0.5 * size)
    return int(half[0]) - 1 if half.size and y[half[0] - 1] - y[half[0]] > _STEPS * size else k


def _foot(t: np.ndarray, y: np.ndarray, k: int, held: float, size: float, steering: Steering) -> int:
    """The last sample before the ramp, or before the step; a helm that wandered before it is passed over."""
    rate = steering.rate
    half = k + 1 + np.flatnonzero(y[k + 1 :] <= held - 0.5 * size)
    if not half.size:
        return k
    j = int(half[0])
    if steering.channel.hole(0.5 * float(t[j - 1] + t[j])) is not None:
        return k
    if rate is None:
        # The rudder steps: over within one interval, or two.
        k = j - 1 if y[j - 1] - y[j] > _STEPS * size else max(k, j - 2)
        return k - 1 if k > 0 and y[k] < held - _OFF * size and y[k - 1] > y[k] + 0.02 * size else k
    middle = float(np.interp(-(held - 0.5 * size), -y[[j - 1, j]], t[[j - 1, j]]))
    earlier = np.flatnonzero(t < middle - 0.8 * size / rate)
    return max(k, int(earlier[-1])) if earlier.size else k


def _ramp(y: np.ndarray, held: float, size: float, reach: float) -> np.ndarray:
    """Samples of the ramp that falls from the plate: those on the first half of the way, more where these are few."""
    inside = y < held - _OFF * size
    ends = np.flatnonzero(y <= held - reach * size)
    last = int(ends[0]) if ends.size else len(y)
    noise = 1.4826 * float(np.median(np.abs(np.diff(y)))) / np.sqrt(2) if len(y) > 2 else 0.0
    rising = np.flatnonzero(np.diff(y[:last]) > max(0.02 * size, 6 * noise))
    # What the rudder rises from is the end of the ramp, or a wild sample.
    last = min(last, int(rising[0]) + (rising[0] < 3)) if rising.size else last
    all_of_it = np.flatnonzero(inside[:last])
    # Up to where it is beyond: the rudder comes back from a plate that is short of the other end.
    beyond = np.flatnonzero(y[:last] < held - 0.6 * size)
    first_half = all_of_it[: np.searchsorted(all_of_it, beyond[0])] if beyond.size else all_of_it
    if all_of_it.size and y[all_of_it[0]] < held - _SEEN_FROM * size:
        # What is left of it behind a hole: the whole, for the way back to the plate is long.
        return all_of_it
    return first_half if first_half.size >= 4 else all_of_it[:4]


def _digit_of_ramp(y: np.ndarray) -> float:
    """The digit of a ramp whose samples are equal steps apart: the gear may be half a digit off all of them; 0 otherwise."""
    steps = np.abs(np.diff(y))
    return float(steps[0]) if len(steps) > 2 and steps[0] > 0 and np.ptp(steps) < 1e-6 * steps[0] else 0.0


def _extended(
    t: np.ndarray, y: np.ndarray, ramp: np.ndarray, level: Level, way: tuple[float, float], rate: float | None, k: int
) -> tuple[float, float]:
    """When the ramp left the plate [s], and how far off that may be [s]."""
    held = level.angle
    if ramp.size >= 3 or (ramp.size == 2 and rate is None):
        behind = y[ramp[0]] < held - _SEEN_FROM * way[0]
        line = line_through(t[ramp], y[ramp]) if behind else ramp_line(t, y, ramp, held, *way)
        if line is not None and line.slope < 0:
            left, scatter = line.reaches(held, level.scatter)
            if rate is not None and -line.slope < _SLOW * rate:
                # No ramp of this gear: a line that was drawn between two samples far apart.
                return left, np.inf
            # A gear does not start at once: some hundredths of the interval, where the samples lie on the line.
            return left, max(scatter, 0.02 * float(t[k + 1] - t[k]))
    if rate is not None:
        back = t[ramp] - (held - y[ramp]) / rate
        # The rate is that of the other ramps, and not exactly this one's.
        return float(np.mean(back)), max(float(np.ptp(back)), 0.25 * float(t[k + 1] - t[k]))
    # One sample on the way: the rate is at least that to the next one.
    first, then = int(ramp[0]), min(int(ramp[0]) + 1, len(y) - 1)
    drop = float(y[first] - y[then])
    earliest = float(t[k])
    if drop > 0:
        earliest = max(earliest, float(t[first] - (held - y[first]) * (t[then] - t[first]) / drop))
    return 0.5 * (earliest + float(t[first])), 0.5 * (float(t[first]) - earliest)
