"""The estimate before the first sample, from the settings and from that sample."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import Arrangement, FilterRecord, columns_of
from shipid.estimation.records.triangles import diagonal_of
from shipid.estimation.recursion.layout import total
from shipid.estimation.settings.first_look import LOOK, first_value
from shipid.estimation.settings.initial import state_spreads


def first_sample(design: FilterDesign, record: FilterRecord, used: np.ndarray) -> dict[str, float]:
    """Return the first finite value of each column, under the names of the measured quantities as well.

    A first value of a sensor that is wild beside those that follow it is not taken (`shipid.estimation.settings.first_look`).

    Parameters
    ----------
    design : FilterDesign
        The filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    used : ndarray of bool, shape (samples,)
        Which of its samples are used.
    """
    columns, _ = columns_of(record)
    there = {n: np.flatnonzero(used & np.isfinite(c))[:LOOK] for n, c in columns.items()}
    firsts = {n: float(columns[n][at[0]]) for n, at in there.items() if at.size}
    for name, level in zip(design.measured, design.r):
        column = design.instruments.column_of(name, firsts)
        if column is not None:
            at = there[column]
            firsts[column] = first_value(columns["t"][at], columns[column][at], float(level))
    return design.instruments.with_quantities(firsts)


def first_estimate(design: FilterDesign, sample: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the first estimate and its standard deviations, SI, shapes (states,).

    Parameters
    ----------
    design : FilterDesign
        The filter.
    sample : mapping of str to float
        The first sample: a state that it measures starts at the measured value.
    """
    first, states = design.first, design.model.states
    sensors = {design.instruments.quantity_of(n): float(level) for n, level in zip(design.measured, design.r)}
    scale = design.instruments.scale
    deviation = state_spreads(design.model, scale, sensors)
    speed = sample.get("cruise", design.instruments.inputs.get("cruise", scale.speed))
    x = np.array([design.model[n].number("start") or 0.0 for n in states])
    for i, name in enumerate(states):
        if name in first.states:
            x[i] = first.states[name]
        elif name in sample and np.isfinite(sample[name]):
            x[i] = sample[name]
        elif name == "u" and speed is not None:
            x[i] = speed
    for name, state in design.parameters.items():
        i = states.index(state)
        value, spread = first.parameters[name]
        x[i] = value if state == name else np.log(value)
        deviation[i] = spread if state == name else spread / value
    for name, level in first.deviations.items():
        state = design.parameters.get(name, name)
        share = abs(first.parameters[name][0]) if state != name else 1.0
        deviation[states.index(state)] = level / share
    return x, deviation


def carried_vector(design: FilterDesign, sample: Mapping[str, float], inputs: np.ndarray) -> np.ndarray:
    """Return the carried vector before the first sample.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    sample : mapping of str to float
        The first sample, SI.
    inputs : ndarray, shape (inputs,)
        The inputs there.
    """
    x, deviation = first_estimate(design, sample)
    layout, places = design.layout, design.layout.carried
    z = np.zeros(total(places))
    z[places["x"]] = x
    z[places["u"]] = inputs
    joint = np.zeros(layout.joint)
    joint[: layout.n] = deviation
    z[places["P"]] = _diagonal(joint, design.form)
    # The gate's memory is empty: no last value, and no difference of two.
    z[places["last"]] = z[places["grain"]] = np.inf
    return z


def first_carried(design: FilterDesign, record: FilterRecord, arranged: Arrangement) -> np.ndarray:
    """Return the carried vector before the first sample of a record.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    record : Trial or mapping of str to ndarray
        What is filtered.
    arranged : Arrangement
        The record as the filter takes it.
    """
    return carried_vector(design, first_sample(design, record, arranged.forward), arranged.inputs[0])


def _diagonal(deviation: np.ndarray, form: str) -> np.ndarray:
    """The carried vector of a diagonal covariance."""
    if form == "square-root":
        return np.diag(deviation).ravel(order="F")
    out = np.zeros(deviation.size * (deviation.size + 1) // 2)
    out[diagonal_of(deviation.size)] = deviation**2
    return out
