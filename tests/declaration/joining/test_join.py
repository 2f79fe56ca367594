"""Joining: connections by name, and every mismatch named with both places."""

import re

import numpy as np
import pytest

from shipid import Component, constant, derived, given, join, parameter, state
from shipid.declaration.model import Evaluation
from shipid.foundation.errors import DeclarationError, UnitError, UnknownNameError


class Yaw(Component):
    """Rate of turn."""

    r = state("rad/s", "rate of turn")
    delta = given("rad", "rudder angle")
    L = constant("m", "length")
    u = given("m/s", "speed")
    K = parameter("1", "gain", start=1.0, low=0.1, high=10.0)

    @r.rate
    def yaw(self):
        """Anon (2000)."""
        return (self.u / self.L) ** 2 * self.K * self.delta


class Heading(Component):
    """Heading."""

    psi = state("rad", "heading")
    r = given("rad/s", "rate of turn")

    @psi.rate
    def turning(self):
        """Anon (2000)."""
        return self.r


class Speed(Component):
    """Speed from the heading, so that the order of joining matters to nothing."""

    u = derived("m/s", "speed")
    L = constant("m", "length", default="50 m")
    psi = given("rad", "heading")
    rate = constant("1/s", "a rate", default="0.1 1/s")

    @u.equals
    def speed(self):
        """Anon (2000)."""
        return self.L * self.rate * (1 + np.cos(self.psi))


def test_what_one_reads_another_states() -> None:
    model = join("ship", Yaw, Heading, Speed)
    assert model.states == ("r", "psi")
    assert model.inputs == ("delta",)
    assert model.constants == ("L", "rate")
    assert model.parameters == ("K",)
    assert model.derived == ("u",)
    values = {"r": 0.01, "psi": 0.0, "delta": 0.1, "K": 2.0, "L": 50.0, "rate": 0.1}
    sides = Evaluation(model, values).right_hand_sides("rate")
    assert sides["psi"] == 0.01
    assert sides["r"] == pytest.approx((10 / 50) ** 2 * 2 * 0.1)


@pytest.mark.parametrize("order", [(Yaw, Heading, Speed), (Speed, Heading, Yaw), (Heading, Yaw, Speed)])
def test_the_order_of_joining_changes_no_connection(order: tuple[type[Component], ...]) -> None:
    model = join("ship", *order)
    assert set(model.states) == {"r", "psi"}
    assert model.inputs == ("delta",)


def test_a_model_may_be_extended() -> None:
    small = join("small", Yaw, Heading)
    assert "u" in small.inputs
    assert join("large", small, Speed).inputs == ("delta",)
    assert small.inputs == ("delta", "u")


def test_a_constant_named_twice_is_one_and_its_default_is_kept() -> None:
    for order in ((Yaw, Speed, Heading), (Speed, Yaw, Heading)):
        assert join("ship", *order)["L"].number("default") == 50.0


def test_a_default_of_an_input_is_kept_whoever_reads_it_first() -> None:
    class WithDefault(Component):
        """Reads the rudder with a default."""

        x = state("rad", "angle")
        delta = given("rad", "rudder angle", default="5 deg")

        @x.rate
        def change(self):
            """Anon (2000)."""
            return self.delta * self.rate

        rate = constant("1/s", "a rate")

    assert join("ship", Yaw, WithDefault)["delta"].number("default") == pytest.approx(np.deg2rad(5))


def test_two_owners_are_both_named() -> None:
    class OtherHeading(Component):
        """States the heading too."""

        psi = derived("rad", "heading")
        time = given("s", "time")
        rate = constant("rad/s", "rate")

        @psi.equals
        def straight(self):
            """Anon (2000)."""
            return self.rate * self.time

    with pytest.raises(DeclarationError) as error:
        join("ship", Yaw, Heading, OtherHeading)
    text = str(error.value)
    assert re.search(r"'psi' is stated twice: by Heading \(state, .*test_join\.py:\d+\)", text)
    assert re.search(r"and by OtherHeading \(derived, .*test_join\.py:\d+\)", text)
    assert "given(...)" in text


