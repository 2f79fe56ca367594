"""Voyages for the studies of the filters: one ship sailed once, then seen through many draws of waves and sensor noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

import shipid
from shipid.estimation.design import FilterDesign
from shipid.estimation.records.arrangement import arrange
from shipid.estimation.records.controls import controls_of
from shipid.estimation.records.first_estimate import first_carried
from shipid.estimation.several.adaptive_noise import AdaptiveFilter
from shipid.generation.loop import make_loop
from shipid.generation.record import make_record
from shipid.generation.step import make_step
from shipid.parameters.catalogue import ship_of
from shipid.parts.helm import ZigzagHelm
from shipid.parts.steering_machine import SteeringMachine
from shipid.parts.waves import Waves

DEG = np.pi / 180
KNOT = 1852 / 3600
SHOWN = ("x", "y", "psi", "u", "v", "r", "delta")
Columns = dict[str, np.ndarray]


def sail(
    ship: shipid.ParameterSet | str,
    angle: float,
    duration: float,
    interval: float,
    *,
    begin: float = 20.0,
    speeds: Sequence[tuple[float, float]] = (),
    currents: Sequence[tuple[float, float, float]] = (),
    values: Mapping[str, float] | None = None,
    model: str = "de-keizer-minimal",
) -> Columns:
    """Sail a zig-zag and return the truth.

    Parameters
    ----------
    ship : ParameterSet or str
        Who sails.
    model : str
        By which equations.
    angle : float
        Rudder and heading of the zig-zag in degrees.
    duration, interval, begin : float
        Length, sampling interval and approach in s.
    speeds : sequence of (float, float)
        From when in s, cruising speed in m/s; by default the ship's own.
    currents : sequence of (float, float, float)
        From when in s, current to the north and to the east in m/s.
    values : mapping of str to float
        Coefficients that replace the ship's, SI.
    """
    known_ship = ship_of(ship)
    own = known_ship.particular("speed", "m/s") or 0.0
    whole = shipid.join("voyage", shipid.find_model(model), SteeringMachine, ZigzagHelm)
    fine = max(1, int(np.ceil(interval / 0.2 - 1e-9)))
    count = round(duration / interval)
    t = np.arange(count * fine + 1) * (interval / fine)
    cruise = _steps(t, speeds or [(0.0, own)])
    inputs = {"cruise": cruise, "current_north": np.zeros(t.size), "current_east": np.zeros(t.size)}
    if currents:
        inputs["current_north"] = _steps(t, [(c[0], c[1]) for c in currents])
        inputs["current_east"] = _steps(t, [(c[0], c[2]) for c in currents])
    helm = {"helm_start": begin, "helm_course": 0.0, "helm_rudder": angle * DEG, "helm_heading": angle * DEG}
    coefficients = known_ship.values(shipid.find_model(model), speed=own) | known_ship.values(whole, speed=own)
    coefficients |= helm | dict(values or {})
    record = make_record(whole, SHOWN, hold="zero")
    x0 = {s: whole[s].number("start") or 0.0 for s in whole.states} | {"u": cruise[0]}
    p = record.system.vector(record.system.coefficients, coefficients)
    table = np.array([inputs.get(n, np.full(t.size, whole[n].number("default") or 0.0)) for n in whole.inputs])
    y, _ = record(np.array([x0[s] for s in whole.states]), table, np.diff(t, append=t[-1]), p)
    columns = {"t": t[::fine]} | {n: row[::fine] for n, row in zip(SHOWN, y)}
    return columns | {n: c[::fine] for n, c in inputs.items()}


def _steps(t: np.ndarray, steps: Sequence[tuple[float, float]]) -> np.ndarray:
    begins, values = (np.array(c) for c in zip(*steps))
    return values[np.clip(np.searchsorted(begins, t + 1e-9, side="right") - 1, 0, None)]


def waves(runs: int, count: int, interval: float, rms: float, seed: int) -> np.ndarray:
    """Return heading and rate of turn by narrow-band waves, as `Waves` declares them, shape (runs, count, 2).

    Parameters
    ----------
    runs, count : int
        How many records, of how many samples.
    interval : float
        Sampling interval in s.
    rms : float
        Of the rate of turn, in rad/s.
    seed : int
        Of the noise.
    """
    model = shipid.join("waves", Waves)
    step = make_step(shipid.generate(model), hold="zero")
    system = step.system
    frequency, damping, fine = 0.6, 0.15, 4
    values = {"wave_frequency": frequency, "wave_damping": damping, "g": 9.81}
    control = ca.SX.sym("noise", fine)
    # The waves are met at the frequency they have: the ship's own speed is left out.
    still = [float(n == "T_s") for n in system.inputs]
    z = system.x
    for k in range(fine):
        u = ca.vertcat(*(control[k] if n == "wave_noise" else still[i] for i, n in enumerate(system.inputs)))
        p = ca.DM([values[n] for n in system.coefficients])
        z = step.function(z, u, u, p, interval / fine)
    function = ca.Function("waves_step", [system.x, control, ca.SX.sym("none", 0)], [z, ca.densify(z)])
    loop = make_loop(function)
    rng = np.random.default_rng([seed, 1])
    level = rms * np.sqrt(4 * damping * frequency * fine / interval)
    drawn = level * rng.standard_normal((runs, count, fine))
    # The waves begin as if they had always been there.
    sizes = {"psi_wave": rms / frequency, "r_wave": rms}
    starts = rng.standard_normal((runs, 2)) * [sizes[n] for n in system.states]
    order = [system.states.index(n) for n in ("psi_wave", "r_wave")]
    done = loop.map(list(starts), list(drawn), [np.zeros(0)] * runs)
    return np.array([out for _, out in done])[:, :, order]


def measured(
    truth: Columns, runs: int, noise: Mapping[str, float], wave_rms: float = 0.0, seed: int = 1
) -> list[Columns]:
    """Return what the sensors show in each run: truth, waves on heading and rate, white noise.

    Parameters
    ----------
    truth : mapping of str to ndarray
        A voyage.
    runs : int
        How many draws.
    noise : mapping of str to float
        Standard deviation of a sample by column, SI; columns without noise are as they are.
    wave_rms : float
        Of the rate of turn by waves, in rad/s.
    seed : int
        Of everything drawn.
    """
    count, interval = truth["t"].size, float(truth["t"][1] - truth["t"][0])
    rng = np.random.default_rng([seed, 0])
    moved = waves(runs, count, interval, wave_rms, seed) if wave_rms else np.zeros((runs, count, 2))
    draws = {n: level * rng.standard_normal((runs, count)) for n, level in noise.items()}
    records = []
    for k in range(runs):
        record = dict(truth)
        for name, draw in draws.items():
            record[name] = record[name] + draw[k]
        record["psi"], record["r"] = record["psi"] + moved[k, :, 0], record["r"] + moved[k, :, 1]
        records.append(record)
    return records


def controls(design: FilterDesign, records: Sequence[Columns]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return what a filter starts from and what it takes, for each run.

    Parameters
    ----------
    design : FilterDesign
        The filter.
    records : sequence of mapping of str to ndarray
        Records without gaps.
    """
    arranged = [arrange(design.instruments, r) for r in records]
    starts = [first_carried(design, r, a) for r, a in zip(records, arranged)]
    return starts, [controls_of(design, a) for a in arranged]


