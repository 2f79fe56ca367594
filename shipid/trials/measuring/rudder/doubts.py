"""What the record of a rudder and of the heading leave open: stretches in which they are silent, samples that are left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.vocabulary import angle
from shipid.foundation.notices import Notice
from shipid.foundation.numbers import moment
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.channel import Channel
from shipid.trials.signals.plates import Plate

_RESTS, _FEWEST = 10, 5
"""Samples amidships, and on a plate, that tell whether the sensor scatters."""

_REPEATS, _STANDS = 0.05, 0.8
"""A sensor that scatters repeats a value for less than the first share of its samples; one at the end of its range for more than the second."""

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


def at_end_of_range(steering: Steering, held: Sequence[Plate]) -> list[Notice]:
    """Return a serious notice where the sensor of the rudder is at the end of its range: the rudder goes on beyond what is written.

    A sensor that scatters where the rudder rests amidships scatters on its plates too, unless it can show no more.

    Parameters
    ----------
    steering : Steering
        The record of the rudder.
    held : sequence of Plate
        The plates of the manoeuvre.
    """
    y, size = steering.channel.y, float(np.median([abs(plate.angle) for plate in held]))
    rest = y[: held[0].first][np.abs(y[: held[0].first]) < 0.3 * size]
    if steering.logged or len(rest) < _RESTS:
        return []
    steps = np.abs(np.diff(rest))
    scatter = 1.4826 * float(np.median(steps)) / float(np.sqrt(2))
    still = 1.4826 * float(np.median(np.abs(rest - np.median(rest))))
    between = np.diff(y[np.abs(y) < 0.5 * size])
    if float(np.mean(between == 0)) > _REPEATS or still > 2 * scatter or scatter == 0:
        return []
    ends = [y[p.first : p.last][np.abs(y[p.first : p.last]) > abs(p.angle) - 3 * scatter] for p in held]
    stands = [len(one) >= _FEWEST and float(np.mean(np.diff(one) == 0)) > _STANDS for one in ends]
    if not all(stands[:-1] or stands):
        return []
    words = (
        f"the rudder repeats {angle(size, 3)} exactly while it is held, and scatters by {angle(scatter, 2)} amidships: its sensor shows "
        "no more, the rudder goes further, and the orders are earlier than is read from its ramps"
    )
    return [Notice(words, "clipped", serious=True, channel=steering.channel.name)]


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
