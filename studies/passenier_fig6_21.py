"""Passenier (1989), fig. 6.21, section 6.3.5: a current is switched on during sailing; its estimate, and the predicted track that follows.

The container ship keeps her course at 19 knots; after 300 s a current of 6 knots to 210 degrees sets in. The yaw filter (0.4 s) and the
position filter (2 s, fixes of 50 m) of the thesis run on; the track is predicted in still water and moved by the estimate (claim P17).
Course, instants and tuning are assumed; the print has no numbers. The navigator of the print reads the heading that makes up for the
current from the predicted track: here the heading whose predicted track keeps the leg, and what it makes of the ship.

    python studies/passenier_fig6_21.py [--runs 5] [--json] [--figure FILE]
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
from _claims import HOLDS, Claim, claim, figure, options, show
from _container import container_ship

import shipid
from shipid.prediction.following.track_adaptation import adapted
from shipid.prediction.following.wheel_over import TrackLeg, heading_on
from shipid.prediction.sailing.simulated_ship import SimulatedShip
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.track_predictor import TrackPredictor

DEG, KNOT = np.pi / 180, 1852 / 3600
SHIP, T, SPEED = container_ship(), 0.4, 19 * KNOT
ON, CORRECTED, END = 300.0, 600.0, 1100.0
SET, TO, COURSE = 6 * KNOT, 210 * DEG, 80 * DEG
CURRENT = (SET * np.cos(TO), SET * np.sin(TO))
NOISE = {"psi": 0.1 * DEG, "r": 0.01 * DEG, "u": 0.1, "x": 50.0, "y": 50.0}
LOOKED = (60.0, 120.0, 240.0)


@functools.cache
def predictor() -> TrackPredictor:
    """Return the first-order predictor of the thesis."""
    pilot = shipid.design_autopilot("de-keizer", SHIP, design="pole", damping=0.85, rudder_limit="15 deg")
    return TrackPredictor(pilot, model="first-order")


@functools.cache
def sailed(correction: float) -> dict[str, np.ndarray]:
    """Sail on; after a while under a heading that is so much beside the course."""
    ship = SimulatedShip(predictor().pilot, speed=SPEED, start={"psi": COURSE})
    rows = [ship.now]
    for k in range(round(END / T)):
        on = k * T >= ON
        ship.inputs |= dict(zip(("current_north", "current_east"), CURRENT if on else (0.0, 0.0)))
        rows.append(ship.advance(T, COURSE + (correction if k * T >= CORRECTED else 0.0)))
    found = {n: np.array([r[n] for r in rows]) for n in ("x", "y", "psi", "r", "u", "v", "delta")}
    return {"t": T * np.arange(len(rows)), **found}


@functools.cache
def cascade() -> shipid.Cascade:
    """Return the two filters of the thesis, each at its own rate."""
    yaw = shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"), SHIP, measured={"compass": "0.1 deg", "gyro": "0.01 deg/s"}, start={"a": "0.94", "b1": "0.59"}
    )  # fmt: skip
    position = shipid.ExtendedKalmanFilter(
        shipid.find_model("position-filter"), SHIP, measured={"log": "0.1 m/s", "fix_north": "50 m", "fix_east": "50 m"}
    )
    return shipid.Cascade({"yaw": yaw, "position": position}, every={"position": "2 s"})


def estimated(truth: Mapping[str, np.ndarray], seed: int) -> Any:
    """Return the run of the position filter."""
    random = np.random.default_rng([seed, 621])
    table = {n: truth[n] + random.standard_normal(truth["t"].size) * s for n, s in NOISE.items()}
    for n in ("x", "y"):
        table[n][np.arange(table[n].size) % 5 != 0] = np.nan
    record = {**table, "t": truth["t"], "delta": truth["delta"], "cruise": np.full(truth["t"].size, SPEED)}
    return cascade().filter(record)["position"]


def at(run: Any, name: str, t: float) -> float:
    """Return an estimate at the last sample before a time."""
    return float(run[name][int(np.searchsorted(run.t, t + 1e-9)) - 1])


def drift_of(run: Any, t: float) -> tuple[float, float]:
    """Return the estimated current at a time."""
    return at(run, "current_north", t), at(run, "current_east", t)


def predicted_error(run: Any, truth: Mapping[str, np.ndarray], t: float, moved: bool) -> float:
    """Return how far the ship is after 200 s from where her track says, from her true place, in m."""
    k = int(np.searchsorted(truth["t"], t))
    track = predictor().predict(Situation({"psi": COURSE, "u": SPEED}), heading=COURSE, horizon=12, band="none")
    there = adapted(
        track, 0.0, truth["x"][k], truth["y"][k], current=drift_of(run, t) if moved else (0.0, 0.0)
    ).at_time(200.0)
    later = k + round(200 / T)
    return float(np.hypot(there["x"] - truth["x"][later], there["y"] - truth["y"][later]))


def errors(seed: int) -> dict[str, Any]:
    """Return what one noise run gives."""
    truth = sailed(0.0)
    run = estimated(truth, seed)
    t = run.t
    size = np.hypot(run["current_north"] - CURRENT[0], run["current_east"] - CURRENT[1])
    found: dict[str, Any] = {f"off {s:g}": float(size[np.searchsorted(t, ON + s)]) for s in LOOKED}
    found["t90"] = float(t[(t >= ON) & (size <= 0.1 * SET)][0] - ON)
    for moved in (False, True):
        found[f"track {moved}"] = predicted_error(run, truth, ON + 240, moved)
    leg = TrackLeg(0.0, 0.0, COURSE)
    heading = heading_on(leg, drift_of(run, CORRECTED), SPEED)
    found["heading"] = heading - COURSE
    after = sailed(round(heading - COURSE, 4))
    across = leg.across(after["x"], after["y"])
    kept = after["t"] >= CORRECTED + 100
    rate = np.polyfit(after["t"][kept], across[kept], 1)[0]
    found["leeway"] = abs(float(rate)) / SET
    return found


def rows_of(made: list[dict[str, Any]]) -> list[Claim]:
    """What is claimed, and what came out."""
    spread = f"median of {len(made)} runs"

    def median(name: str) -> float:
        return float(np.median([m[name] for m in made]))

    exact = heading_on(TrackLeg(0.0, 0.0, COURSE), CURRENT, SPEED) - COURSE
    off = " ".join(f"{median(f'off {s:g}') / KNOT:.2f}" for s in LOOKED)
    return [
        claim(
            "P17 the position filter finds a current of 6 kn: within 10 % after", "fig. 6.21.a, no number; 192 s by a prototype (3 kn)", f"{median('t90'):.0f} s",
            median("t90") <= 240, spread,
        ),
        Claim(f"its error after {' '.join(f'{s:g}' for s in LOOKED)} s, kn", "", off, spread, HOLDS, promised=False),
        claim(
            "P17 where the ship is 200 s later: track in still water; moved by the estimate", "fig. 6.21.b, no number",
            f"off by {median('track False'):.0f} m; {median('track True'):.0f} m", median("track True") <= 0.15 * median("track False"), spread,
        ),
        claim(
            "the heading that makes up for it, read from the predicted track", f"{exact / DEG:.1f} deg exact", f"{median('heading') / DEG:.1f} deg",
            abs(median("heading") - exact) <= 1.5 * DEG, spread,
        ),
        claim(
            "under that heading she leaves her line with this share of the current", "7 % or less: 1.96 times the error of 0.11 m/s of a prototype", f"{100 * median('leeway'):.1f} %",
            median("leeway") <= 0.07, spread,
        ),
    ]  # fmt: skip


def draw(axes: Any) -> None:
    """Draw the estimate, and the tracks before and after it."""
    truth = sailed(0.0)
    run = estimated(truth, 0)
    left, right = axes
    left.plot(run.t, np.hypot(run["current_north"], run["current_east"]) / KNOT, "k")
    left.plot([0, ON, ON, END], [0, 0, 6, 6], "k:")
    left.set_xlabel("t [s]")
    left.set_ylabel("current [kn]")
    k = int(np.searchsorted(truth["t"], ON + 240))
    track = predictor().predict(Situation({"psi": COURSE, "u": SPEED}), heading=COURSE, horizon=12, band="none")
    right.plot(truth["y"], truth["x"], "k", label="sailed")
    for style, drift, name in (
        (":", (0.0, 0.0), "in still water"),
        ("--", drift_of(run, ON + 240), "moved by the estimate"),
    ):
        there = adapted(track, 0.0, truth["x"][k], truth["y"][k], current=drift)
        right.plot(there.y, there.x, "k" + style, label=name)
    right.set_aspect("equal")
    right.set_xlabel("east [m]")
    right.set_ylabel("north [m]")
    right.legend()


if __name__ == "__main__":
    chosen = options(__doc__ or "", 5)
    made = [errors(seed) for seed in range(chosen.runs)]
    figure(chosen.figure, 2, draw)
    show("Passenier (1989), fig. 6.21: a current that is switched on", rows_of(made), chosen.json)
