"""Passenier (1989), chapter 3, claims P1 to P7: the predicted track against the sailed one for changes of course of 120 degrees.

The autopilot has Kp = 1 and a damping ratio of 0.85; the predictor is the first-order model (7.2)-(7.3) at a constant speed.
Deviations are in ship lengths: at equal distance sailed, and to the nearest point of the predicted track. Two ships: one like
the Zeefakkel at 9 knots, and the container ship at 9.5 m/s. Assumed: the effective coefficients of the first, K_u* of both.

    python studies/passenier_ch3.py [--json] [--figure FILE]
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from _claims import Claim, claim, figure, options, show
from _container import container_ship

import shipid
from shipid.autopilot.design.autopilot import Autopilot
from shipid.models import SteeringMachine
from shipid.parts.helm import DirectRudder
from shipid.prediction.following.track_adaptation import node_at_heading
from shipid.prediction.sailing.sail import sail
from shipid.prediction.situations.situation import Situation
from shipid.prediction.tracks.predicted_track import PredictedTrack
from shipid.prediction.tracks.track_predictor import TrackPredictor
from shipid.trials.trial import Trial

DEG, KNOT = np.pi / 180, 1852 / 3600
#: Ship, speed in m/s, rudder rate, and K_u* where the turn at 30 degrees of the model would not be stable.
SHIPS = {"zeefakkel": (9 * KNOT, "5 deg/s", 0.8), "soesterberg": (9.5, "2.5 deg/s", 0.5)}
#: K_u* of both ships.
LOSS = {"zeefakkel": 0.8, "soesterberg": 0.9}
LIMITS, CHANGE, BEGIN = (10, 20, 30), 120.0, 30.0
#: What a faithful implementation was found to give, by ship, in ship lengths: at equal distance, and lateral.
NOTES = {
    ("zeefakkel", "de-keizer", False): ((0.030, 0.082, 0.123), (0.023, 0.066, 0.103)),
    ("soesterberg", "de-keizer", False): ((0.071, 0.117, 0.073), (0.057, 0.098, 0.062)),
    ("zeefakkel", "de-keizer", True): ((0.145, 0.278, 0.419), (0.084, 0.168, 0.257)),
    ("soesterberg", "de-keizer", True): ((0.083, 0.191, 0.368), (0.058, 0.130, 0.222)),
}


@functools.cache
def known_ship(name: str) -> shipid.ParameterSet:
    """Return a ship of the thesis."""
    return container_ship() if name == "soesterberg" else shipid.find_ship(name)


def pilot_of(ship: str, model: str, machine: bool) -> Autopilot:
    """Return the autopilot with gains at speeds so close that the schedule is K_d* L/u to a two-thousandth."""
    speed = SHIPS[ship][0]
    return shipid.design_autopilot(
        model,
        known_ship(ship),
        actuator=SteeringMachine if machine else None,
        speeds=list(np.geomspace(0.2, 2.2, 40) * speed),
        design="pole",
        omega_n=omega_of(ship, model),
        damping=0.85,
    )


def omega_of(ship: str, model: str) -> float:
    """Return the frequency at which Kp is 1, in rad/s at the ship's own speed."""
    known = known_ship(ship)
    values = known.values(shipid.find_model(model))
    pace = (known.particular("speed", "m/s") or 1.0) / (known.particular("L", "m") or 1.0)
    return float(np.sqrt(values["K"] / values["tau"]) * pace)


@dataclass(frozen=True)
class Turn:
    """A change of course as it was sailed and as it was predicted."""

    sailed: dict[str, np.ndarray]
    predicted: PredictedTrack

    @property
    def at_equal_distance(self) -> float:
        """Largest deviation at equal distance, in ship lengths."""
        s, p = self.sailed["s"], self.predicted
        inside = s <= p.s[-1]
        x, y = (np.interp(s[inside], p.s, a) for a in (p.x, p.y))
        return float(np.hypot(self.sailed["x"][inside] - x, self.sailed["y"][inside] - y).max() / p.length)

    @property
    def lateral(self) -> float:
        """Largest distance to the predicted track, in ship lengths."""
        p = self.predicted
        across, node = p.distance_to(self.sailed["x"], self.sailed["y"])
        return float(np.abs(across[node < p.s.size - 1]).max() / p.length)


