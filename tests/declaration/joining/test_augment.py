"""Augmenting: parameters that become states."""

from math import exp, log

import pytest

from shipid import Component, augment, find_model, given, join, parameter, state
from shipid.declaration.joining.unit_check import check_units
from shipid.declaration.model import Evaluation
from shipid.foundation.errors import DeclarationError, UnknownNameError
from shipid.parameters.parameter_set import resolve

POINT = {"r": 0.012, "u": 5.0, "psi": 0.3, "delta": 0.2, "cruise": 6.0, "L": 45.0, "r_disturbance": 0.0}
POINT |= {"u_disturbance": 0.0, "current_north": 0.0, "current_east": 0.0}
SHIP = {"K": 1.2, "tau": 0.9, "K_u": 0.8, "tau_u": 2.0, "gamma": 0.4, "alpha1": 1.0, "alpha3": 2.0}


class Drag(Component):
    """A speed with three coefficients, whose lower bounds are zero, negative and missing."""

    u = state("m/s", "speed")
    thrust = given("m/s^2", "thrust over mass")
    linear = parameter("1/s", "linear drag", low=0.0, high=2.0)
    square = parameter("1/m", "quadratic drag", start=0.1, low=-1e-9, high=2.0)
    cubic = parameter("s/m^2", "cubic drag", start=0.1)

    @u.rate
    def surge(self):
        """Made up: one coefficient for each kind of lower bound."""
        return self.thrust - self.linear * self.u - self.square * self.u**2 - self.cubic * self.u**3


def rates(model, values):
    return {n: float(v) for n, v in Evaluation(model, values).right_hand_sides("rate").items()}


def test_a_positive_parameter_becomes_its_logarithm() -> None:
    model = find_model("de-keizer")
    wide = augment(model, ["K", "tau"])
    assert wide.states == (*model.states, "log_K", "log_tau")
    assert set(wide.parameters) == set(model.parameters) - {"K", "tau"}
    assert {"K", "tau"} <= set(wide.derived)
    rest = {n: v for n, v in SHIP.items() if n not in ("K", "tau")} | {"unit_K": 1.0, "unit_tau": 1.0}
    moved = rates(wide, POINT | rest | {"log_K": log(1.2), "log_tau": log(0.9)})
    wanted = rates(model, POINT | SHIP)
    assert moved.pop("log_K") == moved.pop("log_tau") == 0.0
    assert moved == pytest.approx(wanted, rel=1e-14)
    assert wide["log_K"].number("start") == pytest.approx(log(model["K"].number("start")))
    assert set(model.parameters) == set(SHIP)  # the first model is as it was


def test_a_parameter_of_either_sign_becomes_a_plain_state() -> None:
    wide = augment(find_model("de-keizer"), ["alpha1"])
    assert "alpha1" in wide.states and "log_alpha1" not in wide
    rest = {n: v for n, v in SHIP.items() if n != "alpha1"}
    got = rates(wide, POINT | rest | {"alpha1": -0.4})
    assert got.pop("alpha1") == 0.0
    assert got == pytest.approx(rates(find_model("de-keizer"), POINT | SHIP | {"alpha1": -0.4}), rel=1e-14)


def test_a_lower_bound_of_zero_asks_for_the_logarithm_and_no_bound_does_not() -> None:
    wide = augment(join("drag", Drag), ["linear", "square", "cubic"])
    assert set(wide.states) == {"u", "log_linear", "square", "cubic"}


def test_the_logarithm_starts_at_that_of_the_parameter_or_at_one_unit() -> None:
    wide = augment(join("drag", Drag), ["linear", "cubic"], log=["linear", "cubic"])
    started = {name: wide[name].number("start") for name in ("log_linear", "log_cubic")}
    assert started == {"log_linear": 0.0, "log_cubic": pytest.approx(log(0.1))}
    # ln 1 = 0: the parameter without a start begins at one of its unit.
    assert Evaluation(wide, {"log_linear": started["log_linear"], "unit_linear": 1.0})["linear"] == pytest.approx(1.0)


def test_the_logarithm_may_be_chosen() -> None:
    wide = augment(find_model("de-keizer"), ["K", "tau"], log=["K"])
    assert "log_K" in wide.states and "tau" in wide.states


def test_a_dimensional_parameter_keeps_its_unit() -> None:
    wide = augment(find_model("nomoto"), ["tau"])
    assert wide["tau"].unit == "s" and wide["log_tau"].unit == "1"
    assert Evaluation(wide, {"log_tau": log(31.0), "unit_tau": 1.0})["tau"] == pytest.approx(31.0)
    assert Evaluation(wide, {"log_tau": 0.3, "unit_tau": 1.0})["tau"] == pytest.approx(exp(0.3))
    assert resolve(wide, {}) == {"unit_tau": 1.0}
    check_units(wide)


def test_a_constant_may_be_augmented_too() -> None:
    wide = augment(find_model("de-keizer"), ["L"])
    assert "L" in wide.states and "L" not in wide.constants


@pytest.mark.parametrize(
    ("names", "log", "error", "words"),
    [
        (["Kx"], None, UnknownNameError, r"no parameter in model de-keizer called 'Kx'"),
        (["r"], None, UnknownNameError, r"called 'r'"),
        (["K"], ["tau"], DeclarationError, r"'tau' is to be in log scale but is not among the augmented: K"),
        (["alpha1"], ["alpha1"], DeclarationError, r"'alpha1' may be negative \(its lower bound is -5\)"),
    ],
)
def test_what_cannot_be_augmented_says_why(
    names: list[str], log: list[str] | None, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        augment(find_model("de-keizer"), names, log)


def test_augmenting_twice_is_refused() -> None:
    once = augment(find_model("de-keizer"), ["K"])
    with pytest.raises(UnknownNameError, match="called 'K'"):
        augment(once, ["K"])
    assert augment(find_model("de-keizer"), ["K", "K"]).states.count("log_K") == 1
