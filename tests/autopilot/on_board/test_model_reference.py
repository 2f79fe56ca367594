"""Model reference and indirect adaptation against their formulas, and the loop with an estimator in it."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import shipid
from shipid.autopilot.design.control_law import CourseController
from shipid.autopilot.on_board.model_reference import (
    CompensatedCourseController,
    IndirectAdaptation,
    PlacedGains,
    ReferenceModel,
    SelectedFeedback,
)
from shipid.autopilot.on_board.sampled_loop import Estimator, make_sampled_loop
from shipid.declaration.model import Evaluation
from shipid.foundation.errors import DeclarationError, UnknownNameError
from shipid.generation.simulator import UnstatedInputError
from shipid.models import CubicYaw, PlanarMotion, SteeringMachine, VanLeeuwenSway
from shipid.parts.helm import DirectRudder

L, U, T = 200.0, 9.77, 0.4
K, TAU = 1.6, 1.7
PILOT = shipid.join("pilot", SelectedFeedback, ReferenceModel, PlacedGains, CompensatedCourseController)


def evaluated(model: shipid.Model, **values: float) -> Evaluation:
    """The equations over plain floats, defaults for what is not given."""
    known = {n: model[n].number("default") for n in model.inputs + model.constants} | {"T_s": T, "L": L} | values
    return Evaluation(model, {n: v for n, v in known.items() if v is not None})


def test_the_compensated_ship_is_the_reference():
    """Passenier (1989), (5.87)-(5.90): the rudder of the ship, with the differences put back, is that of the reference."""
    rng = np.random.default_rng(3)
    model = shipid.join("m", ReferenceModel, CompensatedCourseController)
    for _ in range(200):
        known = dict(zip(("a_hat", "b1_hat", "a_ref", "b1_ref"), rng.uniform(0.1, 5.0, 4)))
        known |= {"d_hat": rng.normal() * 1e-4, "r_seen": rng.normal() * 0.02, "speed_seen": U, "psi_seen": 0.0}
        known |= {"psi_order": rng.normal(), "gain_Kp": 1.0, "gain_Kd": 15.0, "compensating": 1.0}
        at = evaluated(model, **known)
        ordered = at["delta_order"]
        delta = float(np.clip(at["rudder_wanted"], -np.deg2rad(15), np.deg2rad(15)))
        a, b = (
            (1 - T * U / L * known[n] for n in ("b1_hat", "b1_ref")),
            (T * (U / L) ** 2 * known[n] for n in ("a_hat", "a_ref")),
        )
        (a_s, a_R), (b_s, b_R) = a, b
        shown = ordered + (a_s - a_R) / b_R * known["r_seen"] + (b_s - b_R) / b_R * ordered + T * known["d_hat"] / b_R
        assert abs(shown - delta) < 1e-12 * max(1.0, abs(ordered) * b_s / b_R)
        # The ship's next rate of turn is the reference's: (5.81) with the compensated rudder is (5.86).
        ship = a_s * known["r_seen"] + b_s * ordered + T * known["d_hat"]
        assert ship == pytest.approx(a_R * known["r_seen"] + b_R * delta, rel=1e-12, abs=1e-15)


def test_without_compensation_the_rudder_is_the_laws():
    model = shipid.join("m", ReferenceModel, CompensatedCourseController)
    at = evaluated(
        model, a_hat=2.0, b1_hat=1.0, a_ref=1.0, b1_ref=3.0, r_seen=0.01, speed_seen=U, psi_seen=0.0, psi_order=0.1,
        gain_Kp=1.0, gain_Kd=5.0, compensating=0.0,
    )  # fmt: skip
    assert at["delta_order"] == pytest.approx(0.1 - 0.05)


def test_gains_of_the_reference_place_its_poles():
    """(5.79)-(5.80) in K* and tau*; a badly chosen reference of K*/4, tau*/4 would push the ship on, and is clipped at nought."""
    placed = shipid.join("gains", PlacedGains)
    omega, zeta = 0.97, 0.85
    for K_R, tau_R in ((K, TAU), (K / 4, TAU / 4)):
        at = evaluated(placed, a_design=K_R / tau_R, b1_design=1 / tau_R, speed_seen=U, omega_star=omega, damping=zeta)
        kp = (omega * U / L) ** 2 * tau_R / K_R * (L / U) ** 2
        kd = L / U * (2 * zeta * np.sqrt(kp * K_R * tau_R) - 1) / K_R
        assert at["gain_Kp"] == pytest.approx(kp)
        assert at["gain_Kd"] == pytest.approx(max(kd, 0.0))
    assert kd == pytest.approx(-15.3, abs=0.2)  # the notes' number, with Kp = 0.94 in place of 1


def test_indirect_adaptation_takes_the_estimates():
    model = shipid.join("m", IndirectAdaptation, PlacedGains, CourseController)
    at = evaluated(model, a_hat=0.9, b1_hat=0.6, r_seen=0.0, speed_seen=U, psi_seen=0.0, psi_order=0.1)
    same = evaluated(shipid.join("g", PlacedGains), a_design=0.9, b1_design=0.6, speed_seen=U)
    assert at["gain_Kd"] == same["gain_Kd"] and at["gain_Kp"] == same["gain_Kp"]
    assert at["delta_order"] == pytest.approx(same["gain_Kp"] * 0.1)


@pytest.mark.parametrize(("share", "expected"), [(0.0, 1.0), (1e9, 2.0), (0.25, 1.0 + 0.25 * T)])
def test_the_reference_follows(share, expected):
    """(5.91)-(5.93): K_R = 0 keeps it, a K_R that takes all in a sample makes it the estimate."""
    model = shipid.join("m", ReferenceModel, CourseController)
    known = dict(a_hat=2.0, b1_hat=2.0, a_ref=1.0, b1_ref=1.0, r_seen=0.0, speed_seen=U, psi_seen=0.0, psi_order=0.0)
    at = evaluated(model, K_R=share, gain_Kp=1.0, gain_Kd=1.0, **known)
    assert at.right_hand_sides("next") == pytest.approx({"a_ref": expected, "b1_ref": expected})
    still = evaluated(model, K_R=share, gain_Kp=1.0, gain_Kd=1.0, adapting=0.0, **known)
    assert still.right_hand_sides("next") == pytest.approx({"a_ref": 1.0, "b1_ref": 1.0})


def truth(a: float, b1: float) -> Estimator:
    """An estimator that knows the ship and sees what it does."""

    def advance(carried, shown, interval):
        return carried + interval, {
            "a_hat": ca.SX(a), "b1_hat": ca.SX(b1), "d_hat": ca.SX(0), "r_hat": shown["r"], "psi_hat": shown["psi"],
        }  # fmt: skip

    return Estimator(np.zeros(1), advance)


SHIP = shipid.join("ship", CubicYaw, PlanarMotion, SteeringMachine)
SHOWN = {"r_shown": ("r", "gyro_noise"), "psi_shown": ("psi",), "u_shown": ("u",)}
SHIP_VALUES = {"a": K / TAU, "b1": 1 / TAU, "b3": 0.0, "L": L, "delta_max": 0.6, "delta_rate": 10.0, "tau_delta": 0.05}


@pytest.fixture(scope="module")
def loop():
    return make_sampled_loop(
        SHIP,
        PILOT,
        truth(K / TAU, 1 / TAU),
        shown=SHOWN,
        outputs=("psi", "r", "delta", "rudder_extra", "a_ref"),
        substeps=16,
    )


def test_a_compensated_ship_runs_as_its_reference(loop):
    """The truth for an estimate and a quick rudder: a ship of K*, tau* answers as its reference of K*/4, tau*/4 does.

    The reference is simulated by Euler's rule, which is its own sampled form.
    """
    settings = {"L": L, "K_R": 0.0, "omega_star": 0.97, "damping": 0.85, "rudder_limit": np.deg2rad(15)}
    p = loop.coefficients(SHIP_VALUES, settings)
    start = loop.start({}, {"a_ref": K / TAU, "b1_ref": 4 / TAU})
    run = loop(start, {"u": U, "cruise": U, "psi_order": 0.5, "filtered": 1.0, "compensating": 1.0}, p, T, 1000)
    psi, r, expected = 0.0, 0.0, []
    pace, kp = U / L, 0.97**2 / (K / TAU)
    for _ in range(1000):
        expected.append(psi)
        delta = float(np.clip(kp * (0.5 - psi), -np.deg2rad(15), np.deg2rad(15)))  # Kd is clipped at nought
        rate = -pace * 4 / TAU * r + pace**2 * K / TAU * delta
        psi, r = psi + T * r, r + T * rate
    # The rudder takes a tenth of a second, and the ship moves between the samples.
    assert np.abs(run["psi"] - expected).max() < 0.02
    free = loop(start, {"u": U, "cruise": U, "psi_order": 0.5, "filtered": 1.0, "compensating": 0.0}, p, T, 1000)
    assert np.abs(free["psi"] - expected).max() > 0.15


def test_the_autopilot_sees_what_it_is_switched_to(loop):
    settings = {"L": L, "K_R": 0.0, "omega_star": 0.97, "damping": 0.85}
    p = loop.coefficients(SHIP_VALUES, settings)
    start = loop.start({}, {"a_ref": K / TAU, "b1_ref": 1 / TAU})
    noise = 0.01 * np.random.default_rng(0).standard_normal(200)
    given = {"u": U, "cruise": U, "psi_order": 0.0, "gyro_noise": noise}
    raw, clean = (loop(start, given | {"filtered": f}, p, T, 200) for f in (0.0, 1.0))
    assert np.abs(raw["delta"]).max() > 1e-3 and np.abs(clean["delta"]).max() == 0.0
    np.testing.assert_allclose(raw["r_shown"], raw["r"] + noise, atol=1e-15)


def test_loops_that_are_none(loop):
    p = loop.coefficients(SHIP_VALUES, {"L": L})
    with pytest.raises(UnknownNameError, match="input of the loop called 'sail'"):
        loop(loop.start(), {"sail": 1.0}, p, T, 3)
    with pytest.raises(DeclarationError, match="has to state 'delta_order'"):
        make_sampled_loop(SHIP, shipid.join("p", PlacedGains), truth(1, 1), shown=SHOWN)
    with pytest.raises(UnstatedInputError, match="reads 'psi_order'"):
        loop(loop.start(), {"u": U, "cruise": U}, p, T, 3)
    with pytest.raises(UnknownNameError, match="quantity of the loop called 'sail'"):
        make_sampled_loop(SHIP, PILOT, truth(1, 1), shown=SHOWN, outputs=("sail",))
    at_once = shipid.join("ship", CubicYaw, PlanarMotion, VanLeeuwenSway, DirectRudder)
    with pytest.raises(DeclarationError, match="follows the rudder order at once"):
        make_sampled_loop(at_once, PILOT, truth(1, 1), shown=SHOWN, outputs=("delta",))
