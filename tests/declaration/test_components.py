"""Components: what is collected, inherited and refused while a class is built."""

from collections.abc import Callable

import numpy as np
import pytest

from shipid import Component, constant, derived, given, join, output, parameter, state
from shipid.declaration.component import declared_equations, declared_quantities, slug
from shipid.declaration.model import Evaluation
from shipid.declaration.quantity import Quantity
from shipid.foundation.errors import DeclarationError


class Turning(Component):
    """A first-order ship."""

    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    K = parameter("1/s", "gain", start=0.1, low=0.01, high=1.0)
    tau = parameter("s", "time constant", start=20.0, low=1.0, high=100.0)

    def damping(self):
        return self.r

    @r.rate
    def yaw(self):
        """Nomoto (1957)."""
        return (self.K * self.delta - self.damping()) / self.tau


class Cubic(Turning):
    """The same with a cubic damping, by replacing a helper."""

    n3 = parameter("s^2/rad^2", "cubic coefficient", start=1.0, low=0.0, high=1e4)

    def damping(self):
        return self.r + self.n3 * self.r**3


class Reversed(Turning):
    """The same with the rudder reversed, by replacing an equation."""

    def yaw(self):
        """Nobody (1900)."""
        return (-self.K * self.delta - self.damping()) / self.tau


def rate(component: type[Component], **values: float) -> float:
    model = join("alone", component)
    return float(Evaluation(model, values).right_hand_sides("rate")["r"])


POINT = {"r": 0.02, "delta": 0.2, "K": 0.1, "tau": 20.0, "n3": 300.0}


def test_quantities_and_equations_are_collected_in_order() -> None:
    assert tuple(declared_quantities(Turning)) == ("r", "delta", "K", "tau")
    assert [q.kind for q in declared_quantities(Turning).values()] == ["state", "given", "parameter", "parameter"]
    assert declared_quantities(Turning)["K"].name == "K"
    equation = declared_equations(Turning)["r"]
    assert (equation.name, equation.kind, equation.source) == ("yaw", "rate", "Nomoto (1957).")
    assert equation.place.startswith(__file__)


def test_a_subclass_inherits_and_adds() -> None:
    assert tuple(declared_quantities(Cubic)) == ("r", "delta", "K", "tau", "n3")
    assert tuple(declared_quantities(Turning)) == ("r", "delta", "K", "tau")


def test_a_helper_may_be_replaced() -> None:
    assert rate(Turning, **POINT) == pytest.approx((0.02 - 0.02) / 20)
    assert rate(Cubic, **POINT) == pytest.approx(-300 * 0.02**3 / 20)


def test_a_method_of_the_same_name_replaces_the_equation() -> None:
    assert rate(Reversed, **POINT) == pytest.approx(-0.04 / 20)
    assert declared_equations(Reversed)["r"].source == "Nobody (1900)."
    assert declared_equations(Turning)["r"].source == "Nomoto (1957)."


def test_a_quantity_may_be_declared_again() -> None:
    class Heavier(Turning):
        """The same with other bounds."""

        tau = parameter("s", "time constant of a heavier ship", start=200.0, low=10.0, high=1000.0)

    assert declared_quantities(Heavier)["tau"].start == 200.0
    assert rate(Heavier, **POINT | {"r": 0.0}) == pytest.approx(0.1 * 0.2 / 20)


def test_properties_and_constants_of_the_class_are_seen_by_equations() -> None:
    class WithProperty(Component):
        """A helper that needs no brackets."""

        LEAST = 0.5
        x = state("1", "something")

        @property
        def twice(self):
            return 2 * self.x

        @x.rate
        def change(self):
            """Anon (2000)."""
            return np.maximum(self.twice, self.LEAST) / self.T_s

        T_s = given("s", "sampling interval")

    model = join("alone", WithProperty)
    assert model.inputs == ()  # the sampling interval is no input
    assert Evaluation(model, {"x": 3.0, "T_s": 2.0}).right_hand_sides("rate")["x"] == 3.0
    assert Evaluation(model, {"x": 0.1, "T_s": 2.0}).right_hand_sides("rate")["x"] == 0.25


