"""An order taken for the rudder: how much of the ship's time constant the steering gear is, that the log does not show."""

from __future__ import annotations

from collections.abc import Sequence
from math import radians, sqrt

import numpy as np

from shipid.foundation.numbers import percent
from shipid.parameters.parameter_set import ParameterSet
from shipid.trials.doctor.examinations.steering.rudder import executes, response
from shipid.trials.filling import interpolated
from shipid.trials.trial import Trial

MATTERS = 0.12
"""From this share of the time constant on, the time of the gear spoils it."""
_GEAR, _LENGTH = radians(65 / 28), 100.0
"""SOLAS II-1/29.3: from 35 deg on one side to 30 deg on the other in 28 s [rad/s]; a ship below this length [m] is faster by
Froude's law."""


def usual_share(trials: Sequence[Trial], ship: ParameterSet) -> float | None:
    """Return the median of `gear_share` over trials: the time constant is one for all of them.

    Parameters
    ----------
    trials : sequence of Trial
        Trials that were fitted together.
    ship : ParameterSet
        The ship.

    Returns
    -------
    float or None
        None where no trial tells it.
    """
    found = [share for trial in trials if (share := gear_share(trial, ship)) is not None]
    return float(np.median(found)) if found else None


def gear_share(trial: Trial, ship: ParameterSet) -> float | None:
    """Return half the time that a gear would take for the steps of an order, in shares of the ship's time constant.

    Parameters
    ----------
    trial : Trial
        A trial whose rudder steps as an order does.
    ship : ParameterSet
        The ship, for its length.

    Returns
    -------
    float or None
        By about this share a time constant comes out too long where no gear is in the model; None where it cannot be told.
    """
    if not trial.has("delta") or not (trial.has("r") or trial.has("psi")):
        return None
    t = trial["t"]
    delta = interpolated(t, trial["delta"])
    rate = interpolated(t, trial["r"]) if trial.has("r") else np.gradient(interpolated(t, trial["psi"]), t)
    known = np.isfinite(delta) & np.isfinite(rate)
    start, length, _ = executes(delta[known])
    found = response(t[known], delta[known], rate[known]) if known.sum() > 60 and len(start) else None
    if found is None or not found.value[1] < -3 * found.std[1]:
        return None
    travel = float(np.median(np.abs(delta[known][start + length] - delta[known][start])))
    long = ship.particular("L", "m") or _LENGTH
    # The time constant that is found has the half time of the gear in it already.
    gear = _GEAR * sqrt(max(1.0, _LENGTH / long))
    return 0.5 * travel / gear * -float(found.value[1])


def effect_of(share: float) -> str:
    """Return what such a share does to a fit, in words.

    Parameters
    ----------
    share : float
        As `gear_share` returns it.
    """
    return (
        f"The model has no steering gear, and the rudder is an order: a usual gear takes {percent(share)} of the time constant for "
        "half a step of it. The time constant comes out too long by about as much, and the gain is off. Fit a model with a lag of "
        "the rudder (compare takes one by itself), or use the rudder angle that was measured."
    )
