"""Default settings of a filter: the sensors that a record holds, and the parameters that a model declares as estimated."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.errors import NotMeasurableError
from shipid.estimation.settings.instruments import Amount, column_of
from shipid.parts.sensors import standard_noise

_TRACK = ("x", "y")
#: Median size of the second differences of normal noise, in its standard deviations: 0.6745 sqrt(6).
_MEDIAN_OF_SECOND_DIFFERENCES = 0.6745 * 6**0.5


def standard_sensors(model: Model, columns: Collection[str]) -> dict[str, Amount | None]:
    """Return the sensors a record holds: the declared outputs of a model, or its quantities that a standard sensor measures.

    Parameters
    ----------
    model : Model
        The model. One with an output that measures what a standard sensor measures says itself what is measured; an output of
        anything else, such as a leeway, stands beside the standard sensors: here where it declares its noise, else in `own_sensors`.
    columns : collection of str
        What the record has.

    Returns
    -------
    dict of str to tuple
        Level with its unit, or None for a declared output, as `ExtendedKalmanFilter` takes it.

    Raises
    ------
    NotMeasurableError
        If the record holds none.
    """
    if has_instruments(model):
        found: dict[str, Amount | None] = {n: None for n in model.outputs if column_of(model, n, columns)}
    else:
        known = [*model.states, *model.derived]
        found = {n: (v, model[n].unit) for n, v in standard_noise().items() if n in known and n in columns}
        # A position depends on the state of a yaw model only through the drift, which the model does not describe.
        found = {n: v for n, v in found.items() if n not in _TRACK} or found
        found |= {
            n: None for n in model.outputs if model[n].quantity.noise is not None and column_of(model, n, columns)
        }
    if not found and not (set(_own(model)) & set(columns)):
        wanted = (
            model.outputs
            if has_instruments(model)
            else tuple(n for n in (*standard_noise(), *_own(model)) if n in model)
        )
        raise NotMeasurableError(
            f"the record holds nothing that a sensor shows of model {model.name} ({', '.join(wanted)}); it has "
            f"{', '.join(columns)}. Say what is measured, as in measured={{'psi': '0.2 deg'}} (--measured 'psi=0.2 deg')."
        )
    return found


def has_instruments(model: Model) -> bool:
    """Return whether a model declares what its standard sensors show: the log, the gyro, the compass, the position.

    Parameters
    ----------
    model : Model
        The model.
    """
    return any(model[n].quantity.measures in standard_noise() for n in model.outputs)


def _own(model: Model) -> tuple[str, ...]:
    """States of a model that no standard sensor measures, and outputs whose noise is not declared."""
    if has_instruments(model):
        return ()
    silent = [n for n in model.outputs if model[n].quantity.noise is None]
    return tuple(n for n in (*model.states, *silent) if n not in standard_noise())


def own_sensors(model: Model, columns: Mapping[str, np.ndarray]) -> dict[str, Amount | None]:
    """Return the states and outputs of a model that a record shows and no sensor of known noise measures, such as a shaft speed.

    Parameters
    ----------
    model : Model
        The model. One that declares what its standard sensors show says itself what is measured.
    columns : mapping of str to ndarray, shape (n,)
        What the record has, SI.

    Returns
    -------
    dict of str to tuple
        A level to start from with its unit: the noise that the second differences of the column show, which no slow motion has, and
        at least a thousandth of its spread.
    """
    found: dict[str, Amount | None] = {}
    for name in _own(model):
        column = np.asarray(columns.get(name, np.empty(0)), dtype=float)
        there = column[np.isfinite(column)]
        if there.size > 2 and np.ptp(there) > 0:
            rough = float(np.median(np.abs(np.diff(there, 2)))) / _MEDIAN_OF_SECOND_DIFFERENCES
            found[name] = (max(rough, 1e-3 * float(np.std(there))), model[name].unit)
    return found


def parameters_to_estimate(model: Model) -> tuple[str, ...]:
    """Return the parameters a model declares as estimated.

    Parameters
    ----------
    model : Model
        The model.
    """
    return tuple(n for n in model.parameters if model[n].quantity.estimated and n not in model.delays.values())
