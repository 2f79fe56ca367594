"""A state that remembers whether a guard of a model was active, for runs of which only the last states are kept."""

from __future__ import annotations

import functools

from shipid.declaration.component import Component
from shipid.declaration.model import Model
from shipid.declaration.quantity import Equation, Quantity, given, state
from shipid.foundation.aliases import Expression

#: The state: 1 once the run has left the range in which the model is valid.
DEPARTED = "departed"


def guard_watch(model: Model) -> tuple[type[Component], ...]:
    """Return the component to join with a model, whose state `DEPARTED` becomes 1 at the first sample a guard is active.

    Parameters
    ----------
    model : Model
        The model; one without guards needs none.
    """
    return (_watch(tuple((n, model[n].unit) for n in model.guards)),) if model.guards else ()


@functools.cache
def _watch(guards: tuple[tuple[str, str], ...]) -> type[Component]:
    """The component for guards of some names and units; one for each set, so that what is generated from it is kept."""
    import numpy as np

    departed: Quantity = state("1", "1 once the run has left the range in which the model is valid")
    margins = {name: given(unit, "margin of a guard") for name, unit in guards}

    def remember(self: Component) -> Expression:
        """It stays 1."""
        found = getattr(self, DEPARTED)
        for name, _ in guards:
            found = np.where(getattr(self, name) < 0, 1.0, found)
        return found

    members = {**margins, DEPARTED: departed, "remember": Equation(departed, "next", remember)}
    return type("GuardWatch", (Component,), {"__doc__": "Whether a guard of the model was active.", **members})
