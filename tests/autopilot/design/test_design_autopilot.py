"""Designs against closed forms and python-control: poles, gains, schedules, and the closed loop as a model."""

from __future__ import annotations

import pickle
import re
from dataclasses import replace

import control
import numpy as np
import pytest

import shipid
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, linear_ship, poles_at, to_control
from shipid.autopilot.design.placement import Gains, closed_poles, closed_polynomial, lqr_gains, place, pole_pair
from shipid.autopilot.design.plant import linear_plant, transfer
from shipid.generation.system import generate

SHIPS = [
    ("de-keizer", "soesterberg"),
    ("van-leeuwen", "soesterberg"),
    ("gain-scheduled", "zeefakkel"),
    ("nomoto", "zeefakkel"),
    ("norrbin", "kvlcc2"),
    ("bech", "kvlcc2"),
    ("cross-flow", "kvlcc2"),
    ("de-keizer-lag", "gunnerus"),
    ("bech-surge", "kvlcc2-7m"),
    ("nomoto", "esso-osaka-3m"),
    ("davidson-schiff", "mariner"),
    ("nomoto-second-order", "mariner"),
]


@pytest.mark.parametrize(("model", "ship"), SHIPS)
def test_poles_are_those_asked_for(model, ship):
    """At every speed of the schedule, of ships of every order: relative to 1e-12."""
    pilot = shipid.design_autopilot(model, ship, omega_n=None, damping=0.8)
    for speed in pilot.speeds:
        asked = np.roots(pole_pair(pilot.request["omega_n"] * speed / pilot.service_speed, 0.8))
        found = poles_at(pilot, float(speed))
        assert (np.abs(found[:, None] - asked[None, :]).min(axis=0) <= 1e-12 * np.abs(asked)).all()


@pytest.mark.parametrize(("model", "ship"), SHIPS[::3])
def test_three_poles_with_an_integral(model, ship):
    pilot = shipid.design_autopilot(model, ship, design="pid", damping=0.8, integral=0.2)
    for speed in pilot.speeds:
        omega = pilot.request["omega_n"] * speed / pilot.service_speed
        asked = np.append(np.roots(pole_pair(omega, 0.8)), -0.2 * omega)
        found = poles_at(pilot, float(speed))
        assert (np.abs(found[:, None] - asked[None, :]).min(axis=0) <= 1e-11 * np.abs(asked)).all()


@pytest.mark.parametrize("damping", [0.5, 0.9, 1.0, 2.0])
def test_closed_form_of_the_thesis(damping):
    """Passenier (1989), eq. (5.79)-(5.80), with omega_n scaled by u/L."""
    L, U0, K, tau, omega = 226.0, 9.5, 1.6, 1.7, 0.05
    pilot = shipid.design_autopilot(
        "de-keizer", "soesterberg", design="pole", omega_n="0.05 rad/s", damping=damping, speeds="4:12:1 m/s"
    )
    for i, u in enumerate(pilot.speeds):
        kp = (omega * u / U0) ** 2 * tau / K * (L / u) ** 2
        kd = L / u * (2 * damping * np.sqrt(kp * K * tau) - 1) / K
        assert pilot.schedule.gains["Kp"][0, i] == pytest.approx(kp, rel=1e-12)
        assert pilot.schedule.gains["Kd"][0, i] == pytest.approx(kd, rel=1e-12)


def test_gains_equal_controls_placement(container):
    for i, speed in enumerate(container.speeds):
        plant = linear_ship(container, [speed]).at(0)
        gains = control.place(plant.A, plant.B[:, None], poles_at(container, float(speed))).ravel()
        ours = [container.schedule.gains["Kp" if s == "psi" else "Kd"][0, i] for s in plant.states]
        np.testing.assert_allclose(ours, gains, rtol=1e-9)  # its rank-one updates leave that much


def test_gains_equal_controls_lqr():
    """Of a ship of first order, heading and rate are all there is; the cost is psi^2 + 2 delta^2, so Kp = 1/sqrt(2)."""
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", design="lqr", rudder_weight=2.0, speeds=[6.0, 9.5])
    for i, speed in enumerate(pilot.speeds):
        plant = linear_ship(pilot, [speed]).at(0)
        heading = np.array([[1.0 if s == "psi" else 0.0 for s in plant.states]])
        feedback, _, _ = control.lqr(plant.A, plant.B[:, None], heading.T @ heading, [[2.0]])
        ours = [pilot.schedule.gains["Kp" if s == "psi" else "Kd"][0, i] for s in plant.states]
        np.testing.assert_allclose(ours, feedback.ravel(), rtol=1e-8)
    np.testing.assert_allclose(pilot.schedule.gains["Kp"], np.sqrt(0.5), rtol=1e-8)


