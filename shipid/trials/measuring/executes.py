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

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.errors import UsageError
from shipid.trials.errors import UnknownColumnError
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.signals.plates import Plate, held_angle, plates
from shipid.trials.trial import Trial

LEFT = 0.15
"""Share of the plate's angle by which the rudder has left it."""

_OFF = 0.08
"""Share of the way at which a rudder is certainly on its ramp."""

READINGS = ("order", "moved")


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


@dataclass(frozen=True, eq=False)
class Steering:
    """The record of the rudder, and how executes are read from it.

    Attributes
    ----------
    channel : Channel
        Rudder angle or order, by its own samples [rad].
    reading : {"order", "moved"}
        The reading.
    logged : bool
        Whether the channel is the order itself.
    on_change : bool
        Whether it is written only when it changes: its stamps are the executes.
    rate : float or None
        Rate of the rudder on its ramps, median [rad/s]; None where it steps or is not logged.
    end : float
        End of the record [s].
    feedback : Steering or None
        The rudder angle beside the logged order: its ramp tells when, within the interval in which the order stepped.
    """

    channel: Channel
    reading: str
    logged: bool
    on_change: bool
    rate: float | None
    end: float
    feedback: Steering | None = None

    @property
    def words(self) -> str:
        """How the executes are read."""
        if self.reading == "moved":
            return "the rudder leaving its plate by 15 %"
        if self.logged and self.on_change:
            return "the order, as logged, written when it changes"
        if self.logged:
            where = (
                "the middle of the interval of its step" if self.rate is None else "within it by the ramp of the rudder"
            )
            return f"the order, as logged every {self.channel.interval:.3g} s ({where})"
        if self.rate is None:
            return (
                f"the step of the rudder, recorded every {self.channel.interval:.3g} s (the middle of the interval of "
                "the step); the order is not logged"
            )
        return (
            f"the ramp of the rudder ({angle(self.rate, 3)}/s), extended back to the plate it leaves; "
            "the order is not logged"
        )

    def after(self, plate: Plate) -> float:
        """Return when a plate ends: the rudder is half over to the other side, or the record ends [s].

        Parameters
        ----------
        plate : Plate
            The plate.
        """
        t = self.channel.t
        return float(t[plate.last]) if plate.last < len(t) else self.end


def steering_of(
    trial: Trial, execute: str | None, column: str | None = None, wrong: np.ndarray | None = None
) -> Steering:
    """Choose the record of the rudder and the reading of the execute.

    Parameters
    ----------
    trial : Trial
        The trial.
    execute : {"order", "moved"} or None
        None is "order".
    column : {"delta", "delta_order"}, optional
        The record; the order where it is logged and asked for, by default.
    wrong : ndarray of bool, shape (samples,), optional
        Samples that count as missing.

    Returns
    -------
    Steering

    Raises
    ------
    UsageError
        If there is no such reading.
    UnknownColumnError
        If the trial has no rudder.
    """
    if execute not in (None, *READINGS):
        raise UsageError(f"execute is '{execute}'. Write 'moved' (the rudder has left its plate) or 'order'.")
    moved = execute == "moved"
    if column is None:
        ordered = trial.has("delta_order") and (not trial.has("delta") or _moves(trial["delta_order"]))
        if not ordered and not trial.has("delta"):
            raise UnknownColumnError(
                f"trial '{trial.name}' has no rudder angle, neither 'delta' nor 'delta_order': a manoeuvre cannot "
                "be measured without the moment of the order."
            )
        column = "delta_order" if ordered and not (moved and trial.has("delta")) else "delta"
    logged = column == "delta_order"
    channel = _without_blips(channel_of(trial, column, wrong, spikes=False))
    steps = np.diff(channel.y)
    on_change = logged and len(channel.y) < 0.5 * len(trial) and bool(np.mean(steps != 0) > 0.9)
    if on_change:
        channel = replace(channel, holes=())
    end = float(trial["t"][-1])
    feedback = None
    if logged and not on_change and trial.has("delta"):
        feedback = steering_of(trial, "order", "delta", wrong)
    rate = (
        ramp_rate(channel.t, channel.y, plates(channel.y))
        if not logged
        else None
        if feedback is None
        else feedback.rate
    )
    return Steering(channel, "moved" if moved else "order", logged, on_change, rate, end, feedback)