def test_a_loop_is_shown_link_by_link() -> None:
    class A(Component):
        """Half a loop."""

        a = derived("m", "one")
        b = given("m", "other")

        @a.equals
        def one(self):
            """Anon (2000)."""
            return 2 * self.b

    class B(Component):
        """The other half."""

        b = derived("m", "other")
        a = given("m", "one")

        @b.equals
        def other(self):
            """Anon (2000)."""
            return self.a / 3

    with pytest.raises(DeclarationError, match=r"model ship has an algebraic loop: a -> b -> a \(A\.a, B\.b\)"):
        join("ship", A, B)


def test_terms_that_do_not_match_are_named_with_their_line() -> None:
    class Wrong(Component):
        """Adds an angle to a rate."""

        r = state("rad/s", "rate of turn")
        psi = given("rad", "heading")
        tau = parameter("s", "time constant", start=1.0)

        @r.rate
        def yaw(self):
            """Anon (2000)."""
            late = self.psi / self.tau
            return (late + self.psi) / self.tau

    with pytest.raises(UnitError) as error:
        join("ship", Wrong)
    text = str(error.value)
    assert "model ship, equation Wrong.yaw" in text
    line = int(re.search(r"test_join\.py:(\d+)", text).group(1))
    with open(__file__, encoding="utf-8") as file:
        assert "late + self.psi" in file.readlines()[line - 1]
    assert "rad/s against rad" in text


def test_a_result_of_the_wrong_unit_names_both() -> None:
    class Wrong(Component):
        """Forgets to divide by the time constant."""

        r = state("rad/s", "rate of turn")
        delta = given("rad", "rudder angle")
        K = parameter("1/s", "gain", start=1.0)

        @r.rate
        def yaw(self):
            """Anon (2000)."""
            return self.K * self.delta

    with pytest.raises(UnitError, match=r"Wrong\.yaw \(.*:\d+\): dr/dt needs rad/s², and the equation gives rad/s\."):
        join("ship", Wrong)


def test_a_bare_number_is_refused_where_a_unit_is_needed() -> None:
    class Wrong(Component):
        """Gravity without a unit."""

        u = state("m/s", "speed")

        @u.rate
        def fall(self):
            """Newton (1687)."""
            return 9.81

    with pytest.raises(UnitError, match=r"du/dt needs m/s², and the equation gives 1"):
        join("ship", Wrong)


def test_a_bare_zero_fits_everywhere() -> None:
    class Still(Component):
        """Keeps its speed."""

        u = state("m/s", "speed")

        @u.rate
        def keep(self):
            """Newton (1687)."""
            return 0.0

    assert join("ship", Still).states == ("u",)


def test_units_that_two_components_disagree_about_are_named() -> None:
    class InDegreesOfTrim(Component):
        """Reads the rate of turn as an angle."""

        x = state("rad", "angle")
        r = given("rad", "rate of turn, by mistake an angle")
        rate = constant("1/s", "a rate")

        @x.rate
        def change(self):
            """Anon (2000)."""
            return self.r * self.rate

    with pytest.raises(UnitError, match=r"Yaw states 'r' in rad/s, and InDegreesOfTrim reads it in rad\."):
        join("ship", Yaw, InDegreesOfTrim)

    class OtherLength(Component):
        """A length in square metres."""

        x = state("m^2", "area")
        L = constant("m^2", "length, by mistake an area")
        rate = constant("1/s", "a rate")

        @x.rate
        def change(self):
            """Anon (2000)."""
            return self.L * self.rate

    with pytest.raises(UnitError, match=r"the constant 'L' is in m in Yaw and in m² in OtherLength"):
        join("ship", Yaw, OtherLength)