def test_lqr_of_a_ship_of_higher_order_costs_least():
    """A change of either gain by a hundredth, up or down, costs more: the integral of psi^2 + delta^2, simulated."""
    plant = linear_ship(shipid.design_autopilot("bech", "kvlcc2", speeds=[7.97]), [7.97]).at(0)
    best = lqr_gains(plant, 1.0, 7.97 / 320)

    def cost(gains: Gains) -> float:
        feedback = np.array([gains.Kp, gains.Kd]) @ plant.C
        closed = plant.A - np.outer(plant.B, feedback)
        start = np.array([1.0 if s == "psi" else 0.0 for s in plant.states])
        weight = np.outer(plant.C[0], plant.C[0]) + np.outer(feedback, feedback)
        return float(start @ control.lyap(closed.T, weight) @ start)

    least = cost(best)
    for kp, kd in ((1.01, 1), (0.99, 1), (1, 1.01), (1, 0.99)):
        assert cost(Gains(best.Kp * kp, best.Kd * kd)) > least


def test_transfer_equals_controls():
    """Numerators and denominator of a random system of four states, two outputs."""
    rng = np.random.default_rng(1)
    A, B, C = rng.normal(size=(4, 4)), rng.normal(size=4), rng.normal(size=(2, 4))
    denominator, numerators = transfer(A, B, C)
    s = np.array([0.3j, 1.0 + 2.0j])
    response = control.ss(A, B[:, None], C, np.zeros((2, 1)))(s)[:, 0]
    ours = [[np.polyval(n, v) / np.polyval(denominator, v) for v in s] for n in numerators]
    np.testing.assert_allclose(ours, response, rtol=1e-12)


def test_poles_between_the_speeds_stay_with_those_asked_for():
    """A coarse schedule is refined until they do; at 40 speeds between, within the 5 % it promises and a little."""
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", speeds=[3.0, 12.0])
    assert len(pilot.speeds) > 2 and {3.0, 12.0} <= set(pilot.speeds)
    for speed in np.linspace(3, 12, 40):
        asked = np.roots(pole_pair(pilot.request["omega_n"] * speed / pilot.service_speed, 0.9))
        found = poles_at(pilot, float(speed))
        assert (np.abs(found[:, None] - asked[None, :]).min(axis=0) <= 0.055 * np.abs(asked)).all()


def test_the_schedule_is_clamped_and_linear(container):
    gains = container.schedule.gains
    for name in ("Kp", "Kd"):
        assert getattr(container.gains(0.1), name) == gains[name][0, 0]
        assert getattr(container.gains(99.0), name) == gains[name][0, -1]
        half = 0.5 * (container.speeds[2] + container.speeds[3])
        assert getattr(container.gains(half), name) == pytest.approx(gains[name][0, 2:4].mean())


def test_the_declared_schedule_equals_the_table(container):
    """The expression that is simulated and emitted, on a grid that runs beyond both ends."""
    system = generate(closed_loop(container))
    p = system.vector(system.coefficients, coefficients_of(container, closed_loop(container), 9.5))
    function = system.function(["gain_Kp", "gain_Kd"])
    x, u = np.zeros(len(system.states)), np.zeros(len(system.inputs))
    for speed in np.linspace(1, 15, 29):
        x[system.states.index("u")] = speed
        found = function(x, u, p).full().ravel()
        expected = container.schedule.at(speed)
        np.testing.assert_allclose(found, [expected["Kp"], expected["Kd"]], rtol=1e-13)


def test_the_closed_loop_is_a_model_like_any_other(container):
    """It linearises to the poles of the design, beside that of the servo, and simulates through python-control."""
    slow = to_control(container, 9.5).poles()
    assert len(slow) == 3
    fast = to_control(shipid.design_autopilot("de-keizer", "soesterberg", design="pole", actuator=None), 9.5).poles()
    np.testing.assert_allclose(np.sort_complex(fast), np.sort_complex(poles_at(container, 9.5)), rtol=1e-12)
    loop = to_control(container, 9.5, nonlinear=True)
    order = np.zeros((len(loop.input_labels), 2))
    order[loop.input_index["cruise"]], order[loop.input_index["psi_order"]] = 9.5, 0.2
    start = [9.5 if s == "u" else 0.0 for s in loop.state_labels]
    answer = control.input_output_response(loop, [0.0, 600.0], order, start)
    assert answer.outputs[0, -1] == pytest.approx(0.2, abs=1e-4)
    assert "psi_order" in closed_loop(container).inputs
    assert shipid.typeset(closed_loop(container))


