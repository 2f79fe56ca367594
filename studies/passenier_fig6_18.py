"""Passenier (1989), section 3.3.2.2 and figure 6.18, claim P2: in closed loop the track is that of any speed if K_d goes by L/u.

python studies/passenier_fig6_18.py [--json]
"""

from __future__ import annotations

import dataclasses

import numpy as np
from _claims import FAILS, UNDER_A_READING, Claim, options, show
from _container import container_ship

import shipid
from shipid.autopilot.course_changes.run_course_changes import run_course_changes
from shipid.autopilot.design.autopilot import Autopilot
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of
from shipid.autopilot.design.schedule import Schedule
from shipid.generation.simulator import make_simulator
from shipid.parameters.parameter_set import Value

CONTAINER, ZEEFAKKEL = 9.5, 4.63
SCALES, BOTH = (0.5, 2.0), "half and double speed"
STEP, LENGTHS = 0.01, 25.0
READING = (
    "Reading: Kp = 1 and a damping ratio of 0.85; the Zeefakkel of section 3.5 at 9 kn with the effective K* = 1.2, tau* = 0.9 "
    "(assumed), course changes of 120 degrees at rudder limits of 10, 20 and 30 degrees, and the container ship of figure 6.18, 90 "
    "degrees at 15 degrees. Rudder at once and no loss of speed, as the theorem has it, where nothing else is said; the schedule is "
    "straight between speeds a twentieth apart. The 0.18 L without a schedule is that of half the speed at 20 degrees of rudder."
)


def ship(name: str, loss: float | None) -> shipid.ParameterSet:
    """A ship of the thesis; without loss of speed where it is given as nought."""
    found = container_ship() if name == "soesterberg" else shipid.find_ship(name)
    if loss is None:
        return found
    section = dict(found.sections["van-leeuwen"]) | {"K_u": Value("K_u", loss, "1", "assumed")}
    return dataclasses.replace(found, sections={**found.sections, "van-leeuwen": section})


def pilot_of(
    name: str, speed: float, limit: float, loss: float | None = 1e-12, machine: str | None = None
) -> Autopilot:
    """Kp = 1: the natural frequency is sqrt(K*/tau*) u/L."""
    found = ship(name, loss)
    known = found.values(shipid.find_model("van-leeuwen"), speed=speed)
    omega = float(np.sqrt(known["K"] / known["tau"])) * speed / known["L"]
    speeds = speed * np.geomspace(0.4, 2.2, 40)
    made = shipid.design_autopilot(
        "van-leeuwen", found, actuator=machine, speeds=speeds, omega_n=omega * found.particular("speed", "m/s") / speed,
        design="pole", damping=0.85, rudder_limit=f"{limit} deg",
    )  # fmt: skip
    return made


def track(pilot: Autopilot, speed: float, change: float) -> np.ndarray:
    """East and north in ship lengths against the distance sailed, shape (2, n)."""
    model, length = closed_loop(pilot), pilot.length
    simulator = make_simulator(model, ("x", "y", "s_star"), hold="zero")
    t = STEP * length / speed * np.arange(round(LENGTHS / STEP))
    run = simulator(t, coefficients_of(pilot, model, speed), {"cruise": speed, "psi_order": change})
    x, y, s = (run[n] for n in ("x", "y", "s_star"))
    grid = np.linspace(0, 0.9 * LENGTHS * (1 if s[-1] > 0.9 * LENGTHS else s[-1] / LENGTHS), 500)
    return np.array([np.interp(grid, s, y) / length, np.interp(grid, s, x) / length])


def deviation(pilot: Autopilot, speed: float, change: float, scales: tuple[float, ...] = SCALES) -> float:
    """Largest distance, at the same distance sailed, between the tracks at other speeds and the one at the speed."""
    own = track(pilot, speed, change)
    found = []
    for scale in scales:
        other = track(pilot, scale * speed, change)
        shortest = min(own.shape[1], other.shape[1])
        found.append(float(np.hypot(*(other[:, :shortest] - own[:, :shortest])).max()))
    return max(found)


def unscheduled(pilot: Autopilot, speed: float) -> Autopilot:
    """The same with the gains of one speed at every speed."""
    found = pilot.schedule.at(speed)
    gains = {n: np.array([[v]]) for n, v in found.items()}
    return pilot.with_schedule(Schedule(np.array([speed]), gains))


def row(
    what: str, asked: str, ours: str, spread: str, good: bool, reading: str = READING, promised: bool = True
) -> Claim:
    return Claim(f"P2 {what}", asked, ours, spread, UNDER_A_READING if good else FAILS, reading, promised)


def main() -> None:
    title = "Section 3.3.2.2 and figure 6.18: track correspondence in closed loop under gain scheduling"
    chosen = options(title)
    rows, half, double = [], [], []
    turn, quarter = np.deg2rad(120), np.deg2rad(90)
    for limit in (10, 20, 30):
        pilot = pilot_of("zeefakkel", ZEEFAKKEL, limit)
        off = deviation(pilot, ZEEFAKKEL, turn)
        rows.append(
            row(f"120 deg, limit {limit} deg, K_d scheduled", "0.002 L at most", f"{off:.5f} L", BOTH, off < 0.002)
        )
        plain = unscheduled(pilot, ZEEFAKKEL)
        half.append(deviation(plain, ZEEFAKKEL, turn, (0.5,)))
        double.append(deviation(plain, ZEEFAKKEL, turn, (2.0,)))
    wide = f"{half[0]:.2f} to {half[2]:.2f} L over the limits; double the speed {double[0]:.2f} to {double[2]:.2f} L"
    rows.append(row("120 deg, K_d of one speed", "about 0.18 L", f"{half[1]:.3f} L", wide, 0.15 < half[1] < 0.21))
    container = pilot_of("soesterberg", CONTAINER, 15)
    off = deviation(container, CONTAINER, quarter)
    rows.append(row("90 deg, container, K_d scheduled", "0.002 L at most", f"{off:.5f} L", BOTH, off < 0.002))
    plain = deviation(unscheduled(container, CONTAINER), CONTAINER, quarter)
    rows.append(row("90 deg, container, K_d of one speed", "far more", f"{plain:.2f} L", BOTH, plain > 0.1))
    lossy = deviation(pilot_of("soesterberg", CONTAINER, 15, None), CONTAINER, quarter)
    rows.append(row("the same, the ship loses speed", "0.002 L at most", f"{lossy:.5f} L", BOTH, lossy < 0.002))
    steered = pilot_of("soesterberg", CONTAINER, 15, None, "SteeringMachine")
    slow = deviation(steered, CONTAINER, quarter)
    share = "The steering machine counts in seconds, not in ship lengths: what is left behind it is its share."
    rows.append(row("the same behind 2.5 deg/s of rudder", "no theorem", f"{slow:.3f} L", BOTH, True, share, False))
    # Figure 6.18: +90 and -90 degrees at 15 degrees of rudder.
    run = run_course_changes(steered, [CONTAINER] * 2, [quarter, -quarter])
    over = np.rad2deg(run.overshoot)
    rows.append(
        row(
            "fig. 6.18, +90 and -90 deg: overshoot",
            "well adjusted",
            f"{over.max():.2f} deg",
            "both sides",
            over.max() < 1.0,
        )
    )
    show(title, rows, chosen.json)


if __name__ == "__main__":
    main()
