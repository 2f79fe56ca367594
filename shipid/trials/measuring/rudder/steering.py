"""The record of the rudder a manoeuvre is steered by: the order or the angle, the rate of its ramps, how executes are read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.errors import UsageError
from shipid.foundation.numbers import brief
from shipid.trials.errors import UnknownColumnError
from shipid.trials.filling import GAP, usual_interval
from shipid.trials.holding import between_knots, repeats_of
from shipid.trials.signals.channel import Channel, channel_of
from shipid.trials.signals.coarse import ramps_of
from shipid.trials.signals.order import order_against_feedback
from shipid.trials.signals.plates import Plate, plates, regular
from shipid.trials.trial import Trial

READINGS = ("order", "moved")

_BEATS = 25
"""Values of a slow sensor at least: a rudder of fewer, that steps at a beat, is held at one angle after the other."""

_SLOWEST = 20.0
"""Beat of the slowest sensor of a rudder [s]: one that steps at a longer beat is held so, as in a spiral."""


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
        End of what is known of the rudder [s]: of the record, or before it where the rudder falls silent.
    feedback : Steering or None
        The rudder angle beside the logged order: its ramp tells when, within the interval in which the order stepped.
    answers : tuple of Plate
        The plates of that rudder.
    doubt : str
        Why the logged order is not what is read, in words; empty where it is, or where none is logged.
    silence : tuple of float or None
        From when to when the record goes on without the rudder [s].
    """

    channel: Channel
    reading: str
    logged: bool
    on_change: bool
    rate: float | None
    end: float
    feedback: Steering | None = None
    answers: tuple[Plate, ...] = ()
    doubt: str = ""
    silence: tuple[float, float] | None = None

    @property
    def words(self) -> str:
        """How the executes are read."""
        if self.reading == "moved":
            return "the rudder 15 % off the angle it held"
        if self.logged and self.on_change:
            return "the order, as logged, written when it changes"
        if self.logged:
            ramp = "between two samples, the ramp of the rudder"
            where = "the middle of the interval of its step" if self.rate is None else ramp
            return f"the order, as logged every {brief(self.channel.interval)} s ({where})"
        why = self.doubt or "the order is not logged"
        if self.rate is None:
            return (
                f"the step of the rudder, recorded every {brief(self.channel.interval)} s (the middle of the interval of "
                f"the step); {why}"
            )
        return f"the ramp of the rudder ({angle(self.rate, 3)}/s), extended back to the angle it leaves; {why}"

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
    check_rudder(trial, execute)
    moved = execute == "moved"
    doubt = ""
    if column is None:
        ordered = _ordered(trial)
        if ordered and trial.has("delta"):
            doubt = order_against_feedback(trial["t"], trial["delta_order"], trial["delta"])
            ordered = not doubt
        column = "delta_order" if ordered and not (moved and trial.has("delta")) else "delta"
    logged = column == "delta_order"
    rejected = wrong
    if not logged:
        # A slow sensor whose last value is written again in every row, or drawn on to the next, knows the rudder at its own beat; of few values each is held.
        angles = trial[column]
        again = repeats_of(angles)
        again = between_knots(angles) if again is None else again
        own = np.empty(0) if again is None else trial["t"][~again]
        if again is not None and len(own) >= _BEATS and usual_interval(own) <= _SLOWEST:
            wrong = again if wrong is None else wrong | again
    channel = _without_blips(channel_of(trial, column, wrong, spikes=False))
    channel = channel if logged else _drawn(channel)
    steps = np.diff(channel.y)
    on_change = logged and len(channel.y) < 0.5 * len(trial) and bool(np.mean(steps != 0) > 0.9)
    if on_change:
        channel = replace(channel, holes=())
    silence = None if on_change else _silence(trial, column, rejected, channel)
    end = float(trial["t"][-1]) if silence is None else silence[0]
    feedback, answers = None, []
    if logged and not on_change and trial.has("delta"):
        feedback = steering_of(trial, "order", "delta", wrong)
        answers = plates(feedback.channel.y)
        feedback = rate_of(feedback, regular(answers) or answers)
    rate = (
        ramp_rate(channel.t, channel.y, plates(channel.y))
        if not logged
        else None
        if feedback is None
        else feedback.rate
    )
    return Steering(
        channel, "moved" if moved else "order", logged, on_change, rate, end, feedback, tuple(answers), doubt, silence
    )


def check_rudder(trial: Trial, execute: str | None) -> None:
    """Refuse a trial without a rudder, and a reading of the execute that does not exist.

    Parameters
    ----------
    trial : Trial
        The trial.
    execute : {"order", "moved"} or None
        None is "order".

    Raises
    ------
    UsageError
        If there is no such reading.
    UnknownColumnError
        If the trial has no rudder.
    """
    if execute not in (None, *READINGS):
        raise UsageError(f"execute is '{execute}'. Write 'moved' (the rudder is off the angle it held) or 'order'.")
    if not trial.has("delta") and not _ordered(trial):
        raise UnknownColumnError(
            f"trial '{trial.name}' has no rudder angle, neither 'delta' nor 'delta_order': a manoeuvre cannot "
            "be measured without the moment of the order."
        )


def _ordered(trial: Trial) -> bool:
    """Whether the order is logged and is the record of a rudder: one that never moves beside a feedback is not."""
    return trial.has("delta_order") and (not trial.has("delta") or _moves(trial["delta_order"]))


def _silence(trial: Trial, column: str, wrong: np.ndarray | None, channel: Channel) -> tuple[float, float] | None:
    """From the last sample of the rudder to the end of the record; None where it comes to the end, or holds until it is written again."""
    t, there = trial["t"], np.isfinite(trial[column])
    if wrong is not None:
        there &= ~wrong
    last = float(t[np.flatnonzero(there)[-1]]) if there.any() else float(t[-1])
    if channel.digit is not None or t[-1] - last <= GAP * usual_interval(t[there]):
        return None
    return last, float(t[-1])


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
    # On a ramp the neighbours are apart, by less than the sample is off both.
    apart = np.abs(y[2:] - y[:-2])
    blip[1:-1] &= (apart < 0.1 * size) | (apart < np.minimum(abs(before), abs(after)))
    # Two in a row that go over and back faster than any ramp.
    fast = max(0.3 * size, 2 * float(np.quantile(np.abs(np.diff(y)), 0.95)), 1e-6)
    over, back = y[1:-2] - y[:-3], y[2:-1] - y[3:]
    pair = (
        (over * back > 0)
        & (np.minimum(abs(over), abs(back)) > fast)
        & (np.abs(y[3:] - y[:-3]) < np.minimum(abs(over), abs(back)))
    )
    blip[1:-2] |= pair
    blip[2:-1] |= pair
    # The last sample and the first have one neighbour: beyond any other is beyond the rudder's stops.
    limit = 1.5 * float(np.quantile(np.abs(y), 0.98)) + 1e-6
    blip[[0, -1]] = np.abs(y[[0, -1]]) > limit
    if not blip.any() or blip.sum() > 0.05 * len(y):
        return channel
    spikes = tuple(float(when) for when in channel.t[blip])
    return replace(channel, t=channel.t[~blip], y=y[~blip], spikes=spikes)


def _drawn(channel: Channel) -> Channel:
    """The rudder angle with the ramps of coarse steps drawn as lines; `grain` is None where its steps are finer than its samples."""
    found = ramps_of(channel.t, channel.y)
    return replace(channel, grain=None) if found is None else replace(channel, y=found.y, grain=found.step)


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
