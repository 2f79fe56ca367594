"""Rate of turn held, and a course kept with a dead band."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid.autopilot.design.control_law import Measured
from shipid.autopilot.errors import DesignRequestError
from shipid.autopilot.on_board.modes import CourseKeeper, RateController, place_rate
from shipid.generation.record import make_record
from shipid.generation.system import generate
from shipid.models import SteeringMachine
from shipid.parts.helm import DirectRudder

SHIP, U = shipid.find_ship("soesterberg"), 9.5


def test_the_poles_of_the_rate_loop(container):
    """Two poles placed; against the eigenvalues of the declared loop with a rudder at once."""
    plant = container.plants(np.array([U])).at(0)
    gain, integral = place_rate(plant, 0.05, 0.8)
    model = shipid.join("rate", container.model, DirectRudder, Measured, RateController)
    known = SHIP.values(model, speed=U) | SHIP.values(container.model, speed=U)
    known |= {"rate_gain": gain, "rate_integral": integral, "u": U, "cruise": U, "rudder_limit": 0.26, "log_scale": 1.0}
    poles = shipid.linearise(model, known, ["r", "heading_lost"], ["r_order"]).poles
    np.testing.assert_allclose(sorted(poles.imag), [-0.03, 0.03], rtol=1e-10)
    np.testing.assert_allclose(poles.real, -0.04, rtol=1e-10)
    with pytest.raises(DesignRequestError, match="are none"):
        place_rate(plant, 0.0, 0.8)


def test_a_rate_is_held(container):
    """Behind the steering machine, with the speed lost in the turn: 0.4 deg/s kept to a thousandth after a while."""
    gain, integral = place_rate(container.plants(np.array([U])).at(0), 0.05, 0.8)
    model = shipid.join("rate", container.model, SteeringMachine, Measured, RateController)
    known = container.values(model, U) | {"rate_gain": gain, "rate_integral": integral, "rudder_limit": np.deg2rad(20)}
    record = make_record(model, ("r", "delta"), hold="zero")
    given = {"cruise": U, "r_order": np.deg2rad(0.4)}
    inputs = np.array([[given.get(n, 0.0)] for n in record.system.inputs])
    start = np.array([U if s == "u" else 0.0 for s in record.system.states])
    p = record.system.vector(record.system.coefficients, known)
    (r, delta), _ = record(start, np.broadcast_to(inputs, (len(inputs), 2000)), np.full(2000, 0.4), p)
    assert r[-1] == pytest.approx(np.deg2rad(0.4), rel=1e-3)
    assert np.abs(delta).max() <= np.deg2rad(20) + 1e-9


def test_the_integral_of_the_rate_stands_at_the_limit():
    """Gain 30 s, limit 0.3 rad: an error of 0.009 rad/s is summed, one of 0.011 asks for more than the limit and is not."""
    system = generate(shipid.join("rate", RateController))
    known = {"rate_gain": 30.0, "rate_integral": 1.0, "rudder_limit": 0.3, "r_seen": 0.002}
    for side in (1, -1):
        for error, summed in ((0.009, 0.009), (0.011, 0.0)):
            at = known | {"r_order": 0.002 + side * error, "heading_lost": 0.0}
            x, u, p = (system.vector(n, at) for n in (system.states, system.inputs, system.coefficients))
            assert float(system.right_hand_side(x, u, p)) == pytest.approx(side * summed)


def test_the_dead_band():
    """Within the band the heading asks for no rudder, beyond it for the part beyond; the setting for the sea widens it."""
    model = shipid.join("keep", CourseKeeper)
    system = generate(model)
    function = system.function(["rudder_wanted"])
    p = system.vector(system.coefficients, {"dead_band": 0.02})

    def rudder(error: float, rate: float, sea: float) -> float:
        known = {"psi_order": error, "psi_seen": 0.0, "r_seen": rate, "gain_Kp": 1.5, "gain_Kd": 20.0, "sea_state": sea}
        return float(function([], [known[n] for n in system.inputs], p))

    assert rudder(0.01, 0.0, 1.0) == 0.0 and rudder(-0.02, 0.0, 1.0) == 0.0
    assert rudder(0.05, 0.0, 1.0) == pytest.approx(1.5 * 0.03) and rudder(-0.05, 0.0, 1.0) == pytest.approx(-1.5 * 0.03)
    assert rudder(0.05, 0.0, 2.0) == pytest.approx(1.5 * 0.01) and rudder(0.05, 0.0, 0.0) == pytest.approx(1.5 * 0.05)
    assert rudder(0.01, 0.001, 1.0) == pytest.approx(-0.02)


def test_the_keeper_takes_the_controllers_place(container):
    """Joined into the loop, it settles within the band, where the controller goes to the course itself."""
    gains = container.schedule.component
    ends = []
    for sea in (0.0, 1.0):
        model = shipid.join("keeping", container.model, SteeringMachine, Measured, CourseKeeper, gains)
        record = make_record(model, ("psi",), hold="zero")
        known = container.values(model, U)
        given = {"cruise": U, "psi_order": 0.1, "sea_state": sea}
        inputs = np.array([[given.get(n, 0.0)] for n in record.system.inputs])
        start = np.array([U if s == "u" else 0.0 for s in record.system.states])
        p = record.system.vector(record.system.coefficients, known)
        (psi,), _ = record(start, np.broadcast_to(inputs, (len(inputs), 2000)), np.full(2000, 0.4), p)
        ends.append(psi[-1])
    assert ends[0] == pytest.approx(0.1, abs=1e-6)
    assert ends[1] == pytest.approx(0.1 - np.deg2rad(1.0), abs=1e-3)
