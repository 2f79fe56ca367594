#!/usr/bin/env python3
"""A model of one's own with an engine as a state: declared, identified, filtered, tuned, command by command.

python studies/job_own_model.py [--short] [--json]

A ferry of 80 m is ordered from 150 to 120 revolutions a minute in the middle of a zig-zag. Her engine follows its order with a lag, the shaft
drives her forward, and her rudder turns her the quicker the faster she is: three components, one file. The two logs are integrated here
step by step from the same equations written by hand, so the truth is known and none of shipid made it. Sensors have noise.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from _commands import answer, empty_folder, shipid
from _table import Row, close, show

from shipid import read_trial

MODEL = '''"""A ferry with an engine of her own: the shaft follows its order with a lag, and drives the ship."""

from shipid import Component, constant, given, join, parameter, state
from shipid.models import PlanarMotion


class Engine(Component):
    """Shaft speed behind a governor with one time constant."""

    n = state("1/s", "shaft speed, revolutions per second")
    n_order = given("1/s", "ordered shaft speed, revolutions per second")
    T_n = parameter("s", "time constant of engine and governor", start=5.0, low=0.5, high=60)

    @n.rate
    def follow(self):
        """Notes of the sea trials, page 3."""
        return (self.n_order - self.n) / self.T_n


class Surge(Component):
    """Forward speed that approaches what the shaft sustains, less what the turn costs."""

    u = state("m/s", "forward speed through the water")
    n = given("1/s", "shaft speed, revolutions per second")
    r = given("rad/s", "rate of turn, positive to starboard")
    L = constant("m", "length between perpendiculars")
    P = parameter("m", "way per revolution on a straight course", start=2.0, low=0.1, high=20)
    k = parameter("s", "speed lost in the turn", start=10.0, low=0.0, high=1000)
    T_u = parameter("s", "time constant of speed", start=20.0, low=2, high=500)

    @u.rate
    def surge(self):
        """Notes of the sea trials, page 4."""
        return (self.P * self.n - self.k * self.L * self.r**2 - self.u) / self.T_u


class Yaw(Component):
    """First-order yaw in lengths sailed."""

    r = state("rad/s", "rate of turn, positive to starboard")
    u = given("m/s", "forward speed through the water")
    delta = given("rad", "rudder angle, positive turns to starboard")
    L = constant("m", "length between perpendiculars")
    K = parameter("1", "yaw gain in lengths sailed", start=1.0, low=0.05, high=20)
    tau = parameter("1", "yaw time constant in lengths sailed", start=1.0, low=0.05, high=20)

    @r.rate
    def yaw(self):
        """Notes of the sea trials, page 5."""
        pace = self.u / self.L
        return pace * (self.K * self.delta * pace - self.r) / self.tau


ferry = join("ferry", Yaw, Surge, Engine, PlanarMotion)
'''
L, SPEED = 80.0, 6.0
TRUTH = {"T_n": 8.0, "P": 2.4, "k": 40.0, "T_u": 35.0, "K": 1.3, "tau": 0.9}
DURATION, STEP = 600, 0.01
#: The engine moves once, for some twenty samples: its time constant is asked to this share, not to its interval. Fitted to the shaft speed
#: alone it has no bias. With heading and rate of turn it comes out about 0.7 standard deviations (0.1 s) too large over 12 seeds. A
#: likely reason is the log of one sample a second, which shows the corners of the rudder at whole seconds; it does not explain all.
ENGINE = 0.1
#: Of the sensors: heading, rate of turn, speed, shaft speed; SI.
NOISE = np.array([np.deg2rad(0.2), np.deg2rad(0.02), 0.05, 0.01])


def write_log(path: str, angle: float, seed: int) -> None:
    """Integrate a zig-zag by Euler's rule at 100 Hz and log it at 1 Hz; the engine is ordered down between two samples."""
    p, k = TRUTH, round(1 / STEP)
    n, u, r, psi, delta, plate = 2.5, SPEED, 0.0, 0.0, 0.0, 0.0
    rows = []
    for i in range(DURATION * k + 1):
        t = i * STEP
        order = 2.5 if t < 299.5 else 2.0
        if t >= 30:
            plate = -angle if psi >= angle else angle if psi <= -angle else plate or angle
        if i % k == 0:
            rows.append((t, psi, r, u, n, delta, order))
        delta += np.clip(plate - delta, -np.deg2rad(3) * STEP, np.deg2rad(3) * STEP)
        n, u, r, psi = (
            n + STEP * (order - n) / p["T_n"],
            u + STEP * (p["P"] * n - p["k"] * L * r**2 - u) / p["T_u"],
            r + STEP * u / L * (p["K"] * delta * u / L - r) / p["tau"],
            psi + STEP * r,
        )
    table = np.array(rows)
    table[:, 1:5] += NOISE * np.random.default_rng(seed).standard_normal((len(table), 4))
    shown = table * [1, 180 / np.pi, 180 / np.pi, 1, 60, 180 / np.pi, 60]
    header = "t [s],psi [deg],r [deg/s],u [m/s],n [rpm],delta [deg],n_order [rpm]"
    np.savetxt(path, shown, delimiter=",", header=header, comments="", fmt="%.6g")


