"""Margins against python-control and closed forms; robustness and the judgement of a design."""

from __future__ import annotations

import json

import control
import numpy as np
import pytest

import shipid
from shipid.autopilot.design.closed_loop import closed_loop, coefficients_of, linear_ship, to_control
from shipid.autopilot.design.placement import Gains
from shipid.autopilot.design.plant import Plant
from shipid.autopilot.judgement.judgement import LIMITS
from shipid.autopilot.judgement.margins import (
    disk_margins,
    disk_on,
    growth,
    loop_polynomials,
    margins_at,
    sea_filtered,
    to_transfer_function,
)
from shipid.generation.system import generate


def loops(pilot):
    for speed in pilot.speeds:
        plant = linear_ship(pilot, [speed], steered=True).at(0)
        yield float(speed), plant, pilot.gains(float(speed))


def opened(plant, gains):
    """The loop in state space, as nothing of ours writes it: rudder order to rudder wanted, the integral a state."""
    n = len(plant.states)
    A, B = np.zeros((n + 1, n + 1)), np.append(plant.B, 0.0)[:, None]
    A[:n, :n], A[n, :n] = plant.A, plant.C[0]
    C = np.append(gains.Kp * plant.C[0] + gains.Kd * plant.C[1], gains.Ki)[None, :]
    return control.ss(A, B, C, [[0.0]]) if gains.Ki else control.ss(plant.A, B[:n], C[:, :n], [[0.0]])


@pytest.fixture(scope="module", params=["container", "unstable", "integral"])
def pilot(request, container):
    if request.param == "container":
        return container
    if request.param == "integral":
        return request.getfixturevalue("integral")
    return shipid.design_autopilot("bech-surge", "kvlcc2-7m", speeds=[0.9, 1.2])


def test_the_loop_is_that_of_the_model(pilot):
    """The loop of the judgement against the declared loop, opened at the rudder order: 1 / (1 + L) from order to rudder."""
    for speed, plant, gains in loops(pilot):
        numerator, denominator = loop_polynomials(plant, gains)
        closed = to_control(pilot, speed).poles()
        found = np.roots(numerator + denominator)
        away = np.abs(found[:, None] - closed[None, :]).min(axis=1)
        assert (away <= 1e-9 * np.abs(found)).all()


def test_margins_equal_python_controls(pilot):
    for speed, plant, gains in loops(pilot):
        found = margins_at(plant, gains, speed, pilot.pace(speed))
        loop = opened(plant, gains)
        gain, phase, distance, _, crossing, _ = control.stability_margins(loop)
        assert found.phase_deg == pytest.approx(phase, rel=1e-6)
        assert found.delay_s == pytest.approx(np.deg2rad(phase) / crossing, rel=1e-6)
        # In state space rounding leaves a crossing at a gain of 1e15 where there is none.
        assert (found.gain is None) == (not gain < 1e9)
        if found.gain is not None:
            assert found.gain == pytest.approx(gain, rel=1e-6)
        assert found.sensitivity == pytest.approx(1 / distance, rel=1e-3)
        assert found.disk == pytest.approx(
            control.disk_margins(loop, pilot.pace(speed) * np.geomspace(1e-2, 1e3, 2000))[0], rel=1e-3
        )


def test_disk_margins_equal_python_controls_on_one_grid(pilot):
    omega = np.geomspace(1e-4, 1e2, 300)
    for _, plant, gains in loops(pilot):
        loop = to_transfer_function(plant, gains)
        ours = disk_on(*loop_polynomials(plant, gains), omega).min()
        assert ours == pytest.approx(control.disk_margins(loop, omega)[0], rel=1e-9)


def test_disk_margin_of_an_integrator_with_delay_free_gain():
    """L = k/s: |S - T| is 1 at every frequency, so the margin is 2, the most there is; k/(s (s + 1)) has a closed form."""
    assert disk_margins(np.array([0.0, 3.0]), np.array([1.0, 0.0]), 1.0) == pytest.approx(2.0)
    found = disk_margins(np.array([[0.0, 0.0, 0.5], [0.0, 0.0, -0.5]]), np.array([[1.0, 1.0, 0.0]] * 2), 1.0)
    omega = np.geomspace(1e-2, 1e2, 200001)
    loop = 0.5 / (1j * omega * (1j * omega + 1))
    assert found[0] == pytest.approx(2 / np.abs((1 - loop) / (1 + loop)).max(), rel=1e-6)
    assert found[1] == 0.0  # positive feedback: unstable


