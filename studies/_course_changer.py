"""The course changer of Passenier (1989), section 6.3.2, in a closed loop: ship, steering machine, waves, wind, filter, reference.

L = 200 m, 19 kn, rudder 2.5 deg/s; 60 degree course changes at a rudder limit of 15 degrees; the reference starts at K*/4 and
tau*/4. The print gives neither the true coefficients nor the tuning: K* = 1.6 and tau* = 1.7 are taken, Kp = 1 and a damping
ratio of 0.85 (thesis, section 3.5), waves of 0.1 deg/s, a reference that follows in 300 s, and the levels of models/yaw_filter.py.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

import shipid
from shipid.autopilot.design.control_law import CourseController, Measured
from shipid.autopilot.on_board.filter_in_loop import estimator_of
from shipid.autopilot.on_board.model_reference import (
    CompensatedCourseController,
    PlacedGains,
    ReferenceModel,
    SelectedFeedback,
)
from shipid.autopilot.on_board.sampled_loop import make_sampled_loop
from shipid.generation.simulator import make_simulator
from shipid.models import CubicYaw, DeKeizer, PlanarMotion, SteeringMachine, VanLeeuwenSway, Waves, Wind
from shipid.parts.helm import DirectRudder

LENGTH, SPEED, T = 200.0, 9.77, 0.4
K, TAU, OMEGA, ZETA = 1.6, 1.7, float(np.sqrt(1.6 / 1.7)), 0.85
LIMIT, CHANGE, EVERY, FIRST, CHANGES = np.deg2rad(15.0), np.deg2rad(60.0), 300.0, 50.0, 7
TRUSTED = 350.0
WAVES, GYRO, COMPASS = np.deg2rad(0.1), np.deg2rad(0.01), np.deg2rad(0.1)
WAVE_FREQUENCY, WAVE_DAMPING = 0.6, 0.15
#: Adaptation runs while a course change does.
MANOEUVRE = 200.0


@dataclass(frozen=True)
class Case:
    """One setting of the loop.

    Attributes
    ----------
    compensating : bool
        Whether the filter's deviations become rudder.
    share : float
        Share of the difference the reference takes over in a second; so large that it is all, it is pure identification.
    wind : float
        True wind in m/s, from the port bow of the first course.
    cubic : float
        Cubic yaw damping of the ship, which the filter does not know.
    known : bool
        Whether the reference is the ship's from the beginning.
    """

    compensating: bool = True
    share: float = 1 / 300.0
    wind: float = 0.0
    cubic: float = 0.0
    known: bool = False


def ship_model() -> shipid.Model:
    """De Keizer's ship with steering machine, wind and waves."""
    return shipid.join("ship", DeKeizer, VanLeeuwenSway, PlanarMotion, SteeringMachine, Wind, Waves)


@functools.cache
def loop_of(case: Case):
    """The closed loop, and the coefficients of ship and autopilot."""
    ship = ship_model()
    pilot = shipid.join("pilot", SelectedFeedback, ReferenceModel, PlacedGains, CompensatedCourseController)
    reference = {"a": K / TAU, "b1": (1.0 if case.known else 4.0) / TAU}
    kalman = shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"),
        values={"L": LENGTH, "wave_time": 3.0},
        measured={"compass": (COMPASS, "rad"), "gyro": (GYRO, "rad/s")},
        start={"a": reference["a"], "b1": reference["b1"]},
        # As the thesis does: waves far stronger than they are, for sensors and states apart.
        noise={"wave_noise": (3 * WAVES, "rad/s")},
        shared_noise=False,
        switchable=True,
        gate=None,
    )
    filter_ = estimator_of(
        kalman,
        shown={"gyro": "r_shown", "compass": "psi_shown", "u": "u_shown"},
        estimates={"b1_hat": "b1", "a_hat": "a", "d_hat": "r_disturbance", "r_hat": "r", "psi_hat": "psi"},
        sample={"psi": 0.0, "r": 0.0, "u": SPEED, "cruise": SPEED},
    )
    loop = make_sampled_loop(
        ship,
        pilot,
        filter_,
        shown={
            "r_shown": ("r", "r_wave", "gyro_noise"),
            "psi_shown": ("psi", "psi_wave", "compass_noise"),
            "u_shown": ("u",),
        },
        outputs=(
            "psi",
            "r",
            "u",
            "delta",
            "delta_order",
            "rudder_extra",
            "a_ref",
            "b1_ref",
            "gain_Kd",
            "rudder_wanted",
        ),
    )
    coefficients = {
        "K": K, "tau": TAU, "alpha1": 1.0, "alpha3": case.cubic, "K_u": 0.9, "tau_u": 2.5, "gamma": 0.573, "L": LENGTH,
        "delta_max": np.deg2rad(35.0), "delta_rate": np.deg2rad(2.5), "N_w": 0.017 / LENGTH**2, "F_w": 0.018 / LENGTH**2,
        "wave_frequency": WAVE_FREQUENCY, "wave_damping": WAVE_DAMPING,
    }  # fmt: skip
    settings = {"L": LENGTH, "omega_star": OMEGA, "damping": ZETA, "rudder_limit": LIMIT, "K_R": case.share}
    return loop, loop.coefficients(coefficients, settings), reference