def turn(
    ship: str,
    model: str,
    limit: float,
    *,
    machine: bool = False,
    known_machine: bool = False,
    factor: float = 1.0,
    current: tuple[float, float] | None = None,
    scheduled: bool = True,
    lengths: float = 10.0,
    values: dict[str, float] | None = None,
) -> Turn:
    """Sail a change of course, and predict it at a speed that is a factor of the ship's own."""
    pilot = pilot_of(ship, model, machine)
    speed, rate, gentle = SHIPS[ship]
    coefficients = dict(values or {})
    coefficients["K_u"] = gentle if model == "de-keizer" and limit == 30 else LOSS[ship]
    if machine:
        coefficients["delta_rate"] = float(rate.split()[0]) * DEG
    flow = None if current is None else (current[0], current[1])
    length = pilot.length
    step = 0.002 * length / speed
    trial = sail(
        pilot, [(BEGIN * step, f"{CHANGE} deg")], speed=speed, rudder_limit=limit * DEG, duration=(1.3 * lengths) * length / speed,
        sampling=step, current=flow, values=coefficients,
    )  # fmt: skip
    sailed = _from(trial, BEGIN * step)
    steering = pilot if known_machine else replace(pilot, actuator=DirectRudder)
    predictor = TrackPredictor(steering, model="first-order", values=effective(pilot, ship, model))
    there = {"psi": 0.0, "u": factor * speed}
    if current is not None:
        there |= {"current_north": current[0] * np.cos(current[1]), "current_east": current[0] * np.sin(current[1])}
    if not scheduled:
        # The derivative gain of the ship's own speed, whatever speed is predicted with.
        fixed = pilot.gains(speed).Kd
        predictor.values |= {f"pilot_Kd_{i + 1}": fixed for i in range(len(pilot.speeds))}
    found = predictor.predict(
        Situation(there),
        heading=CHANGE * DEG,
        rudder_limit=limit * DEG,
        horizon=lengths,
        points=int(400 * lengths),
        band="none",
    )
    return Turn(sailed, found)


def effective(pilot: Autopilot, ship: str, model: str) -> dict[str, float]:
    """Return K*, tau* and gamma* as the ship's set states them."""
    known = known_ship(ship).values(shipid.find_model(model))
    return {n: known[n] for n in ("K", "tau", "gamma")}


def _from(trial: Trial, begin: float) -> dict[str, np.ndarray]:
    t = trial.table["t"].to_numpy()
    rows = t >= begin - 1e-9
    table = {n: trial.table[n].to_numpy()[rows] for n in ("t", "x", "y", "psi", "r", "u", "v")}
    table["t"] = table["t"] - table["t"][0]
    table["x"], table["y"] = table["x"] - table["x"][0], table["y"] - table["y"][0]
    steps = 0.5 * (table["u"][1:] + table["u"][:-1]) * np.diff(table["t"])
    table["s"] = np.concatenate([[0.0], np.cumsum(steps)])
    return table


def translated(ship: str, limit: float, degrees: float, factor: float) -> tuple[float, float]:
    """Return how far along the track the point of translation is off, found by course and by time, in ship lengths."""
    one = turn(ship, "van-leeuwen", limit, factor=factor)
    sailed, track = one.sailed, one.predicted
    k = int(np.argmax(sailed["psi"] >= degrees * DEG))
    nodes = np.arange(track.s.size)
    by_course = np.interp(node_at_heading(track, float(sailed["psi"][k])), nodes, track.s)
    by_time = np.interp(sailed["t"][k], track.t, track.s)
    return tuple(float(abs(s - sailed["s"][k]) / track.length) for s in (by_course, by_time))  # type: ignore[return-value]


