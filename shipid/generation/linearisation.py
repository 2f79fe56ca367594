"""Linearisation at a condition, and the steady conditions to linearise at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from shipid.declaration.delays import refuse_delay
from shipid.declaration.model import Model
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import ShipidError, UnknownNameError, UsageError
from shipid.foundation.exit_codes import ExitCode
from shipid.foundation.result import Result
from shipid.generation.system import System, generate

if TYPE_CHECKING:
    import pandas as pd

#: States that may change at a constant rate in a steady motion: position and heading. Others that no
#: equation but their own kind reads, such as a distance sailed, are found by `_settling`.
COORDINATES = ("x", "y", "psi")


class NoSteadyStateError(ShipidError):
    """No steady motion was found from the given starting point."""

    exit_code = ExitCode.NO_CONVERGENCE


@dataclass(frozen=True, repr=False)
class Linearisation(Result):
    """The linear model ``dx/dt = A x + B u``, ``y = C x + D u`` of small deviations from a condition.

    Attributes
    ----------
    A, B, C, D : ndarray
        Exact Jacobians, shapes (n, n), (n, m), (k, n), (k, m).
    states, inputs, outputs : tuple of str
        Names along them.
    condition : mapping of str to float
        Where it holds, SI.
    """

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    condition: Mapping[str, float]

    @property
    def poles(self) -> np.ndarray:
        """Eigenvalues of A in 1/s, slowest decay first."""
        values = np.linalg.eigvals(self.A)
        return values[np.argsort(-values.real)]

    def to_state_space(self) -> Expression:
        """Return the python-control state-space system, with names."""
        import control

        return control.ss(
            self.A,
            self.B,
            self.C,
            self.D,
            states=list(self.states),
            inputs=list(self.inputs),
            outputs=list(self.outputs),
        )

    def to_frame(self) -> pd.DataFrame:
        """Return the blocks A, B above C, D as a pandas table: rates of states, then outputs, against states and inputs."""
        import pandas as pd

        rows = [("rate", s) for s in self.states] + [("output", y) for y in self.outputs]
        columns = [("state", s) for s in self.states] + [("input", u) for u in self.inputs]
        blocks = np.block([[self.A, self.B], [self.C, self.D]])
        return pd.DataFrame(blocks, pd.MultiIndex.from_tuples(rows), pd.MultiIndex.from_tuples(columns))

    def text(self) -> str:
        """Return the linear model in lines of text."""
        sizes = f"states {', '.join(self.states)}; inputs {', '.join(self.inputs)}; outputs {', '.join(self.outputs)}"
        poles = ", ".join(f"{p.real:.4g}" if not p.imag else f"{p.real:.4g}{p.imag:+.4g}j" for p in self.poles)
        return f"linear model: {sizes}\n  poles [1/s]  {poles}"


def linearise(
    model: Model,
    condition: Mapping[str, float],
    states: Sequence[str] | None = None,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    *,
    delayed: bool = False,
) -> Linearisation:
    """Linearise a continuous model at a condition, with exact Jacobians.

    Parameters
    ----------
    model : Model
        A model whose states all have a rate.
    condition : mapping of str to float
        SI values of states (0 where not given), inputs, parameters and constants.
    states, inputs, outputs : sequence of str, optional
        Which to keep; by default all states, all inputs, and the states as outputs.
    delayed : bool
        Whether who asks takes account of inputs that have a dead time; a linear system alone cannot.

    Returns
    -------
    Linearisation

    Raises
    ------
    UsageError
        If the condition is no mapping.
    DeclarationError
        If a value is missing, or a state is sampled.
    UnknownNameError
        If the model has no such state, input or output.
    """
    if not isinstance(condition, Mapping):
        kind = type(condition).__name__
        raise UsageError(
            f"linearise takes numbers by name, such as {{'u': 9.5, 'K': 0.05}}, and no {kind}; fit.to_control() takes a ship."
        )
    if not delayed:
        refuse_delay(model, "A linear system without one")
    system = generate(model)
    _ = system.right_hand_side  # raises for a sampled model
    at = (
        system.vector(system.states, condition, default=0.0),
        system.vector(system.inputs, condition, default=0.0),
        system.vector(system.coefficients, condition),
    )
    kept = tuple(states or system.states)
    shown = tuple(outputs or kept)
    used = tuple(inputs or system.inputs)
    for kind, names, known in (("state", kept, system.states), ("input", used, system.inputs)):
        for name in names:
            if name not in known:
                raise UnknownNameError(f"{kind} of model {model.name} called", name, known)
    rates, y = (system.at_an_instant(e) for e in (system.rates, system.expression(shown)))
    blocks = ca.Function(
        "linear",
        [system.x, system.u, system.p],
        [
            ca.jacobian(rates, system.x),
            ca.jacobian(rates, system.u),
            ca.jacobian(y, system.x),
            ca.jacobian(y, system.u),
        ],
    )
    a, b, c, d = (np.asarray(m.full()) for m in blocks(*at))
    i = [system.states.index(s) for s in kept]
    j = [system.inputs.index(n) for n in used]
    return Linearisation(
        a[np.ix_(i, i)], b[np.ix_(i, j)], c[:, i], d[:, j], kept, used, shown, MappingProxyType(dict(condition))
    )


def _settling(system: System) -> list[int]:
    """Return the indices of the states that come to rest in a steady motion, and are not constant anyway."""
    reads = np.array(ca.DM(ca.jacobian(system.rates, system.x).sparsity(), 1).full(), dtype=bool)
    drifting = np.array([s in COORDINATES for s in system.states])
    for _ in system.states:
        drifting |= ~reads[~drifting].any(axis=0)
    return [i for i, drifts in enumerate(drifting) if not drifts and not system.rates[i].is_zero()]


def find_steady_state(model: Model, condition: Mapping[str, float]) -> dict[str, float]:
    """Return the states of a steady motion: all rates zero but those of position, heading and distance sailed.

    Parameters
    ----------
    model : Model
        A model whose states all have a rate.
    condition : mapping of str to float
        Inputs, parameters and constants, and where the search starts in the states (0 where not given).

    Returns
    -------
    dict of str to float
        Every state, SI.

    Raises
    ------
    NoSteadyStateError
        If the search does not converge.
    """
    from scipy.optimize import root

    system = generate(model)
    rates, jacobian = system.right_hand_side, system.jacobian("rates", "x")
    free = _settling(system)
    x = system.vector(system.states, condition, default=0.0)
    u = system.vector(system.inputs, condition, default=0.0)
    p = system.vector(system.coefficients, condition)

    def fun(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x[free] = z
        return rates(x, u, p).full().ravel()[free], jacobian(x, u, p).full()[np.ix_(free, free)]

    if not free:
        return dict(zip(system.states, x.tolist()))
    found = root(fun, x[free].copy(), jac=True, tol=1e-13)
    residual = np.abs(fun(found.x)[0]).max()
    if not np.isfinite(residual) or residual > 1e-8:
        raise NoSteadyStateError(
            f"model {model.name} has no steady motion near the given start (the rates stay at {residual:.2g}). "
            "Start the search closer, or ask for less rudder."
        )
    return dict(zip(system.states, x.tolist()))
