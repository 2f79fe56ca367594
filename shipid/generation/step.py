"""Steps: from one sample to the next, by an explicit Runge-Kutta method, or exactly where the model is sampled.

The input is held (``hold="zero"``) or runs in a straight line between its samples (``hold="linear"``, right for a
measured rudder). A state that is defined by its next sample takes it from the start of the step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from shipid.declaration.delays import refuse_delay
from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.foundation.errors import UnknownNameError, UsageError
from shipid.generation.system import System


@dataclass(frozen=True)
class Tableau:
    """An explicit Runge-Kutta method: its Butcher tableau and order.

    Attributes
    ----------
    a : tuple of tuple of float
        Strictly lower triangular weights, one row a stage.
    b, c : tuple of float
        Weights of the stages, and where in the step they lie.
    order : int
        Order of the method.
    """

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    c: tuple[float, ...]
    order: int


METHODS: dict[str, Tableau] = {
    "euler": Tableau(((),), (1.0,), (0.0,), 1),
    "heun": Tableau(((), (1.0,)), (0.5, 0.5), (0.0, 1.0), 2),
    "rk4": Tableau(((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), (1 / 6, 1 / 3, 1 / 3, 1 / 6), (0.0, 0.5, 0.5, 1.0), 4),
}


@dataclass(frozen=True)
class Step:
    """One step as SX expressions, for further generation.

    Attributes
    ----------
    system : System
        What it steps.
    u0, u1 : casadi.SX
        Inputs at the start and the end of the step (the same symbol when the input is held).
    x_next : casadi.SX
        States at the end of the step.
    """

    system: System
    u0: Any
    u1: Any
    x_next: Any

    @property
    def function(self) -> CasadiFunction:
        """The CasADi function ``(x, u0, u1, p, T) -> x_next``."""
        s = self.system
        u1 = ca.SX.sym("u1", s.u.shape[0])
        held = ca.is_equal(self.u0, self.u1)
        return ca.Function(
            "step",
            [s.x, self.u0, u1 if held else self.u1, s.p, s.T],
            [self.x_next],
            ["x", "u0", "u1", "p", "T"],
            ["x_next"],
        )


def make_step(
    system: System, method: str = "rk4", hold: str = "linear", substeps: int = 1, delayed: bool = False
) -> Step:
    """Generate the step of a system.

    Parameters
    ----------
    system : System
        The equations.
    method : {"rk4", "heun", "euler"}
        Integration method of the continuous states.
    hold : {"linear", "zero"}
        How the input runs between its samples.
    substeps : int
        Integration steps in one sampling interval.
    delayed : bool
        Whether who runs it shifts the inputs that have a dead time (`shipid.declaration.delays`); a step alone cannot.

    Returns
    -------
    Step

    Raises
    ------
    UnknownNameError
        If the method or the hold is unknown.
    UsageError
        If `substeps` is less than one, or an input has a dead time that nobody shifts it by.
    """
    if method not in METHODS:
        raise UnknownNameError("integration method", method, METHODS)
    if hold not in ("linear", "zero"):
        raise UnknownNameError("hold", hold, ("linear", "zero"))
    if substeps < 1:
        raise UsageError(f"a step needs at least one substep, and got {substeps}.")
    u1 = system.u if hold == "zero" else ca.SX.sym("u1", system.u.shape[0])
    if not delayed:
        refuse_delay(system.model, "A step from sample to sample")
    x_next = system.x + 0  # a copy: assigning to its rows must not change the system
    if len(system.nexts) < system.x.shape[0]:
        rates = ca.Function("rates", [system.x, system.u, system.p, system.T], [system.rates])
        for i in range(substeps):
            x_next = _advance(METHODS[method], rates, system, u1, x_next, i / substeps, 1 / substeps)
    for index, expression in system.nexts.items():
        x_next[index] = expression
    return Step(system, system.u, u1, x_next)


def _advance(
    tableau: Tableau, rates: Expression, system: System, u1: Expression, x: Expression, begin: float, length: float
) -> Expression:
    """Advance by a fraction of the sampling interval."""
    h = system.T * length
    slopes: list[Any] = []
    for weights, c in zip(tableau.a, tableau.c):
        at = begin + c * length
        stage = x
        for w, slope in zip(weights, slopes):
            if w:
                stage = stage + h * w * slope
        slopes.append(rates(stage, system.u + at * (u1 - system.u), system.p, system.T))
    total = sum(b * slope for b, slope in zip(tableau.b, slopes))
    return x + h * total