def rows(short: bool) -> list[Row]:
    """Do the job in an empty folder."""
    found = []
    Path("ferry.py").write_text(MODEL, encoding="utf-8")
    write_log("twenty.csv", np.deg2rad(20), 1)
    write_log("ten.csv", np.deg2rad(10), 2)

    # What has been declared?
    said = answer("show ferry.py:ferry")
    states = [name for name, one in said["quantities"].items() if one["kind"] == "state"]
    found.append(Row("show: states", "n among them", ", ".join(states), "n" in states))

    # The ship, the log, the coefficients.
    shipid(
        f"ship --new ferry --length '{L:g} m' --speed '{SPEED:g} m/s' --rudder '35 deg' --rudder-rate '3 deg/s' --source 'general "
        "arrangement' -o ferry.toml"
    )
    code = shipid("check twenty.csv ten.csv --ship ferry.toml")
    found.append(Row("check: both logs", "exit code 0", f"exit code {code}", code == 0))
    starts = " --starts 2" if short else ""
    fit = answer(f"identify twenty.csv --model ferry.py:ferry --ship ferry.toml --validate ten.csv --out found{starts}")
    for name, true in TRUTH.items():
        one = fit["parameters"][name]
        within = ENGINE * true if name == "T_n" else 3 * one["std"]
        found.append(close(f"identify: {name}", true, one["value"], within, one["unit"], 3))
    unseen = fit["validation"]["ten"]
    for name, noise in (("psi", NOISE[0]), ("n", NOISE[3])):
        ratio = unseen[name]["rmse"]["value"] / noise
        found.append(
            Row(f"identify: {name} of the other zig-zag, rms over noise", "below 1.3", f"{ratio:.2f}", ratio < 1.3)
        )

    # A Kalman filter with the shaft speed among its sensors.
    sensors = "psi=0.2 deg,r=0.02 deg/s,u=0.05 m/s,n=0.6 rpm"
    run = answer(
        f"filter twenty.csv --model ferry.py:ferry --ship found/ship.toml --measured '{sensors}' --out filtered"
    )
    found.append(Row("filter: sensors", "n among them", ", ".join(run["innovations"]), "n" in run["innovations"]))

    # An autopilot, and a course under it at the revolutions that hold her speed.
    samples = " --samples 20" if short else ""
    revolutions = "--input 'n_order=150 rpm'"
    tuned = answer(
        f"tune ferry.py:ferry --ship found/ship.toml {revolutions} --speeds '5:6:0.5 m/s' --out tuning{samples}"
    )
    margin = min(tuned["margins"]["disk"])
    found.append(Row("tune: least disk margin", "above 0.6", f"{margin:.2f}", margin > 0.6))
    shipid(
        f"simulate ferry.py:ferry --ship found/ship.toml --autopilot tuning/schedule.toml --course '40 deg' {revolutions} -o voyage.csv"
    )
    heading = float(np.degrees(read_trial("voyage.csv")["psi"][-1]))
    found.append(close("simulate: heading under the autopilot", 40.0, heading, 0.5, "deg", 3))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--short", action="store_true", help="fewer starts of the search, fewer draws of the judgement")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    with empty_folder():
        found = rows(chosen.short)
    show(
        "A model with an engine as a state, from its declaration to a course under its autopilot",
        found,
        "",
        chosen.json,
    )


if __name__ == "__main__":
    main()
