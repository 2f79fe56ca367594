"""The two ends of a zig-zag: what the rudder did before its first regular plate, and what it does once the course is kept again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.trials.measuring.rudder.executes import leaves
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.plates import DWELL, IDLE, Plate, reached_angle

_ALIKE = 0.3
"""Headings at which the rudder is reversed are one where they are this share of it apart."""

_COMES_OFF = 0.4
"""A rudder that moves at more than this share of the rate of its gear is on its way."""

_TIP = 0.15
"""A rudder that goes over by less than this share of its plate before it is no order of the zig-zag."""

_OTHER = 0.4
"""A reversal farther from the usual heading than this share of it was not ordered by the zig-zag."""


def without_keeping(steering: Steering, psi: Channel, held: list[Plate]) -> list[Plate]:
    """Return the plates of a zig-zag without those of rough course keeping after it: they are left at other headings.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    psi : Channel
        The heading.
    held : list of Plate
        The regular plates.

    Returns
    -------
    list of Plate
        All of them where fewer than three reversals at the beginning tell the heading.
    """
    if len(held) < 5:
        return held
    at = np.interp([leaves(steering, plate).time for plate in held[:-1]], psi.t, psi.y) * held[0].side
    out, back = float(np.median(at[0:3:2])), float(at[1])
    usual = np.where(np.arange(len(at)) % 2 == 0, out, back)
    swing = 0.5 * (out - back)
    if abs(at[0] - at[2]) > _ALIKE * swing:
        return held
    # A single one among others was late, or early.
    of_it = np.flatnonzero(np.abs(at - usual) <= _OTHER * swing)
    return held[: int(of_it[-1]) + 2]


def turned_back(steering: Steering, psi: Channel, everything: Sequence[Plate], held: Sequence[Plate]) -> list[Plate]:
    """Return the plates before the first, where slow gear was reversed short of it, at the heading of the other reversals.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    psi : Channel
        The heading.
    everything : sequence of Plate
        All plates of the record.
    held : sequence of Plate
        The regular ones.

    Returns
    -------
    list of Plate
        In order of time; seldom more than one.
    """
    k = next(i for i, plate in enumerate(everything) if plate.first == held[0].first)
    if len(held) < 3:
        return []
    before = everything[k - 1] if k else _short_of_half(steering, held[0])
    if before is None or before.side == held[0].side or before.idle > IDLE or before.dwell < DWELL:
        return []
    at = np.interp([leaves(steering, plate).time for plate in (before, *held[:-1])], psi.t, psi.y) * before.side
    swing = 0.5 * float(at[0] - at[1])
    alike = max(float(np.ptp(at[0::2])), float(np.ptp(at[1::2]))) < _ALIKE * swing
    if not (swing > 0 and alike):
        return []
    earlier = everything if k else [before, *everything]
    return [*turned_back(steering, psi, earlier, [before, *held]), before]


def _short_of_half(steering: Steering, first: Plate) -> Plate | None:
    """The tip that gear so slow was reversed at that it is no plate: not half over to the other side before the first."""
    y = -first.side * steering.channel.y[: first.first]
    over = np.flatnonzero(y > _TIP * abs(first.angle))
    if not over.size:
        return None
    gaps = np.flatnonzero(np.diff(over) > 1)
    run = over[int(gaps[-1]) + 1 :] if gaps.size else over
    peak = reached_angle(y[run])
    begin = int(run[np.argmax(y[run] >= 0.5 * peak)])
    put = y[begin : int(run[-1]) + 1]
    dwell = float(np.mean(np.abs(put - peak) <= 0.2 * peak))
    return Plate(begin, first.first, -first.side * peak, dwell, float(np.mean(np.abs(y[begin:]) < 0.15 * peak)))


def begins_on_its_way(steering: Steering, first: Plate) -> bool:
    """Return whether the record begins with the rudder coming off a plate, so that it was ordered off it before.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    first : Plate
        The first plate.
    """
    channel = steering.channel
    if first.first or steering.logged or steering.rate is None:
        return False
    last = min(max(2, int(np.ceil(1.0 / channel.interval))), len(channel.t) - 1)
    falls = first.side * float(channel.y[0] - channel.y[last]) / float(channel.t[last] - channel.t[0])
    return falls > _COMES_OFF * steering.rate


def goes_on_from(steering: Steering, everything: Sequence[Plate], held: Sequence[Plate]) -> bool:
    """Return whether the zig-zag goes on from a plate like its own, too short or too coarsely sampled to be measured itself.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    everything : sequence of Plate
        All plates of the record.
    held : sequence of Plate
        The regular ones.
    """
    k = next(i for i, plate in enumerate(everything) if plate.first == held[0].first)
    before = everything[k - 1] if k else None
    size = float(np.median([abs(plate.angle) for plate in held]))
    if before is None or before.side == held[0].side or before.idle > IDLE:
        return False
    peak = float(np.abs(steering.channel.y[before.first : before.last]).max())
    return 0.9 * size < peak < 1.1 * size