def _moves(order: np.ndarray) -> bool:
    there = order[np.isfinite(order)]
    return bool(there.size and np.ptp(there) > 0)


def _without_blips(channel: Channel) -> Channel:
    """Leave out single samples far off both neighbours, which agree: no rudder goes over and back in one interval."""
    y = channel.y
    if len(y) < 15:
        return channel
    size = float(np.quantile(np.abs(y), 0.9))
    before, after = y[1:-1] - y[:-2], y[1:-1] - y[2:]
    blip = np.r_[False, (before * after > 0) & (np.minimum(abs(before), abs(after)) > max(0.3 * size, 1e-6)), False]
    blip[1:-1] &= np.abs(y[2:] - y[:-2]) < 0.1 * size
    # The last sample and the first have one neighbour: beyond any other is beyond the rudder's stops.
    limit = 1.5 * float(np.quantile(np.abs(y), 0.98)) + 1e-6
    blip[[0, -1]] = np.abs(y[[0, -1]]) > limit
    if not blip.any() or blip.sum() > 0.05 * len(y):
        return channel
    spikes = tuple(float(when) for when in channel.t[blip])
    return replace(channel, t=channel.t[~blip], y=y[~blip], spikes=spikes)


def ramp_rate(t: np.ndarray, y: np.ndarray, held: Sequence[Plate]) -> float | None:
    """Return the median rate of the rudder on its ramps to plates; None where it steps from one sample to the next.

    Parameters
    ----------
    t, y : ndarray, shape (n,)
        Time [s] and rudder angle [rad].
    held : sequence of Plate
        The plates.

    Returns
    -------
    float or None
        In rad/s.
    """
    found = []
    for k, plate in enumerate(held):
        before = held[k - 1] if k and held[k - 1].last == plate.first and held[k - 1].idle < 0.3 else None
        size = abs(plate.angle)
        low = 0.15 * size if before is None else -0.85 * abs(before.angle)
        share = plate.side * y[: plate.last]
        begins = np.flatnonzero(share[: plate.first + 1] <= low)
        ends = plate.first + np.flatnonzero(share[plate.first :] >= 0.85 * size)
        if not begins.size or not ends.size:
            continue
        inside = slice(int(begins[-1]) + 1, int(ends[0]))
        if inside.stop - inside.start < 2:
            continue
        x = t[inside] - t[inside][0]
        offset, slope = np.polynomial.polynomial.polyfit(x, share[inside], 1)
        # A helm that wanders towards the plate by hand is no ramp, and the line does not lead there.
        leads = offset + slope * (t[ends[0]] - t[inside][0]) > 0.75 * size
        if slope > 0 and leads and float(np.std(share[inside] - offset - slope * x)) < 0.08 * (0.85 * size - low):
            found.append(float(slope))
    return float(np.median(found)) if found else None


def rate_of(steering: Steering, held: Sequence[Plate]) -> Steering:
    """Return the record of the rudder with the rate of its ramps to these plates: hand steering elsewhere says nothing of it.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    held : sequence of Plate
        The plates of the manoeuvre.
    """
    if steering.logged:
        return steering
    return replace(steering, rate=ramp_rate(steering.channel.t, steering.channel.y, held))


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
    found = _put_over(steering, near, y, plate.last - plate.first, abs(plate.angle), 0.0, 1.8)
    return _refined(steering, found, plate.side)


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
    before = plate.side * rudder[: plate.first]
    way = abs(plate.angle)
    calm = np.flatnonzero(np.abs(before) < 0.3 * way)
    if not calm.size:
        return None
    # The neutral angle: where the rudder stays before, over a stretch no longer than the plate is held.
    recent = calm[-max(5, plate.last - plate.first) :]
    neutral = held_angle(before[recent])
    y = -plate.side * rudder
    share = plate.first + 1
    if moved is None or steering.reading == "order":
        near = slice(max(0, int(recent[0])), min(len(t), plate.last))
        found = _put_over(steering, near, y[near], share - near.start, -neutral, -way, 0.9)
        return _refined(steering, found, -plate.side), plate.side * neutral
    # From midships, unless the helm carried more than that before.
    still = np.flatnonzero(y[:share] > -(moved if neutral < moved else neutral + moved))
    k = int(still[-1])
    return _moved(steering.channel, k), plate.side * neutral


