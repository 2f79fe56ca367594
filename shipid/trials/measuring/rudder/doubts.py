"""What the record of the rudder leaves open: orders that it follows late, stretches in which it is silent."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.rudder.executes import leaves
from shipid.trials.measuring.rudder.steering import Steering
from shipid.trials.signals.order import LATE, LATE_SAMPLES, lag_behind_order
from shipid.trials.signals.plates import Plate
from shipid.trials.trial import Trial

_LONG = 0.5
"""Silences longer than this share of the usual plate may hide an execute there and one back."""


def late_by(trial: Trial, steering: Steering) -> float | None:
    """Return how long after the logged order the rudder sets out [s]; None where it does so at once, or where that is not known.

    Parameters
    ----------
    trial : Trial
        The trial.
    steering : Steering
        The record of the rudder.
    """
    if not steering.logged or steering.reading != "order" or not trial.has("delta"):
        return None
    lag = lag_behind_order(trial["t"], trial["delta_order"], trial["delta"])
    return None if lag is None or lag < max(LATE, LATE_SAMPLES * steering.channel.interval) else lag


def setting_out(steering: Steering, orders: Sequence[float], lag: float) -> list[float]:
    """Return when the rudder leaves its plate after each order, by its ramp [s].

    Parameters
    ----------
    steering : Steering
        The record of the order, with that of the rudder beside it.
    orders : sequence of float
        When the orders were given [s].
    lag : float
        How much later the rudder usually leaves [s].
    """
    rudder = steering.feedback
    if rudder is None or len(steering.answers) < 2:
        return [when + lag for when in orders]
    seen = np.array([leaves(rudder, plate).time for plate in steering.answers[:-1]])
    usual = np.asarray(orders) + lag
    nearest = seen[np.abs(usual[:, None] - seen).argmin(axis=1)]
    return [float(a) for a in np.where(np.abs(nearest - usual) < 0.5 * lag, nearest, usual)]


def late_words(lag: float) -> str:
    """Return what to say of a rudder that is late.

    Parameters
    ----------
    lag : float
        How late [s].
    """
    return f"the rudder sets out {lag:.3g} s after the order: the gear has a dead time, or the order is stamped early"


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
