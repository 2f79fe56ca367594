"""A model run along a clock: named values in, named columns out.

This is the only place that lays out initial states, inputs and coefficients in the order of generated functions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import UsageError
from shipid.generation.departure import RUNS_AWAY, Departure, first_departure
from shipid.generation.record import Record, make_record
from shipid.generation.system import generate

#: Numbers by name: one for the whole run, or an array with one number a sample (inputs) or a run (everything).
Named = Mapping[str, "float | np.ndarray"]


class UnstatedInputError(UsageError):
    """A model reads an input that nothing states and that declares no default."""


def unstated_input(model: Model, name: str, where: str = "") -> UnstatedInputError:
    """Return the error that every command gives for an input that nothing states.

    Parameters
    ----------
    model : Model
        The model.
    name : str
        The input.
    where : str
        What should have stated it, as in ``"trial zigzag"``; nothing by default.

    Returns
    -------
    UnstatedInputError
    """
    by = f" that {where} does not record" if where else " that nothing states"
    return UnstatedInputError(
        f"model {model.name} reads '{name}' ({model[name].quantity.meaning}),{by} and that declares no default. "
        "shipid does not take it as zero: record it, state it (--input NAME=VALUE, or inputs={...} in Python), or choose a model that "
        "does not read it."
    )


def initial_state(model: Model, start: Named | None = None) -> np.ndarray:
    """Return initial states in the order of the model.

    Parameters
    ----------
    model : Model
        The model.
    start : mapping of str to float or ndarray, optional
        By state, SI; a state that is not named takes its declared start, or zero. Names that are no states are passed over.

    Returns
    -------
    ndarray, shape (states,) or (states, runs)
        One column a run where a value is an array.
    """
    given = start or {}
    rows = [given.get(name, model[name].number("start") or 0.0) for name in model.states]
    if not rows:
        return np.zeros(0)
    return np.array(np.broadcast_arrays(*(np.asarray(r, dtype=float) for r in rows)))


def input_rows(
    model: Model, given: Named, count: int, where: str = "", needed: Sequence[str] | None = None
) -> np.ndarray:
    """Return inputs in the order of the model.

    Parameters
    ----------
    model : Model
        The model.
    given : mapping of str to float or ndarray, shape (count,)
        By input, SI. Names that are no inputs are passed over.
    count : int
        Samples, or runs.
    where : str
        What should have stated them, for the message.
    needed : sequence of str, optional
        Inputs that have an influence on what is wanted; one that has none may stay unstated. All by default.

    Returns
    -------
    ndarray, shape (inputs, count)

    Raises
    ------
    UnstatedInputError
        If an input is not given and declares no default.
    """
    rows = np.zeros((len(model.inputs), count))
    for i, name in enumerate(model.inputs):
        value = given.get(name, model[name].number("default"))
        if value is not None:
            rows[i] = value
        elif needed is None or name in needed:
            raise unstated_input(model, name, where)
    return rows


def coefficient_vector(model: Model, values: Named) -> np.ndarray:
    """Return parameters and constants in the order of the generated functions.

    Parameters
    ----------
    model : Model
        The model.
    values : mapping of str to float or ndarray, shape (runs,)
        By name, SI; a constant that is not named takes its declared default.

    Returns
    -------
    ndarray, shape (coefficients,) or (coefficients, runs)

    Raises
    ------
    DeclarationError
        If one has no value.
    """
    system = generate(model)
    if not any(np.ndim(values[n]) for n in system.coefficients if n in values):
        return system.vector(system.coefficients, {n: float(values[n]) for n in system.coefficients if n in values})
    known = {n: np.asarray(values[n], dtype=float) for n in system.coefficients if n in values}
    alone = system.vector(system.coefficients, {n: float(v.flat[0]) for n, v in known.items()})
    return np.stack(np.broadcast_arrays(*(known.get(n, alone[i]) for i, n in enumerate(system.coefficients))))


@dataclass(frozen=True, eq=False)
class Simulation:
    """A run of a model; N samples.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Times in s.
    columns : mapping of str to ndarray, shape (N,)
        Outputs by name, SI; not finite from where the model diverges.
    slopes : ndarray, shape (outputs, unknowns, N)
        Derivatives of the outputs by the unknowns of the simulator, in their order.
    departure : Departure or None
        Where the run first leaves the range in which the model is valid.
    """

    t: np.ndarray
    columns: Mapping[str, np.ndarray]
    slopes: np.ndarray
    departure: Departure | None = None

    def __getitem__(self, name: str) -> np.ndarray:
        """Return an output, SI, shape (N,)."""
        return self.columns[name]

    @property
    def finite(self) -> np.ndarray:
        """Whether every output of a sample is finite, shape (N,)."""
        return np.asarray(np.isfinite(np.stack(list(self.columns.values()))).all(axis=0))


@dataclass(frozen=True, eq=False)
class Simulator:
    """A model, compiled to run along any clock; made by `make_simulator`.

    Attributes
    ----------
    model : Model
        What runs.
    record : Record
        The generated function over a whole record.
    """

    model: Model
    record: Record

    def __call__(
        self,
        t: np.ndarray,
        values: Named,
        inputs: Named | None = None,
        start: Named | None = None,
        biases: Named | None = None,
        where: str = "",
    ) -> Simulation:
        """Run the model.

        Parameters
        ----------
        t : ndarray, shape (N,)
            Times in s, rising.
        values : mapping of str to float
            Parameters and constants, SI.
        inputs : mapping of str to float or ndarray, shape (N,)
            Inputs, SI; an input that is not named takes its declared default.
        start : mapping of str to float, optional
            Initial states, SI; a state that is not named takes its declared start, or zero.
        biases : mapping of str to float, optional
            Added to inputs, SI.
        where : str
            What should have stated the inputs, for messages.

        Returns
        -------
        Simulation

        Raises
        ------
        UnstatedInputError
            If an input that has an influence on the outputs is not named and declares no default.
        DeclarationError
            If a coefficient has no value.
        UsageError
            If an input has a hole.
        """
        system = self.record.system
        needed = system.inputs_behind((*self.record.outputs, *self.record.guards))
        rows = input_rows(self.model, inputs or {}, t.size, where, needed)
        for name, row in zip(self.model.inputs, rows):
            if name in needed and not np.isfinite(row).all():
                raise UsageError(
                    f"the input '{name}' of model {self.model.name} has no value at {np.count_nonzero(~np.isfinite(row))} of "
                    f"{t.size} times, and the model cannot be run past them. Fill it, or run the stretches between "
                    "(shipid.trials.stretches)."
                )
        shift = None if not biases else np.array([float(biases.get(n, 0.0)) for n in self.model.inputs])
        y, slopes, margins = self.record.run(
            initial_state(self.model, start),
            rows,
            np.diff(t, append=t[-1]),
            coefficient_vector(self.model, values),
            shift,
        )
        left = first_departure(self.model, t, dict(zip(self.record.guards, margins)), y)
        if left is not None and left.reason == RUNS_AWAY and left.time <= t[1]:
            left = self._without_value(left, t, values, rows[:, 0] if shift is None else rows[:, 0] + shift, start)
        return Simulation(t, dict(zip(self.record.outputs, y)), slopes, left)

    def _without_value(
        self, left: Departure, t: np.ndarray, values: Named, inputs: np.ndarray, start: Named | None
    ) -> Departure:
        """The same departure, with the equations that have no value where the run begins: nothing runs away there."""
        system, x = self.record.system, initial_state(self.model, start)
        first = ca.Function("first", [system.x, system.u, system.p, system.T], [system.rates])
        rates = first(x, inputs, coefficient_vector(self.model, values), t[1] - t[0]).full()[:, 0]
        lost = [n for n, rate in zip(self.model.states, rates) if not np.isfinite(rate)]
        if not lost:
            return left
        equations = ", ".join(f"d{n}/dt" for n in lost)
        reason = (
            f"{equations} {'has' if len(lost) == 1 else 'have'} no finite value where the run begins: by a division by zero, or a root or "
            "logarithm of zero, which np.where or np.maximum avoids"
        )
        return replace(left, time=float(t[0]), reason=reason)


def make_simulator(
    model: Model,
    outputs: Sequence[str],
    *,
    coefficients: Sequence[str] = (),
    initial: Sequence[str] = (),
    biases: Sequence[str] = (),
    method: str = "rk4",
    hold: str = "linear",
    substeps: int = 1,
    compiled: bool = True,
) -> Simulator:
    """Generate and compile a model that runs along a clock.

    Parameters
    ----------
    model : Model
        The model.
    outputs : sequence of str
        Quantities to return at every sample.
    coefficients, initial, biases : sequence of str
        What to differentiate by: coefficients, initial values of states, constant biases of inputs.
    method, hold, substeps
        See `shipid.generation.step.make_step`.
    compiled : bool
        Whether to compile.

    Returns
    -------
    Simulator
        Generated once for each choice, and kept.
    """
    record = make_record(
        model,
        tuple(outputs),
        tuple(coefficients),
        tuple(initial),
        tuple(biases),
        method,
        hold,
        substeps,
        compiled,
        True,
    )
    return Simulator(model, record)
