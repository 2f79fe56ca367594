"""A model as CasADi expressions: everything else is generated from it."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from shipid.declaration.component import SAMPLING_INTERVAL
from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction, Expression
from shipid.foundation.errors import DeclarationError, UnknownNameError, UsageError
from shipid.generation.symbolic_evaluation import SymbolicEvaluation, check_numbers

# CasADi has two modes for NumPy functions of its symbols; equations need the one that returns symbols.
ca.GlobalOptions.setNumpyMode(1)

#: The sampling interval in s of what is looked at as continuous: short beside the response of any ship.
_INSTANT = 0.005


@dataclass(frozen=True, repr=False)
class System:
    """The equations of a model as SX expressions of its states, inputs and coefficients.

    Attributes
    ----------
    model : Model
        What it was generated from.
    x, u, p : casadi.SX
        Column vectors: states, inputs, coefficients (parameters, then constants), in the order of the names.
    T : casadi.SX
        The sampling interval.
    rates : casadi.SX
        Time derivative of each state; zero for a state that is defined by its next sample.
    nexts : mapping of int to casadi.SX
        Next sample of the states that are defined by it, by index.
    values : mapping of str to casadi.SX
        Every quantity of the model by name.
    """

    model: Model
    x: Any
    u: Any
    p: Any
    T: Any
    rates: Any
    nexts: Mapping[int, Any]
    values: Mapping[str, Any] = field(repr=False)

    def __repr__(self) -> str:
        return (
            f"<equations of {self.model.name!r}: states {', '.join(self.states)}; inputs {', '.join(self.inputs) or 'none'}; "
            f"coefficients {', '.join(self.coefficients) or 'none'}>"
        )

    def _repr_html_(self) -> str:
        """The model that it was generated from."""
        return self.model._repr_html_()

    @property
    def states(self) -> tuple[str, ...]:
        """Names along `x`."""
        return self.model.states

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names along `u`."""
        return self.model.inputs

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Names along `p`: the parameters, then the constants."""
        return self.model.parameters + self.model.constants

    def expression(self, names: Sequence[str]) -> Expression:
        """Return the named quantities as one column.

        Parameters
        ----------
        names : sequence of str
            Quantities of the model.

        Raises
        ------
        UnknownNameError
            If the model has no such quantity.
        """
        unknown = [n for n in names if n not in self.values]
        if unknown:
            raise UnknownNameError(f"quantity in model {self.model.name} called", unknown[0], self.values)
        return ca.vertcat(*(self.values[n] for n in names)) if names else ca.SX(0, 1)

    def function(self, names: Sequence[str]) -> CasadiFunction:
        """Return the CasADi function ``(x, u, p) -> quantities``.

        Parameters
        ----------
        names : sequence of str
            States, inputs, derived quantities or outputs.
        """
        quantities = self.at_an_instant(self.expression(names))
        return ca.Function("quantities", [self.x, self.u, self.p], [quantities], ["x", "u", "p"], ["y"])

    def at_an_instant(self, expression: Expression) -> Expression:
        """Return an expression of a continuous model as it is at a very short sampling interval; the same of a sampled one.

        Parameters
        ----------
        expression : casadi.SX
            Of the symbols of this system.
        """
        return expression if self.nexts else ca.substitute(expression, self.T, _INSTANT)

    @functools.cached_property
    def right_hand_side(self) -> CasadiFunction:
        """The CasADi function ``(x, u, p) -> dx/dt``.

        Raises
        ------
        DeclarationError
            If a state is defined by its next sample, and so has no rate.
        """
        if self.nexts:
            sampled = ", ".join(self.states[i] for i in self.nexts)
            raise DeclarationError(f"model {self.model.name} has no right-hand side: {sampled} is sampled. Use a step.")
        rates = self.at_an_instant(self.rates)
        return ca.Function("right_hand_side", [self.x, self.u, self.p], [rates], ["x", "u", "p"], ["dx"])

    def jacobian(self, of: str, by: str) -> CasadiFunction:
        """Return the CasADi function ``(x, u, p) -> Jacobian``, exact.

        Parameters
        ----------
        of : {"rates"} or str
            The right-hand side, or the name of a quantity.
        by : {"x", "u", "p"}
            The argument to differentiate by.
        """
        wanted = self.at_an_instant(self.rates if of == "rates" else self.expression([of]))
        derivative = ca.jacobian(wanted, {"x": self.x, "u": self.u, "p": self.p}[by])
        return ca.Function("jacobian", [self.x, self.u, self.p], [derivative], ["x", "u", "p"], ["J"])

    def states_behind(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return the states that can have an influence on the named quantities, in order.

        Parameters
        ----------
        names : sequence of str
            Quantities of the model.
        """
        moves, shown = self.moves, self.expression(names)
        reads = _dependence(moves, self.x)
        behind = np.asarray(_dependence(shown, self.x).any(axis=0))
        for _ in self.states:
            behind = behind | reads[behind].any(axis=0)
        return tuple(s for s, needed in zip(self.states, behind.tolist()) if needed)

    def inputs_behind(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return the inputs that can have an influence on the named quantities, in order.

        Parameters
        ----------
        names : sequence of str
            Quantities of the model.
        """
        return _inputs_behind(self.model, tuple(names))

    def states_driven_by(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return the states on which some inputs or coefficients can have an influence, in order.

        Parameters
        ----------
        names : sequence of str
            Inputs and coefficients of the model.
        """
        moves, known = self.moves, (*self.inputs, *self.coefficients)
        reads = _dependence(moves, self.x)
        columns = [known.index(n) for n in names]
        driven = np.asarray(_dependence(moves, ca.vertcat(self.u, self.p))[:, columns].any(axis=1))
        for _ in self.states:
            driven = driven | reads[:, driven].any(axis=1)
        return tuple(s for s, is_driven in zip(self.states, driven.tolist()) if is_driven)

    @property
    def moves(self) -> Expression:
        """The expression of each state's equation: its rate, or its next sample."""
        moves = self.rates + 0
        for index, expression in self.nexts.items():
            moves[index] = expression
        return moves

    def vector(self, names: Sequence[str], values: Mapping[str, float], default: float | None = None) -> np.ndarray:
        """Return named numbers in an order, shape (len(names),).

        Parameters
        ----------
        names : sequence of str
            The order.
        values : mapping of str to float
            By name, SI; a number that is not there takes the declared default.
        default : float, optional
            For a number that declares none either.

        Raises
        ------
        DeclarationError
            If a number is missing and there is no default.
        """
        out = np.empty(len(names))
        for i, name in enumerate(names):
            fallback = self.model[name].number("default") if name not in values else None
            value = values.get(name, fallback if fallback is not None else default)
            if value is None:
                raise DeclarationError(f"'{name}' of model {self.model.name} has no value.")
            out[i] = value
        return out

    @functools.cached_property
    def digest(self) -> str:
        """A hash of the equations, the same wherever and whenever the declaration is the same."""
        names = (self.states, self.inputs, self.coefficients, tuple(self.values))
        text = repr((names, str(self.rates), sorted((i, str(e)) for i, e in self.nexts.items())))
        shown = self.model.derived + self.model.outputs
        text += repr([(n, str(self.values[n])) for n in shown])
        # CasADi prints six digits of a number; the rest counts too.
        everything = ca.vertcat(self.rates, *self.nexts.values(), *(self.values[n] for n in shown))
        program = ca.Function("all", [self.x, self.u, self.p, self.T], [everything])
        instructions = range(program.n_instructions())
        text += repr(
            [program.instruction_constant(k) for k in instructions if program.instruction_id(k) == ca.OP_CONST]
        )
        return hashlib.sha256(text.encode()).hexdigest()


def _dependence(of: Expression, by: Expression) -> np.ndarray:
    """Which entries of a column can depend on which symbols, shape (of, by)."""
    return np.asarray(ca.DM(ca.jacobian(of, by).sparsity(), 1).full(), dtype=bool)


@functools.lru_cache(maxsize=256)
def _inputs_behind(model: Model, names: tuple[str, ...]) -> tuple[str, ...]:
    """See `System.inputs_behind`; cached, as every run asks for it and the search visits all equations."""
    system = generate(model)
    moving = [system.states.index(s) for s in system.states_behind(names)]
    moved, shown = _dependence(system.moves, system.u)[moving], _dependence(system.expression(names), system.u)
    needed = np.asarray(moved.any(axis=0) | shown.any(axis=0))
    return tuple(n for n, used in zip(system.inputs, needed.tolist()) if used)


@functools.lru_cache(maxsize=64)
def generate(model: Model) -> System:
    """Translate a model to CasADi expressions.

    Parameters
    ----------
    model : Model
        Any model made by `shipid.join`.

    Returns
    -------
    System

    Raises
    ------
    DeclarationError
        If an equation does what only numbers can do, or gives other numbers over symbols.
    UsageError
        If it is no model.
    """
    if not isinstance(model, Model):
        raise UsageError(
            f"generate takes a model, as shipid.join or shipid.find_model('de-keizer') returns it, and no {type(model).__name__}."
        )
    groups = {
        "x": model.states,
        "u": model.inputs,
        "p": model.parameters + model.constants,
    }
    symbols = {n: ca.SX.sym(n) for names in groups.values() for n in names}
    interval = ca.SX.sym(SAMPLING_INTERVAL)
    evaluation = SymbolicEvaluation(model, symbols | {SAMPLING_INTERVAL: interval})
    rates = evaluation.right_hand_sides("rate")
    nexts = evaluation.right_hand_sides("next")
    values = {n: symbols[n] if n in symbols else ca.SX(evaluation[n]) for n in model.entries if n != SAMPLING_INTERVAL}
    check_numbers(model)
    columns = {k: ca.vertcat(*(symbols[n] for n in names)) if names else ca.SX(0, 1) for k, names in groups.items()}
    return System(
        model,
        columns["x"],
        columns["u"],
        columns["p"],
        interval,
        ca.vertcat(*(ca.SX(rates.get(s, 0.0)) for s in model.states)),
        {i: ca.SX(nexts[s]) for i, s in enumerate(model.states) if s in nexts},
        values,
    )
