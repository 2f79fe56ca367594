"""The dead time of the rudder: when it is estimated unasked, and where its search starts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.parameters.catalogue import delayed, model_of
from shipid.trials.doctor.early_rudder import early_rudder
from shipid.trials.trial import Trial

#: The coefficient of `shipid.parts.rudder_delay.RudderDelay`.
DEAD_TIME = "delay"
#: States between the rudder of a log and its force: a model that has one takes a late answer for its lag.
_LAGS = ("delta", "delta_lagged", "delta_behind")


def usual_delay(trials: Sequence[Trial]) -> float | None:
    """Return by how much the rudder of trials acts later than it is logged, in s, as `check` finds it; None where it finds nothing.

    Parameters
    ----------
    trials : sequence of Trial
        The trials.
    """
    found = [early.seconds for trial in trials if trial.has("delta") and (early := early_rudder(trial)) is not None]
    return float(np.median(found)) if found else None


def has_lag(model: Model) -> bool:
    """Return whether a model has a steering gear or a lag between the rudder of a log and its force.

    Parameters
    ----------
    model : Model
        The model.
    """
    return any(state in model.states for state in _LAGS)


def with_dead_time(model: Model | type[Component] | str, trials: Sequence[Trial]) -> Model:
    """Return a model with a dead time of the rudder, where `check` is certain of one in every trial; the same otherwise.

    Parameters
    ----------
    model : Model, component class or str
        The model. One with a lag between the rudder of the log and its force stays as it is.
    trials : sequence of Trial
        The trials.
    """
    whole = model_of(model)
    if has_lag(whole):
        return whole
    found = [early_rudder(trial) if trial.has("delta") else None for trial in trials]
    return delayed(whole) if all(early is not None and early.firm for early in found) else whole
