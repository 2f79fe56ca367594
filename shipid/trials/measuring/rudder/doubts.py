"""What the record of a rudder and of the heading leave open: stretches in which they are silent, samples that are left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.foundation.numbers import moment
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.plates import Plate

_LONG = 0.5
"""Silences longer than this share of the usual plate may hide an execute there and one back."""


def silent_in(steering: Steering, held: Sequence[Plate], faults: Faults) -> list[str]:
    """Return what to say of long silences of the rudder while it lies on one plate.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    held : sequence of Plate
        The plates of the manoeuvre.
    faults : Faults
        What the doctor found.
    """
    t, name = steering.channel.t, steering.channel.name
    ends = [steering.after(plate) for plate in held]
    longest = _LONG * float(np.median([end - t[plate.first] for plate, end in zip(held, ends)]))
    inside = [
        (a, b)
        for plate, end in zip(held, ends)
        for a, b in steering.channel.holes
        if t[plate.first] <= a and b <= end and b - a > longest
    ]
    return [f"{faults.hole(name, hole)}: executes in there are not counted" for hole in inside]


def others_than(held: Sequence[Plate], everything: Sequence[Plate]) -> int:
    """Return how often the rudder is over by half a plate or more beside the zig-zag.

    Parameters
    ----------
    held : sequence of Plate
        The plates of the zig-zag.
    everything : sequence of Plate
        All of the record.
    """
    size = float(np.median([abs(plate.angle) for plate in held]))
    return sum(abs(p.angle) > 0.5 * size and not held[0].first <= p.first <= held[-1].first for p in everything)


def left_out(channel: Channel) -> list[str]:
    """Return what to say of single wild samples that are left out.

    Parameters
    ----------
    channel : Channel
        The channel.
    """
    if not channel.spikes:
        return []
    times = ", ".join(moment(when) for when in channel.spikes[:3]) + (", ..." if len(channel.spikes) > 3 else "")
    return [f"{len(channel.spikes)} single wild samples of {channel.name} are left out (at {times} s)"]


def bridges(logged: Channel, psi: Channel, executes: Sequence[float], faults: Faults) -> list[str]:
    """Return what to say of short holes of the heading that are bridged.

    Parameters
    ----------
    logged, psi : Channel
        The heading as logged, and bridged.
    executes : sequence of float
        The reversals [s].
    faults : Faults
        What the doctor found.
    """
    inside = [h for h in logged.holes if h not in psi.holes and h[1] > executes[0]]
    return [f"{faults.hole('psi', hole)} is bridged by a cubic through its neighbours" for hole in inside]
