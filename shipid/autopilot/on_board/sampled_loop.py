"""A loop as it runs on board: the ship moves between samples, the filter and the autopilot work on them.

The ship is a continuous model, the autopilot a model of sampled equations, and the estimator whatever carries a state from
sample to sample: a Kalman filter, or the truth. The whole is one expression, compiled, and accumulated over a record.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import DeclarationError, UnknownNameError
from shipid.generation.compiling import compile_function
from shipid.generation.step import make_step
from shipid.generation.system import System, generate


@dataclass(frozen=True, eq=False)
class Estimator:
    """What stands between the instruments and the autopilot; the seat of the yaw filter.

    Attributes
    ----------
    start : ndarray, shape (n,)
        What is carried, before the first sample.
    advance : callable
        ``(carried, shown, interval) -> (carried, estimates)`` over SX: ``shown`` holds the quantities of the ship and the
        inputs of the loop by name, as they are at the sample, with what the instruments show and ``delta_before``, the
        rudder one sample earlier; the estimates go to the inputs of the autopilot of the same name.
    inputs : tuple of str
        Inputs of its own, with a value at every sample: a switch.
    """

    start: np.ndarray
    advance: Callable[[Any, Mapping[str, Any], Any], tuple[Any, Mapping[str, Any]]]
    inputs: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """A ship, an estimator and an autopilot in one step; made by `make_sampled_loop`.

    Attributes
    ----------
    ship, pilot : System
        Their equations.
    estimator : Estimator
        What stands between.
    inputs : tuple of str
        What has a value at every sample, in order.
    outputs : tuple of str
        What is recorded at every sample, before the step.
    """

    ship: System
    pilot: System
    estimator: Estimator
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    _step: Any = field(repr=False)

    def start(self, ship: Mapping[str, float] | None = None, pilot: Mapping[str, float] | None = None) -> np.ndarray:
        """Return a state to start from.

        Parameters
        ----------
        ship, pilot : mapping of str to float, optional
            States of both, SI; the declared starts where not given.
        """
        parts = [
            [known.get(n, system.model[n].number("start") or 0.0) for n in system.states]
            for system, known in ((self.ship, ship or {}), (self.pilot, pilot or {}))
        ]
        rudder = (ship or {}).get("delta", 0.0)
        return np.concatenate([*parts, self.estimator.start, [rudder]])

    def coefficients(self, ship: Mapping[str, float], pilot: Mapping[str, float]) -> np.ndarray:
        """Return the coefficients of both, in order.

        Parameters
        ----------
        ship, pilot : mapping of str to float
            SI; declared defaults where not given.
        """
        return np.concatenate(
            [s.vector(s.coefficients, known) for s, known in ((self.ship, ship), (self.pilot, pilot))]
        )

    def __call__(
        self, start: np.ndarray, inputs: Mapping[str, np.ndarray | float], p: np.ndarray, interval: float, count: int
    ) -> dict[str, np.ndarray]:
        """Run the loop.

        Parameters
        ----------
        start : ndarray
            From `start`.
        inputs : mapping of str to ndarray or float
            A value a sample, or one for all; zero where not given.
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
        """
        unknown = sorted(set(inputs) - set(self.inputs))
        if unknown:
            raise UnknownNameError("input of the loop called", unknown[0], self.inputs)
        table = np.zeros((len(self.inputs), count))
        for name, value in inputs.items():
            table[self.inputs.index(name)] = value
        _, y = _run(self, count)(start, table, p, interval)
        return dict(zip(self.outputs, np.asarray(y.full())))


@functools.lru_cache(maxsize=32)
def _run(loop: SampledLoop, count: int) -> Any:
    step = loop._step
    z, w = ca.MX.sym("z", step.size1_in(0)), ca.MX.sym("w", step.size1_in(1), count)
    p, interval = ca.MX.sym("p", step.size1_in(2)), ca.MX.sym("T")
    end, y = step.mapaccum(count)(z, w, ca.repmat(p, 1, count), ca.repmat(interval, 1, count))
    return ca.Function("loop", [z, w, p, interval], [end, y])


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
        A model of sampled equations that states ``delta_order``. Its inputs are estimates, what the instruments show, or
        inputs of the loop.
    estimator : Estimator
        What the autopilot knows.
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
        If the autopilot states no order, or has a continuous state.
    """
    plant, mind = generate(ship), generate(pilot)
    if "delta_order" not in pilot.entries or "delta_order" not in plant.inputs:
        raise DeclarationError(f"model {pilot.name} has to state 'delta_order', and model {ship.name} to read it.")
    if len(mind.nexts) < len(mind.states):
        raise DeclarationError(f"the autopilot {pilot.name} has a continuous state; a sampled loop needs @x.next.")
    summed = {part for parts in shown.values() for part in parts}
    own = [n for n in plant.inputs if n != "delta_order"]
    outside = [n for n in (*summed, *own) if n not in plant.values or n in own]
    free = dict.fromkeys([*outside, *estimator.inputs])
    interval = plant.T
    x, c = plant.x, ca.SX.sym("c", estimator.start.size)
    before = ca.SX.sym("delta_before")
    symbols = {n: ca.SX.sym(n) for n in free}
    # The ship's quantities in terms of its states, the inputs of the loop, and nothing else.
    at = [plant.inputs.index(n) for n in own]
    if own:
        put = ca.vertcat(*(symbols[n] for n in own))
        values = dict(zip(plant.values, ca.substitute(list(plant.values.values()), [plant.u[at]], [put])))
    else:
        values = dict(plant.values)

    def value(name: str) -> Any:
        return symbols[name] if name in symbols else values[name]

    instruments = {name: sum(value(part) for part in parts) for name, parts in shown.items()}
    seen = {**values, **symbols, **instruments, "delta_before": before}
    carried, estimates = estimator.advance(c, seen, interval)
    known = {**instruments, **estimates}
    extra = [n for n in mind.inputs if n not in known and n not in symbols]
    symbols |= {n: ca.SX.sym(n) for n in extra}
    known |= symbols
    # The autopilot with its inputs put in.
    given = [ca.SX(known[n]) for n in mind.inputs]
    decided = ca.Function(
        "pilot",
        [mind.x, mind.u, mind.p, mind.T],
        [mind.values["delta_order"], ca.vertcat(*(mind.nexts[i] for i in range(len(mind.states)))),
         mind.expression([n for n in outputs if n in mind.values])],
    )  # fmt: skip
    order, next_mind, of_mind = decided(mind.x, ca.vertcat(*given), mind.p, interval)
    step = make_step(plant, "rk4", "zero", substeps).function
    held = ca.vertcat(*(order if n == "delta_order" else symbols[n] for n in plant.inputs))
    moved = step(x, held, held, plant.p, interval)
    of_ship = [n for n in outputs if n in plant.values and n not in mind.values]
    names = [*[n for n in outputs if n in mind.values], *of_ship, *instruments, *estimates]
    lost = [n for n in outputs if n not in names]
    if lost:
        raise UnknownNameError("quantity of the loop called", lost[0], names)
    row = ca.vertcat(of_mind, *(values[n] for n in of_ship), *instruments.values(), *estimates.values())
    if ca.depends_on(ca.vertcat(row, order), plant.u[plant.inputs.index("delta_order")]):
        raise DeclarationError(
            f"what is shown or recorded of model {ship.name} follows the rudder order at once: put a steering machine between."
        )
    delta = values.get("delta", order)
    state = ca.vertcat(x, mind.x, c, before)
    inputs = tuple(symbols)
    function = ca.Function(
        "sample",
        [state, ca.vertcat(*symbols.values()), ca.vertcat(plant.p, mind.p), interval],
        [ca.densify(ca.vertcat(moved, next_mind, carried, delta)), ca.densify(row)],
    )
    return SampledLoop(plant, mind, estimator, inputs, tuple(names), compile_function(function))
