#!/usr/bin/env python3
"""Course changes and course keeping under an autopilot, in gusts and in waves: what identification finds of the ship.

python studies/closed_loop.py [--records 4] [--json]

Nomoto's ship (K 0.08 1/s, tau 12 s, 8 m/s) is steered for 1200 s at 1 Hz by an autopilot of heading and rate of turn. Gusts
that last for 120 s turn her with a standard deviation of 0.03 deg/s^2, which is the yaw moment of 4.5 degrees of rudder. The
course is changed every 120 s to and fro by a step, or kept. Heading and rate of turn have noise of 0.3 deg and 0.05 deg/s.

Each record is identified with the defaults: the fit finds that an autopilot steers and takes prediction error. Asked with steps of
10 degrees and more: K and tau within 10 % of the truth in the mean of the records, and in each record within two standard
deviations and 10 %. With steps of 5 degrees the gusts move the rudder as much as the orders, and only the second is asked.
Output error, asked for by name, is shown beside it: rudder and gust are correlated, and its gain is far too small.

In course keeping nothing but the gusts moves the rudder: rudder angle, heading and gust are one signal, and no method tells them
apart. Asked is that the record is named for it (the finding `course-keeping`, which is serious), not that it gives the truth.

In waves the sensors show a yaw that the rudder answers, and that does not turn the ship: the zeefakkel under the autopilot that is
designed for her, with course changes of 20 and 10 degrees. Asked of whitened residuals: K and tau within 10 % in the mean, and in
each record within two standard deviations and 10 %.
"""

from __future__ import annotations

import argparse

import numpy as np
import pandas as pd
from _table import Row, show
from scipy.signal import lfilter

import shipid
from shipid import Component, constant, derived, given
from shipid.generation.simulator import make_simulator
from shipid.models import Nomoto, PlanarMotion, SteeringMachine

TRUTH = {"K": 0.08, "tau": 12.0}
SPEED, DURATION, EVERY = 8.0, 1200.0, 120.0
GUST, LASTS = np.deg2rad(0.03), 120.0
NOISE = {"psi": np.deg2rad(0.3), "r": np.deg2rad(0.05)}
#: Steps of the course in degrees; zero keeps it.
STEPS = (20.0, 10.0, 5.0, 0.0)
#: Waves on a ship whose truth is in her file, course changes in them, and the noise of her sensors.
WAVES = ("0.3 deg from 40 deg", "1 deg from 90 deg", "1 deg from 40 deg")
SHIP, SHE = "zeefakkel", {"K": 0.5, "tau": 31.0}
SHOWN = "psi=0.2 deg,r=0.05 deg/s"
WITHIN = 0.1


class HeadingPilot(Component):
    """An autopilot that steers by heading and rate of turn."""

    delta_order = derived("rad", "rudder angle that is ordered, positive turns to starboard")
    psi = given("rad", "heading, clockwise from north")
    r = given("rad/s", "rate of turn, positive to starboard")
    psi_order = given("rad", "heading that is ordered")
    K_psi = constant("1", "rudder angle per degree off course", default=1.4)
    K_r = constant("s", "rudder angle per rate of turn", default=8.0)

    @delta_order.equals
    def law(self):
        """Proportional and rate feedback (Passenier 1989, section 3.2)."""
        return self.K_psi * (self.psi_order - self.psi) - self.K_r * self.r


def records(step: float, count: int) -> list[shipid.Trial]:
    """Sail the ship under her autopilot, each time in other gusts."""
    whole = shipid.join("steered ship", Nomoto, PlanarMotion, SteeringMachine, HeadingPilot)
    simulator = make_simulator(whole, ("psi", "r", "delta"), hold="zero", compiled=False)
    t = np.arange(0.0, DURATION + 0.5)
    courses = np.deg2rad(step) * (np.floor(t / EVERY) % 2)
    values = {**TRUTH, "delta_max": np.deg2rad(15.0), "delta_rate": np.deg2rad(5.0)}
    made = []
    for seed in range(count):
        rng = np.random.default_rng([9, seed])
        kept = np.exp(-1.0 / LASTS)
        gust = lfilter([np.sqrt(1 - kept**2) * GUST], [1.0, -kept], rng.standard_normal(t.size))
        run = simulator(t, values, {"u": SPEED, "psi_order": courses, "r_disturbance": gust})
        table = {"t": t, "delta": run["delta"]}
        table |= {n: run[n] + d * rng.standard_normal(t.size) for n, d in NOISE.items()}
        units = {"t": "s", "delta": "rad", "psi": "rad", "r": "rad/s"}
        made.append(shipid.Trial.from_frame(pd.DataFrame(table), name=f"steps-{step:g}-{seed}", units=units))
    return made


