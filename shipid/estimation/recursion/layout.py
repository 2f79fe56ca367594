"""Where everything stands in the vectors that a generated step takes and returns."""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType
from typing import Literal

import casadi as ca
import numpy as np

from shipid.estimation.recursion import covariance_form, square_root_form
from shipid.estimation.recursion.equations import Equations
from shipid.estimation.recursion.gate import MEMORY, Gate
from shipid.foundation.aliases import Expression

#: What is carried of the covariance.
Form = Literal["covariance", "square-root"]
#: The functions of each form; both have the same names.
FORMS: dict[str, ModuleType] = {"covariance": covariance_form, "square-root": square_root_form}
#: The parts of a vector by name.
Places = dict[str, slice]


def places_of(**sizes: int) -> Places:
    """Return the places of parts that stand one after the other.

    Parameters
    ----------
    **sizes : int
        Length of each part by name, in order.
    """
    places, at = {}, 0
    for name, count in sizes.items():
        places[name] = slice(at, at + count)
        at += count
    return places


def total(places: Places) -> int:
    """Return the length of a vector with these places.

    Parameters
    ----------
    places : dict of str to slice
        Its parts.
    """
    return max((p.stop for p in places.values()), default=0)


def part(vector: Expression, place: slice) -> Expression:
    """Return a part of a column; CasADi takes an empty part of a single number for a row.

    Parameters
    ----------
    vector : casadi.SX
        The column.
    place : slice
        The part.
    """
    return vector[place] if place.stop > place.start else ca.SX(0, 1)


@dataclass(frozen=True, eq=False)
class StepSettings:
    """What a generated filter step does besides its equations.

    Attributes
    ----------
    form : {"covariance", "square-root"}
        What is carried of the covariance.
    gate : Gate or None
        When samples are rejected; None takes in every one.
    wraps : ndarray of bool, shape (sensors,)
        Which sensors show an angle that wraps.
    low, high : ndarray, shape (states,)
        Bounds of each state, infinite where it has none.
    resettable : ndarray of bool, shape (states,)
        Which states may be reset to what a sensor persistently shows: those that are no parameters.
    switchable : bool
        Whether each sample says if the parameters adapt.
    """

    form: Form
    gate: Gate | None
    wraps: np.ndarray
    low: np.ndarray
    high: np.ndarray
    resettable: np.ndarray
    switchable: bool

    def gain_factors(self, size: int, switch: Expression) -> Expression | None:
        """Return a factor on the gain of each unknown: the switch for parameters, 1 for all others; None without a switch.

        Parameters
        ----------
        size : int
            Number of unknowns.
        switch : casadi.SX
            1 where parameters adapt, 0 where they do not.
        """
        if not self.switchable:
            return None
        factors = ca.SX.ones(size)
        for index in np.flatnonzero(~self.resettable).tolist():
            factors[index] = switch
        return factors


class StepLayout:
    """Where everything stands in the vectors of a filter step.

    Parameters
    ----------
    equations : Equations
        The model.
    settings : StepSettings
        What the step does.

    Attributes
    ----------
    n, joint, inputs, sensors, sources : int
        How many states, unknowns of the joint vector, inputs, sensors and noise sources there are.
    carried, control, constants : dict of str to slice
        What the step takes: what it carries from sample to sample, what comes with a sample, what never changes.
    brief, full : dict of str to slice
        What it returns of a sample, without and with covariances and predicted values.
    """

    def __init__(self, equations: Equations, settings: StepSettings) -> None:
        self.n = equations.system.x.shape[0]
        self.joint = equations.joint.shape[0]
        self.inputs = equations.system.u.shape[0]
        self.sensors = len(equations.measured)
        self.sources = len(equations.sources)
        remembered = self.sensors if settings.gate is not None else 0
        self.carried = places_of(
            x=self.n,
            w=self.joint - self.n,
            u=self.inputs,
            P=FORMS[settings.form].size(self.joint),
            **dict.fromkeys(MEMORY, remembered),
        )
        self.control = places_of(
            u=self.inputs,
            T=1,
            z=self.sensors,
            there=self.sensors,
            scale=self.sources,
            adapting=int(settings.switchable),
        )
        self.constants = places_of(p=equations.p.shape[0], q=self.sources, r=self.sensors)
        brief = {"x": self.n, "var": self.n, "e": self.sensors, "S": self.sensors, "fate": self.sensors, "ll": 1}
        triangle = covariance_form.size(self.joint)
        self.brief = places_of(**brief)
        self.full = places_of(
            **brief,
            w=self.joint - self.n,
            P=triangle,
            ahead=self.joint,
            P_ahead=triangle,
            inflation=self.sensors,
        )
