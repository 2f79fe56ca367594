"""Models as immutable data: what they list, and the new models that are made of them."""

import pickle
from dataclasses import FrozenInstanceError

import pytest

from shipid import Component, derived, find_model, given, join, parameter, state
from shipid.declaration.joining.join import replace_component
from shipid.declaration.model import Evaluation
from shipid.foundation.errors import DeclarationError, UnknownNameError
from shipid.models import DeKeizer, DeKeizerMinimal, Norrbin, PlanarMotion, VanLeeuwenSway
from shipid.parameters.parameter_set import resolve

POINT = {"r": 0.012, "delta": 0.2, "u": 5.0, "v": 0.0, "psi": 0.3, "r_disturbance": 0.0}
POINT |= {"current_north": 0.0, "current_east": 0.0}


def test_a_model_lists_what_it_holds() -> None:
    model = find_model("norrbin")
    assert model.states == ("r", "x", "y", "psi")
    assert model.inputs == ("delta", "r_disturbance", "u", "v", "current_north", "current_east")
    assert model.parameters == ("a", "b1", "b3")
    assert model.derived == ("K", "tau", "n3")
    assert model.constants == model.outputs == ()
    assert not model.is_sampled
    assert find_model("pershitz-track").is_sampled
    assert "norrbin" in repr(model) and "b3" in repr(model)


def test_a_model_cannot_be_changed() -> None:
    model = find_model("norrbin")
    with pytest.raises(FrozenInstanceError):
        model.name = "other"
    with pytest.raises(TypeError):
        model.entries["r"] = model["psi"]
    with pytest.raises(FrozenInstanceError):
        model["r"].owner = PlanarMotion


def test_a_model_goes_through_pickle() -> None:
    """Worker processes get it that way; an equation that was replaced, inherited or imposed comes along."""
    for model in (find_model("de-keizer"), find_model("norrbin").impose(["n3"])):
        again = pickle.loads(pickle.dumps(model))
        assert again.name == model.name
        assert tuple(again.entries) == tuple(model.entries)
        assert hash(again) == hash(model)
        numbers = {n: 0.7 for n in model.entries if n not in model.derived}
        rates = [Evaluation(m, numbers).right_hand_sides("rate") for m in (model, again)]
        assert rates[0] == rates[1]


def test_imposing_a_published_coefficient_turns_the_fitted_one_into_a_derived_one() -> None:
    model = find_model("norrbin")
    imposed = model.impose(["n3"])
    assert imposed.parameters == ("a", "b1")
    assert imposed.constants == ("n3",)
    assert set(imposed.derived) == {"K", "tau", "b3"}
    values = POINT | {"a": 0.016, "b1": 0.032, "n3": 1313.0}
    evaluation = Evaluation(imposed, values)
    assert evaluation["b3"] == pytest.approx(1313.0 * 0.032)
    by_hand = 0.016 * 0.2 - 0.032 * 0.012 - 1313.0 * 0.032 * 0.012**3
    assert evaluation.right_hand_sides("rate")["r"] == pytest.approx(by_hand, rel=1e-12)
    assert model.parameters == ("a", "b1", "b3")


def test_imposing_all_leaves_nothing_to_estimate() -> None:
    imposed = find_model("norrbin").impose(["K", "tau", "n3"])
    assert imposed.parameters == ()
    values = POINT | {"K": 0.5, "tau": 31.0, "n3": 1313.0}
    by_hand = (0.5 * 0.2 - 0.012 - 1313.0 * 0.012**3) / 31.0
    assert Evaluation(imposed, values).right_hand_sides("rate")["r"] == pytest.approx(by_hand, rel=1e-12)


def test_two_published_coefficients_that_define_the_same_two_parameters() -> None:
    """Bech's time constants: each takes a parameter of its own, and one alone is refused."""
    model = find_model("bech")
    imposed = model.impose(["tau1", "tau2"])
    assert imposed.parameters == ("d1", "d0", "c3")
    values = POINT | {"w": 0.0, "tau1": 118.0, "tau2": 7.8, "d1": 1e-4, "d0": 1e-6, "c3": 0.0}
    evaluation = Evaluation(imposed, values)
    assert evaluation["c0"] == pytest.approx(1 / (118.0 * 7.8))
    assert evaluation["c1"] == pytest.approx((118.0 + 7.8) / (118.0 * 7.8))
    with pytest.raises(DeclarationError, match=r"algebraic loop.*Give the published coefficients.*tau1 as well"):
        model.impose(["tau1"])


def test_what_cannot_be_imposed_is_refused_with_what_can() -> None:
    with pytest.raises(DeclarationError, match=r"'v' of model de-keizer is a derived quantity .* What can: K, tau"):
        find_model("de-keizer").impose(["v"])
    with pytest.raises(UnknownNameError, match=r"no quantity in model norrbin called 'n4'. Did you mean n3\?"):
        find_model("norrbin").impose(["n4"])