def rows_of() -> list[Claim]:
    """Every claim of the chapter."""
    rows = []
    for ship in SHIPS:
        for factor in (0.5, 1.0, 2.0):
            worst = max(turn(ship, "van-leeuwen", limit, factor=factor).at_equal_distance for limit in LIMITS)
            rows.append(claim(
                f"P1, P3, P4 {ship}, Van Leeuwen, predicted with {factor:g} of its speed: deviation",
                "exact: 0.002 L or less", f"{worst:.4f} L", worst <= 0.002,
            ))  # fmt: skip
        loose = [turn(ship, "van-leeuwen", limit, factor=0.5, scheduled=False).at_equal_distance for limit in LIMITS]
        rows.append(claim(
            f"P2 {ship}, half its speed, K_d not scheduled: 10 20 30 deg", "not exact (about 0.2 L)",
            " ".join(f"{v:.2f}" for v in loose) + " L", max(loose) > 0.1,
        ))  # fmt: skip
    for (ship, model, machine), (equal, lateral) in NOTES.items():
        found = [turn(ship, model, limit, machine=machine) for limit in LIMITS]
        ours = tuple(t.at_equal_distance for t in found), tuple(t.lateral for t in found)
        near = all(abs(a - b) <= max(0.2 * b, 0.005) for o, n in zip(ours, (equal, lateral)) for a, b in zip(o, n))
        text = [" ".join(f"{v:.3f}" for v in values) for values in (*ours, equal, lateral)]
        rows.append(claim(
            f"P7 {ship}, De Keizer{' with its rudder rate' if machine else ''}, 10 20 30 deg: equal distance; lateral, L",
            f"{text[2]}; {text[3]} within 20 %", f"{text[0]}; {text[1]}", near,
            reading="K_u* of 0.5 for the container ship at 30 degrees, where 0.9 has no steady turn",
        ))  # fmt: skip
        if machine:
            better = [turn(ship, model, limit, machine=True, known_machine=True).lateral for limit in LIMITS]
            rows.append(claim(
                f"{ship}, De Keizer with its rudder rate, the predictor knows the steering machine: lateral, L",
                "nearer than without it", " ".join(f"{v:.3f}" for v in better), max(better) < max(ours[1]),
            ))  # fmt: skip
    offs = [translated("zeefakkel", 20, degrees, 0.7) for degrees in (30.0, 60.0, 90.0)]
    course, clock = max(o[0] for o in offs), [o[1] for o in offs]
    rows.append(claim(
        "P5 point of translation after 30, 60, 90 deg, predicted with 0.7 of the speed: by course; by time",
        "0.005 L or less; 0.60 to 1.21 L", f"{course:.4f} L; " + " ".join(f"{v:.2f}" for v in clock) + " L",
        course <= 0.005 and min(clock) >= 0.5,
    ))  # fmt: skip
    drift = (3 * KNOT, 30 * DEG)
    flow = [turn("zeefakkel", "van-leeuwen", limit, current=drift, lengths=20.0).at_equal_distance for limit in LIMITS]
    rows.append(claim(
        "P6 zeefakkel, 3 kn of current, known, predicted with the cruising speed, 20 L: 10 20 30 deg", "usable: 0.11 0.21 0.29 L within 20 %",
        " ".join(f"{v:.2f}" for v in flow) + " L", all(abs(a - b) <= 0.2 * b for a, b in zip(flow, (0.11, 0.21, 0.29))),
        reading="the current flows to 30 degrees from the first course",
    ))  # fmt: skip
    return rows


def draw(axes: Any) -> None:
    """Draw the tracks of the three rudder limits, as in figs. 3.9 to 3.11."""
    for axis, ship in zip(axes, SHIPS):
        for limit in LIMITS:
            one = turn(ship, "de-keizer", limit, machine=True)
            length = one.predicted.length
            axis.plot(one.sailed["y"] / length, one.sailed["x"] / length, "k", lw=0.8)
            axis.plot(one.predicted.y / length, one.predicted.x / length, "k--", lw=0.8)
        axis.set_aspect("equal")
        axis.set_ylabel(f"{ship}: north, L")
    axes[-1].set_xlabel("east, L; sailed (full) and predicted (dashed) for limits of 10, 20, 30 degrees")


if __name__ == "__main__":
    chosen = options(__doc__ or "")
    found = rows_of()
    figure(chosen.figure, 2, draw)
    show("Passenier (1989), chapter 3: the basic predictor", found, chosen.json)
