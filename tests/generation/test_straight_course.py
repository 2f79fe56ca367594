from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid import Component, constant, given, parameter, state
from shipid.generation.linearisation import NoSteadyStateError
from shipid.generation.straight_course import linear_ship
from shipid.parameters.parameter_set import ParameterSet, Value


class Driven(Component):
    """A ship whose speed follows her shaft."""

    r = state("rad/s", "rate of turn")
    u = state("m/s", "forward speed", start=5.0)
    delta = given("rad", "rudder angle")
    n = given("rps", "shaft speed")
    K = parameter("1/s", "rate of turn per rudder angle", start=0.1, low=0.01, high=1)
    T = parameter("s", "time constant of yaw", start=20.0, low=1, high=100)
    D = constant("m", "speed per revolution", default=5.0)

    @r.rate
    def yaw(self):
        """Nomoto, first order."""
        return (self.K * self.delta - self.r) / self.T

    @u.rate
    def surge(self):
        """The speed follows the shaft with the time constant of yaw."""
        return (self.D * self.n - self.u) / self.T


MODEL = shipid.join("driven", Driven)
SHIP = ParameterSet(
    "made",
    sections={"driven": {n: Value(n, v, u, "made up") for n, v, u in (("K", 0.1, "1/s"), ("T", 25.0, "s"))}},
)


def test_the_linear_ship_is_the_closed_form():
    found = linear_ship(MODEL, SHIP, 10.0, {"n": "120 rpm"}, inputs=["delta"], outputs=["r"])
    assert found.condition["u"] == pytest.approx(10.0)
    system = found.to_state_space()
    assert np.allclose(system.poles(), -1 / 25.0) and system.dcgain() == pytest.approx(0.1)
    assert list(system.input_labels) == ["delta"] and list(system.output_labels) == ["r"]


def test_a_speed_that_the_inputs_do_not_hold_is_refused():
    with pytest.raises(NoSteadyStateError, match="goes straight at 5 m/s with these inputs, and not at 10 m/s"):
        linear_ship(MODEL, SHIP, 10.0, {"n": "60 rpm"})
    with pytest.raises(shipid.ShipidError, match="'n'"):
        linear_ship(MODEL, SHIP, 10.0)
    with pytest.raises(shipid.ShipidError, match="input of model driven called 'shaft'"):
        linear_ship(MODEL, SHIP, 10.0, {"shaft": "60 rpm"})