@pytest.mark.parametrize(
    ("unit", "instead"),
    [("deg/s", "rad/s"), ("kn", "m/s"), ("km", "m"), ("deg", "rad"), ("rpm", "rps"), ("kN m", "kg·m²/s²"), ("%", "1")],
)
def test_a_declaration_is_in_si(unit: str, instead: str) -> None:
    wrong = type("Wrong", (Component,), {"r": given(unit, "something")})
    words = rf"'r' of Wrong is declared in .*, which is not a coherent SI unit\. Declare it in {instead}:"
    with pytest.raises(UnitError, match=words):
        join("ship", Yaw, wrong)


def test_a_unit_that_does_not_exist_says_where() -> None:
    wrong = type("Wrong", (Component,), {"q": given("furlongz", "something")})
    with pytest.raises(UnitError, match=r"'q' of Wrong: 'furlongz' is not a unit"):
        join("ship", Yaw, wrong)


def test_an_undeclared_name_is_refused_with_the_nearest() -> None:
    class Wrong(Component):
        """Misspells the rudder."""

        r = state("rad/s", "rate of turn")
        delta = given("rad", "rudder angle")
        tau = parameter("s", "time constant", start=1.0)

        @r.rate
        def yaw(self):
            """Anon (2000)."""
            return self.detla / self.tau**2

    with pytest.raises(DeclarationError, match=r"Wrong reads 'detla'.*Did you mean delta or tau\?.*given\(\.\.\.\)"):
        join("ship", Wrong)


def test_an_equation_that_raises_or_returns_nothing_is_named() -> None:
    class Raises(Component):
        """Divides by zero."""

        x = state("1", "something")

        @x.rate
        def change(self):
            """Anon (2000)."""
            return 1 / 0

    class Nothing(Component):
        """Forgets to return."""

        x = state("1", "something")

        @x.rate
        def change(self):
            """Anon (2000)."""

    with pytest.raises(
        DeclarationError, match=r"equation Raises\.change \(.*:\d+\) raises ZeroDivisionError.*and not of arrays\.$"
    ):
        join("ship", Raises)
    with pytest.raises(DeclarationError, match=r"equation Nothing\.change \(.*:\d+\) returns nothing"):
        join("ship", Nothing)


@pytest.mark.parametrize(
    ("result", "said"),
    [
        (lambda s: (s.r / s.tau,), "returns a tuple, and r is one number"),
        (lambda s: [s.r / s.tau], "returns a list, and r is one number"),
        (lambda s: "r", "returns a str, and r is one number"),
        (lambda s: np.zeros(3), "returns a ndarray, and r is one number"),
        (lambda s: s.r / s.tau * np.ones(2), "returns 2 numbers, and r is one"),
        (lambda s: s.r / s.tau / 0, "gives no finite number, whatever is put into it"),
        (lambda s: s.r / s.tau * float("nan"), "gives no finite number, whatever is put into it"),
        (lambda s: s.r / s.tau * np.log(-abs(s.a)), "gives no finite number, whatever is put into it"),
    ],
)
def test_an_equation_that_gives_no_number_or_several_is_named(result, said) -> None:
    class Odd(Component):
        """Gives what is no rate of turn."""

        r = state("rad/s", "rate of turn")
        a = given("1", "something")
        tau = parameter("s", "time constant", start=1.0)

        @r.rate
        def yaw(self):
            """Anon (2000)."""
            return result(self)

    with pytest.raises(DeclarationError, match=rf"equation Odd\.yaw \(.*:\d+\) {said}"):
        join("ship", Odd)


def test_an_equation_that_is_finite_for_some_numbers_only_is_one() -> None:
    class Odd(Component):
        """The root of what is negative for most numbers."""

        r = state("rad/s", "rate of turn")
        a = given("1", "something")
        tau = parameter("s", "time constant", start=1.0)

        @r.rate
        def yaw(self):
            """Anon (2000)."""
            return self.r / self.tau * np.sqrt(self.a - 1.2)

    assert join("ship", Odd).inputs == ("a",)