def test_the_sea_filter_in_the_loop():
    """Against the product of the three transfer functions, of two loops at once; both polynomials have one length."""

    loop = np.array([[0.0, 0.0, 0.5], [0.0, 0.3, 0.5]]), np.array([[1.0, 1.0, 0.0], [1.0, 2.0, 0.0]])
    numerator, denominator = sea_filtered(*loop, np.array([0.6, 0.9]), 0.7, np.array([0.3, 0.9]))
    for k, frequency in enumerate((0.6, 0.9)):
        notch = control.tf([1, 0, frequency**2], [1, 1.4 * frequency, frequency**2])
        corner = (0.3, 0.9)[k]
        lag = control.tf([corner], [1, corner])
        whole = notch * lag * control.tf(loop[0][k], loop[1][k])
        s = 0.3 + 0.4j
        assert np.polyval(numerator[k], s) / np.polyval(denominator[k], s) == pytest.approx(whole(s), rel=1e-12)


def test_growth_of_many():
    assert growth(np.array([[1.0, 3.0, 2.0], [1.0, 0.0, 4.0], [1.0, -1.0, 0.0]])) == pytest.approx(
        [-1, 0, 1], abs=1e-12
    )


def test_bandwidth_equals_python_controls(pilot):
    for speed, plant, gains in loops(pilot):
        found = margins_at(plant, gains, speed, pilot.pace(speed)).bandwidth
        loop = to_control(pilot, speed)[0, 0]
        assert found == pytest.approx(control.bandwidth(loop, 20 * np.log10(np.sqrt(0.5))), rel=1e-4)


