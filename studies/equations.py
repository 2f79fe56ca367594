#!/usr/bin/env python3
"""Every right-hand side, Jacobian, sensitivity and simulation against an evaluation that does not use CasADi.

Right-hand sides: the declared methods called with plain floats. Jacobians: the same methods called with a complex
step of 1e-30 (five-point differences where an equation takes the size of an angle or a flow). Simulations: SciPy's
DOP853 at a relative tolerance of 1e-10 over a zig-zag. Every model with every ship that determines it; the short form takes the
first ship of each.

    python studies/equations.py [--short] [--json]
"""

from __future__ import annotations

import argparse
from typing import Any

import casadi as ca
import numpy as np
from _table import Row, below, show
from scipy.integrate import solve_ivp

from shipid import Model, generate
from shipid.declaration.component import SAMPLING_INTERVAL
from shipid.declaration.model import Evaluation
from shipid.generation.record import make_record
from shipid.generation.system import System
from shipid.parameters.catalogue import known_models, known_ships

SIZES = {"x": 100.0, "y": 100.0, "psi": 1.0, "r": 0.01, "w": 1e-4, "v": 0.3, "r_star": 0.4, "u_star": 0.2, "s_star": 3.0,
         "omega": 0.03, "beta": 0.1, "Omega": 0.003, "dOmega": 0.001, "delta": 0.3, "r_disturbance": 1e-5,
         "u_disturbance": 1e-3, "current_north": 0.5, "current_east": 0.5, "r_residual": 1e-5}  # fmt: skip
#: Coefficients of an even stern.
BENDS = {"C_2_port": 1.0, "C_2_starboard": 1.0, "gamma_port": 0.5, "gamma_starboard": 0.5}
INTERVAL = 2.0
POINTS = 50
Values = dict[str, Any]


def pairs() -> list[tuple[Model, str, float, float, Values]]:
    """Every model of a ship with every ship: model, ship, speed, L/U, coefficients."""
    found = []
    for model in known_models().values():
        for ship in known_ships().values():
            speed, length = ship.particular("speed", "m/s"), ship.particular("L", "m")
            values = ship.values(model, speed=speed)
            # The motion of a point on the radar has no coefficients and no rudder; the tests have its formulas by hand.
            if values and speed and length and not set(model.parameters + model.constants) - set(values):
                found.append((model, ship.name, speed, length / speed, values))
    return found


def random_point(model: Model, speed: float, values: Values, rng: np.random.Generator) -> Values:
    """States and inputs of a likely size and either sign, coefficients within a tenth of the ship's."""
    names = model.states + model.inputs
    point = {n: rng.choice([-1, 1]) * rng.uniform(0.5, 1.5) * SIZES.get(n, 1.0) for n in names}
    point |= {n: rng.uniform(0.5, 1.0) * speed for n in names if n in ("u", "V_U")}
    point |= {n: speed for n in names if n == "cruise"}
    return point | {n: v * rng.uniform(0.9, 1.1) for n, v in values.items()}


def over_plain_numbers(model: Model, point: Values) -> np.ndarray:
    """All right-hand sides: rates and next samples in the order of the states, then what is derived."""
    evaluation = Evaluation(model, point | {SAMPLING_INTERVAL: INTERVAL})
    moves = evaluation.right_hand_sides("rate") | evaluation.right_hand_sides("next")
    return np.array([moves[s] for s in model.states] + [evaluation[n] for n in model.derived])


def generated(system: System) -> Any:
    """The same as one expression of the generated system."""
    rows = [system.nexts.get(i, system.rates[i]) for i in range(len(system.states))]
    return ca.vertcat(*rows, system.expression(system.model.derived))


def vectors(system: System, point: Values) -> list[np.ndarray]:
    """States, inputs and coefficients of a point."""
    return [system.vector(n, point) for n in (system.states, system.inputs, system.coefficients)]


def right_hand_side_deviation(model: Model, points: list[Values]) -> float:
    """Largest relative deviation; entries that are no number on both sides count as equal."""
    system = generate(model)
    function = ca.Function("f", [system.x, system.u, system.p, system.T], [generated(system)])
    worst = 0.0
    for point in points:
        wanted = over_plain_numbers(model, point)
        got = function(*vectors(system, point), INTERVAL).full().ravel()
        if not np.array_equal(np.isfinite(got), np.isfinite(wanted)):
            return np.inf
        here = np.isfinite(wanted)
        worst = max(worst, (np.abs(got - wanted)[here] / np.maximum(np.abs(wanted[here]), 1e-300)).max())
    return worst


def jacobian_deviation(model: Model, points: list[Values]) -> float:
    """Largest deviation of an entry from the largest of its row, each times the size of what it is taken by."""
    system = generate(model)
    everything = ca.vertcat(system.x, system.u, system.p)
    arguments = [system.x, system.u, system.p, system.T]
    function = ca.Function("J", arguments, [ca.jacobian(generated(system), everything)])
    names = system.states + system.inputs + system.coefficients
    # Complex steps do not go through the size of a number or the angle of a wind.
    smooth = not model.name.startswith(("pershitz", "mmg")) and "wind_angle" not in model.derived
    worst = 0.0
    for point in points:
        got = function(*vectors(system, point), INTERVAL).full() * np.array([point[n] for n in names])
        columns = []
        for name in names:
            if smooth:
                moved = over_plain_numbers(model, point | {name: point[name] + 1e-30j})
                columns.append(moved.imag / 1e-30 * point[name])
            else:
                sides = {
                    k: over_plain_numbers(model, point | {name: point[name] * (1 + k * 3e-4)}) for k in (-2, -1, 1, 2)
                }
                columns.append((8 * (sides[1] - sides[-1]) - sides[2] + sides[-2]) / 3.6e-3)
        wanted = np.array(columns).T
        here = np.isfinite(got).all(axis=1)
        scale = np.abs(got[here]).max(axis=1, keepdims=True)
        worst = max(worst, (np.abs(got - wanted)[here] / np.maximum(scale, 1e-300)).max())
    return worst


