"""Whether a sound trial can be identified from: a rudder, or another input of the model, that moves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from shipid.declaration.model import Model
from shipid.declaration.units import pretty, same_dimension
from shipid.declaration.vocabulary import FIELDS, angle
from shipid.parts.rudder_delay import steered_by
from shipid.trials.checks import STEADY_RUDDER
from shipid.trials.errors import ColumnUnitError, NoRudderMovementError, UnknownColumnError
from shipid.trials.trial import Trial


def check_identifiable(trials: Sequence[Trial], model: Model) -> None:
    """Refuse trials in which nothing moves the model: there is no response to identify.

    Parameters
    ----------
    trials : sequence of Trial
        The trials.
    model : Model
        What is fitted to them. One that no rudder steers, such as the depth of a submarine under her planes, needs another of its
        inputs to change.

    Raises
    ------
    NoRudderMovementError
        If the rudder of a trial stays within 0.5 deg, no sample of it is known, or no input of a model without a rudder changes.
    UnknownColumnError
        If a trial does not have the rudder.
    """
    steered = steered_by(model)
    for trial in trials:
        if steered is not None or not model.inputs:
            check_identifiable_input(trial, steered or "delta")
        elif not any(_changes(trial, n) for n in model.inputs):
            raise NoRudderMovementError(
                f"trial '{trial.name}' holds nothing that moves model {model.name}: none of its inputs {', '.join(model.inputs)} changes in "
                f"it. It has {', '.join(trial.table.columns)}."
            )


def check_column_units(trial: Trial, model: Model, names: Iterable[str] | None = None) -> None:
    """Refuse a column outside the vocabulary whose unit is not that of the quantity of the model: its SI values go in as they are.

    Parameters
    ----------
    trial : Trial
        The trial.
    model : Model
        What reads it.
    names : iterable of str, optional
        The columns; by default those of the inputs, states and outputs of the model.

    Raises
    ------
    ColumnUnitError
        With the column and both units.
    """
    for name in (*model.inputs, *model.states, *model.outputs) if names is None else names:
        if name in FIELDS or name not in model or not trial.has(name):
            continue
        found, wanted = trial.unit(name), model[name].unit
        if not same_dimension(found, wanted):
            raise ColumnUnitError(
                f"trial '{trial.name}', column '{name}': it is in {pretty(found)}, and model {model.name} has '{name}' "
                f"({model[name].quantity.meaning}) in {pretty(wanted)}. Correct the unit in the header or in a format file, or rename the column."
            )


def _changes(trial: Trial, name: str) -> bool:
    values = trial[name][np.isfinite(trial[name])] if trial.has(name) else np.empty(0)
    return values.size > 1 and bool(np.ptp(values) > 0)


def check_identifiable_input(trial: Trial, column: str = "delta") -> None:
    """Refuse a trial in which the rudder does not move: there is no response to identify.

    Parameters
    ----------
    trial : Trial
        The trial.
    column : str
        The input: ``delta`` or ``delta_order``.

    Raises
    ------
    NoRudderMovementError
        If the rudder stays within 0.5 deg, or no sample of it is known.
    UnknownColumnError
        If there is no such column.
    """
    if not trial.has(column):
        raise UnknownColumnError(
            f"trial '{trial.name}' has no column '{column}', and without the rudder angle there is nothing to "
            f"identify. It has {', '.join(trial.table.columns)}." + _of_thrusters(trial, column)
        )
    delta = trial[column]
    delta = delta[np.isfinite(delta)]
    if not delta.size:
        raise NoRudderMovementError(
            f"trial '{trial.name}', column '{column}': each of its {len(trial)} samples is missing, so that there is no response to identify. "
            "Use a stretch in which the rudder is known."
        )
    spread = float(np.ptp(delta))
    if spread <= STEADY_RUDDER:
        raise NoRudderMovementError(
            f"trial '{trial.name}', column '{column}': the rudder stays at {angle(float(np.median(delta)), 3)} "
            f"(it moves by {angle(spread, 2)}), so the response to it cannot be identified. "
            "Use a stretch with a manoeuvre in it, or check which column holds the rudder angle."
        )


def _of_thrusters(trial: Trial, column: str) -> str:
    """What to do where a ship is steered by azimuth thrusters: models of yaw read their angle as that of a rudder."""
    angles = [n for n in trial.table.columns if "azi" in n.casefold()]
    if not angles:
        return ""
    one = angles[0]
    return (
        f" A ship that is steered by azimuth thrusters is read by the same models: name the angle of one of them, '{one}', "
        f"{column} in a format file ('shipid format FILE' drafts it), with sign = -1 where a positive angle turns her to port. Thrusters on "
        "both sides that are turned together count once."
    )
