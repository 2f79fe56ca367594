"""The noise level of the measured state: as given, or from the record alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.errors import NoiseLevelError, NotMeasurableError
from shipid.estimation.settings.instruments import Amount
from shipid.estimation.settings.noise import sensor_levels
from shipid.foundation.errors import UsageError


def noise_of(samples: np.ndarray, t: np.ndarray | None = None) -> float:
    """Return the standard deviation of white noise in a record of a smooth motion.

    Third differences of a smooth motion are small, those of white noise have twenty times its variance; the median of their
    size is not changed by the few at the corners of a manoeuvre.

    Parameters
    ----------
    samples : ndarray, shape (N,)
        The record.
    t : ndarray, shape (N,), optional
        Times in s. Samples on either side of a missing one are not compared; by default all are evenly sampled.

    Returns
    -------
    float
        At least a millionth of the record's span, so that a record without noise has a level too.

    Raises
    ------
    NoiseLevelError
        If there are fewer than ten samples, or they are all the same.
    """
    if samples.size < 10 or not np.ptp(samples) > 0:
        raise NoiseLevelError(
            f"{samples.size} samples that span {np.ptp(samples) if samples.size else 0:g} have no known noise level: give "
            "the standard deviation of one (measured=...)."
        )
    third = np.diff(samples, 3)
    if t is not None:
        step = np.diff(t)
        even = np.abs(step - _common(step)) <= 0.3 * _common(step)
        together = even[:-2] & even[1:-1] & even[2:]
        # Where hardly any four samples follow each other, all count: the level is then on the high side.
        third = third[together] if np.count_nonzero(together) >= 10 else third
    # 0.6745 is the median of the size of a standard normal number.
    level = float(np.median(np.abs(third)) / (0.6744897501960817 * np.sqrt(20.0)))
    return max(level, 1e-6 * float(np.ptp(samples)))


def _common(step: np.ndarray) -> float:
    """The interval of the sensor itself: the shorter ones, where samples are missing at random."""
    return float(np.quantile(step, 0.25))


def read_sensor(
    model: Model, measured: Mapping[str, Amount | None] | None
) -> tuple[str | None, float | None, str | None]:
    """Return the sensor, its noise level (SI) and the state it measures, as far as they are given.

    Parameters
    ----------
    model : Model
        The model.
    measured : mapping of str to str or None, or None
        The one measured state or sensor, and the standard deviation of a sample with its unit.

    Raises
    ------
    UsageError
        If there are several.
    NotMeasurableError
        If the model has no such state, and no sensor of one.
    """
    if measured is None:
        return None, None, None
    if len(measured) != 1:
        raise UsageError(
            f"a recursion takes one measured state, and got {', '.join(measured) or 'none'}. For several sensors take the "
            "extended Kalman filter."
        )
    (name, value) = next(iter(measured.items()))
    if name not in model:
        sensor_levels(model, measured)  # raises, with the nearest names
    state = model[name].quantity.measures or name
    if state not in model.states:
        raise NotMeasurableError(
            f"'{name}' is no state of model {model.name}, and no sensor of one. Its states: {', '.join(model.states)}."
        )
    declared = value if value is not None else model[name].quantity.noise if name in model.outputs else None
    level = None if declared is None else sensor_levels(model, {name: declared})[name]
    return name, level, state