def test_the_name_on_the_command_line() -> None:
    class NomotoSecondOrderShip(Turning):
        """A long name."""

    assert slug(NomotoSecondOrderShip) == "nomoto-second-order-ship"
    assert slug(Turning) == "turning"


def test_components_are_not_instantiated() -> None:
    with pytest.raises(DeclarationError, match=r"Turning is a declaration .* pass the class to shipid.join"):
        Turning()


def _missing_rate() -> None:
    class Bad(Component):
        x = state("m", "position")


def _missing_equals() -> None:
    class Bad(Component):
        v = derived("m/s", "speed")


def _missing_output() -> None:
    class Bad(Component):
        z = output("m/s", "log")


def _rate_of_derived() -> None:
    class Bad(Component):
        v = derived("m/s", "speed")

        @v.rate
        def change(self):
            return 0.0


def _equation_of_constant() -> None:
    class Bad(Component):
        L = constant("m", "length")

        @L.equals
        def change(self):
            return 0.0


def _state_hidden_by_another_base() -> None:
    class Reads(Component):
        x = given("m", "position")

    class Moves(Component):
        x = state("m", "position")

        @x.rate
        def move(self):
            return 0.0

    class Bad(Reads, Moves):
        pass


def _twice() -> None:
    class Bad(Component):
        x = state("m", "position")

        @x.rate
        def one(self):
            return 0.0

        @x.next
        def other(self):
            return self.x


def _reserved() -> None:
    class Bad(Component):
        t = given("s", "time")


def _underscore() -> None:
    class Bad(Component):
        _hidden = given("s", "time")


def _own_interval() -> None:
    class Bad(Component):
        T_s = parameter("s", "time constant", start=1.0)


def _no_meaning() -> None:
    class Bad(Component):
        x = given("m", "  ")


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (_missing_rate, r"state 'x' of Bad has no equation: add a method under @x\.rate"),
        (_missing_equals, r"derived 'v' of Bad has no equation: add a method under @v\.equals"),
        (_missing_output, r"output 'z' of Bad has no equation"),
        (_state_hidden_by_another_base, r"'x' of Bad is given, and 'move' .* is its equation.* join them instead"),
        (_rate_of_derived, r"a derived takes @equals, and 'change' \(.*test_components\.py:\d+\) gives it @rate"),
        (_equation_of_constant, r"a constant takes no equation"),
        (_twice, r"Bad defines 'x' twice: in 'one' \(.*:\d+\) and in 'other' \(.*:\d+\)"),
        (_reserved, r"may not name a quantity 't': the name is reserved"),
        (_underscore, r"may not name a quantity '_hidden'"),
        (_own_interval, r"'T_s', which is the sampling interval: declare it as given"),
        (_no_meaning, r"'x' of Bad has no meaning"),
    ],
)
def test_a_component_that_is_not_well_formed_says_why(build: Callable[[], None], words: str) -> None:
    with pytest.raises(DeclarationError, match=words):
        build()


def test_a_declaration_is_data() -> None:
    quantity = declared_quantities(Turning)["K"]
    with pytest.raises(AttributeError):
        quantity.start = 3.0
    with pytest.raises(AttributeError):
        declared_equations(Turning)["r"].kind = "next"
    assert isinstance(quantity, Quantity)


def test_a_time_constant_may_be_called_T() -> None:
    class FirstOrder(Component):
        """Nomoto's first order, in the symbols of its author."""

        r = state("rad/s", "rate of turn, positive to starboard")
        delta = given("rad", "rudder angle, positive turns to starboard")
        K = parameter("1/s", "yaw gain", start=0.5, prime=True)
        T = parameter("s", "yaw time constant", start=1.0, prime=True)

        @r.rate
        def yaw(self):
            """Nomoto (1957)."""
            return (self.K * self.delta - self.r) / self.T

    model = join("first order", FirstOrder)
    assert model.parameters == ("K", "T")
    rates = Evaluation(model, {"r": 0.1, "delta": 0.5, "K": 0.4, "T": 5.0}).right_hand_sides("rate")
    assert rates["r"] == (0.4 * 0.5 - 0.1) / 5.0


