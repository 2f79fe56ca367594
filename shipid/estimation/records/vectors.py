"""What a filter is fed with: the vectors its generated step takes, from records, samples and settings."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

import numpy as np

from shipid.estimation.records.arrangement import Arrangement, column_of
from shipid.estimation.recursion.step import total
from shipid.estimation.settings.initial import state_spreads
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.trials.trial import Trial

if TYPE_CHECKING:
    from shipid.estimation.kalman import ExtendedKalmanFilter


def columns_of(record: Trial | Mapping[str, np.ndarray]) -> tuple[dict[str, np.ndarray], str]:
    """Return the SI columns of a record, and its name.

    Parameters
    ----------
    record : Trial or mapping of str to ndarray
        What is filtered.
    """
    if isinstance(record, Trial):
        return {n: record[n] for n in record.table.columns}, record.name
    if "t" not in record:
        raise UsageError(f"a record to filter needs its times 't'; it has {', '.join(record)}.")
    columns = {n: np.asarray(c, dtype=float) for n, c in record.items()}
    count = columns["t"].size
    for name, column in columns.items():
        if column.shape != (count,):
            raise UsageError(
                f"column '{name}' of the record has {column.size} samples, and 't' has {count}: give one value for each time."
            )
    return columns, "record"


def first_sample(kalman: ExtendedKalmanFilter, record: Trial | Mapping[str, np.ndarray]) -> dict[str, float]:
    """Return the first finite value of each column, and what it says of measured quantities and the cruising speed.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    """
    columns, _ = columns_of(record)
    sample = {}
    for n, c in columns.items():
        finite = np.flatnonzero(np.isfinite(c))
        if finite.size:
            sample[n] = float(c[finite[0]])
    if "cruise" not in sample and "u" in sample:
        sample["cruise"] = float(np.nanmedian(columns["u"][:10]))
    for name in kalman.measured:
        column = column_of(kalman.model, name, sample)
        if column is not None:
            sample.setdefault(kalman.model[name].quantity.measures or name, sample[column])
    return sample


def first_estimate(kalman: ExtendedKalmanFilter, sample: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the first estimate and its standard deviations, SI, shapes (states,).

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    sample : mapping of str to float
        The first sample: what it shows of a state is where the state starts.
    """
    shown_by = {kalman.model[n].quantity.measures or n: i for i, n in enumerate(kalman.measured)}
    sensors = {n: float(kalman._r[i]) for n, i in shown_by.items()}
    deviation = state_spreads(kalman.model, kalman._length, kalman._speed, sensors)
    x = np.empty(kalman.layout.n)
    for i, name in enumerate(kalman.model.states):
        if name in kalman._given_starts:
            x[i] = kalman._given_starts[name]
        elif name in sample and np.isfinite(sample[name]):
            x[i] = sample[name]
        elif name == "u" and (speed := sample.get("cruise", kalman.inputs.get("cruise", kalman._speed))) is not None:
            x[i] = speed
        else:
            x[i] = kalman.model[name].number("start") or 0.0
    for name, state in kalman.parameters.items():
        i = kalman.model.states.index(state)
        value, spread = kalman._estimates[name]
        x[i] = value if state == name else np.log(value)
        deviation[i] = spread if state == name else spread / value
    for name, level in kalman._deviations.items():
        state = kalman.parameters.get(name, name)
        share = abs(kalman._estimates[name][0]) if state != name else 1.0
        deviation[kalman.model.states.index(state)] = level / share
    return x, deviation


def carried_vector(kalman: ExtendedKalmanFilter, sample: Mapping[str, float], inputs: np.ndarray) -> np.ndarray:
    """Return the carried vector before the first sample.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    sample : mapping of str to float
        The first sample, SI.
    inputs : ndarray, shape (inputs,)
        The inputs there.
    """
    x, deviation = first_estimate(kalman, sample)
    z = np.zeros(total(kalman.layout.carried))
    places = kalman.layout.carried
    z[places["x"]] = x
    z[places["u"]] = inputs
    full = np.zeros(kalman.layout.joint)
    full[: kalman.layout.n] = deviation
    z[places["P"]] = _diagonal(full, kalman.form)
    if kalman.gate is not None:
        z[places["last"]] = z[places["grain"]] = np.inf
    return z


def controls_of(
    kalman: ExtendedKalmanFilter,
    arranged: Arrangement,
    adapt: np.ndarray | bool = True,
    scale: Mapping[str, np.ndarray | float] | None = None,
) -> np.ndarray:
    """Return the controls of every row, shape (N, controls).

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    arranged : Arrangement
        The record.
    adapt : bool or ndarray of bool, shape (samples,)
        Where parameters adapt.
    scale : mapping of str to float or ndarray
        Factors on the noise of sources, over the samples: a sea state that changes.
    """
    places, rows = kalman.layout.control, arranged.t.size
    table = np.zeros((rows, total(places)))
    table[:, places["u"]] = arranged.inputs
    table[:, places["T"]] = arranged.intervals[:, None]
    table[:, places["z"]] = arranged.z
    table[:, places["there"]] = arranged.there
    table[:, places["scale"]] = 1.0
    # Rows that bridge a gap belong to the sample that ends it.
    sample = np.minimum(np.searchsorted(np.flatnonzero(arranged.shown), np.arange(rows)), arranged.shown.sum() - 1)
    check_scale(kalman, scale)
    for i, source in enumerate(kalman.sources):
        column = table[:, places["scale"]][:, i]
        if scale and source.name in scale:
            factor = np.asarray(scale[source.name], dtype=float)
            column *= _each(factor, arranged, f"factors on the noise of '{source.name}'")[sample]
        if source.name in kalman.lost:
            missing = arranged.lost[:, kalman.system.inputs.index(source.name)]
            usual = 0.0 if source.level == kalman.lost[source.name] else 1.0
            column *= np.where(missing, kalman.lost[source.name] / source.level, usual)
    if kalman.switchable:
        table[:, places["adapting"]] = _each(np.asarray(adapt), arranged, "'adapt'")[sample, None]
    return table


def check_scale(kalman: ExtendedKalmanFilter, scale: Collection[str] | None) -> None:
    """Raise an error if a factor is given for a noise that the filter does not have.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter.
    scale : collection of str or None
        Names of sources.
    """
    for name in scale or ():
        if name not in (driven := [s.name for s in kalman.sources]):
            raise UnknownNameError("noise to scale called", name, driven)


def _each(values: np.ndarray, arranged: Arrangement, what: str) -> np.ndarray:
    """One value for each sample that was let through, from one for each or for all."""
    if not values.ndim:
        return np.broadcast_to(values, arranged.forward.sum())
    if values.shape != arranged.forward.shape:
        raise UsageError(f"{what}: {values.size} of them, and the record has {arranged.forward.size} samples.")
    return values[arranged.forward]


def _diagonal(deviation: np.ndarray, form: str) -> np.ndarray:
    """The carried vector of a diagonal covariance."""
    if form == "square-root":
        return np.diag(deviation).ravel(order="F")
    out = np.zeros(deviation.size * (deviation.size + 1) // 2)
    out[np.cumsum(np.arange(1, deviation.size + 1)) - 1] = deviation**2
    return out
