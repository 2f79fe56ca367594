"""The coefficients of a ship at a speed that may lie outside its trials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.scale import Scale
from shipid.declaration.units import factor
from shipid.foundation.errors import ParameterSetError
from shipid.parameters.parameter_set import ParameterSet, missing_values


@dataclass(frozen=True)
class ShipCoefficients:
    """The coefficients of a ship at one speed, and how they were found.

    Attributes
    ----------
    values : mapping of str to float
        SI.
    span : tuple of float or None
        Speeds in m/s between which the coefficients are known; None where the set does not state them.
    reference : float or None
        The speed in m/s that coefficients with a dimension belong to; None where the set does not say it.
    scaled : bool
        Whether dimensional coefficients were carried from another speed by powers of L and L/U.
    """

    values: Mapping[str, float]
    span: tuple[float, float] | None
    reference: float | None
    scaled: bool


def coefficients_at(
    model: Model, ship: ParameterSet, speed: float, values: Mapping[str, float] | None = None
) -> ShipCoefficients:
    """Return the coefficients of a ship at a speed that may lie outside its trials.

    Coefficients without dimension hold at every speed. Dimensional ones belong to the speed at which they were identified or
    published, that before the manoeuvres of the trials, of a table, or the ship's own; elsewhere they follow the speed by powers of L and L/U: Passenier (1989), eq. (2.61).

    Parameters
    ----------
    model : Model
        A ship model.
    ship : ParameterSet
        The ship.
    speed : float
        In m/s.
    values : mapping of str to float, optional
        SI values at the ship's own speed that replace those of the set: a sample.

    Raises
    ------
    ParameterSetError
        If the ship lacks a coefficient, or the length or the speed that is needed to scale one.
    """
    own, length = ship.particular("speed", "m/s"), ship.particular("L", "m")
    tables = [v for v in (ship.find(model, n) for n in model.entries) if v is not None and v.speed]
    limits = [[s * factor(v.speed_unit, "m/s") for s in (v.speed[0], v.speed[-1])] for v in tables]
    span = (max(a for a, _ in limits), min(b for _, b in limits)) if limits else None
    joint = ship.joint.get(model.name)
    trials, sailed = (None, None) if joint is None else (joint.speeds, joint.belongs_to)
    reference = float(np.clip(speed, *span)) if span else own if sailed is None else sailed
    known = ship.values(model, speed=reference) | dict(values or {})
    lacking = missing_values(model, known, f"ship {ship.name}")
    if lacking:
        raise lacking
    dimensional = [n for n in model.parameters if model[n].quantity.prime]
    if not dimensional or speed == reference:
        return ShipCoefficients(known, span or trials, reference, False)
    if reference is None or length is None or not length > 0:
        what = "speed" if reference is None else "length L"
        raise ParameterSetError(
            f"ship {ship.name} has no {what} of its own, by which {', '.join(dimensional)} of model {model.name} follow the "
            "speed. Add it to the particulars."
        )
    here, there = Scale(length, speed), Scale(length, reference)
    for name in dimensional:
        known[name] *= here.factor_of(model[name]) / there.factor_of(model[name])
    return ShipCoefficients(known, span or trials, reference, True)