@pytest.mark.parametrize(
    ("start", "low", "high"), [(5, 0, 1), (float("nan"), 0, 1), (0.5, 10, 1), (1, 1, 1), (0, float("nan"), 1)]
)
def test_a_start_outside_of_its_bounds_is_refused(start: float, low: float, high: float) -> None:
    class Lag(Component):
        """A lag."""

        y = state("m", "what follows")
        tau = parameter("s", "time constant", start=start, low=low, high=high)

        @y.rate
        def follow(self):
            """Own notes."""
            return -self.y / self.tau

    with pytest.raises(DeclarationError, match=r"'tau' of Lag declares .*low has to be below high"):
        join("lag", Lag)


def twice_a_quantity() -> type[Component]:
    class Own(Component):
        """The second line was to be another coefficient."""

        K = parameter("1/s", "gain", start=0.1)
        K = parameter("s^2/rad^2", "cubic coefficient", start=10.0)

    return Own


def a_method_named_as_its_state() -> type[Component]:
    class Own(Component):
        """The equation would take the place of the state."""

        r = state("rad/s", "rate of turn")

        @r.rate
        def r(self):
            """Nobody (1900)."""
            return 0.0

    return Own


def two_equations_in_one_method() -> type[Component]:
    class Own(Component):
        """The first equation would be lost."""

        r = state("rad/s", "rate of turn")
        v = state("m/s", "sway speed")

        @r.rate
        def motion(self):
            """Nobody (1900)."""
            return 0.0

        @v.rate
        def motion(self):  # noqa: F811
            """Nobody (1900)."""
            return 0.0

    return Own


def a_helper_named_as_a_coefficient() -> type[Component]:
    class Own(Component):
        """The coefficient would be lost."""

        T = parameter("s", "time constant", start=10.0)

        def T(self):  # noqa: F811
            return 3.0

    return Own


@pytest.mark.parametrize(
    ("declare", "name", "kind"),
    [
        (twice_a_quantity, "K", r"a quantity \(parameter\)"),
        (a_method_named_as_its_state, "r", r"a quantity \(state\)"),
        (two_equations_in_one_method, "motion", "the method of an equation"),
        (a_helper_named_as_a_coefficient, "T", r"a quantity \(parameter\)"),
    ],
)
def test_a_name_that_is_used_twice_in_a_component_is_refused_with_both_lines(declare, name, kind):
    """Python keeps the last one: a state was lost without a word."""
    with pytest.raises(
        DeclarationError, match=rf"Own uses the name '{name}' twice .*in line \d+ for {kind}.* in line \d+ again"
    ):
        declare()


def test_a_component_that_inherits_may_declare_anew() -> None:
    class Wider(Turning):
        """The same with wider bounds."""

        K = parameter("1/s", "gain", start=0.1, low=0.001, high=10.0)

    assert declared_quantities(Wider)["K"].high == 10.0


@pytest.mark.parametrize("unit", [None, 1, 1.0])
def test_a_unit_that_is_no_text_is_refused(unit):
    with pytest.raises(
        DeclarationError, match=r"'B' of Own has the unit .*write it in quotes, as in 'm/s', or '1' for a number"
    ):

        class Own(Component):
            """A unit without quotes."""

            B = constant(unit, "beam")


@pytest.mark.parametrize(("name", "why"), [("t", r"what changes with it is an input"), ("Y_", "begins or ends with _")])
def test_a_reserved_name_says_why(name, why):
    with pytest.raises(DeclarationError, match=rf"'{name}': the name is reserved; .*{why}"):
        type("Own", (Component,), {name: parameter("1", "a coefficient", start=1.0)})
