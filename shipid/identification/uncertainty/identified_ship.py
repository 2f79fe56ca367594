"""The identified ship: a parameter set of the estimates, their standard deviations and their correlation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from shipid.estimation.estimate import Estimate
from shipid.identification.problem.setting import Setting
from shipid.identification.problem.ship_scale import recorded_speeds
from shipid.parameters.correlation import Joint
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value
from shipid.trials.trial import Trial


def identified_ship(
    setting: Setting,
    parameters: Mapping[str, Estimate],
    trials: Sequence[Trial],
    source: str,
    correlation: np.ndarray,
) -> ParameterSet:
    """Return the ship as it was given, with the coefficients that were identified.

    Parameters
    ----------
    setting : Setting
        What was known beforehand.
    parameters : mapping of str to Estimate
        The estimates.
    trials : sequence of Trial
        What they come from.
    source : str
        Source of the coefficients, in words.
    correlation : ndarray, shape (estimated, estimated)
        Of the estimates, in the order of `setting.estimated`.

    Returns
    -------
    ParameterSet
    """
    model, given = setting.model, setting.ship
    section = {}
    for name, e in parameters.items():
        if not e.follows and e.value is not None:
            note = "" if e.identifiable else f"{e.standing} by these trials: {e.why}"
            section[name] = Value(name, e.value, e.unit, source, std=e.std, note=note)
    particulars = dict(given.sections.get(PARTICULARS, {}))
    for name, value in setting.fixed.items():
        if given.particular(name, model[name].unit) == value:
            continue
        held = given.find(model, name)
        own = held.source if held is not None else "held during the identification"
        target = particulars if name == "L" else section
        target[name] = Value(name, value, model[name].unit, own)
    speeds = recorded_speeds(trials)
    # As written, so that a set that is read again is the same. Rounding leaves a badly conditioned matrix slightly asymmetric.
    even = np.clip(0.5 * (correlation + correlation.T), -1.0, 1.0)
    np.fill_diagonal(even, 1.0)
    matrix = tuple(tuple(float(f"{v:.6g}") for v in row) for row in even)
    joint = Joint(setting.estimated, matrix, (min(speeds), max(speeds)) if speeds and min(speeds) >= 0 else None)
    sections = {**given.sections, PARTICULARS: particulars, model.name: section}
    return replace(given, sections=sections, joint={**given.joint, model.name: joint})