def test_comparisons_are_told_in_words_of_our_own() -> None:
    class Compared(Component):
        """Compares a length with a number."""

        x = state("m", "something")

        @x.rate
        def change(self):
            """Anon (2000)."""
            return self.x if self.x > 3 else 0

    class Truth(Component):
        """Gives true or false, for units that differ: nothing equals nothing of another kind."""

        x = state("m", "something")
        T = given("s", "time constant")

        @x.rate
        def change(self):
            """Anon (2000)."""
            return self.x == self.T

    with pytest.raises(
        UnitError, match=r"Compared\.change \(.*:\d+\): the units do not match: .* compared with a number"
    ):
        join("ship", Compared)
    with pytest.raises(DeclarationError, match=r"Truth\.change \(.*:\d+\) gives true or false, and x is a number"):
        join("ship", Truth)


def test_join_takes_components_and_models_only() -> None:
    with pytest.raises(DeclarationError, match=r"join takes component classes and models, and got 'Yaw'"):
        join("ship", "Yaw")
    with pytest.raises(DeclarationError, match=r"a model needs a name"):
        join(" ", Yaw)
    with pytest.raises(DeclarationError, match=r"joins no component that states anything"):
        join("ship")


def test_an_attribute_with_the_wrong_unit_says_whose() -> None:
    class Wrong(Component):
        """A start in the wrong unit."""

        x = state("m", "position", start="3 kg")

        @x.rate
        def still(self):
            """Anon (2000)."""
            return 0.0

    with pytest.raises(UnitError, match=r"start of 'x' in Wrong needs the unit m, and kg does not fit it"):
        join("ship", Wrong)


def test_an_unknown_quantity_of_a_model_offers_the_nearest() -> None:
    model = join("ship", Yaw, Heading)
    with pytest.raises(UnknownNameError, match=r"no quantity in model ship called 'pssi'. Did you mean psi\?"):
        model["pssi"]
    assert "psi" in model and "pssi" not in model


def test_the_angle_has_to_be_named() -> None:
    class WithN3(Component):
        """A cubic coefficient whose value is refused without an angle."""

        x = state("1", "something")
        n3 = constant("s^2/rad^2", "cubic coefficient", default="0.4 s^2")

        @x.rate
        def still(self):
            """Anon (2000)."""
            return 0.0

    with pytest.raises(UnitError, match=r"s²/rad², and s² does not say which angle it counts in\. .* s²/deg²"):
        join("ship", WithN3)


class Scaled(Component):
    """What two components of a ship have in common."""

    u = given("m/s", "speed")
    L = constant("m", "length")
    pace = derived("1/s", "ship lengths per second")
    share = parameter("1", "share of the speed that counts", start=1.0, low=0.1, high=2.0)

    def counted(self):
        """The speed that counts."""
        return self.share * self.u

    @pace.equals
    def scale(self):
        """Anon (2000)."""
        return self.counted() / self.L


class ScaledYaw(Scaled):
    """Reads the common scale."""

    r = state("rad/s", "rate of turn")

    @r.rate
    def yaw(self):
        """Anon (2000)."""
        return -self.pace * self.r


class ScaledSpeed(Scaled):
    """Reads the common scale too, and states what the other reads."""

    u = state("m/s", "speed")

    @u.rate
    def slowing(self):
        """Anon (2000)."""
        return -self.pace * self.u


def test_what_two_components_inherit_unchanged_is_stated_once() -> None:
    for order in ((ScaledYaw, ScaledSpeed), (ScaledSpeed, ScaledYaw)):
        model = join("ship", *order)
        assert set(model.states) == {"u", "r"}
        assert (model.derived, model.parameters, model.inputs) == (("pace",), ("share",), ())
        sides = Evaluation(model, {"u": 6.0, "r": 0.01, "L": 100.0, "share": 0.5}).right_hand_sides("rate")
        assert sides["u"] == pytest.approx(-0.03 * 6.0)
        assert sides["r"] == pytest.approx(-0.03 * 0.01)
    assert join("ship", join("half", ScaledYaw), ScaledSpeed).states == ("u", "r")


