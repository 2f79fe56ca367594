"""Whole records: a step accumulated over all samples in one call, with or without sensitivities."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from shipid.declaration.delays import shifted_rows
from shipid.declaration.model import Model
from shipid.foundation.aliases import Expression
from shipid.generation.loop import Loop, make_loop
from shipid.generation.step import make_step
from shipid.generation.system import System, generate


@dataclass(frozen=True)
class Record:
    """A model over a whole record of samples.

    Made by `make_record`. Sample k of the outputs belongs to the states before step k, so N samples of the input
    give N samples of the outputs.

    Attributes
    ----------
    system : System
        The equations.
    outputs : tuple of str
        Names along the rows of the result.
    unknowns : tuple of str
        Names the outputs are differentiated by: coefficients, then ``x0:STATE``, then ``bias:INPUT``.
    loop : Loop
        The step with its sensitivities, run over the samples.
    seed : ndarray
        Derivatives of the initial states, which the loop starts with after the states.
    guards : tuple of str
        Names of the margins that `run` returns, without derivatives.
    late : tuple of str
        Inputs of which the loop reads the derivative by their dead time.
    """

    system: System
    outputs: tuple[str, ...]
    unknowns: tuple[str, ...]
    loop: Loop = field(repr=False)
    seed: np.ndarray = field(repr=False)
    guards: tuple[str, ...] = ()
    late: tuple[str, ...] = ()

    @property
    def step(self) -> Expression:
        """The CasADi function of one sample that the loop runs over."""
        return self.loop.step

    def __call__(
        self, x0: np.ndarray, u: np.ndarray, intervals: np.ndarray, p: np.ndarray, bias: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Run the record.

        Parameters
        ----------
        x0 : ndarray, shape (states,)
            Initial states.
        u : ndarray, shape (inputs, N)
            Inputs at the samples; those with a dead time as they are given.
        intervals : ndarray, shape (N,)
            Time from each sample to the next, in s; the last one is not used.
        p : ndarray, shape (coefficients,)
            Parameters and constants.
        bias : ndarray, shape (inputs,), optional
            Added to every sample of the inputs.

        Returns
        -------
        y : ndarray, shape (outputs, N)
            Outputs; not finite from where the model diverges.
        dy : ndarray, shape (outputs, unknowns, N)
            Derivatives of the outputs by the unknowns.
        """
        y, dy, _ = self.run(x0, u, intervals, p, bias)
        return y, dy

    def run(
        self, x0: np.ndarray, u: np.ndarray, intervals: np.ndarray, p: np.ndarray, bias: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Run the record, and return the margins of its guards as well.

        Parameters
        ----------
        x0, u, intervals, p, bias
            See `__call__`.

        Returns
        -------
        y, dy : ndarray
            See `__call__`.
        margins : ndarray, shape (guards, N)
            Negative where the model is not valid.
        """
        count = u.shape[1]
        n_y, n_q = len(self.outputs), len(self.unknowns)
        shifted = u if bias is None else u + bias[:, None]
        if count == 0:
            return np.empty((n_y, 0)), np.empty((n_y, n_q, 0)), np.empty((len(self.guards), 0))
        steps = np.array(intervals, dtype=float)
        steps[-1] = 0.0
        model, by_delay = self.system.model, np.zeros((0, count))
        if model.delays:
            delays = {x: float(p[self.system.coefficients.index(n)]) for x, n in model.delays.items()}
            t = np.concatenate([[0.0], np.cumsum(steps[:-1])])
            shifted, by_delay = shifted_rows(model, t, shifted, delays)
            by_delay = by_delay[[model.inputs.index(x) for x in self.late]]
        now = np.vstack([shifted, by_delay])
        following = np.concatenate([now[:, 1:], now[:, -1:]], axis=1)
        count_u = len(shifted)
        controls = np.vstack([shifted, following[:count_u], steps, by_delay, following[count_u:]]).T
        _, out = self.loop(np.concatenate([x0, self.seed]), controls, p)
        end = n_y * (1 + n_q)
        slopes = out[:, n_y:end].reshape(count, n_q, n_y).transpose(2, 1, 0)
        return out[:, :n_y].T, slopes, out[:, end:].T

    def __hash__(self) -> int:
        return id(self)


@functools.lru_cache(maxsize=64)
def make_record(
    model: Model,
    outputs: tuple[str, ...],
    coefficients: tuple[str, ...] = (),
    initial: tuple[str, ...] = (),
    biases: tuple[str, ...] = (),
    method: str = "rk4",
    hold: str = "linear",
    substeps: int = 1,
    compiled: bool = True,
    guarded: bool = False,
) -> Record:
    """Generate a record function, with forward sensitivities carried inside the step.

    Parameters
    ----------
    model : Model
        The model.
    outputs : tuple of str
        Quantities to return at every sample.
    coefficients, initial, biases : tuple of str
        What to differentiate by: coefficients, initial values of states, constant biases of inputs.
    method, hold, substeps
        See `shipid.generation.step.make_step`.
    compiled : bool
        Whether to compile the step.
    guarded : bool
        Whether to compute the margins of the model's guards.

    Returns
    -------
    Record

    Notes
    -----
    With S the derivative of the states by the unknowns q, the step carries
    ``S+ = (dx+/dx) S + dx+/dq``, and the outputs ``dy/dq = (dy/dx) S + dy/dq``: one pass, no adjoint of the whole
    record, 2-4 times faster than differentiating the accumulated function. A dead time acts through its input:
    its ``dx+/dq`` is that of the input at both ends of the step, times the derivative of these values by the dead time.
    """
    system = generate(model)
    step = make_step(system, method, hold, substeps, delayed=True)
    late = tuple(x for x, n in model.delays.items() if n in coefficients)
    now, then = ca.SX.sym("late", len(late)), ca.SX.sym("later", len(late))
    n_x, n_q = system.x.shape[0], len(coefficients) + len(initial) + len(biases)
    sensitivities = ca.SX.sym("S", n_x, n_q)
    outputs_now = system.expression(outputs)

    def slopes(expression: Expression) -> Expression:
        direct = _direct(expression, system, step, coefficients, initial, biases)
        for k, name in enumerate(late):
            place, column = system.inputs.index(name), coefficients.index(model.delays[name])
            direct[:, column] += ca.jacobian(expression, step.u0)[:, place] * now[k]
            if not ca.is_equal(step.u0, step.u1):
                direct[:, column] += ca.jacobian(expression, step.u1)[:, place] * then[k]
        return ca.jacobian(expression, system.x) @ sensitivities + direct

    carried, shown = slopes(step.x_next), slopes(outputs_now)

    u1 = step.u1 if not ca.is_equal(step.u0, step.u1) else ca.SX.sym("u1", system.u.shape[0])
    z = ca.vertcat(system.x, ca.vec(sensitivities))
    z_next = ca.vertcat(step.x_next, ca.vec(carried))
    # Dense, as the record is read from plain memory: a derivative that is structurally zero has its place too.
    guards = model.guards if guarded else ()
    out = ca.densify(ca.vertcat(outputs_now, ca.vec(shown), system.expression(guards)))
    function = ca.Function("step", [z, ca.vertcat(system.u, u1, system.T, now, then), system.p], [z_next, out])
    seed = np.zeros((n_x, n_q))
    for j, name in enumerate(initial):
        seed[system.states.index(name), len(coefficients) + j] = 1.0
    unknowns = (*coefficients, *(f"x0:{n}" for n in initial), *(f"bias:{n}" for n in biases))
    return Record(
        system,
        tuple(outputs),
        unknowns,
        make_loop(function, compiled),
        seed.ravel(order="F"),
        guards,
        late,
    )


def _direct(
    expression: Expression,
    system: System,
    step: Expression,
    coefficients: Sequence[str],
    initial: Sequence[str],
    biases: Sequence[str],
) -> Expression:
    """Derivative of an expression by the unknowns at fixed states."""
    by_p = ca.jacobian(expression, system.p)
    by_u = ca.jacobian(expression, system.u)
    if not ca.is_equal(step.u0, step.u1):
        by_u = by_u + ca.jacobian(expression, step.u1)
    rows = expression.shape[0]
    columns = [by_p[:, system.coefficients.index(n)] for n in coefficients]
    columns += [ca.SX.zeros(rows, 1) for _ in initial]
    columns += [by_u[:, system.inputs.index(n)] for n in biases]
    return ca.horzcat(*columns) if columns else ca.SX(rows, 0)