def zigzag(model: Model, speed: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Initial states and inputs: the rudder goes over every 25 samples, current and disturbances act all the time."""
    swing = np.where((np.arange(count) // 25) % 2 == 0, 0.15, -0.12)
    steady = {"u": speed, "cruise": speed, "v": -0.1, "r_disturbance": 1e-6, "current_north": 0.4, "current_east": -0.3}
    rows = {n: np.full(count, steady.get(n, 0.0)) for n in model.inputs} | {"delta": swing, "Omega": swing / 50}
    x0 = np.array([{"u": speed, "V_U": speed, "psi": 0.3}.get(s, 0.0) for s in model.states])
    return x0, np.array([rows[n] for n in model.inputs])


def simulation_deviation(model: Model, speed: float, unit: float, values: Values) -> float:
    """Largest deviation of a state from SciPy's, relative to the largest value the state takes."""
    x0, u = zigzag(model, speed, 150)
    # Shorter than the lag of a rudder, which is faster than the ship.
    interval = min(0.1 * unit, 0.8 * values.get("t_delta", np.inf))
    record = make_record(model, model.states, substeps=8, compiled=False)
    system = record.system
    p = system.vector(system.coefficients, values)
    got, _ = record(x0, u, np.full(150, interval), p)
    rates, x, rows = system.right_hand_side, x0, [x0]
    for k in range(149):

        def motion(t: float, x: np.ndarray, k: int = k) -> np.ndarray:
            return rates(x, u[:, k] + t / interval * (u[:, k + 1] - u[:, k]), p).full().ravel()

        x = solve_ivp(motion, (0, interval), x, method="DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
        rows.append(x)
    reference = np.array(rows).T
    sizes = np.abs(reference).max(axis=1)
    return float((np.abs(got - reference).max(axis=1) / np.maximum(sizes, 1e-12)).max())


def sensitivity_deviation(model: Model, speed: float, unit: float, values: Values) -> float:
    """Largest deviation of a carried sensitivity from five-point differences of the record, per unknown."""
    x0, u = zigzag(model, speed, 60)
    intervals = np.full(60, min(0.2 * unit, values.get("t_delta", np.inf)))
    names = model.parameters + model.constants
    record = make_record(model, model.states, names, compiled=False)
    p = record.system.vector(names, values)
    _, carried = record(x0, u, intervals, p)
    plain = make_record(model, model.states, compiled=False)
    worst = 0.0
    for j in range(len(names)):
        h = 1e-3 * (abs(p[j]) or 1.0)
        y = {k: plain(x0, u, intervals, p + k * h * np.eye(p.size)[j])[0] for k in (-2, -1, 1, 2)}
        measured = (8 * (y[1] - y[-1]) - y[2] + y[-2]) / (12 * h)
        # A state that hardly depends on the unknown shows the rounding of the state itself.
        scale = np.abs(measured).max(axis=1) + 1e-6 * np.abs(y[1]).max(axis=1) / h
        error = np.abs(carried[:, j] - measured).max(axis=1)
        worst = max(worst, (error[scale > 0] / scale[scale > 0]).max(initial=0.0))
    return worst


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="one ship for each model")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    given = parser.parse_args()
    rng = np.random.default_rng(1)
    found = pairs()
    if given.short:
        found = list({model.name: pair for pair in reversed(found) for model in pair[:1]}.values())
    rows: list[Row] = []
    worst: dict[str, float] = {}
    for model, ship, speed, unit, values in found:
        points = [random_point(model, speed, values, rng) for _ in range(POINTS)]
        # Along a run the stern of the MMG model sees flow from both sides, where its coefficients change: differences across
        # that bend are not its derivative, and SciPy's steps do not end there.
        even = values | {n: v for n, v in BENDS.items() if n in values}
        results = {
            "right-hand side": (right_hand_side_deviation(model, points), 1e-12),
            "Jacobian": (jacobian_deviation(model, points[:10]), 1e-9),
            "sensitivities": (sensitivity_deviation(model, speed, unit, even), 1e-7),
        }
        if not model.is_sampled:
            results["simulation"] = (simulation_deviation(model, speed, unit, even), 1e-6)
        for what, (deviation, limit) in results.items():
            rows.append(below(f"{model.name}, {ship}: {what}", limit, deviation))
            worst[what] = max(worst.get(what, 0.0), deviation)
    notes = "Largest of each: " + ", ".join(f"{what} {deviation:.1e}" for what, deviation in worst.items()) + "."
    notes += f" {len({m.name for m, *_ in found})} of {len(known_models())} models, {len(found)} pairs."
    show("Generated equations against an independent evaluation (relative deviations)", rows, notes, given.json)


if __name__ == "__main__":
    main()