def test_an_equation_that_replaces_the_inherited_one_is_stated_by_both() -> None:
    class Slow(ScaledSpeed):
        """Scales in its own way."""

        def scale(self):
            """Anon (2001)."""
            return 0.5 * self.u / self.L

    class SlowAsWell(Slow):
        """Inherits that way."""

    class Slower(ScaledYaw):
        """Scales in another way."""

        def scale(self):
            """Anon (2002)."""
            return 0.25 * self.u / self.L

    words = r"'pace' is stated twice: by (\w+) \(derived, .*test_join\.py:\d+\) and by (\w+) \(derived, .*test_join\.py:\d+\)"
    for pair in ((ScaledYaw, Slow), (Slow, ScaledYaw), (Slower, Slow)):
        with pytest.raises(DeclarationError) as error:
            join("ship", *pair)
        found = re.search(words, str(error.value))
        assert found and found.groups() == tuple(c.__name__ for c in pair)
    with pytest.raises(DeclarationError, match=r"'pace' is stated twice: by ScaledYaw .* and by SlowAsWell "):
        join("ship", ScaledYaw, SlowAsWell)


def test_one_replacement_inherited_by_two_is_stated_once() -> None:
    class Halved(Scaled):
        """Scales in its own way, by a plain method that replaces the equation."""

        def scale(self):
            """Anon (2001)."""
            return 0.5 * self.u / self.L

    class HalvedYaw(Halved):
        """Reads it."""

        r = state("rad/s", "rate of turn")

        @r.rate
        def yaw(self):
            """Anon (2000)."""
            return -self.pace * self.r

    class HalvedTrim(Halved):
        """Reads it as well."""

        trim = state("rad", "trim")

        @trim.rate
        def settling(self):
            """Anon (2000)."""
            return -self.pace * self.trim

    assert join("ship", HalvedYaw, HalvedTrim).derived == ("pace",)


def test_an_inherited_equation_with_another_helper_is_another_statement() -> None:
    class Counted(ScaledSpeed):
        """Keeps the equation of the scale, and changes what it calls."""

        def counted(self):
            """The speed that counts, halved."""
            return 0.5 * self.share * self.u

    for pair in ((ScaledYaw, Counted), (Counted, ScaledYaw)):
        with pytest.raises(DeclarationError, match=r"'pace' is stated twice: by \w+ \(derived.* and by \w+ \(derived"):
            join("ship", *pair)


def test_a_quantity_declared_anew_is_stated_by_both() -> None:
    class OtherShare(ScaledSpeed):
        """Bounds the shared parameter anew."""

        share = parameter("1", "share of the speed that counts", start=1.5, low=1.0, high=2.0)

    with pytest.raises(
        DeclarationError, match=r"'share' is stated twice: by ScaledYaw \(parameter\) and by OtherShare"
    ):
        join("ship", ScaledYaw, OtherShare)
    with pytest.raises(DeclarationError, match=r"stated twice: by ScaledYaw .* and by ScaledYaw"):
        join("ship", ScaledYaw, ScaledYaw)


@pytest.mark.parametrize(("name", "unit"), [("n", "rad/s"), ("n_order", "rad/s")])
def test_a_shaft_is_counted_in_models_too(name: str, unit: str) -> None:
    """Samples of a record go into a model as they are: n in rad/s would be driven with revolutions per second."""
    wrong = type("Engine", (Component,), {name: given(unit, "something")})
    with pytest.raises(UnitError, match=rf"Engine declares '{name}' in .* Declare it in that unit"):
        join("ship", Yaw, wrong)


def test_an_angle_may_be_declared_as_a_number() -> None:
    assert "n" in join("ship", Yaw, type("Engine", (Component,), {"n": given("1/s", "revolutions")})).inputs
