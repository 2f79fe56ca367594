"""Ships sailed with the noise a filter believes in: truth and records for the studies of filters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np

from shipid.declaration.model import Model
from shipid.estimation.records.first_estimate import first_estimate
from shipid.generation.loop import Loop, make_loop
from shipid.generation.step import make_step
from shipid.generation.system import generate


def make_ship(model: Model) -> Loop:
    """Return the true ship over fine steps: control is inputs and interval, then what is added to the states."""
    system = generate(model)
    step = make_step(system, "rk4", "linear").function
    n, m = system.x.shape[0], system.u.shape[0]
    z, c = ca.SX.sym("z", n + m), ca.SX.sym("c", m + 1 + n)
    ahead = step(z[:n], z[n:], c[:m], system.p, c[m]) + c[m + 1 :]
    return make_loop(ca.Function("ship", [z, c, system.p], [ca.vertcat(ahead, c[:m]), ahead]))


def sail(
    kalman: Any, t: np.ndarray, inputs: Mapping[str, np.ndarray], runs: int, finer: int = 10, seed: int = 2026
) -> tuple[list[dict[str, np.ndarray]], np.ndarray]:
    """Simulate runs whose first state, parameters and noise are drawn from what a filter believes.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter
        The filter; its noise is white and drives states.
    t : ndarray, shape (N,)
        Times of the samples in s, at equal intervals.
    inputs : mapping of str to ndarray
        SI, at the samples; they run in straight lines between them.
    runs : int
        How many.
    finer : int
        Integration steps between two samples.
    seed : int
        Of the random numbers.

    Returns
    -------
    records : list of dict
        Time, inputs and what the sensors show.
    truth : ndarray, shape (runs, N, states)
        In the order of the filter's states.
    """
    design, model, base = kalman.design, kalman.model, kalman.design.base
    rng = np.random.default_rng(seed)
    step = float(t[1] - t[0]) / finer
    fine = np.linspace(t[0], t[-1], (t.size - 1) * finer + 1)
    table = np.zeros((fine.size, len(base.inputs)))
    for name, values in inputs.items():
        table[:, base.inputs.index(name)] = np.interp(fine, t, values)
    levels = np.zeros(len(base.states))
    for source in design.sources:
        if source.place == "state":
            levels[base.states.index(source.name)] = source.level * np.sqrt(step)
    believed, deviation = first_estimate(design, {})
    coefficients = base.parameters + base.constants
    ship = design.ship.values(base, speed=design.ship.particular("speed", "m/s"))
    known = np.array([ship[n] for n in coefficients])
    own = [model.states.index(s) for s in base.states]
    starts, controls, values, joints = [], [], [], []
    for _ in range(runs):
        joint = believed + deviation * rng.standard_normal(believed.size)
        p = known.copy()
        for name, state in kalman.parameters.items():
            at = joint[model.states.index(state)]
            p[coefficients.index(name)] = at if state == name else np.exp(at)
        noise = levels * rng.standard_normal((fine.size - 1, len(base.states)))
        starts.append(np.concatenate([joint[own], table[0]]))
        controls.append(np.hstack([table[1:], np.full((fine.size - 1, 1), step), noise]))
        values.append(p)
        joints.append(joint)
    records, truth = [], []
    for start, joint, (_, out) in zip(starts, joints, make_ship(base).map(starts, controls, values)):
        whole = np.tile(joint, (t.size, 1))
        whole[:, own] = np.vstack([start[: len(own)], out])[::finer]
        columns = {"t": t, **{n: v + 0.0 for n, v in inputs.items()}}
        for name, level in zip(design.measured, design.r):
            columns[name] = whole[:, model.states.index(name)] + level * rng.standard_normal(t.size)
        records.append(columns)
        truth.append(whole)
    return records, np.array(truth)
