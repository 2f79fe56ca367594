"""The identified ship: a parameter set of the estimates, their standard deviations and their correlation."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.estimate import Estimate
from shipid.identification.loading import loading_of
from shipid.identification.problem.setting import Setting
from shipid.identification.uncertainty.amplitudes import largest_amplitudes, recorded_speeds, speed_before_of
from shipid.identification.uncertainty.estimates import is_as_stated
from shipid.parameters.correlation import Joint
from shipid.parameters.loading import measure_of
from shipid.parameters.parameter_set import PARTICULARS, ParameterSet, Value
from shipid.trials.trial import Trial

#: Source of a value that the trials say nothing about, and that the ship states in other coefficients, or the model as a prior.
_BEFORE = (
    "known before these trials, which hold no information about it: from other coefficients of the ship, or declared"
)


def identified_ship(
    setting: Setting,
    parameters: Mapping[str, Estimate],
    trials: Sequence[Trial],
    source: str,
    correlation: np.ndarray,
    unseen: Collection[str] = (),
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
    unseen : collection of str
        Coefficients about which the trials hold no information. One that the ship states keeps what she states, one that is known
        only as part of a combination has the value that goes with the others, and one that nothing states is left out.

    Returns
    -------
    ParameterSet
    """
    model, given = setting.model, setting.ship
    section: dict[str, Value] = {}
    stated = setting.stated
    for name, e in parameters.items():
        if name in unseen and name not in stated:
            continue
        if name in unseen and (e.value is None or is_as_stated(e.value, stated[name][0])):
            held = given.find(model, name)
            section[name] = held or Value(name, stated[name][0], e.unit, _BEFORE, std=stated[name][1])
        elif not e.follows and e.value is not None:
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
    # As written, so that a set that is read again is the same. Rounding leaves a badly conditioned matrix slightly asymmetric.
    names = [n for n in setting.estimated if n in section]
    at = [setting.estimated.index(n) for n in names]
    correlation = correlation[np.ix_(at, at)]
    even = np.clip(0.5 * (correlation + correlation.T), -1.0, 1.0)
    np.fill_diagonal(even, 1.0)
    matrix = tuple(tuple(float(f"{v:.6g}") for v in row) for row in even)
    reached = largest_amplitudes(trials)
    joint = Joint(
        tuple(names),
        matrix,
        recorded_speeds(trials),
        speed_before_of(trials),
        reached.get("rudder"),
        reached.get("rate"),
        reached.get("drift"),
        _loadings(model, trials),
    )
    sections = {**given.sections, PARTICULARS: particulars, model.name: section}
    return replace(given, sections=sections, joint={**given.joint, model.name: joint})


def _loadings(model: Model, trials: Sequence[Trial]) -> dict[str, tuple[float, float]]:
    """The lowest and the highest loading of the trials, for a model whose coefficients depend on it."""
    measure = measure_of(model)
    stated = [] if measure is None else [v for t in trials if (v := loading_of(t, measure)) is not None]
    return {measure: (min(stated), max(stated))} if measure is not None and stated else {}
