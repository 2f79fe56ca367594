"""The navigator's console: what is tried, what is executed, and the ranges of both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, TypedDict, get_args

from shipid.bridge.shown.plain_values import number, number_given
from shipid.foundation.aliases import Plain
from shipid.foundation.errors import UsageError

#: How the ship is steered: to a heading, by a rudder angle, to a heading at a rate of turn, or along the route.
SteeringMode: TypeAlias = Literal["heading", "rudder", "rate", "track"]


class Ordered(TypedDict, total=False):
    """What is ordered of a predicted track; SI."""

    heading: float
    rudder: float
    rate: float
    rudder_limit: float


_NUMBERS = ("heading", "rudder_limit", "rate", "rudder")


@dataclass(frozen=True)
class SteeringOrder:
    """What is ordered, or tried; SI.

    Attributes
    ----------
    mode : {"heading", "rudder", "rate", "track"}
        How the ship is steered.
    heading : float
        Heading to steer in rad, from 0 to 2 pi.
    rudder_limit : float
        Largest rudder angle in rad.
    rate : float
        Rate of the turn in rad/s; the heading says to which side.
    rudder : float
        Rudder angle to hold in rad, positive to starboard.
    """

    mode: SteeringMode
    heading: float
    rudder_limit: float
    rate: float
    rudder: float

    def order(self) -> Ordered:
        """Return it as the order of a predicted track; along a route it is a heading."""
        if self.mode == "rudder":
            return {"rudder": self.rudder}
        if self.mode == "rate":
            return {"heading": self.heading, "rudder_limit": self.rudder_limit, "rate": self.rate}
        return {"heading": self.heading, "rudder_limit": self.rudder_limit}

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {"mode": self.mode, **{n: number(getattr(self, n)) for n in _NUMBERS}}


@dataclass(frozen=True)
class Limits:
    """The ranges of what can be ordered; SI, each from its lowest to its highest value.

    Attributes
    ----------
    rudder_limit, rate, rudder : tuple of float
        In rad, rad/s and rad.
    """

    rudder_limit: tuple[float, float]
    rate: tuple[float, float]
    rudder: tuple[float, float]

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {n: [number(v) for v in getattr(self, n)] for n in ("rudder_limit", "rate", "rudder")}


class Console:
    """What is tried and what is executed.

    Parameters
    ----------
    start : SteeringOrder
        What is tried at the beginning.
    limits : Limits
        The ranges.
    modes : tuple of str
        The modes that are possible: along a track only where there is a route.
    executed : bool
        Whether the beginning counts as executed.

    Attributes
    ----------
    trial : SteeringOrder
        What is tried.
    executed : SteeringOrder or None
        What is executed; None before anything was.
    """

    def __init__(
        self, start: SteeringOrder, limits: Limits, modes: tuple[SteeringMode, ...], *, executed: bool = True
    ) -> None:
        self.limits, self.modes = limits, modes
        self.trial = start
        self.executed: SteeringOrder | None = start if executed else None

    def change(self, wanted: Mapping[str, Plain]) -> bool:
        """Change what is tried; a number beyond its range takes the end of the range.

        Parameters
        ----------
        wanted : mapping of str to number or str
            Any of ``mode``, ``heading``, ``rudder_limit``, ``rate``, ``rudder``.

        Returns
        -------
        bool
            Whether something has changed.

        Raises
        ------
        UsageError
            If a name, a mode or a number is none; nothing is changed then.
        """
        found: dict[str, Plain] = {}
        for name, value in wanted.items():
            if name == "mode":
                if value not in self.modes:
                    raise UsageError(f"the mode is one of {', '.join(self.modes)}.")
                found[name] = value
            elif name in _NUMBERS:
                found[name] = self._within(name, value)
            else:
                raise UsageError(f"a trial has no '{str(name)[:40]}': it has mode, {', '.join(_NUMBERS)}.")
        before, self.trial = self.trial, replace(self.trial, **found)
        return self.trial != before

    def _within(self, name: str, value: Plain) -> float:
        given = number_given(value, name)
        if name == "heading":
            return given % (2 * math.pi)
        low, high = getattr(self.limits, name)
        return float(min(max(given, low), high))

    def execute(self) -> None:
        """Make what is tried what is executed."""
        self.executed = self.trial

    def cancel(self) -> bool:
        """Return whether it changes something to set what is tried back to what is executed, having done so."""
        before = self.trial
        self.trial = self.executed or self.trial
        return self.trial != before

    def to_dict(self) -> dict[str, Plain]:
        """Return plain values, SI."""
        return {
            "mode": self.trial.mode if self.executed is None else self.executed.mode,
            "trial": self.trial.to_dict(),
            "executed": None if self.executed is None else self.executed.to_dict(),
            "limits": self.limits.to_dict(),
            "modes": [m for m in get_args(SteeringMode) if m in self.modes],
        }
