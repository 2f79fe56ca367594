"""Many runs of one model at once: each with its own start, inputs, coefficients and clock.

Inputs are constant during a run unless they are declared as varying. Only the last state is returned: a measure of the
course has to be a state of the model. So a thousand runs need no more memory than one; one compiled function is mapped.
"""

from __future__ import annotations

import functools
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import chain

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.aliases import CasadiFunction
from shipid.foundation.errors import UnknownNameError
from shipid.generation.compiling import compile_function
from shipid.generation.record import Record
from shipid.generation.simulator import Named, coefficient_vector, initial_state, input_rows
from shipid.generation.step import make_step
from shipid.generation.system import System, generate

#: Samples of all runs below which threads cost more than they bring.
_WORTH_THREADS = 20_000
#: Steps in one compiled block: enough for the call to cost nothing, few enough for any length to be near a multiple.
BLOCK = 64


@dataclass(frozen=True, eq=False)
class Ensemble:
    """A model over many runs of one length; made by `make_ensemble`.

    Attributes
    ----------
    system : System
        The equations.
    varying : tuple of str
        Inputs that have a value of their own at every step; the others are held for the whole run.
    block : CasadiFunction
        The compiled function of `BLOCK` steps.
    """

    system: System
    varying: tuple[str, ...]
    block: CasadiFunction = field(repr=False)

    def run(
        self,
        runs: int,
        values: Named,
        inputs: Named,
        start: Named,
        interval: np.ndarray,
        count: int,
        sequences: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Run all of them, from named numbers to named last states.

        Parameters
        ----------
        runs : int
            How many.
        values, inputs, start : mapping of str to float or ndarray, shape (runs,)
            Coefficients, held inputs and initial states, SI; one number for all runs, or one a run.
        interval, count, sequences
            See `__call__`.

        Returns
        -------
        dict of str to ndarray, shape (runs,)
            The last states by name; not finite where a run diverged.

        Raises
        ------
        UnstatedInputError
            If an input is not named and declares no default.
        """
        model = self.system.model
        everyone = np.zeros(runs)
        known = {n: v + everyone for n, v in values.items() if n in self.system.coefficients}
        begin = {n: start.get(n, model[n].number("start") or 0.0) + everyone for n in model.states}
        # A varying input is replaced by its sequence at every step: its held value has no influence.
        held = {**dict.fromkeys(self.varying, 0.0), **inputs}
        p, x0 = coefficient_vector(model, known), initial_state(model, begin)
        p = np.broadcast_to(p.reshape(len(p), -1), (len(p), runs))
        end = self(x0, input_rows(model, held, runs), p, interval, count, sequences)
        return dict(zip(model.states, end))

    def __call__(
        self,
        x0: np.ndarray,
        held: np.ndarray,
        p: np.ndarray,
        interval: np.ndarray,
        count: int,
        sequences: np.ndarray | None = None,
    ) -> np.ndarray:
        """Run all of them.

        Parameters
        ----------
        x0 : ndarray, shape (states, runs)
            Initial states.
        held : ndarray, shape (inputs, runs)
            Inputs, the same at every step of a run (a varying one is replaced by its sequence).
        p : ndarray, shape (coefficients, runs)
            Parameters and constants.
        interval : ndarray, shape (runs,)
            Length of a step in s.
        count : int
            Steps of each run, rounded up to whole blocks.
        sequences : ndarray, shape (varying, steps, runs), optional
            Values of the varying inputs; steps is `steps_of(count)`.

        Returns
        -------
        ndarray, shape (states, runs)
            The last states; not finite where a run diverged.
        """
        runs = x0.shape[1]
        blocks = steps_of(count) // BLOCK
        constant = np.vstack([held, interval[None, :], p])
        noise = np.zeros((0, blocks * BLOCK, runs)) if sequences is None else sequences
        flat = noise.transpose(0, 2, 1).reshape(noise.shape[0], runs * noise.shape[1])
        function = _mapped(self, blocks, runs)
        return np.asarray(function(x0, constant, flat).full())


def steps_of(count: int) -> int:
    """Return the steps a run takes: whole blocks.

    Parameters
    ----------
    count : int
        Steps that are wanted at least.
    """
    return max(1, -(-count // BLOCK)) * BLOCK


@functools.lru_cache(maxsize=64)
def _mapped(ensemble: Ensemble, blocks: int, runs: int) -> CasadiFunction:
    block = ensemble.block
    x, constant = ca.MX.sym("x", block.size1_in(0)), ca.MX.sym("c", block.size1_in(1))
    noise = ca.MX.sym("w", block.size1_in(2), blocks * BLOCK)
    end = block.fold(blocks)(x, ca.repmat(constant, 1, blocks), noise) if blocks > 1 else block(x, constant, noise)
    run = ca.Function("run", [x, constant, noise], [end])
    threads = min(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1, runs)
    return run.map(runs, "thread", threads) if threads > 1 else run.map(runs)


@functools.lru_cache(maxsize=32)
def make_ensemble(model: Model, varying: tuple[str, ...] = (), method: str = "rk4") -> Ensemble:
    """Generate and compile a model for many runs at once.

    Parameters
    ----------
    model : Model
        The model; its inputs are held over a step.
    varying : tuple of str
        Inputs that get a value at every step.
    method : str
        See `shipid.generation.step.make_step`.

    Returns
    -------
    Ensemble

    Raises
    ------
    UnknownNameError
        If a varying input is none of the model's.
    """
    system = generate(model)
    for name in varying:
        if name not in system.inputs:
            raise UnknownNameError(f"input of model {model.name} called", name, system.inputs)
    step = make_step(system, method, "zero")
    places = [system.inputs.index(n) for n in varying]
    w = ca.SX.sym("w", len(varying))
    held = ca.SX.sym("h", len(system.inputs))
    inputs = held + 0
    for place, row in zip(places, range(len(varying))):
        inputs[place] = w[row]
    moved = ca.substitute(step.x_next, system.u, inputs)
    # Dense, as the block is called on plain memory.
    one = ca.Function("step", [system.x, ca.vertcat(held, system.T, system.p), w], [ca.densify(moved)])
    x, constant = ca.MX.sym("x", one.size1_in(0)), ca.MX.sym("c", one.size1_in(1))
    noise = ca.MX.sym("w", one.size1_in(2), BLOCK)
    block = ca.Function("block", [x, constant, noise], [one.fold(BLOCK)(x, ca.repmat(constant, 1, BLOCK), noise)])
    return Ensemble(system, varying, compile_function(block))


def run_many(
    record: Record,
    x0: np.ndarray,
    u: np.ndarray,
    intervals: np.ndarray,
    p: np.ndarray,
    bias: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Run a record function many times; the machine code releases Python's lock, so that threads run in parallel.

    Parameters
    ----------
    record : Record
        Made by `shipid.generation.record.make_record`.
    x0 : ndarray, shape (runs, states)
        Initial states.
    u : ndarray, shape (runs, inputs, N) or (inputs, N)
        Inputs at the samples; the same for all runs where there is one only.
    intervals : ndarray, shape (runs, N) or (N,)
        Time from each sample to the next, in s; the last one is not used.
    p : ndarray, shape (runs, coefficients)
        Parameters and constants.
    bias : ndarray, shape (runs, inputs)
        Added to every sample of the inputs.

    Returns
    -------
    y : ndarray, shape (runs, outputs, N)
        Outputs; not finite from where the model diverges.
    dy : ndarray, shape (runs, outputs, unknowns, N)
        Derivatives of the outputs by the unknowns.
    """
    runs, count = len(x0), u.shape[-1]
    inputs = np.broadcast_to(u, (runs, *u.shape[-2:]))
    steps = np.broadcast_to(intervals, (runs, count))
    cores = min(os.cpu_count() or 1, runs) if runs * count >= _WORTH_THREADS else 1
    if cores == 1:
        found = list(map(record, x0, inputs, steps, p, bias))
    else:
        # A thread is given its share of the runs at once: handing over each by itself costs more than a short run takes.
        shares = zip(*(np.array_split(part, cores) for part in (x0, inputs, steps, p, bias)))
        with ThreadPoolExecutor(cores) as pool:
            found = list(chain.from_iterable(pool.map(lambda share: list(map(record, *share)), shares)))
    n_y, n_q = len(record.outputs), len(record.unknowns)
    y, dy = np.empty((runs, n_y, count)), np.empty((runs, n_y, n_q, count))
    for i, (one, slope) in enumerate(found):
        y[i], dy[i] = one, slope
    return y, dy
