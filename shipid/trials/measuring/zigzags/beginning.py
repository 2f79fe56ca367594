"""What a zig-zag measures from its first execute: approach speed, initial turning, reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.foundation.aliases import Plain
from shipid.foundation.numbers import brief
from shipid.foundation.statistics import NORMAL_95
from shipid.trials.measuring.faults import Faults
from shipid.trials.measuring.rudder.executes import Execute
from shipid.trials.measuring.track import distance_between, speed_channel
from shipid.trials.measuring.uncertainty import scatter_of
from shipid.trials.signals import series
from shipid.trials.signals.channel import Channel
from shipid.trials.trial import Trial

#: Reversed at so much of its angle, a ship turns on to all of it before the rudder takes hold.
_ALL_BUT = 0.85


@dataclass(frozen=True)
class Swing:
    """The heading of a zig-zag until its second execute.

    Attributes
    ----------
    psi : Channel
        The heading, short holes bridged.
    course : float
        Heading before the first execute [rad].
    side : {1, -1}
        Of the first plate; 1 is starboard.
    switch : float
        Change of heading for which the zig-zag is named [rad].
    half : float
        Half the width over which the heading is averaged [s].
    late : float
        By so much the clocks of rudder and heading may be apart [s].
    """

    psi: Channel
    course: float
    side: int
    switch: float
    half: float
    late: float


def measure_beginning(
    trial: Trial,
    swing: Swing,
    first: Execute | None,
    second: Execute,
    faults: Faults,
    reasons: dict[str, str],
    silent: tuple[float, float] | None,
) -> dict[str, Plain]:
    """Return what is measured from the first execute, by name.

    Parameters
    ----------
    trial : Trial
        The trial.
    swing : Swing
        Its heading.
    first, second : Execute or None, Execute
        The first execute, where the record shows it, and the first reversal.
    faults : Faults
        What the doctor found.
    reasons : dict of str to str
        Why a quantity is not known, by its name; written to.
    silent : tuple of float, or None
        A hole of the rudder while it was on its first plate [s].
    """
    psi, course, side = swing.psi, swing.course, swing.side
    names = (
        *("approach_speed", "first_execute", "initial_turning_time", "initial_turning_distance"),
        *("initial_turning_ability", "reach"),
    )
    result: dict[str, Plain] = dict.fromkeys(names)
    if first is None:
        for name in names:
            reasons[name] = "the record does not show the rudder setting out for the first angle it holds"
        return result
    if first.hole is not None:
        for name in names:
            reasons[name] = faults.hole("delta", first.hole)
        return result
    result["first_execute"] = first.time
    hole = second.hole or silent
    if hole is None:
        result["initial_turning_time"] = second.time - first.time
    else:
        for name in ("initial_turning_time", "initial_turning_distance", "initial_turning_ability"):
            reasons[name] = faults.hole("delta", hole)
    moving = speed_channel(trial, faults.wrong)
    if moving is not None:
        moving = moving.bridged(0.5 * second.time - 0.5 * first.time if moving.digit is None else 0.0)
        if (hole := moving.hole(first.time)) is not None:
            reasons["approach_speed"] = faults.hole(moving.name, hole)
        else:
            result["approach_speed"] = series.value_at(moving.t, moving.y, first.time, swing.half, 1)
        if (hole := moving.hole(first.time, second.time)) is not None:
            reasons["initial_turning_distance"] = faults.hole(moving.name, hole)
        elif second.hole is None and silent is None:
            result["initial_turning_distance"] = distance_between(moving, first.time, second.time)
        if "initial_turning_ability" not in reasons:
            result |= _ability(swing, moving, first, second, faults, reasons)
    after = psi.t > second.time
    back = series.crossing(psi.t[after], -side * (psi.y[after] - course), 0.0)
    if back is not None and (hole := psi.hole(back)) is not None:
        reasons["reach"] = faults.hole("psi", hole)
    elif back is not None:
        result["reach"] = back - first.time
    return result


def _ability(
    swing: Swing, moving: Channel, first: Execute, second: Execute, faults: Faults, reasons: dict[str, str]
) -> dict[str, Plain]:
    """The track until the heading has changed by the angle of the zig-zag, with its 95 % uncertainty.

    Whoever reverses the rudder late or early does not change how fast the ship turned. What is uncertain: the moment of the order; the
    heading before it and at the angle, by its scatter and digits; scatter and digits of the speed. A log that is off all the time is not.
    """
    psi, degrees = swing.psi, brief(float(np.degrees(swing.switch)))
    turned, scatter = swing.side * (psi.y - swing.course), NORMAL_95 * scatter_of(psi.y)
    if np.interp(second.time, psi.t, turned) + np.sqrt(2) * scatter < _ALL_BUT * swing.switch:
        reasons["initial_turning_ability"] = f"the rudder was reversed before the heading had changed by {degrees} deg"
        return {}
    after = psi.t > first.time
    calm = series.local_values(psi.t[after], turned[after], swing.half)
    when = series.crossing(psi.t[after], calm, swing.switch)
    if when is None:
        reasons["initial_turning_ability"] = f"the heading did not change by {degrees} deg"
        return {}
    # The heading counts where it has changed, the speed all the way.
    for channel, hole in ((psi, psi.hole(when)), (moving, moving.hole(first.time, when))):
        if hole is not None:
            reasons["initial_turning_ability"] = faults.hole(channel.name, hole)
            return {}
    if (why := faults.step(first.time, when)) is not None:
        reasons["initial_turning_ability"] = why
        return {}
    lasts = when - first.time
    count = max(1, int(np.sum(np.abs(psi.t - when) <= swing.half)))
    # By a quarter of the way on either side: over a few samples the scatter would make a rate of its own.
    k, around = int(np.searchsorted(psi.t, when)), np.searchsorted(psi.t, [when - lasts / 4, when + lasts / 4])
    near = slice(max(0, min(k - 2, around[0])), max(k + 2, around[1]))
    rate = abs(float(np.polyfit(psi.t[near] - when, turned[near], 1)[0]))
    heading = np.hypot(scatter * np.sqrt(1 + 1 / count), 0.78 * (psi.digit or psi.grain or 0.0))
    before, there = np.interp([first.time, when], moving.t, moving.y)
    samples = max(1.0, lasts / moving.interval)
    parts = [
        before * first.within,
        there * heading / max(rate, 1e-9),
        NORMAL_95 * scatter_of(moving.y) * lasts / np.sqrt(samples),
        0.5 * (moving.digit or moving.grain or 0.0) * lasts,
    ]
    return {
        "initial_turning_ability": distance_between(moving, first.time, when),
        "initial_turning_ability_uncertainty": float(np.sqrt(np.sum(np.square(parts))) + before * swing.late),
    }


def in_lengths(beginning: Mapping[str, Plain], length: float | None) -> dict[str, Plain]:
    """Return the distances in ship lengths, by name; None without a distance or a length.

    Parameters
    ----------
    beginning : Mapping
        What `measure_beginning` returned.
    length : float or None
        Ship length [m].
    """
    found = {
        "initial_turning_ratio": "initial_turning_distance",
        "initial_turning_ability_ratio": "initial_turning_ability",
    }
    return {
        name: None if beginning[of] is None or length is None else beginning[of] / length for name, of in found.items()
    }
