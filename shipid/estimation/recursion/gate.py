"""The gate of a filter: which samples are rejected, and when a sensor that was rejected is accepted again.

A sample is beyond the gate where its innovation exceeds a number of standard deviations. A sensor that repeats one value is
stuck, and its gate is narrower. One that stays beyond the gate while its value changes is accepted after a time: the
estimate was wrong, not the sensor. The same holds for one that is beyond it in a large share of its recent samples: the gate
is open until the share is small again, since many samples are rarely wrong all at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from shipid.foundation.aliases import Expression

#: What became of a sample: taken in, not there, beyond the gate.
TAKEN, MISSING, REJECTED = 1, 0, -1
#: After so many equal values in a row a sensor may be stuck, and its gate is narrowed to this share.
_SUSPECT, _NARROW = 5, 0.5
#: Values are equal within this part of the sensor's noise; a sensor whose values differ by less than that part is a fine one.
_EQUAL, _FINE = 1e-6, 0.1
#: The gate of a sensor is open while more than this share of its recent samples, those that repeat a value apart, is beyond it.
OPEN_SHARE = 0.5
#: Recent are so many samples, and at least three times the patience.
_RECENT = 30
#: What is stored for each sensor: its last value, how often it has been repeated and for how long, how long the sensor has
#: been rejected, the smallest difference of two of its values, and the share of its recent samples that is beyond the gate.
MEMORY = ("last", "same", "rejecting", "held", "grain", "share")


@dataclass(frozen=True)
class Gate:
    """When a sample is rejected.

    Attributes
    ----------
    width : float
        In standard deviations of the innovation.
    patience : float
        Seconds of rejections after which a sensor whose value changes is accepted again. The covariance of the states it
        shows is then inflated until the innovation is one standard deviation, so that the estimate follows at once with a
        matching standard deviation.
    """

    width: float
    patience: float


def apply_gate(
    gate: Gate | None,
    e: Expression,
    variance: Expression,
    z: Expression,
    there: Expression,
    memory: Sequence[Expression],
    interval: Expression,
    deviation: Expression,
) -> tuple[Expression, Expression, list[Expression]]:
    """Return whether a sample counts, whether it is beyond the gate, and what is stored for its sensor.

    Parameters
    ----------
    gate : Gate or None
        The gate; None accepts every sample.
    e, variance : casadi.SX
        Innovation and its variance.
    z, there : casadi.SX
        What the sensor shows, and 1 where it shows something.
    memory : sequence of casadi.SX
        What was stored, in the order of `MEMORY`; nothing without a gate.
    interval : casadi.SX
        Seconds since the sample before.
    deviation : casadi.SX
        Standard deviation of the sensor.

    Returns
    -------
    counts, beyond : casadi.SX
        1 or 0.
    remembered : list of casadi.SX
        As `memory`.
    """
    if gate is None:
        return there, ca.SX(0), []
    last, same, rejecting, held, grain, share = memory
    change, patience = ca.fabs(z - last), (1 - 1e-6) * gate.patience
    equal = change <= _EQUAL * deviation
    repeats = ca.if_else(there, ca.if_else(equal, same + 1, 0), same)
    holding = ca.if_else(there, ca.if_else(equal, held + interval, 0), held)
    width = ca.if_else(repeats >= _SUSPECT, _NARROW * gate.width, gate.width)
    outside = e**2 > width**2 * variance
    # Once rejected, it counts as stuck for as long as its value repeats, even where the ship passes through that value. A fine
    # sensor never repeats the same value for so long.
    stuck = ca.fmax((repeats >= _SUSPECT) * (rejecting > 0), (holding >= patience) * (grain < _FINE * deviation))
    beyond = ca.fmax(outside, stuck)
    waited = rejecting + interval
    weight = ca.fmin(1 / _RECENT, interval / max(3 * gate.patience, 1e-9))
    recent = share + weight * (outside * (repeats == 0) - share)
    accepted = ca.fmax(waited >= patience, share > OPEN_SHARE) * (repeats == 0)
    counts = there * (1 - beyond * (1 - accepted))
    remembered = [
        ca.if_else(there, z, last),
        repeats,
        # The time also counts between the samples of a slow sensor.
        ca.if_else(there, beyond, rejecting > 0) * waited,
        holding,
        ca.if_else(there * (1 - equal), ca.fmin(grain, change), grain),
        ca.if_else(there, recent, share),
    ]
    return counts, beyond, remembered


def states_to_reset(sensitivity: Expression, sensor: int, resettable: np.ndarray) -> list[int]:
    """Return the states whose covariance is inflated where a sensor is accepted again, by index.

    Parameters
    ----------
    sensitivity : casadi.SX, shape (sensors, unknowns)
        Jacobian of the sensors.
    sensor : int
        Which of them.
    resettable : ndarray of bool, shape (states,)
        Which states may be reset.
    """
    return [k for k in sensitivity[sensor, :].sparsity().get_col() if k < resettable.size and resettable[k]]