def test_the_partner_of_a_published_coefficient() -> None:
    model = find_model("norrbin")
    assert [model.partner(n) for n in ("K", "tau", "n3", "a", "r")] == ["a", "b1", "b3", None, None]


def test_resolving_works_out_fitted_from_published() -> None:
    model = find_model("norrbin")
    assert resolve(model, {"K": 0.5, "tau": 31.0, "n3": 1313.0}) == pytest.approx(
        {"a": 0.5 / 31, "b1": 1 / 31, "b3": 1313 / 31}
    )
    assert resolve(model, {"tau": 31.0}) == pytest.approx({"b1": 1 / 31})
    assert resolve(model, {"a": 0.02, "tau": 31.0, "K": 0.5})["a"] == 0.02  # what is given stays
    assert resolve(model, {}) == {}
    assert resolve(model, {"tau": 0.0}) == {}  # 1/0 determines nothing


def test_replacing_a_component() -> None:
    model = find_model("de-keizer")
    minimal = replace_component(model, DeKeizer, DeKeizerMinimal, "minimal")
    assert minimal.name == "minimal"
    assert minimal.components == (DeKeizerMinimal, VanLeeuwenSway, PlanarMotion)
    assert "alpha3" not in minimal and "alpha3" in model
    assert replace_component(model, DeKeizer, DeKeizerMinimal).name == "de-keizer"
    with pytest.raises(DeclarationError, match=r"model de-keizer has no component Norrbin to replace"):
        replace_component(model, Norrbin, DeKeizer)


def test_an_equation_is_evaluated_once_and_only_when_asked() -> None:
    calls = []

    class Counted(Component):
        """Counts."""

        x = state("1", "something")
        y = derived("1", "half of it")
        z = derived("1", "not read")
        rate = given("1/s", "a rate")

        @y.equals
        def half(self):
            """Anon (2000)."""
            calls.append("y")
            return self.x / 2

        @z.equals
        def unread(self):
            """Anon (2000)."""
            calls.append("z")
            return self.x

        @x.rate
        def change(self):
            """Anon (2000)."""
            return (self.y + self.y) * self.rate

    model = join("counted", Counted)
    calls.clear()
    evaluation = Evaluation(model, {"x": 3.0, "rate": 1.0})
    assert evaluation.right_hand_sides("rate") == {"x": 3.0}
    assert calls == ["y"]


def test_a_value_given_for_a_derived_quantity_stands_for_its_equation() -> None:
    values = POINT | {"a": 0.016, "b1": 0.032, "b3": 0.0, "K": 7.0}
    assert Evaluation(find_model("norrbin"), values)["K"] == 7.0


def test_a_missing_value_is_named_or_asked_for() -> None:
    model = find_model("norrbin")
    with pytest.raises(DeclarationError, match=r"the parameter 'b1' of model norrbin has no value"):
        Evaluation(model, {"a": 1.0})["K"]
    assert Evaluation(model, {"a": 1.0}, missing=lambda _: 4.0)["K"] == 0.25


def test_equations_run_over_symbols_as_they_do_over_floats() -> None:
    """One method, one meaning: CasADi's symbols and plain floats give the same number."""
    casadi = pytest.importorskip("casadi")
    import warnings

    model = find_model("de-keizer")
    numbers = POINT | {"cruise": 6.0, "L": 45.0, "K": 1.2, "tau": 0.9, "K_u": 0.8, "tau_u": 2.0, "gamma": 0.4}
    numbers |= {"alpha1": 1.0, "alpha3": 2.0, "u_disturbance": 0.0}
    numbers.pop("v")
    symbols = {n: casadi.SX.sym(n) for n in numbers}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # CasADi announces its NumPy mode, which generation sets and this test does not
        sides = Evaluation(model, symbols).right_hand_sides("rate")
    wanted = Evaluation(model, numbers).right_hand_sides("rate")
    function = casadi.Function("f", list(symbols.values()), list(sides.values()))
    got = function(*numbers.values())
    assert [float(g) for g in got] == pytest.approx(list(wanted.values()), rel=1e-14)


class Scaled(Component):
    """A model of the test, for units of start and bounds."""

    x = state("rad", "angle", nominal="10 deg", start="90 deg")
    rate = parameter("rad/s", "rate", start="1 deg/s", low=0.0, high="10 deg/s")

    @x.rate
    def change(self):
        """Anon (2000)."""
        return self.rate


def test_numbers_of_a_declaration_come_out_in_si() -> None:
    model = join("scaled", Scaled)
    assert model["x"].number("start") == pytest.approx(1.5707963267948966)
    assert model["rate"].number("high") == pytest.approx(0.17453292519943295)
    assert model["rate"].number("low") == 0.0
    assert model["x"].number("low") is None
