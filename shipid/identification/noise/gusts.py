"""Gusts: what drives a state and lasts, as a first-order Gauss-Markov process with a size and a correlation time of its own.

White noise on a state is forgotten at the next sample. Wind and waves that push the ship for many seconds move the coefficients
more than white noise of the same power from sample to sample, and intervals that take them for white are too narrow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from shipid.declaration.component import Component, Scope
from shipid.declaration.model import Entry, Model
from shipid.declaration.quantity import Equation, Quantity
from shipid.foundation.aliases import Expression


@dataclass(frozen=True)
class Gust:
    """A disturbance that drives a state.

    Attributes
    ----------
    size : float
        Its standard deviation: unit of the state per second, SI.
    time : float
        Its correlation time in s.
    """

    size: float
    time: float


def state_of(name: str) -> str:
    """Return the name of the state that holds the gust on another state.

    Parameters
    ----------
    name : str
        The state it drives.
    """
    return f"gust_{name}"


def rate_of(name: str) -> str:
    """Return the name of the parameter: logarithm of one over the correlation time of the gust on a state, in 1/s.

    Parameters
    ----------
    name : str
        The state it drives.
    """
    return f"log_rate_{name}"


def with_gusts(model: Model, names: Sequence[str]) -> Model:
    """Return a model in which gusts drive states: ``x' = f + g``, ``g' = -g / T + white noise``.

    Parameters
    ----------
    model : Model
        The model.
    names : sequence of str
        States with a rate.

    Returns
    -------
    Model
        With a state and a parameter more for each name (`state_of`, `rate_of`).
    """
    entries = dict(model.entries)
    for name in names:
        entries |= _driven(entries[name])
    return replace(model, entries=entries)


def _driven(entry: Entry) -> dict[str, Entry]:
    name, moves = entry.name, entry.equation
    assert moves is not None and moves.kind == "rate"
    gust = Quantity("state", f"({entry.unit})/s", f"gust on {entry.quantity.meaning}", name=state_of(name))
    rate = Quantity(
        "parameter", "1", f"logarithm of one over the correlation time in s of {gust.meaning}", name=rate_of(name)
    )

    def decays(self: Scope) -> Expression:
        """First-order Gauss-Markov process: Gelb (1974), section 3.5."""
        return -np.exp(getattr(self, rate.name)) * getattr(self, gust.name)

    def driven(self: Scope) -> Expression:
        """The equation as declared, with the gust added."""
        return moves.function(self) + getattr(self, gust.name)

    shaping = Equation(gust, "rate", decays)
    members = {gust.name: gust, rate.name: rate, "decays": shaping}
    owner = type(f"Gust_{name}", (Component,), {"__doc__": "A gust.", **members})
    reads = {gust.name: replace(gust, kind="given")}
    whole = type(f"Driven_{name}", (entry.owner,), {"__doc__": "A component under a gust.", **reads})
    return {
        gust.name: Entry(gust, owner, shaping),
        rate.name: Entry(rate, owner),
        name: Entry(entry.quantity, whole, Equation(entry.quantity, "rate", driven)),
    }