def _refined(steering: Steering, found: Execute, side: int) -> Execute:
    """The execute within the interval of a logged step, by the ramp of the rudder that answers it, if it begins in there."""
    feedback = steering.feedback
    if feedback is None or feedback.rate is None or found.hole is not None or steering.reading != "order":
        return found
    t, y = feedback.channel.t, side * feedback.channel.y
    k = int(np.searchsorted(t, found.time - found.within + 1e-9, side="right")) - 1
    if k < 0 or k + 3 >= len(t):
        return found
    # The rudder where it lay, and the ramp at about its usual rate behind it.
    held = float(y[k])
    slower = k + 1 + np.flatnonzero(np.diff(y[k + 1 :]) > -0.3 * feedback.rate * np.diff(t[k + 1 :]))
    stop = int(slower[0]) + 1 if slower.size else len(t)
    ramp = np.arange(k + 2, min(stop, k + 12))
    if ramp.size < 2:
        return found
    left, inaccuracy = _extended(t, y, ramp, held, feedback.rate, k)
    if abs(left - found.time) > found.within + inaccuracy:
        return found
    return Execute(left, min(inaccuracy, found.within))


def _moved(channel: Channel, k: int) -> Execute:
    after = float(channel.t[min(k + 1, len(channel.t) - 1)])
    when = float(channel.t[k])
    return Execute(when, 0.5 * (after - when), channel.hole(0.5 * (when + after)))


def _put_over(
    steering: Steering, near: slice, y: np.ndarray, end: int, held: float, towards: float, reach: float
) -> Execute:
    """Execute at which `y`, held until somewhere before sample `end`, sets out for `towards` (downwards)."""
    t = steering.channel.t[near]
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
    if not steering.logged:
        k = _foot(t, y, k, held, size, steering)
    ramp = _ramp(y[k + 1 :], held, size, reach) + k + 1
    hole = steering.channel.hole(0.5 * float(t[k] + t[k + 1]))
    if steering.logged or steering.rate is None or not ramp.size:
        return Execute(0.5 * float(t[k] + t[k + 1]), 0.5 * float(t[k + 1] - t[k]), hole)
    left, inaccuracy = _extended(t, y, ramp, held, steering.rate, k)
    slack = 0.0 if steering.channel.digit is None else 0.5 * steering.channel.digit / (steering.rate or np.inf)
    # A ramp that is seen from the hole on gives the order all the same.
    known = hole is None or (ramp.size >= 2 and steering.rate is not None)
    return Execute(max(left, float(t[0])), inaccuracy + slack, None if known else hole)


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
        return j - 1 if y[j - 1] - y[j] > 0.3 * size else max(k, j - 2)
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
    last = min(last, int(rising[0]) + 1) if rising.size else last
    all_of_it = np.flatnonzero(inside[:last])
    first_half = all_of_it[y[all_of_it] >= held - 0.6 * size]
    return first_half if first_half.size >= 4 else all_of_it[:4]


def _extended(
    t: np.ndarray, y: np.ndarray, ramp: np.ndarray, held: float, rate: float | None, k: int
) -> tuple[float, float]:
    """When the ramp left the plate [s], and how far off that may be [s]."""
    if ramp.size >= 3 or (ramp.size == 2 and rate is None):
        x = t[ramp] - t[ramp[0]]
        offset, slope = np.polynomial.polynomial.polyfit(x, y[ramp], 1)
        if slope < 0:
            scatter = float(np.std(y[ramp] - offset - slope * x))
            # A gear does not start at once: some hundredths of the interval, where the samples lie on the line.
            inaccuracy = max(2 * scatter / -float(slope) / np.sqrt(ramp.size), 0.02 * float(t[k + 1] - t[k]))
            return float(t[ramp[0]] + (held - offset) / slope), float(inaccuracy)
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