def run_voyage(case: Case, seed: int) -> dict[str, np.ndarray]:
    """One voyage: seven course changes, to starboard and back."""
    loop, p, reference = loop_of(case)
    count = round((FIRST + CHANGES * EVERY) / T)
    t = T * np.arange(count)
    number = np.clip(np.floor((t - FIRST) / EVERY), -1, CHANGES - 1)
    order = np.where(number % 2 == 0, CHANGE, 0.0)
    since = t - (FIRST + EVERY * number)
    rng = np.random.default_rng(seed)
    intensity = 4 * WAVE_DAMPING * WAVE_FREQUENCY * WAVES**2
    trusted = t >= TRUSTED
    inputs = {
        "cruise": SPEED,
        "psi_order": order,
        "gyro_noise": GYRO * rng.standard_normal(count),
        "compass_noise": COMPASS * rng.standard_normal(count),
        "wave_noise": np.sqrt(intensity / T) * rng.standard_normal(count),
        "wave_direction": np.deg2rad(120.0),
        "wind_speed": case.wind,
        "wind_direction": np.deg2rad(120.0),
        "adapting": ((since <= MANOEUVRE) & (number >= 0)).astype(float),
        "filtered": trusted.astype(float),
        "compensating": trusted * float(case.compensating),
    }
    start = loop.start({"u": SPEED}, {"a_ref": reference["a"], "b1_ref": reference["b1"]})
    return {"t": t, "psi_order": order} | loop(start, inputs, p, T, count)


def predictor():
    """The prediction: the reference at constant speed under its own autopilot, the rudder at once."""
    model = shipid.join("predictor", CubicYaw, PlanarMotion, DirectRudder, Measured, PlacedGains, CourseController)
    return make_simulator(model, ("r", "psi"), hold="zero")


def measured(run: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What each course change comes to: J_r over the distance sailed, overshoot and extra rudder in degrees, K_R*.

    J_r is (6.2) in ship lengths: the ship's rate of turn against the predicted one at the same distance sailed.
    """
    simulator = predictor()
    known = {"b3": 0.0, "L": LENGTH, "omega_star": OMEGA, "damping": ZETA, "rudder_limit": LIMIT}
    steps = round(EVERY / T)
    found: dict[str, list[float]] = {"J_r": [], "overshoot": [], "extra": [], "K_R": []}
    for k in range(CHANGES):
        first = round((FIRST + EVERY * k) / T)
        part = slice(first, first + steps)
        a, b1, order = run["a_ref"][first], run["b1_ref"][first], run["psi_order"][first]
        inputs = {"u": SPEED, "cruise": SPEED, "a_design": a, "b1_design": b1, "psi_order": order}
        start = {n: run[n][first] for n in ("psi", "r")}
        # A loss of speed makes the ship sail its lengths later: the prediction is long enough for either.
        r_p = simulator(T * np.arange(steps), known | {"a": a, "b1": b1}, inputs, start)["r"]
        sailed = np.concatenate([[0.0], np.cumsum(run["u"][part][:-1]) * T / LENGTH])
        predicted = np.interp(sailed, np.arange(steps) * T * SPEED / LENGTH, r_p * LENGTH / SPEED)
        own = run["r"][part] * LENGTH / run["u"][part]
        found["J_r"].append(float(np.trapezoid((own - predicted) ** 2, sailed)))
        side = 1.0 if order > 0 else -1.0
        found["overshoot"].append(float(np.rad2deg(np.max(side * (run["psi"][part] - order)))))
        found["extra"].append(float(np.rad2deg(np.sqrt(np.mean(run["rudder_extra"][part] ** 2)))))
        found["K_R"].append(float(run["a_ref"][first + steps - 1] / run["b1_ref"][first + steps - 1]))
    return {n: np.array(v) for n, v in found.items()}


def over_seeds(case: Case, seeds: int) -> dict[str, np.ndarray]:
    """The same for several voyages, shape (seeds, changes)."""
    runs = [measured(run_voyage(case, s)) for s in range(seeds)]
    return {n: np.array([r[n] for r in runs]) for n in runs[0]}
