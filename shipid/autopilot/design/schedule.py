"""The gain schedule: clamped and piecewise linear in the speed, one expression for simulation, derivative and emission.

A schedule is a component: its speeds and gains are constants of the model, with the designed values as defaults. So the
equations run over floats, quantities with units and symbols alike, another tuning of the same size is the same compiled code,
and the gains can be set on the target machine.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from shipid.autopilot.design.placement import Gains
from shipid.autopilot.errors import DesignRequestError
from shipid.declaration.component import Component
from shipid.declaration.quantity import Equation, Quantity, constant, derived, given
from shipid.foundation.aliases import Expression
from shipid.foundation.result import Result

if TYPE_CHECKING:
    import pandas as pd

#: Gain: its unit, and its meaning.
GAINS = {
    "Kp": ("1", "rudder per heading error"),
    "Kd": ("s", "rudder per rate of turn"),
    "Ki": ("1/s", "rudder per heading error and second"),
}


@dataclass(frozen=True, eq=False, repr=False)
class Schedule(Result):
    """Gains against speed, for one load condition or several.

    Attributes
    ----------
    speeds : ndarray, shape (n,)
        In m/s, rising.
    gains : mapping of str to ndarray, shape (conditions, n)
        ``Kp`` [1], ``Kd`` [s] and, with an integral, ``Ki`` [1/s].
    """

    UNITS: ClassVar[Mapping[str, str]] = {"speeds": "m/s"}

    speeds: np.ndarray
    gains: Mapping[str, np.ndarray]

    def __post_init__(self) -> None:
        if self.speeds.ndim != 1 or not len(self.speeds) or not (np.diff(self.speeds) > 0).all():
            raise DesignRequestError("the speeds of a schedule have to rise.")
        object.__setattr__(self, "gains", {n: np.atleast_2d(np.asarray(g, dtype=float)) for n, g in self.gains.items()})

    @property
    def conditions(self) -> int:
        """Number of load conditions."""
        return len(next(iter(self.gains.values())))

    def at(self, speed: float | np.ndarray, condition: int = 0) -> dict[str, np.ndarray]:
        """Return the gains by name at a speed, or at several; beyond the ends of the schedule they stay as they are.

        Parameters
        ----------
        speed : float or ndarray
            In m/s.
        condition : int
            Which load condition.
        """
        return {n: np.interp(speed, self.speeds, g[condition]) for n, g in self.gains.items()}

    def gains_at(self, speed: float, condition: int = 0) -> Gains:
        """Return the gains at one speed.

        Parameters
        ----------
        speed : float
            In m/s.
        condition : int
            Which load condition.
        """
        return Gains(**{n: float(v) for n, v in self.at(speed, condition).items()})

    def to_frame(self, condition: int = 0) -> pd.DataFrame:
        """Return the gains against speed as a pandas table.

        Parameters
        ----------
        condition : int
            Which load condition.
        """
        import pandas as pd

        columns = {f"{n} [{GAINS[n][0]}]": g[condition] for n, g in self.gains.items()}
        return pd.DataFrame(columns, index=pd.Index(self.speeds, name="u [m/s]"))

    @property
    def component(self) -> type[Component]:
        """The schedule as a component that states ``gain_Kp``, ``gain_Kd`` and, with an integral, ``gain_Ki``."""
        gains = tuple((n, tuple(map(tuple, g.tolist()))) for n, g in self.gains.items())
        return _component(tuple(self.speeds.tolist()), gains)


def clamped(at: Expression, nodes: Sequence[Expression], values: Sequence[Expression]) -> Expression:
    """Return the value of a piecewise linear function, constant beyond its ends.

    Parameters
    ----------
    at : float, Quantity or SX
        Where.
    nodes, values : sequence of float, Quantity or SX
        The corners, rising, and the function there.
    """
    total = values[0]
    for low, high, below, above in zip(nodes, nodes[1:], values, values[1:]):
        share = np.minimum(np.maximum((at - low) / (high - low), 0.0), 1.0)
        total = total + (above - below) * share
    return total


@functools.lru_cache(maxsize=64)
def _component(
    speeds: tuple[float, ...], gains: tuple[tuple[str, tuple[tuple[float, ...], ...]], ...]
) -> type[Component]:
    conditions = len(gains[0][1])
    members: dict[str, object] = {
        "__doc__": "Gains of an autopilot against the measured speed, clamped and piecewise linear.",
        "__module__": __name__,
        "speed_seen": given("m/s", "forward speed through the water, as the autopilot measures it"),
    }
    for i, speed in enumerate(speeds, start=1):
        members[f"pilot_u_{i}"] = constant("m/s", f"speed {i} of the schedule", default=speed)
    if conditions > 1:
        members["loading"] = given(
            "1", "load condition: 0 for the first, 1 for the second, linear between", default=0.0
        )
        for j in range(conditions):
            members[f"pilot_load_{j + 1}"] = constant("1", f"load condition {j + 1} of the schedule", default=float(j))
    for name, table in gains:
        unit, meaning = GAINS[name]
        for j, row in enumerate(table, start=1):
            for i, value in enumerate(row, start=1):
                members[f"pilot_{name}_{i}" if conditions == 1 else f"pilot_{name}_{i}_{j}"] = constant(
                    unit,
                    f"{meaning} at speed {i}" + ("" if conditions == 1 else f", load condition {j}"),
                    default=value,
                )
        quantity: Quantity = derived(unit, f"{meaning}, scheduled", latex=f"K_{name[1]}")
        members[f"gain_{name}"] = quantity
        members[f"schedule_{name}"] = Equation(quantity, "equals", _interpolating(name, len(speeds), conditions))
    return type("GainSchedule", (Component,), members)


@functools.lru_cache(maxsize=256)
def _interpolating(name: str, count: int, conditions: int) -> Callable[[Component], Expression]:
    def schedule(self: Expression) -> Expression:
        """Clamped piecewise linear in the speed, and in the load condition where there are several."""
        nodes = [getattr(self, f"pilot_u_{i}") for i in range(1, count + 1)]
        if conditions == 1:
            return clamped(self.speed_seen, nodes, [getattr(self, f"pilot_{name}_{i}") for i in range(1, count + 1)])
        by_load = [
            clamped(self.speed_seen, nodes, [getattr(self, f"pilot_{name}_{i}_{j}") for i in range(1, count + 1)])
            for j in range(1, conditions + 1)
        ]
        return clamped(self.loading, [getattr(self, f"pilot_load_{j}") for j in range(1, conditions + 1)], by_load)

    return schedule