def test_load_conditions(sized):
    """Two ships; at either end each has its own poles, and half way the gains are in the middle."""
    light = sized("soesterberg", "de-keizer", K=2.2)
    pilot = shipid.design_autopilot("de-keizer", [shipid.find_ship("soesterberg"), light], speeds=[8.0, 9.5])
    alone = shipid.design_autopilot("de-keizer", light, speeds=[8.0, 9.5], omega_n=pilot.request["omega_n"])
    np.testing.assert_allclose(pilot.schedule.gains["Kp"][1], alone.schedule.gains["Kp"][0])
    system = generate(closed_loop(pilot))
    p = system.vector(system.coefficients, coefficients_of(pilot, closed_loop(pilot), 9.5))
    x, u = np.zeros(len(system.states)), np.zeros(len(system.inputs))
    x[system.states.index("u")] = 9.5
    found = []
    for load in (-1.0, 0.0, 0.5, 1.0, 3.0):
        u[system.inputs.index("loading")] = load
        found.append(float(system.function(["gain_Kp"])(x, u, p)))
    a, b = pilot.schedule.gains["Kp"][:, -1]
    np.testing.assert_allclose(found, [a, a, 0.5 * (a + b), b, b])
    assert pilot.to_dict()["conditions"].keys() == {"soesterberg"}  # both sets bear one name


def test_a_table_against_speed_is_followed():
    """The Zeefakkel's K and tau are tabulated: at 6 m/s they are those of the table and not scaled."""
    pilot = shipid.design_autopilot("nomoto", "zeefakkel", design="pole", speeds=[5.0, 6.0])
    K, tau = np.interp(6.0, [5.0, 6.2], [0.50, 0.83]), np.interp(6.0, [5.0, 6.2], [31.0, 43.0])
    np.testing.assert_allclose(np.sort(np.linalg.eigvals(linear_ship(pilot, [6.0]).A[0])), [-1 / tau, 0], atol=1e-15)
    assert pilot.schedule.gains["Kp"][0, -1] == pytest.approx((pilot.request["omega_n"] * 1.2) ** 2 * tau / K)


def test_a_course_unstable_ship_is_told_with_its_time_constant(sized):
    """Nomoto's ship with K and tau below zero grows as exp(t/|tau|): 50 s at its own 9.5 m/s, by u/L half of 100 s at 4.75."""
    ship = sized("soesterberg", "nomoto", K=-0.05, tau=-50.0)
    pilot = shipid.design_autopilot("nomoto", ship, speeds=[4.75, 9.5])
    assert any(
        w.startswith("course-unstable") and "leaves its course with a time constant of 50 s at 9.5 m/s" in w
        for w in pilot.warnings
    )


@pytest.mark.parametrize(("speeds", "outside"), [([2.5, 6.1], False), ([1.6, 6.0], True), ([5.5, 7.5], True)])
def test_speeds_beyond_the_trials_are_told(speeds, outside):
    """The Zeefakkel's table runs from 2 to 6.2 m/s."""
    warnings = shipid.design_autopilot("nomoto", "zeefakkel", speeds=speeds).warnings
    assert any("The schedule runs from" in w for w in warnings) == outside


def test_a_result_says_what_it_is(container, integral):
    assert container.to_frame().shape == (8, 3)
    found = integral.to_dict()
    assert set(found["gains"]) == {"Kp", "Kd", "Ki"}
    assert len(found["poles"]["value"]) == len(found["speeds"]["value"]) and len(found["poles"]["value"][0]) == 3
    assert "autopilot of soesterberg (de-keizer), pid" in integral.text()
    # Wide enough for a power of ten: the columns ran into each other.
    small = replace(integral.schedule, gains={n: g * 1e-8 for n, g in integral.schedule.gains.items()})
    rows = replace(integral, schedule=small).text().splitlines()[2 : 2 + len(integral.speeds)]
    assert all(len(re.findall(r"(?<=\s)\S+ × 10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+(?!\S)", row)) == 3 for row in rows)
    assert pickle.loads(pickle.dumps(container)).to_dict() == container.to_dict()


def test_remainder_at_extreme_scales():
    """A frequency a thousand times slower than the ship's own: the pair is still there to 1e-9."""
    plant = linear_plant(
        shipid.find_model("nomoto"), np.array([9.5]), np.array([[0.0672566], [40.4421]])
    ).at(0)  # fmt: skip
    gains = place(plant, pole_pair(1e-6, 0.9))
    assert np.abs(closed_polynomial(plant, gains)[-2:] * 40.4421 / pole_pair(1e-6, 0.9)[-2:] / 40.4421 - 1).max() < 1e-9
    assert closed_poles(plant, gains).shape == (2,)


def test_an_integral_is_the_default_for_a_course():
    """Wind turns a ship off its course for good: two poles alone leave an error. A rate of turn has an integral of its own."""
    course, rate = (
        shipid.design_autopilot("de-keizer", "soesterberg", speeds=[9.5], mode=m) for m in ("course", "rate")
    )
    assert (course.design, rate.design) == ("pid", "pole") and "Ki" in course.schedule.gains
