"""What is believed of a trial before it is fitted: small rudder biases that trials share, and initial states as measured.

A bias that is free in every trial takes up what the model cannot describe, and the coefficients are off by as much: in
clean tank data the fitted biases of mirrored runs come out with opposite signs, which no rudder has. One scale serves all
ships: angles in degrees, speeds in shares of the ship's own, and one independent sample in one and a half L/U.
"""

from __future__ import annotations

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import prime_factor
from shipid.identification.problem.output_error import Prior
from shipid.identification.problem.trial_data import Sailed

#: Standard deviation of a trial's rudder bias about the mean of all trials, and of that mean, in rad.
RUDDER_BIAS = np.deg2rad(0.08)
MEAN_RUDDER_BIAS = np.deg2rad(3.0)
#: Standard deviation of a measured initial heading (and drift) in rad, of an initial speed in shares of the ship's; of the
#: cruising speed, which the approach shows.
INITIAL_ANGLE = np.deg2rad(0.3)
INITIAL_SPEED = 0.01
CRUISE = 0.005
#: Error at which a low-order model is as good as can be hoped: angles in rad, speeds in shares of the ship's.
STRUCTURE_ANGLE = np.deg2rad(1.0)
STRUCTURE_SPEED = 0.03
#: Time between two independent samples of a residual, in L/U: the residuals of fitted trials last for 0.9 to 3.
INDEPENDENT = 1.5


def prior_of(
    model: Model,
    initial: tuple[str, ...],
    biases: tuple[str, ...],
    sailed: Sailed,
    unit_time: float,
    estimated: tuple[str, ...] = (),
) -> Prior:
    """Return the prior of the trials of one ship.

    Parameters
    ----------
    model : Model
        The model.
    initial, biases : tuple of str
        States and inputs with unknowns of their own in each trial.
    sailed : Sailed
        A trial, for speed and sampling.
    unit_time : float
        L/U in s.
    estimated : tuple of str
        Parameters of which the declaration may believe something (`spread`).

    Returns
    -------
    Prior
    """
    speed = abs(sailed.speed)
    spread = {
        "psi": INITIAL_ANGLE,
        "r": INITIAL_ANGLE / unit_time,
        "u": INITIAL_SPEED * speed,
        "v": INITIAL_ANGLE * speed,
    }
    # A state nobody measures starts near zero, within its nominal size; a position without one stays free.
    nominal = {s: n for s in initial if s not in spread and (n := model[s].number("nominal")) is not None}
    return Prior(
        biases={"delta": RUDDER_BIAS} if "delta" in biases else {},
        mean_biases={"delta": MEAN_RUDDER_BIAS} if "delta" in biases else {},
        own={"cruise": CRUISE * speed} if "cruise" in biases else {},
        initial={s: spread[s] for s in initial if s in spread} | nominal,
        parameters={n: belief for n in estimated if (belief := _declared(model, n, speed, unit_time)) is not None},
        strength=strength_of(sailed, unit_time),
    )


def _declared(model: Model, name: str, speed: float, unit_time: float) -> tuple[float, float] | None:
    """Mean and standard deviation the declaration gives a parameter, SI."""
    entry = model[name]
    mean, spread = entry.number("start"), entry.number("spread")
    if mean is None or spread is None:
        return None
    scale = prime_factor(entry.unit, speed * unit_time, speed) if entry.quantity.prime else 1.0
    return mean * scale, spread * scale


def scales_of(signals: tuple[str, ...], sailed: Sailed, unit_time: float) -> np.ndarray:
    """Return the error of each signal at which a low-order model is as good as can be hoped, SI, shape (signals,).

    What such a model leaves unexplained is its structure, not noise: weighting by the smallest residuals a fit can reach
    would let it bend its coefficients to them.

    Parameters
    ----------
    signals : tuple of str
        Fitted signals.
    sailed : Sailed
        A trial, for its speed.
    unit_time : float
        L/U in s.
    """
    speed = abs(sailed.speed)
    track = speed * unit_time * 0.05
    scale = {
        "psi": STRUCTURE_ANGLE,
        "r": STRUCTURE_ANGLE / unit_time,
        "u": STRUCTURE_SPEED * speed,
        "v": STRUCTURE_ANGLE * speed,
        "x": track,
        "y": track,
    }
    return np.array([scale.get(s, 1.0) for s in signals])


def strength_of(sailed: Sailed, unit_time: float) -> float:
    """Return how many samples of a record make one independent one, at least one."""
    interval = float(np.median(sailed.intervals[:-1])) if sailed.intervals.size > 1 else unit_time
    return max(1.0, INDEPENDENT * unit_time / interval)
