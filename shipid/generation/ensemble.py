"""Many runs of one model at once: each with its own start, inputs held for the run, coefficients and clock.

A run ends in its last state; what is wanted of its course is a state of the model that measures it. So a thousand runs need
no more memory than one, and the whole is one compiled function mapped over the runs.
"""

from __future__ import annotations

import functools
import os
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.foundation.errors import UnknownNameError
from shipid.generation.compiling import compile_function
from shipid.generation.step import make_step
from shipid.generation.system import System, generate

#: Steps in one compiled block: enough for the call to cost nothing, few enough for any length to be near a multiple.
BLOCK = 64


@dataclass(frozen=True, eq=False)
class Batch:
    """A model over many runs of one length; made by `make_batch`.

    Attributes
    ----------
    system : System
        The equations.
    varying : tuple of str
        Inputs that have a value of their own at every step; the others are held for the whole run.
    """

    system: System
    varying: tuple[str, ...]
    _block: Any = field(repr=False)

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
    """Return the steps a run takes for at least `count` of them: whole blocks."""
    return max(1, -(-count // BLOCK)) * BLOCK


@functools.lru_cache(maxsize=64)
def _mapped(batch: Batch, blocks: int, runs: int) -> Any:
    block = batch._block
    x, constant = ca.MX.sym("x", block.size1_in(0)), ca.MX.sym("c", block.size1_in(1))
    noise = ca.MX.sym("w", block.size1_in(2), blocks * BLOCK)
    end = block.fold(blocks)(x, ca.repmat(constant, 1, blocks), noise) if blocks > 1 else block(x, constant, noise)
    run = ca.Function("run", [x, constant, noise], [end])
    threads = min(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1, runs)
    return run.map(runs, "thread", threads) if threads > 1 else run.map(runs)


@functools.lru_cache(maxsize=32)
def make_batch(model: Model, varying: tuple[str, ...] = (), method: str = "rk4") -> Batch:
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
    Batch

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
    return Batch(system, varying, compile_function(block))
