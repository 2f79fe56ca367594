"""The part of a model that some of its quantities depend on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from shipid.declaration.model import Model
from shipid.declaration.quantity import COMPUTED
from shipid.generation.system import generate


def reduced(model: Model, names: Sequence[str]) -> Model:
    """Return the model without the states that have no influence on the named quantities.

    A filter that measures heading and rate of turn needs no position; each state that is left out saves a row of the
    covariance.

    Parameters
    ----------
    model : Model
        The model.
    names : sequence of str
        Quantities that have to stay.

    Returns
    -------
    Model
        The same equations; derived quantities, outputs and guards that read a state left out are left out too.
    """
    system = generate(model)
    kept = system.states_behind(names)
    if len(kept) == len(model.states):
        return model
    gone = ca.vertcat(*(system.values[s] for s in model.states if s not in kept))
    entries = {}
    for name, entry in model.entries.items():
        kind = entry.quantity.kind
        reads = kind in COMPUTED and name in system.values and ca.depends_on(system.values[name], gone)
        if not reads and (kind != "state" or name in kept):
            entries[name] = entry
    return replace(model, entries=entries)