def is_named(trial: shipid.Trial) -> bool:
    """Whether the doctor says that the course is kept, as a serious finding."""
    return any(f.kind == "course-keeping" and f.serious for f in shipid.check_trial(trial).findings)


def rows_of(step: float, count: int) -> list[Row]:
    """Identify each record with the defaults and by output error; one row a coefficient."""
    trials = records(step, count)
    fits = [shipid.identify("nomoto", [t], starts=2) for t in trials]
    others = [shipid.identify("nomoto", [t], starts=2, method="output-error") for t in trials]
    rows = []
    what = f"course steps of {step:g} deg" if step else "course keeping"
    for name, true in TRUTH.items():
        # A fit that finds that disturbances hide the coefficient gives none.
        told = [(e.value, e.std or np.inf) for f in fits if (e := f.parameters[name]).value is not None]
        found, std = (np.array([pair[k] for pair in told]) / true - (1 - k) for k in (0, 1))
        known = [v for f in others if (v := f.parameters[name].value) is not None]
        plain = f"{np.mean(known) / true - 1:+.0%}" if known else "no value"
        honest = bool(np.all(np.abs(found) <= 2 * std + WITHIN))
        taken = all(f.identified.method == "prediction-error" for f in fits)
        said = f"no value in {count - len(told)} of {count} records" if len(told) < count else ""
        if told:
            said += f"{'; ' if said else ''}{found.mean():+.1%} in the mean, largest {np.abs(found).max():.1%}, stated ± {np.median(std):.1%}"
        if step >= 10:
            asked, holds = "10 %", len(told) == count and abs(found.mean()) <= WITHIN and honest and taken
        elif step:
            asked, holds = "covered", honest and taken
        else:
            asked, holds = "named", taken and all(is_named(t) for t in trials)
        rows.append(Row(f"{what}: {name}", asked, f"{said}; output error {plain}", holds))
    return rows


def rows_in_waves(waves: str, step: float, count: int) -> list[Row]:
    """Identify each record in waves with the defaults and by output error; one row a coefficient."""
    pilot = shipid.design_autopilot("nomoto", SHIP)
    orders = [(f"{20 + 140 * k} s", f"{step:g} deg" if k % 2 == 0 else "0 deg") for k in range(6)]
    how = {"waves": waves, "noise": SHOWN, "duration": "900 s", "sampling": "1 s"}
    trials = [shipid.sail(pilot, orders, **how, seed=seed) for seed in range(count)]
    fits = [shipid.identify("nomoto", [t], ship=SHIP, starts=2) for t in trials]
    others = [shipid.identify("nomoto", [t], ship=SHIP, starts=2, method="output-error") for t in trials]
    rows = []
    for name, true in SHE.items():
        told = [(e.value, e.std or np.inf) for f in fits if (e := f.parameters[name]).value is not None]
        found, std = (np.array([pair[k] for pair in told]) / true - (1 - k) for k in (0, 1))
        known = [v for f in others if (v := f.parameters[name].value) is not None]
        plain = f"{np.mean(known) / true - 1:+.0%}" if known else "no value"
        held = int(np.sum(np.abs(found) <= 1.96 * std))
        said = (
            f"{found.mean():+.1%} in the mean, largest {np.abs(found).max():.1%}, stated ± {np.median(std):.1%}, "
            f"{held} of {len(found)} intervals hold"
        )
        honest = bool(np.all(np.abs(found) <= 2 * std + WITHIN)) and len(told) == count
        what = f"waves of {waves}, course changes of {step:g} deg: {name}"
        rows.append(Row(what, "10 %", f"{said}; output error {plain}", abs(found.mean()) <= WITHIN and honest))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--records", type=int, default=4, help="records for each step")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    chosen = parser.parse_args()
    rows = [row for step in STEPS for row in rows_of(step, chosen.records)]
    rows += [row for waves in WAVES for step in STEPS[:2] for row in rows_in_waves(waves, step, chosen.records)]
    show("Identification of a ship that an autopilot steers in gusts and in waves", rows, "", chosen.json)


if __name__ == "__main__":
    main()
