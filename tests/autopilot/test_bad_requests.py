"""Every request that is none, once: an error that says what and where, or a warning by its name."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid import Component, derived, given, join, parameter, state
from shipid.autopilot.design.closed_loop import poles_at
from shipid.autopilot.errors import DesignRequestError, NoStraightCourseError, NotSteerableError, UnstableDesignError
from shipid.foundation.errors import ParameterSetError, UnitError, UnknownNameError
from shipid.generation.simulator import UnstatedInputError
from shipid.models import PlanarMotion, SteeringMachine
from shipid.parameters.held_inputs import hold_inputs
from shipid.parameters.parameter_set import ParameterSet, Value
from shipid.parameters.replaced import with_values


class Yaw(Component):
    """Yaw with a bias and a rudder that may do nothing."""

    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    a = parameter("1/s^2", "yaw acceleration per rudder angle", start=0.1)
    b = parameter("1/s", "damping", start=0.1)
    c = parameter("rad/s^2", "bias", start=0.0)

    @r.rate
    def yaw(self):
        """A test."""
        return self.a * self.delta - self.b * self.r + self.c


yaw = join("yaw", Yaw, PlanarMotion)


def ship(**values: float | None) -> ParameterSet:
    units = {
        "a": "1/s^2",
        "b": "1/s",
        "c": "rad/s^2",
        "L": "m",
        "speed": "m/s",
        "delta_max": "rad",
        "delta_rate": "rad/s",
    }
    known = {"a": 0.01, "b": 0.1, "c": 0.0} | values
    made = {n: Value(n, v, units[n], "assumed") for n, v in known.items() if v is not None}
    parts = {n: v for n, v in made.items() if n in ("L", "speed", "delta_max", "delta_rate")}
    return ParameterSet(
        "test", sections={"particulars": parts, "yaw": {n: v for n, v in made.items() if n not in parts}}
    )


GOOD = {"L": 100.0, "speed": 5.0, "delta_max": 0.6, "delta_rate": 0.05}


class Wobbling(Component):
    """A rate of turn of first order, and a yaw that the rudder hardly moves, which grows between 8.3 and 9.7 m/s."""

    r = state("rad/s", "rate of turn")
    w = state("rad/s^2", "yaw acceleration")
    delta = given("rad", "rudder angle")
    u = given("m/s", "forward speed")
    a = parameter("1/s^2", "yaw acceleration per rudder angle", start=0.1)
    b = parameter("1/s", "damping", start=0.1)
    c = parameter("s/m^2", "change of the growth with the speed", start=0.1)
    middle = shipid.constant("m/s", "speed of the largest growth", default=9.0)
    half = shipid.constant("m/s", "half of the range of growth", default=0.7)
    touch = shipid.constant("1/s", "what the rudder adds to it", default=1e-4)

    @r.rate
    def yaw(self):
        """A test."""
        return self.a * self.delta - self.b * self.r + self.w

    @w.rate
    def memory(self):
        """A test."""
        return self.c * (self.half**2 - (self.u - self.middle) ** 2) * self.w + self.touch * self.a * self.delta


class Compassless(Component):
    """Rate of turn, and nothing else."""

    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")

    @r.rate
    def yaw(self):
        """A test."""
        return 0.0 * self.delta / self.second**2 - self.r / self.second

    second = shipid.constant("s", "one second", default=1.0)


class Steered(Component):
    """A heading that follows a rudder at once."""

    psi = state("rad", "heading", wraps=True)
    r = derived("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    g = parameter("1/s", "rate of turn per rudder angle", start=1.0)

    @r.equals
    def rate(self):
        """A test."""
        return self.g * self.delta

    @psi.rate
    def turning(self):
        """A test."""
        return self.r


class Towed(Component):
    """A ship that a tug turns."""

    r = state("rad/s", "rate of turn")
    pull = given("rad/s^2", "yaw acceleration by the tug")

    @r.rate
    def yaw(self):
        """A test."""
        return self.pull


def test_a_model_without_heading_rudder_or_rate():
    with pytest.raises(NotSteerableError, match="no heading 'psi'"):
        shipid.design_autopilot(join("compassless", Compassless), ship(**GOOD))
    with pytest.raises(
        NotSteerableError, match=r"SteeringMachine in it.*take the model without it.*actuator=SteeringMachine"
    ):
        shipid.design_autopilot(join("steered", shipid.find_model("nomoto"), SteeringMachine), "soesterberg")
    with pytest.raises(NotSteerableError, match=r"reads no rudder angle 'delta'.*derived from one delta"):
        shipid.design_autopilot(join("towed", Towed, PlanarMotion), "soesterberg")
    with pytest.raises(NotSteerableError, match="no rate of turn 'r'"):
        shipid.design_autopilot(join("moving", PlanarMotion), ship(**GOOD))


class OwnMachine(Component):
    """A steering machine that knows of no dead time."""

    delta_order = given("rad", "rudder order")
    delta = derived("rad", "rudder angle")

    @delta.equals
    def follows(self):
        """A test."""
        return 0.9 * self.delta_order


def test_an_actuator_of_ones_own_has_to_carry_the_dead_time_of_the_model():
    late = with_values(shipid.find_ship("zeefakkel"), {"delay": "2 s"}, [shipid.find_model("norrbin-delay")])
    with pytest.raises(
        NotSteerableError, match=r"'delay', and the actuator OwnMachine has none.*derive yours from LateRudder"
    ):
        shipid.design_autopilot("norrbin-delay", late, actuator=OwnMachine)


def test_a_sampled_model_is_refused_with_the_states_that_are():
    with pytest.raises(NotSteerableError, match=r"pershitz-discrete is sampled \(.*psi.*\).*continuous model"):
        shipid.design_autopilot("pershitz-discrete", "semerdjiev")


class Propelled(Yaw):
    """Yaw by a rudder in the wash of a propeller whose revolutions nothing states."""

    n = given("1/s", "propeller revolutions")
    n0 = shipid.constant("1/s", "revolutions at which the coefficient holds", default=1.0)

    def yaw(self):
        """A test."""
        return self.a * self.delta * self.n / self.n0 - self.b * self.r + self.c


def test_an_input_that_nothing_states():
    """It is refused, and not taken as zero."""
    made = ParameterSet("s", sections={**ship(**GOOD).sections, "propelled": ship(**GOOD).sections["yaw"]})
    with pytest.raises(UnstatedInputError, match="model propelled reads 'n' "):
        shipid.design_autopilot(join("propelled", Propelled, PlanarMotion), made)


def test_an_uncontrollable_ship():
    with pytest.raises(NotSteerableError, match="does not move its heading at 5 m/s"):
        shipid.design_autopilot(yaw, ship(**GOOD, a=0.0))


def test_a_rate_that_has_no_state():
    made = ParameterSet("s", sections={**ship(**GOOD).sections, "steered": {"g": Value("g", 0.1, "1/s", "assumed")}})
    with pytest.raises(NotSteerableError, match="follows the rudder at once"):
        shipid.design_autopilot(join("steered", Steered), made)


def test_a_ship_that_does_not_go_straight():
    with pytest.raises(NoStraightCourseError, match=r"'r' changes by 0\.001 in a second"):
        shipid.design_autopilot(yaw, ship(**GOOD, c=0.001))


def test_a_request_that_leaves_the_loop_unstable():
    with pytest.raises(UnstableDesignError, match="is unstable: besides the requested poles"):
        shipid.design_autopilot("de-keizer-lag", "gunnerus", omega_n="1.6 rad/s")


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"design": "magic"}, UnknownNameError, "no design 'magic'"),
        ({"speeds": "4 m/s"}, DesignRequestError, None),
        ({"speeds": "nonsense"}, DesignRequestError, "neither FROM:TO:STEP nor a list"),
        ({"speeds": "4:12:1"}, DesignRequestError, "have no unit"),
        ({"speeds": "9:4:1 m/s"}, DesignRequestError, "neither FROM:TO:STEP"),
        ({"speeds": "0:4:1 m/s"}, DesignRequestError, "no speeds of a ship under way"),
        ({"speeds": []}, DesignRequestError, "no speeds of a ship under way"),
        ({"speeds": "1:100:0.1 m/s"}, DesignRequestError, "more than a schedule holds"),
        ({"speeds": "4:12:1 deg"}, UnitError, "the speeds needs the unit"),
        ({"omega_n": -1.0}, DesignRequestError, "natural frequency of -1 rad/s"),
        ({"omega_n": "1 m"}, UnitError, "omega_n needs the unit"),
        ({"damping": 0.0}, DesignRequestError, "damping ratio of 0"),
        ({"design": "pid", "integral": 9.0}, DesignRequestError, "third pole of 9 omega_n"),
        ({"design": "lqr", "rudder_weight": 0.0}, DesignRequestError, "rudder weight of 0"),
        ({"design": "lqr", "damping": 0.9}, DesignRequestError, "lqr has no frequency and damping to set"),
        ({"rudder_limit": "0 deg"}, DesignRequestError, "rudder limit of 0 deg"),
        ({"actuator": "Sail"}, UnknownNameError, "no component 'Sail'"),
    ],
)
def test_requests_that_are_none(options, error, words):
    if words is None:
        assert shipid.design_autopilot("de-keizer", "soesterberg", **options).speeds.tolist() == [4.0]
        return
    with pytest.raises(error, match=words):
        shipid.design_autopilot("de-keizer", "soesterberg", **options)


def test_no_ship_and_no_numbers():
    with pytest.raises(DesignRequestError, match="an autopilot needs a ship"):
        shipid.design_autopilot("de-keizer", [])
    with pytest.raises(ParameterSetError, match="needs K"):
        shipid.design_autopilot("nomoto", ParameterSet("empty", sections=ship(**GOOD).sections), speeds=[5.0])
    with pytest.raises(ParameterSetError, match="no speed of its own: give the speeds"):
        shipid.design_autopilot(yaw, ship(L=100.0))
    with pytest.raises(ParameterSetError, match="the speed of ship test is -1"):
        shipid.design_autopilot(yaw, ship(**GOOD | {"speed": -1.0}))
    with pytest.raises(ParameterSetError, match="largest rudder rate delta_rate of ship test is 0"):
        shipid.design_autopilot(yaw, ship(**GOOD | {"delta_rate": 0.0}))
    light = shipid.find_ship("zeefakkel").sections["nomoto"]
    bare = ParameterSet("bare", sections={"nomoto": {n: Value(n, 1.0, v.unit, "assumed") for n, v in light.items()}})
    with pytest.raises(ParameterSetError, match="no speed of its own, by which K, tau"):
        shipid.design_autopilot("nomoto", bare, speeds=[5.0, 6.0])


@pytest.mark.parametrize(
    ("model", "chosen", "options", "words"),
    [
        (
            "nomoto",
            "zeefakkel",
            {"speeds": "1:6:1 m/s"},
            "The schedule runs from 1 to 6 m/s: the [nomoto] coefficients of ship zeefakkel were found at 2 to 6.2",
        ),
        ("nomoto", "soesterberg", {}, "scaled by speed: the coefficients of nomoto hold at 9.5 m/s"),
        ("bech", "kvlcc2", {}, "course-unstable: without the autopilot"),
        ("de-keizer", "soesterberg", {"omega_n": 0.005}, "negative rate gain"),
        ("de-keizer", "soesterberg", {"omega_n": 0.3}, "rudder rate: at 11.4 m/s the request is 0.36 rad/s"),
        ("de-keizer", "soesterberg", {"rudder_limit": "50 deg"}, "rudder limit: the rudder itself stops at 35 deg"),
        (yaw, ship(L=100.0, speed=5.0), {}, "assumed: the largest rudder rate"),
        (yaw, ship(**GOOD | {"L": None}), {}, "assumed: the length of ship test is not known"),
    ],
)
def test_named_warnings(model, chosen, options, words):
    pilot = shipid.design_autopilot(model, chosen, **options)
    assert any(words in w for w in pilot.warnings), pilot.warnings


def test_a_rudder_that_works_the_other_way(sized):
    pilot = shipid.design_autopilot("de-keizer", sized("soesterberg", "de-keizer", K=-1.6))
    assert any("reversed rudder" in w for w in pilot.warnings) and (pilot.schedule.gains["Kp"] < 0).all()
    assert poles_at(pilot, 9.5).real.max() < 0


def test_the_rudder_rate_a_request_needs():
    """The frequency named in the warning is met: a request at it brings none."""
    asked = shipid.design_autopilot("de-keizer", "soesterberg", omega_n=0.3)
    most = float(asked.warnings[-1].split("At most ")[1].split(" rad/s")[0])
    assert most == pytest.approx(np.deg2rad(2.5) / np.deg2rad(15) * 9.5 / 11.4, rel=5e-3)
    slower = shipid.design_autopilot("de-keizer", "soesterberg", omega_n=0.99 * most)
    assert not any(w.startswith("rudder rate") for w in slower.warnings)


def test_a_ship_that_no_rudder_holds_between_two_speeds_is_refused():
    """Stable at both speeds of the schedule; between them the requested poles are met, and another one grows."""
    units = {"a": "1/s^2", "b": "1/s", "c": "s/m^2"}
    values = {n: Value(n, v, units[n], "assumed") for n, v in {"a": 0.01, "b": 0.1, "c": 0.02}.items()}
    parts = {"L": Value("L", 100.0, "m", "assumed"), "speed": Value("speed", 10.0, "m/s", "assumed")}
    wobbling = ParameterSet("test", sections={"particulars": parts, "wobbling": values})
    model = join("wobbling", Wobbling, PlanarMotion)
    assert len(shipid.design_autopilot(model, wobbling, speeds=[8.0]).speeds) == 1
    with pytest.raises(UnstableDesignError, match="at 9 m/s is unstable"):
        shipid.design_autopilot(model, wobbling, speeds=[8.0, 10.0])


def test_revolutions_held_at_every_speed_are_told():
    """Of a model whose speed they make; a current that is held turns no propeller, and one speed needs no word."""
    turning = hold_inputs(shipid.find_model("mmg-revolutions"), {"n": "1.5 rps"})
    pilot = shipid.design_autopilot(turning, "kvlcc2", speeds=[6.0, 7.0])
    (said,) = [w for w in pilot.warnings if "held" in w]
    assert "'n' is held at 90 rpm at every speed of the schedule, from 6 to 7 m/s" in said
    carried = hold_inputs(shipid.find_model("de-keizer"), {"current_north": "1 kn"})
    for model, ship, speeds in ((turning, "kvlcc2", [7.0]), (carried, "soesterberg", [7.0, 9.5])):
        assert not [w for w in shipid.design_autopilot(model, ship, speeds=speeds).warnings if "held" in w]
