"""A loop as it runs on board: the ship moves between samples, the filter and the autopilot work on the samples.

The ship is a continuous model, the autopilot a model that is read once a sample (its continuous states by Euler's rule), and
the estimator carries a state from sample to sample: a Kalman filter, or the true state. The whole is one expression, compiled with
the loop over its samples.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import Expression
from shipid.foundation.errors import DeclarationError, UnknownNameError, UsageError
from shipid.generation.loop import Loop, make_loop
from shipid.generation.simulator import Named, coefficient_vector, initial_state, unstated_input
from shipid.generation.step import make_step
from shipid.generation.system import System, generate

#: ``(carried, shown, interval) -> (carried, estimates)``.
Advance = Callable[[Expression, Mapping[str, Expression], Expression], tuple[Expression, Mapping[str, Expression]]]


@dataclass(frozen=True, eq=False)
class Estimator:
    """The estimator between the instruments and the autopilot: a Kalman filter, or the true state.

    Attributes
    ----------
    start : ndarray, shape (n,)
        The carried vector before the first sample.
    advance : callable
        ``(carried, shown, interval) -> (carried, estimates)`` over SX: ``shown`` holds the quantities of the ship and the
        inputs of the loop by name, as they are at the sample, with what the instruments show and ``delta_before``, the
        rudder one sample earlier; the estimates go to the inputs of the autopilot of the same name.
    inputs : tuple of str
        Inputs of its own, with a value at every sample: a switch.
    """

    start: np.ndarray
    advance: Advance
    inputs: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """A ship, an estimator and an autopilot in one step; made by `make_sampled_loop`.

    Attributes
    ----------
    ship, pilot : Model
        Both declarations.
    estimator : Estimator
        The estimator.
    inputs : tuple of str
        Inputs with a value at every sample, in order.
    noises : tuple of str
        Inputs that neither model declares: noise of the instruments, zero where it is not given.
    outputs : tuple of str
        Quantities that are recorded at every sample, before the step.
    loop : Loop
        The compiled step.
    """

    ship: Model
    pilot: Model
    estimator: Estimator
    inputs: tuple[str, ...]
    noises: tuple[str, ...]
    outputs: tuple[str, ...]
    loop: Loop = field(repr=False)

    def start(self, ship: Named | None = None, pilot: Named | None = None) -> np.ndarray:
        """Return a state to start from.

        Parameters
        ----------
        ship, pilot : mapping of str to float, optional
            States of both, SI; the declared starts where not given.
        """
        rudder = float((ship or {}).get("delta", 0.0))
        states = initial_state(self.ship, ship), initial_state(self.pilot, pilot)
        return np.concatenate([*states, self.estimator.start, [rudder]])

    def coefficients(self, ship: Named, pilot: Named) -> np.ndarray:
        """Return the coefficients of both, in order.

        Parameters
        ----------
        ship, pilot : mapping of str to float
            SI; declared defaults where not given.
        """
        return np.concatenate([coefficient_vector(self.ship, ship), coefficient_vector(self.pilot, pilot)])

    def __call__(
        self, start: np.ndarray, inputs: Named, p: np.ndarray, interval: float, count: int
    ) -> dict[str, np.ndarray]:
        """Run the loop.

        Parameters
        ----------
        start : ndarray
            From `start`.
        inputs : mapping of str to ndarray or float
            A value a sample, or one for all; the declared default where not given.
        p : ndarray
            From `coefficients`.
        interval : float
            Between two samples, in s.
        count : int
            Samples.

        Returns
        -------
        dict of str to ndarray, shape (count,)
            The outputs, SI.

        Raises
        ------
        UnknownNameError
            If an input is none of the loop's.
        UsageError
            If a switch of the estimator is not given.
        UnstatedInputError
            If an input is not given and declares no default.
        """
        unknown = sorted(set(inputs) - set(self.inputs))
        if unknown:
            raise UnknownNameError("input of the loop called", unknown[0], self.inputs)
        table = np.zeros((count, len(self.inputs) + 1))
        for i, name in enumerate(self.inputs):
            table[:, i] = inputs[name] if name in inputs else self._default(name)
        table[:, -1] = interval
        _, out = self.loop(start, table, p)
        return dict(zip(self.outputs, out.T))

    def _default(self, name: str) -> float:
        if name in self.noises:
            return 0.0
        for model in (self.pilot, self.ship):
            if name in model.inputs:
                default = model[name].number("default")
                if default is None:
                    raise unstated_input(model, name)
                return default
        raise UsageError(f"the estimator is switched by '{name}', which has no default: give it to the loop.")


def make_sampled_loop(
    ship: Model,
    pilot: Model,
    estimator: Estimator,
    *,
    shown: Mapping[str, Sequence[str]],
    outputs: Sequence[str] = (),
    substeps: int = 4,
) -> SampledLoop:
    """Join a ship, an estimator and an autopilot.

    Parameters
    ----------
    ship : Model
        A continuous model that reads ``delta_order``.
    pilot : Model
        A model that states ``delta_order``. Its inputs are estimates, what the instruments show, or inputs of the loop.
    estimator : Estimator
        The estimator between the instruments and the autopilot.
    shown : mapping of str to sequence of str
        What the instruments show: a name, and the quantities of the ship and inputs of the loop whose sum it is, such as
        ``{"r_shown": ("r", "r_wave", "gyro_noise")}``.
    outputs : sequence of str
        Quantities of ship and autopilot to record, besides what is shown and estimated.
    substeps : int
        Integration steps of the ship between two samples.

    Returns
    -------
    SampledLoop

    Raises
    ------
    DeclarationError
        If the autopilot states no order, or the ship reads none, or what is recorded follows the order at once.
    UnknownNameError
        If an output is none of the loop's quantities.
    """
    plant, law = generate(ship), generate(pilot)
    if "delta_order" not in pilot.entries or "delta_order" not in plant.inputs:
        raise DeclarationError(f"model {pilot.name} has to state 'delta_order', and model {ship.name} to read it.")
    summed = {part for parts in shown.values() for part in parts}
    own = [n for n in plant.inputs if n != "delta_order"]
    noises = tuple(dict.fromkeys(n for parts in shown.values() for n in parts if n not in plant.values))
    outside = [n for n in (*summed, *own) if n not in plant.values or n in own]
    interval, before = plant.T, ca.SX.sym("delta_before")
    carried = ca.SX.sym("carried", estimator.start.size)
    symbols = {n: ca.SX.sym(n) for n in dict.fromkeys([*outside, *estimator.inputs])}
    values = _with_inputs(plant, own, symbols)
    instruments = {
        name: sum(symbols[part] if part in symbols else values[part] for part in parts) for name, parts in shown.items()
    }
    visible = {**values, **symbols, **instruments, "delta_before": before}
    following, estimates = estimator.advance(carried, visible, interval)
    known = {**instruments, **estimates}
    symbols |= {n: ca.SX.sym(n) for n in law.inputs if n not in known and n not in symbols}
    known |= symbols

    of_law = [n for n in outputs if n in law.values]
    decided = ca.Function(
        "pilot",
        [law.x, law.u, law.p, law.T],
        [law.values["delta_order"], make_step(law, "euler", "zero").x_next, law.expression(of_law)],
    )
    order, law_next, of_law_now = decided(law.x, ca.vertcat(*(ca.SX(known[n]) for n in law.inputs)), law.p, interval)
    held = ca.vertcat(*(order if n == "delta_order" else symbols[n] for n in plant.inputs))
    moved = make_step(plant, "rk4", "zero", substeps).function(plant.x, held, held, plant.p, interval)

    of_ship = [n for n in outputs if n in plant.values and n not in law.values and n not in instruments]
    names = (*of_law, *of_ship, *instruments, *estimates)
    lost = [n for n in outputs if n not in names]
    if lost:
        raise UnknownNameError("quantity of the loop called", lost[0], names)
    row = ca.vertcat(of_law_now, *(values[n] for n in of_ship), *instruments.values(), *estimates.values())
    if ca.depends_on(ca.vertcat(row, order), plant.u[plant.inputs.index("delta_order")]):
        raise DeclarationError(
            f"what is shown or recorded of model {ship.name} follows the rudder order at once: put a steering machine between."
        )
    step = ca.Function(
        "sample",
        [
            ca.vertcat(plant.x, law.x, carried, before),
            ca.vertcat(*symbols.values(), interval),
            ca.vertcat(plant.p, law.p),
        ],
        [ca.densify(ca.vertcat(moved, law_next, following, values.get("delta", order))), ca.densify(row)],
    )
    return SampledLoop(ship, pilot, estimator, tuple(symbols), noises, names, make_loop(step))


def _with_inputs(plant: System, own: Sequence[str], symbols: Mapping[str, Expression]) -> dict[str, Expression]:
    """The ship's quantities in terms of its states and the inputs of the loop."""
    if not own:
        return dict(plant.values)
    places = [plant.inputs.index(n) for n in own]
    put = ca.vertcat(*(symbols[n] for n in own))
    return dict(zip(plant.values, ca.substitute(list(plant.values.values()), [plant.u[places]], [put])))
