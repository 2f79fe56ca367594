"""The Kalman filter in a loop: it is the filter that runs on the record of that loop, to rounding."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.autopilot.design.control_law import CourseController
from shipid.autopilot.on_board.filter_in_loop import estimator_of
from shipid.autopilot.on_board.model_reference import PlacedGains
from shipid.autopilot.on_board.sampled_loop import make_sampled_loop
from shipid.foundation.errors import UsageError
from shipid.models import DeKeizer, PlanarMotion, SteeringMachine, VanLeeuwenSway, Waves

T, SPEED, LENGTH = 0.4, 9.5, 226.0
ESTIMATES = {"a_design": "a", "b1_design": "b1", "r_seen": "r", "psi_seen": "psi", "d_seen": "r_disturbance"}


@pytest.fixture(scope="module")
def kalman() -> shipid.ExtendedKalmanFilter:
    return shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"),
        values={"L": LENGTH},
        measured={"compass": "0.1 deg", "gyro": "0.01 deg/s"},
        start={"a": 0.9, "b1": 0.6},
        switchable=True,
    )


def loop_and_run(kalman: shipid.ExtendedKalmanFilter):
    ship = shipid.join("ship", DeKeizer, VanLeeuwenSway, PlanarMotion, SteeringMachine, Waves)
    pilot = shipid.join("pilot", PlacedGains, CourseController)
    shown = {"gyro": "r_shown", "compass": "psi_shown", "u": "u_shown"}
    wanted = {n: s for n, s in ESTIMATES.items() if n in (*pilot.inputs, "d_seen")}
    estimator = estimator_of(kalman, shown, wanted, {"psi": 0.0, "r": 0.0, "u": SPEED, "cruise": SPEED})
    loop = make_sampled_loop(
        ship,
        pilot,
        estimator,
        shown={
            "r_shown": ("r", "r_wave", "gyro_noise"),
            "psi_shown": ("psi", "psi_wave"),
            "u_shown": ("u",),
            "speed_seen": ("u",),
        },
        outputs=("psi", "r", "u", "delta"),
    )
    count = 600
    rng = np.random.default_rng(0)
    coefficients = {"K": 1.6, "tau": 1.7, "alpha1": 1.0, "alpha3": 0.0, "K_u": 0.9, "tau_u": 2.5, "gamma": 0.573,
                    "L": LENGTH, "delta_max": 0.6, "delta_rate": 0.0436}  # fmt: skip
    p = loop.coefficients(coefficients, {"L": LENGTH, "omega_star": 0.9, "damping": 0.9, "rudder_limit": 0.26})
    inputs = {
        "cruise": SPEED,
        "psi_order": np.where(np.arange(count) > 50, 0.5, 0.0),
        "gyro_noise": 2e-4 * rng.standard_normal(count),
        "wave_noise": 1e-3 * rng.standard_normal(count),
        "adapting": (np.arange(count) > 100).astype(float),
    }
    inputs = {n: v for n, v in inputs.items() if n in loop.inputs}
    return wanted, inputs, loop(loop.start({"u": SPEED}), inputs, p, T, count)


def test_the_filter_in_the_loop_is_the_filter_on_its_record(kalman):
    wanted, inputs, run = loop_and_run(kalman)
    assert len(wanted) >= 4
    # The loop's first sample comes a step after its start: a row before it, in which no instrument shows anything.
    t = T * np.arange(-1, run["psi"].size)
    record = {
        "t": t,
        "gyro": np.append(np.nan, run["r_shown"]),
        "compass": np.append(np.nan, run["psi_shown"]),
        "u": np.append(SPEED, run["u_shown"]),
        "delta": np.append(0.0, run["delta"]),
        "cruise": np.full(t.size, SPEED),
    }
    again = shipid.ExtendedKalmanFilter(
        shipid.find_model("yaw-filter"),
        values={"L": LENGTH},
        measured={"compass": "0.1 deg", "gyro": "0.01 deg/s"},
        start={"a": 0.9, "b1": 0.6, "psi": "0 rad", "r": "0 rad/s"},
        switchable=True,
    )
    filtered = again.filter(record, adapt=np.append(True, inputs["adapting"] > 0))
    for name, state in wanted.items():
        np.testing.assert_allclose(run[name], filtered[state][1:], rtol=1e-9, atol=1e-12)


def test_parameters_stand_still_while_they_do_not_adapt(kalman):
    _, _, run = loop_and_run(kalman)
    held = run["a_design"][:100]
    assert (held == held[0]).all()
    assert run["a_design"][-1] != held[0]


def test_an_estimate_the_filter_does_not_make(kalman):
    with pytest.raises(
        UsageError, match=r"'q_hat' is to be 'q', which the filter of model yaw-filter does not estimate"
    ):
        estimator_of(kalman, {}, {"q_hat": "q"}, {"psi": 0.0})
