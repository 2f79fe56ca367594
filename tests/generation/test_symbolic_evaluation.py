"""What only numbers can do is refused with the model, the equation, the line, and what to write instead."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

import shipid
from shipid import Component, given, parameter, state
from shipid.foundation.errors import DeclarationError, UnitError
from shipid.generation.system import generate


def yaw_of(effect: Callable[[Any], Any]) -> Any:
    """A first-order model whose rudder works through a function."""

    class Yaw(Component):
        """A yaw model."""

        r = state("rad/s", "rate of turn, positive to starboard")
        delta = given("rad", "rudder angle, positive turns to starboard")
        K = parameter("1/s", "gain", start=0.05, low=0.001, high=1)
        tau = parameter("s", "time constant", start=10, low=0.5, high=200)

        @r.rate
        def yaw(self):
            """Own notes."""
            return (self.K * effect(self.delta) - self.r) / self.tau

    return shipid.join("yaw", Yaw)


def test_a_table_whose_places_fall_is_told_so() -> None:
    """NumPy's own interp gives anything there, and the advice was np.interp."""
    with pytest.raises(DeclarationError, match=r"np\.interp with rising places"):
        generate(yaw_of(lambda d: np.interp(d, [0.6, 0.0, -0.6], [-0.5, 0.0, 0.5])))


def chosen(delta):
    if delta > 0:
        return delta
    return 0.5 * delta


@pytest.mark.parametrize(
    ("effect", "advice"),
    [
        (lambda d: math.sin(d), "np.sin for math.sin"),
        (lambda d: float(d), "leave out float()"),
        (lambda d: np.array([d], dtype=float)[0], "np.array()"),
        (lambda d: int(d), "int()"),
        (lambda d: max(min(d, 0.3), -0.3), "np.maximum and np.minimum for max and min"),
        (chosen, "np.where(condition, a, b) for 'if'"),
        (lambda d: d if (d > 0 and d < 1) else -d, "np.logical_and"),
        (lambda d: d.magnitude, "elementwise functions"),
    ],
)
def test_what_only_numbers_can_do(effect, advice):
    with pytest.raises(DeclarationError) as caught:
        generate(yaw_of(effect))
    said = str(caught.value)
    assert said.startswith("model yaw, equation Yaw.yaw (")
    assert advice in said
    line = int(re.search(r"test_symbolic_evaluation\.py:(\d+)\)", said)[1])
    lines = Path(__file__).read_text(encoding="utf-8").splitlines()
    assert "delta > 0" in lines[line - 1] or "lambda" in lines[line - 1] or "effect(" in lines[line - 1]


def test_a_table_is_interpolated():
    angles, effects = [-0.6, 0.0, 0.4, 0.6], [-0.5, 0.0, 0.3, 0.5]
    system = generate(yaw_of(lambda d: np.interp(d, angles, effects)))
    p = system.vector(system.coefficients, {"K": 1.0, "tau": 1.0})
    for delta in (-0.9, -0.6, -0.1, 0.0, 0.2, 0.5, 0.7):
        rate = float(system.right_hand_side(0.0, delta, p))
        assert rate == pytest.approx(np.interp(delta, angles, effects), abs=1e-15)


def test_a_choice_among_symbols_and_constants_work():
    system = generate(yaw_of(lambda d: np.where(d > 0, np.minimum(d, 0.3), math.sin(0.2) * d)))
    p = system.vector(system.coefficients, {"K": 1.0, "tau": 1.0})
    assert float(system.right_hand_side(0.0, 0.5, p)) == pytest.approx(0.3)
    assert float(system.right_hand_side(0.0, -0.5, p)) == pytest.approx(-0.5 * math.sin(0.2))


def test_symbols_elsewhere_are_left_as_they_are():
    before = ca.SX.__float__
    with pytest.raises(DeclarationError):
        generate(yaw_of(lambda d: math.cos(d)))
    assert ca.SX.__float__ is before
    assert math.isnan(float(ca.SX.sym("x"))) and float(ca.SX(2)) == 2.0


def tried(d):
    try:
        return math.sin(d)
    except TypeError:
        return 0 * d


@pytest.mark.parametrize("effect", [tried, lambda d: d if isinstance(d, ca.SX) else 0.5 * d])
def test_other_numbers_over_symbols_are_refused(effect):
    with pytest.raises(DeclarationError, match=r"equation Yaw.yaw .* over numbers and .* over symbols"):
        generate(yaw_of(effect))


@pytest.mark.parametrize("effect", [np.deg2rad, np.rad2deg])
def test_a_conversion_of_units_is_refused(effect):
    with pytest.raises(UnitError, match=r"with units and .* over plain SI numbers"):
        yaw_of(effect)


@pytest.mark.parametrize("effect", [lambda d: d % 0.1, math.floor, lambda d: np.array([d, d])[1], lambda d: [0] * d])
def test_what_is_the_same_over_both_is_taken(effect):
    assert generate(yaw_of(effect)).states == ("r",)


def test_an_equation_that_ends_the_program_is_refused():
    def ends(_d):
        raise SystemExit(0)

    with pytest.raises(DeclarationError, match="SystemExit"):
        yaw_of(ends)
