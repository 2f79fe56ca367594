"""The prior of a trial's own unknowns: small rudder biases that trials share, and initial states as measured.

A bias that is free in every trial absorbs the model's error, and the coefficients are biased by it: in
clean tank data the fitted biases of mirrored runs have opposite signs, which no rudder has. The prior of all ships is
the same in relative terms: angles in degrees, speeds as shares of the ship's speed, and one independent sample in 1.5 L/U.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.identification.problem.signals import slowed_by_wind
from shipid.identification.problem.trial_data import TrialData
from shipid.parts.sensors import shown_by

#: Standard deviation of a trial's rudder bias about the mean of all trials, and of that mean, in rad.
RUDDER_BIAS = np.deg2rad(0.08)
MEAN_RUDDER_BIAS = np.deg2rad(3.0)
#: Standard deviation of a measured initial heading (and drift) in rad, of an initial speed in shares of the ship's; of the
#: speed before the manoeuvre, which is measured in the approach.
INITIAL_ANGLE = np.deg2rad(0.3)
INITIAL_SPEED = 0.01
CRUISE = 0.005
#: The same of the cruising speed in shares of the speed before the manoeuvre, where wind from ahead or aft acts on that.
CRUISE_IN_WIND = 0.1
#: The same of a heading in rad, and of speeds in shares, by an instrument with an offset, a lag or a scale of its own.
MISREAD = 0.3
#: Error that a good low-order model still has: angles in rad, speeds in shares of the ship's.
STRUCTURE_ANGLE = np.deg2rad(1.0)
STRUCTURE_SPEED = 0.03
#: Time between two independent samples of a residual, in L/U: the residuals of fitted trials last for 0.9 to 3.
INDEPENDENT = 1.5


@dataclass(frozen=True)
class Prior:
    """Normal prior of the unknowns that each trial has of its own, and of shared parameters.

    Attributes
    ----------
    biases : mapping of str to float
        Standard deviation of a trial's bias about the mean of all trials, SI, by input.
    mean_biases : mapping of str to float
        Standard deviation of that mean about zero.
    own : mapping of str to float
        Standard deviation of a bias that trials do not share about zero, SI, by input: the speed before the manoeuvre.
    initial : mapping of str to float
        Standard deviation of an initial state about its first guess, SI, by state.
    parameters : mapping of str to tuple of float
        Mean and standard deviation of a shared parameter, SI.
    strength : float
        Number of samples of the record that one term of the prior counts as: residuals are correlated, and repeated samples
        would outweigh it.
    lasting : mapping of str to float
        Error of the model that lasts, beyond that of a good model of low order, SI, by state
        (`shipid.identification.search.prediction_weights`): as far its initial state lies from what was measured.
    """

    biases: Mapping[str, float]
    mean_biases: Mapping[str, float]
    own: Mapping[str, float]
    initial: Mapping[str, float]
    parameters: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    strength: float = 1.0
    lasting: Mapping[str, float] = field(default_factory=dict)


def prior_of(
    model: Model,
    initial: tuple[str, ...],
    biases: tuple[str, ...],
    data: TrialData,
    unit_time: float,
    estimated: tuple[str, ...] = (),
) -> Prior:
    """Return the prior for the trials of one ship.

    Parameters
    ----------
    model : Model
        The model.
    initial, biases : tuple of str
        States and inputs with unknowns of their own in each trial.
    data : TrialData
        A trial, for speed and sampling.
    unit_time : float
        L/U in s.
    estimated : tuple of str
        Parameters; those whose declaration states a spread have a prior.

    Returns
    -------
    Prior
    """
    speed = abs(data.speed)
    spread = {
        "psi": INITIAL_ANGLE,
        "r": INITIAL_ANGLE / unit_time,
        "u": INITIAL_SPEED * speed,
        "v": INITIAL_ANGLE * speed,
    }
    # What an instrument with errors of its own shows is a start, and says little of the true value.
    misread = {n: wide for n, wide in (("psi", MISREAD), ("u", MISREAD * speed)) if shown_by(model, (n,)) != (n,)}
    spread |= misread
    # A state that is not measured starts near zero, within its nominal size; a position without one stays free.
    nominal = {s: n for s in initial if s not in spread and (n := model[s].number("nominal")) is not None}
    scale = Scale(speed * unit_time, speed)
    usual = CRUISE_IN_WIND if slowed_by_wind(model) else CRUISE
    return Prior(
        biases={"delta": RUDDER_BIAS} if "delta" in biases else {},
        mean_biases={"delta": MEAN_RUDDER_BIAS} if "delta" in biases else {},
        own={"cruise": misread.get("u", usual * speed)} if "cruise" in biases else {},
        initial={s: spread[s] for s in initial if s in spread} | nominal,
        parameters={n: prior for n in estimated if (prior := _declared(model, n, scale)) is not None},
        strength=strength_of(data, unit_time),
    )


def _declared(model: Model, name: str, scale: Scale) -> tuple[float, float] | None:
    """Mean and standard deviation the declaration gives a parameter, SI."""
    entry = model[name]
    mean, spread = scale.start_of(entry), entry.number("spread")
    return None if mean is None or spread is None else (mean, spread * scale.factor_of(entry))


def structural_errors(signals: tuple[str, ...], data: TrialData, unit_time: float) -> np.ndarray:
    """Return the error of each signal that a good low-order model still has, SI, shape (signals,).

    The residuals of such a model come from its structure, not from noise: weights from the smallest residuals of a fit
    would bias its coefficients.

    Parameters
    ----------
    signals : tuple of str
        Fitted signals.
    data : TrialData
        A trial, for its speed.
    unit_time : float
        L/U in s.
    """
    speed = abs(data.speed)
    track = speed * unit_time * 0.05
    errors = {
        "psi": STRUCTURE_ANGLE,
        "r": STRUCTURE_ANGLE / unit_time,
        "u": STRUCTURE_SPEED * speed,
        "v": STRUCTURE_ANGLE * speed,
        "x": track,
        "y": track,
    }
    # Of another state, such as a shaft speed: of its own size in the record, as that of the speed is of the speed.
    errors |= {s: STRUCTURE_SPEED * _size(data, s) for s in signals if s not in errors}
    return np.array([errors[s] for s in signals])


def _size(data: TrialData, name: str) -> float:
    """Root mean square of a signal of a record; one where the record does not show it."""
    size = float(np.sqrt(np.nanmean(data.column(name) ** 2))) if data.shows(name) else 0.0
    return size or 1.0


def strength_of(data: TrialData, unit_time: float) -> float:
    """Return how many samples of a record make one independent one, at least one.

    Parameters
    ----------
    data : TrialData
        The record.
    unit_time : float
        L/U in s.
    """
    return max(1.0, INDEPENDENT * unit_time / (data.step or unit_time))
