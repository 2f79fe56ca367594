"""Candidates with what was measured: the wind where every trial has it, a lag where the rudder of the log is the order."""

from __future__ import annotations

from collections.abc import Sequence

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.foundation.errors import ShipidError
from shipid.identification.problem.dead_time import with_dead_time
from shipid.parameters.catalogue import IN_WIND, find_model, in_wind, model_of
from shipid.trials.measuring.rudder.steering import rate_of, steering_of
from shipid.trials.signals.plates import plates, regular
from shipid.trials.trial import Trial

#: The candidates where none are named: first-order yaw, the same with surge, second-order yaw with surge and a rudder in the
#: slipstream, and sway and yaw with cross-flow drag.
CANDIDATES = ("cubic", "de-keizer", "bech-slipstream", "cross-flow")
#: What stands at the end of the name of a model that is behind an actuator with a lag.
BEHIND_A_LAG = "-lag"


def completed(models: Sequence[Model | type[Component] | str], trials: Sequence[Trial]) -> tuple[Model, ...]:
    """Return the candidates with what the trials hold, each once.

    A wind that was measured has turned the ship, an actuator that only has orders lags whatever the hull is like, and a rudder that
    acts late in every trial does so: none is a property of a structure that the comparison could find.

    Parameters
    ----------
    models : sequence of Model, component class or str
        As they are named.
    trials : sequence of Trial
        What they will be fitted to.

    Returns
    -------
    tuple of Model
    """
    windy = all(t.has("wind_speed", "wind_direction") for t in trials)
    late = all(holds_orders_only(t) for t in trials)
    found: dict[str, Model] = {}
    for one in models:
        model = model_of(one)
        if late:
            model = _behind_a_lag(model)
        if windy:
            model = in_wind(model)
        model = with_dead_time(model, trials)
        found.setdefault(model.name, model)
    return tuple(found.values())


def _behind_a_lag(model: Model) -> Model:
    """The model of the installation that differs by the lag of the actuator; the same where there is none."""
    if BEHIND_A_LAG in model.name or "delta_lagged" in model.states:
        return model
    base, wind = (model.name.removesuffix(IN_WIND), IN_WIND) if model.name.endswith(IN_WIND) else (model.name, "")
    try:
        return find_model(base + BEHIND_A_LAG + wind)
    except ShipidError:
        return model


def holds_orders_only(trial: Trial) -> bool:
    """Return whether the rudder of a trial is an order: it steps from plate to plate, which no rudder does.

    Parameters
    ----------
    trial : Trial
        The trial.
    """
    if not trial.has("delta"):
        return False
    try:
        steering = steering_of(trial, "order", "delta")
    except ShipidError:
        return False
    held = regular(plates(steering.channel.y))
    return len(held) > 1 and rate_of(steering, held).rate is None
