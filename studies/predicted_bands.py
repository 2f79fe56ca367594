"""The bands of predicted tracks: over many simulated changes of course, how often does the 95 % band hold the track?

The ship is driven by gusts (white noise on her yaw and surge), in a current and a yaw disturbance that wander, each as strong as the
filter takes it; instruments as on an ordinary bridge. The filter of her own model runs up to the order, and the track is predicted with its
band by linear propagation. Then the same with a model that is wrong in a stated way: the ship has a cubic damping, or a late sway, that the
predictor does not know; the study says by how much the band misses.

    python studies/predicted_bands.py [--runs 300] [--short] [--json]
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from _table import Row, show

import shipid
from shipid.autopilot.course_changes.weather import CALM
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of
from shipid.generation.loop import make_loop
from shipid.generation.simulator import initial_state, input_rows
from shipid.generation.step import make_step
from shipid.generation.system import generate
from shipid.prediction.situations.filtered_situation import situation_of
from shipid.prediction.situations.own_ship_filter import own_ship_filter, own_ship_model
from shipid.prediction.tracks.track_predictor import TrackPredictor

DEG = np.pi / 180
SHIP, T, APPROACH, LENGTHS = "soesterberg", 0.5, 400.0, 10.0
NOISE = {"psi": 0.2 * DEG, "r": 0.02 * DEG, "u": 0.1, "x": 10.0, "y": 10.0}
SHOWN = ("x", "y", "psi", "u", "r", "delta")
#: Distances from the order in ship lengths at which the band is looked at.
PLACES = (1.0, 2.0, 4.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True)
class Case:
    """A ship, and what her predictor does not know of her."""

    name: str
    values: Mapping[str, float]
    right: bool


CASES = (
    Case("the model is right", {}, True),
    Case("the ship has a cubic damping of 2", {"alpha3": 2.0}, False),
    Case("her gain is 10 % higher", {"K": 1.76}, False),
)


def sail_driven(
    pilot: Autopilot, case: Case, change: float, current: tuple[float, float], density: Mapping[str, float], seed: int
) -> dict[str, np.ndarray]:
    """Sail a change of course with noise that drives the states; the truth every half a second."""
    # Current and disturbance wander as the filter takes them to.
    model = closed_loop(replace(pilot, model=own_ship_model(pilot.model)))
    system = generate(model)
    step = make_step(system, "rk4", "zero", 2)
    names = [n for n in density if n in model.states]
    w = ca.SX.sym("w", len(names))
    pushed = step.x_next + 0
    for i, name in enumerate(names):
        pushed[system.states.index(name)] += w[i]
    row = ca.densify(system.expression(SHOWN))
    loop = make_loop(
        ca.Function("driven", [system.x, ca.vertcat(system.u, system.T, w), system.p], [ca.densify(pushed), row])
    )
    count = int((APPROACH + 450) / T)
    inputs = {
        **CALM,
        "cruise": pilot.own_speed,
        "psi_order": 0.0,
        "current_north": current[0],
        "current_east": current[1],
    }
    table = np.repeat(np.append(input_rows(model, inputs, 1)[:, 0], T)[None], count, axis=0)
    table[int(APPROACH / T) :, model.inputs.index("psi_order")] = change
    random = np.random.default_rng([seed, 12])
    driving = random.standard_normal((count, len(names))) * np.array([density[n] for n in names]) * np.sqrt(T)
    known = coefficients_of(pilot, model, pilot.own_speed) | dict(case.values)
    x0 = initial_state(model, {"u": pilot.own_speed, "current_north": current[0], "current_east": current[1]})
    _, out = loop(x0, np.hstack([table, driving]), system.vector(system.coefficients, known))
    return {"t": np.arange(count) * T, **dict(zip(SHOWN, out.T))}


def inside(case: Case, runs: int) -> tuple[np.ndarray, np.ndarray]:
    """Return which tracks are within the band and how far off they are in half-widths, shapes (runs, places)."""
    pilot = shipid.design_autopilot("de-keizer", SHIP, design="pole", damping=0.85)
    own = own_ship_filter("de-keizer", SHIP)
    density = {s.name: s.level for s in own.design.sources}
    predictor = TrackPredictor(pilot)
    held, off = np.zeros((runs, len(PLACES)), dtype=bool), np.zeros((runs, len(PLACES)))
    for seed in range(runs):
        random = np.random.default_rng([seed, 11])
        change = random.choice((-1, 1)) * random.uniform(20, 120) * DEG
        set_, to = random.uniform(0, 1.5), random.uniform(0, 2 * np.pi)
        truth = sail_driven(pilot, case, change, (set_ * np.cos(to), set_ * np.sin(to)), density, seed)
        seen = {n: truth[n] + random.standard_normal(truth["t"].size) * s for n, s in NOISE.items()}
        now = int(APPROACH / T)
        record = {"t": truth["t"], **seen, "delta": truth["delta"], "cruise": np.full(truth["t"].size, pilot.own_speed)}
        run = own.filter({n: c[: now + 1] for n, c in record.items()})
        track = predictor.predict(situation_of(run), heading=float(change), horizon=LENGTHS + 1)
        across, node = track.distance_to(truth["x"][now:], truth["y"][now:])
        along = np.interp(node, np.arange(track.s.size), track.s_star)
        width = np.interp(node, np.arange(track.s.size), track.half_width)
        for k, place in enumerate(PLACES):
            at = int(np.argmax(along >= place))
            off[seed, k] = abs(across[at]) / width[at]
            held[seed, k] = off[seed, k] <= 1
    return held, off


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--short", action="store_true", help="20 runs of the right model")
    parser.add_argument("--json", action="store_true")
    chosen = parser.parse_args()
    runs = 20 if chosen.short else chosen.runs
    rows = []
    for case in CASES[:1] if chosen.short else CASES:
        held, off = inside(case, runs)
        share = held.mean()
        by_place = " ".join(f"{v:.0%}" for v in held.mean(axis=0))
        # The places of one run are not independent: the error of the share is that of so many runs.
        slack = 1.96 * np.sqrt(0.95 * 0.05 / runs)
        text = f"{share:.1%}; at {' '.join(f'{p:g}' for p in PLACES)} L {by_place}; worst {off.max():.1f} half-widths"
        asked = "93 to 97 %" if case.right else "missed, by how much is told"
        rows.append(
            Row(
                f"{case.name}, {runs} runs",
                asked,
                text,
                not case.right or abs(share - 0.95) <= 0.02 + (slack if chosen.short else 0),
            )
        )
    show("95 % bands of predicted tracks", rows, as_json=chosen.json)


if __name__ == "__main__":
    main()
