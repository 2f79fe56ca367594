"""The angles at which the rudder lies before it sets out: on a plate, and before the first one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shipid.trials.measuring.rudder.ramps import RampLine, line_through
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.plates import Plate, held_angle, reached_angle

_MOST = 60
"""Samples of a plate that are averaged at most: the last ones, from which the rudder sets out."""

_HELD = 6
"""Samples on a plate at least: fewer are told from its ramps by what fits best."""

_BESIDE = 0.7
"""Share of a ramp on either side of half of the way that a line is drawn through."""

_SHORT = 0.97
"""A rudder that is reversed below this share of its usual angle had not reached its plate."""

_CALM = 1.5
"""A rudder scatters so many times as much as from sample to sample at most, where it lies still."""

_OPPOSITE = 0.08
"""A rudder beyond this share of its way, on the other side, sets out from there."""

_COMES = 0.15
"""A rudder this share of its way over on the other side need not lie there: from less it sets out where it lay still."""

_TOP = 0.03
"""A rudder that is held stays within this share of its angle from sample to sample."""

_PASSES = 1.3
"""A rudder that goes over from one side to the other takes so many times as long as at its rate, at the most."""


@dataclass(frozen=True)
class Level:
    """An angle at which the rudder lies.

    Attributes
    ----------
    angle : float
        The angle [rad], positive to the side of the plate.
    scatter : float
        Its standard deviation [rad]; 0 where the samples do not tell.
    """

    angle: float
    scatter: float = 0.0


def level_held(steering: Steering, plate: Plate) -> Level:
    """Return the angle of a plate: that of the samples between its two ramps; where slow gear leaves none, where the ramps meet.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    plate : Plate
        The plate.
    """
    level, rate = Level(abs(plate.angle)), steering.rate
    if steering.logged or rate is None or steering.reading != "order":
        return level
    half = 0.5 * level.angle
    begin = max(0, plate.first - round(half / rate / steering.channel.interval))
    t, y = steering.channel.t[begin : plate.last], plate.side * steering.channel.y[begin : plate.last]
    over = np.flatnonzero(y >= half)
    over = over[over >= plate.first - begin]
    if not over.size:
        return level
    up, down = (float(t[k] - s * (y[k] - half) / rate) for k, s in ((over[0], 1), (over[-1], -1)))
    found = level
    for _ in range(3):
        ramp = (found.angle - half) / rate
        inside = np.flatnonzero((t > up + ramp) & (t < down - ramp))
        if inside.size >= _HELD:
            found = _middle(y[inside[-min(_MOST, 2 * inside.size // 3) :]])
    usual = float(np.quantile(np.abs(steering.channel.y), 0.9))
    if inside.size < _HELD or (inside.size < 3 * _HELD and found.angle < _SHORT * usual):
        rising, falling = (
            line_through(t[near], y[near])
            for near in (np.abs(t - middle) <= _BESIDE * half / rate for middle in (up, down))
        )
        if plate.first == 0 or rising is None or falling is None or not rising.slope > 0 > falling.slope:
            return level
        inside = np.flatnonzero((t >= up) & (t <= down))
        found = _between(t[inside], y[inside], rising, falling, usual)
    return found if abs(found.angle - level.angle) < 0.2 * level.angle else level


def _between(t: np.ndarray, y: np.ndarray, rising: RampLine, falling: RampLine, usual: float) -> Level:
    """The middle of the angles at which a rudder may have been held, for a moment or not at all, between two ramps.

    Where its ramps meet short of the usual plate it was reversed on its way, and held nowhere.
    """
    roof = np.minimum(rising.at(t), falling.at(t))
    meet = falling.reaches(0.0, 0.0)[0] - rising.reaches(0.0, 0.0)[0]
    top = meet * rising.slope * falling.slope / (falling.slope - rising.slope)
    levels = np.linspace(0.8 * top, top, 201)
    away = np.square(np.minimum(roof[:, None], levels[None, :]) - y[:, None]).sum(axis=0)
    scatter = max(rising.scatter, falling.scatter)
    alike = levels[away <= away.min() + (2 * scatter) ** 2 + 1e-15]
    own = scatter / float(np.sqrt(min(rising.count, falling.count)))
    if alike[-1] == top and top + 2 * own < _SHORT * usual:
        return Level(float(top), own)
    return Level(float(alike[0] + alike[-1]) / 2, float(np.hypot(own, (alike[-1] - alike[0]) / 4)))


def level_before(steering: Steering, plate: Plate, recent: np.ndarray) -> Level:
    """Return the angle from which the rudder sets out for its first plate.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    plate : Plate
        The plate it goes to.
    recent : ndarray of int
        Samples before it, at angles near midships.
    """
    t, y = steering.channel.t, plate.side * steering.channel.y
    if steering.logged or steering.rate is None or plate.first == 0:
        return Level(held_angle(y[recent]))
    half = float(t[plate.first]) - (float(y[plate.first]) - 0.5 * abs(plate.angle)) / steering.rate
    still = y[recent[t[recent] < half - 0.6 * abs(plate.angle) / steering.rate - steering.channel.interval]]
    if len(still) < 5:
        return Level(held_angle(y[recent]))
    noise = 1.4826 * float(np.median(np.abs(np.diff(still)))) / np.sqrt(2)
    if float(np.std(still)) < _CALM * noise:
        return _middle(still[-_MOST:])
    # A helm that wanders is left where it stayed longest, or else somewhere on its way; only noise is averaged.
    held = held_angle(y[recent])
    return Level(held, 0.5 * float(np.quantile(np.abs(still - held), 0.75)))


def level_opposite(steering: Steering, plate: Plate) -> Level:
    """Return the angle that the rudder has where it turns back from a stretch on the other side, which it may only touch.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    plate : Plate
        That stretch.
    """
    if steering.logged or steering.rate is None or plate.last - plate.first >= 3 * _HELD:
        return level_held(steering, plate)
    y = plate.side * steering.channel.y[plate.first : plate.last]
    between = 0.5 * steering.rate * steering.channel.interval
    top = y[y >= y.max() - between - _TOP * abs(plate.angle)]
    # It turns back at a sample, or between two.
    return _middle(top) if len(top) >= 3 else Level(float(y.max()) + 0.5 * between, 0.3 * between)


def opposite_helm(steering: Steering, plate: Plate) -> Plate | None:
    """Return the stretch on the other side from which the rudder goes over to its first plate; None where it comes from midships.

    A helm that wanders from side to side, as in steering by hand, is no such stretch: it is somewhere on its way when it is ordered.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    plate : Plate
        The plate it goes to.
    """
    t, y, way = steering.channel.t, -plate.side * steering.channel.y, abs(plate.angle)
    least = _OPPOSITE * way
    beyond = np.flatnonzero(y[: plate.first] > least)
    if not beyond.size:
        return None
    last = int(beyond[-1])
    interval = steering.channel.interval
    passing = 2.1 * interval
    if steering.rate is not None:
        passing += _PASSES * (0.5 * way + float(y[last])) / steering.rate
    if t[plate.first] - t[last] > passing:
        return None
    inside = np.flatnonzero(y[: last + 1] <= least)
    begin = int(inside[-1]) + 1 if inside.size else 0
    part = y[begin : last + 1]
    angle = reached_angle(part[part >= 0.5 * part.max()])
    over = np.flatnonzero(part >= 0.5 * angle)
    stretch = part[over[0] : over[-1] + 1]
    dwell = float(np.mean(np.abs(stretch - angle) <= 0.2 * angle))
    before = np.abs(y[max(0, begin - 3 * len(part)) : begin])
    alone = not before.size or float(np.quantile(before, 0.9)) < 0.3 * angle
    if not (dwell > 0.5 and len(stretch) >= _HELD) and not (alone and angle > _COMES * way):
        return None
    end = begin + int(over[-1]) + 1
    return Plate(begin + int(over[0]), end, -plate.side * angle, dwell)


def _middle(values: np.ndarray) -> Level:
    """Median of values, and its standard deviation."""
    scatter = 1.4826 * float(np.median(np.abs(values - np.median(values))))
    return Level(float(np.median(values)), 1.25 * scatter / np.sqrt(len(values)))