def test_a_delay_margin_where_the_loop_leads():
    """``0.6 s^2 / ((s^2 + 0.4 s + 1)(0.02 s + 1))`` leads by 0 to 180 deg where its gain is one: a phase margin below zero.

    It is stable, and the delay at which it is no longer so is that of python-control's Pade approximation.
    """
    denominator = np.polymul([1.0, 0.4, 1.0], [0.02, 1.0]) / 0.02
    numerators = np.array([[0.0, 30.0, 0.0], [30.0, 0.0, 0.0]])
    A, B = np.array([-denominator[1:], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([1.0, 0.0, 0.0])
    plant, gains = Plant(("a", "b", "c"), A, B, numerators, denominator, numerators), Gains(0.0, 1.0)
    loop = control.ss(A, B[:, None], numerators[1:], [[0.0]])
    phases = control.stability_margins(loop, returnall=True)[1]
    assert len(phases) == 2 and (phases < 0).all()
    found = margins_at(plant, gains, 1.0, 1.0).delay_s
    assert found is not None

    def stable(delay: float) -> bool:
        return bool((control.feedback(loop * control.ss(control.tf(*control.pade(delay, 8)))).poles().real < 0).all())

    assert all(stable(share * found) for share in (0.1, 0.5, 0.9, 0.99)) and not stable(1.01 * found)


def test_an_unstable_ship_has_a_lower_gain_margin():
    pilot = shipid.design_autopilot("bech-surge", "kvlcc2-7m", design="pole", speeds=[1.2])
    (speed, plant, gains), = loops(pilot)  # fmt: skip
    low = margins_at(plant, gains, speed, pilot.pace(speed)).gain_low
    assert low is not None and 0 < low < 1
    for factor, stable in ((1.02 * low, True), (0.98 * low, False)):
        numerator, denominator = loop_polynomials(plant, Gains(factor * gains.Kp, factor * gains.Kd))
        assert (growth(numerator + denominator) < 0) == stable


@pytest.fixture(scope="module")
def judgement(uncertain_pilot):
    return shipid.judge(uncertain_pilot, samples=50)


def test_the_judgement_holds_the_keys_of_its_result(judgement, uncertain_pilot):
    found = json.loads(json.dumps(judgement.to_dict(), allow_nan=False))
    count = len(uncertain_pilot.speeds)
    assert found["speeds"]["value"] == uncertain_pilot.speeds.tolist()
    assert set(found["gains"]) == {"Kp", "Kd", "Ki"}
    for name in ("gain", "disk"):
        assert len(found["margins"][name]) == count
    for name, unit in (("phase", "deg"), ("delay", "s"), ("bandwidth", "rad/s")):
        assert len(found["margins"][name]["value"]) == count and found["margins"][name]["unit"] == unit
    assert len(found["poles"]["value"]) == count and len(found["poles"]["value"][0][0]) == 2
    assert found["robust"]["samples"] == 50 and found["robust"]["disk_worst"] > 0
    assert {"speed", "change", "overshoot", "settling"} <= set(found["steps"][0])
    assert {"what", "where", "value"} <= set(found["weakest"])
    assert any("The schedule runs from" in w["message"] for w in found["warnings"])
    assert judgement.to_frame().shape[0] == count
    assert "worst disk margin" in judgement.text() and "The weakest point" in judgement.text()


def test_the_worst_draw_is_worse_than_the_ship_itself(judgement):
    assert judgement.robust[0].disk_worst < min(m.disk for m in judgement.margins[0])
    assert judgement.robust[0].disk_worst <= judgement.robust[0].disk_low
    assert len(judgement.robust[0].disk_by_speed) == 3
    slow = judgement.robust[0].variants["steering machine of half the rate and twice the lag"]
    assert slow["disk"] < judgement.robust[0].variants["as designed"]["disk"]


def test_a_log_that_is_off_shifts_the_schedule(judgement, uncertain_pilot):
    """Poles placed for K ~ u/L and tau ~ L/u make Kd ~ L/u: a log that reads a tenth high takes the Kd of a tenth more speed."""
    model = closed_loop(uncertain_pilot)
    system = generate(model)
    known = coefficients_of(uncertain_pilot, model, 9.5) | {"log_scale": 1.1, "u": 9.5, "cruise": 9.5}
    x, u, p = (system.vector(n, known, 0.0) for n in (system.states, system.inputs, system.coefficients))
    seen, kd = system.function(["speed_seen", "gain_Kd"])(x, u, p).full().ravel()
    assert seen == pytest.approx(1.1 * 9.5) and kd == pytest.approx(uncertain_pilot.gains(10.45).Kd)
    variants = judgement.robust[0].variants
    high, low = variants["log reads 10 % too high"], variants["log reads 10 % too low"]
    # The gains of a higher speed damp less, those of a lower speed more.
    assert low["overshoot_deg"] < variants["as designed"]["overshoot_deg"] < high["overshoot_deg"]
    for shown, found in ((1.1, high), (0.9, low)):
        off = [opened(plant, uncertain_pilot.gains(shown * v)) for v, plant, _ in loops(uncertain_pilot)]
        least = min(control.disk_margins(loop, np.geomspace(1e-4, 1e2, 4000))[0] for loop in off)
        assert found["disk"] == pytest.approx(least, rel=1e-3)


def test_correlation_counts(uncertain):
    """K and tau that move together leave a = K/tau alone, which the loop sees most; apart they cost more margin."""
    worst = []
    for correlation in (0.99, -0.99):
        ship = uncertain("soesterberg", "nomoto", share=0.3, correlation=correlation)
        pilot = shipid.design_autopilot("nomoto", ship, speeds=[7.0, 9.5, 11.0])
        worst.append(shipid.judge(pilot, samples=50).robust[0].disk_worst)
    assert worst[0] > worst[1]


def test_a_weak_design_says_so(uncertain):
    """Poles far quicker than the servo: the disk margin falls below its limit, in the warnings and the weakest point."""
    pilot = shipid.design_autopilot("nomoto", "soesterberg", omega_n=1.5, speeds=[7.0, 9.5, 11.0])
    judged = shipid.judge(pilot, samples=10)
    assert any(w.startswith("disk margin: the least of the design is") for w in judged.warnings)
    assert any(w.startswith("no uncertainty") for w in judged.warnings)
    assert judged.weakest.share < 1 and "beyond its limit" in judged.weakest.sentence
    assert LIMITS["disk margin"] == 0.5


def test_the_loop_is_shown_at_the_slowest_the_own_and_the_fastest_speed():
    pilot = shipid.design_autopilot("de-keizer", "soesterberg", speeds=[6.0, 8.0, 9.5, 11.0])
    shown = shipid.judge(pilot).responses
    assert [r.speed for r in shown] == pytest.approx([6.0, 9.5, 11.0])
    for r in shown:
        # Far above its bandwidth a loop answers less and less.
        assert abs(r.response[-1]) < abs(r.response[0])


def test_every_load_condition_is_among_the_points(sized):
    ships = ["soesterberg", sized("soesterberg", "de-keizer", K=2.2)]
    pilot = shipid.design_autopilot("de-keizer", ships, speeds=[9.5], actuator=None)
    found = shipid.judge(pilot)
    disks = [p for p in found.points() if p.what == "disk margin"]
    assert [p.value for p in disks[::2]] == pytest.approx([min(m.disk for m in found.margins[j]) for j in range(2)])
    # The sea filter takes away margin: a limit that it breaks is broken.
    assert [p.where.partition(" (")[0] for p in disks[1::2]] == ["while the sea filter is on"] * 2
    assert [p.value for p in disks[1::2]] == [r.variants["sea filter on"]["disk"] for r in found.robust]