def filtered(kalman: shipid.ExtendedKalmanFilter | AdaptiveFilter, records: Sequence[Columns]) -> np.ndarray:
    """Return the estimates of every run, shape (runs, samples, states); the runs side by side on all processors.

    Parameters
    ----------
    kalman : ExtendedKalmanFilter or AdaptiveFilter
        The filter.
    records : sequence of mapping of str to ndarray
        Records without gaps.
    """
    design = kalman.design
    starts, rows = controls(design, records)
    loop = design.loop()
    if isinstance(kalman, AdaptiveFilter):
        starts, loop = [kalman.mixed_start(s) for s in starts], kalman.loop()
    done = loop.map(starts, rows, [design.constants] * len(records))
    return np.array([out[:, design.layout.brief["x"]] for _, out in done])


def settled(t: np.ndarray, good: np.ndarray) -> np.ndarray:
    """Return when each run has become good for good, NaN where it never does, shape (runs,).

    Parameters
    ----------
    t : ndarray, shape (N,)
        Times.
    good : ndarray of bool, shape (runs, N)
        Where a run is good.
    """
    last_bad = good.shape[1] - 1 - np.argmax(~good[:, ::-1], axis=1)
    first = np.where(good.all(axis=1), 0, last_bad + 1)
    return np.where(first < t.size, t[np.minimum(first, t.size - 1)], np.nan)
