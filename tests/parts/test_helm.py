"""The helmsmen alone, over plain numbers."""

from typing import Any

import pytest

from shipid import Component, join
from shipid.declaration.model import Evaluation
from shipid.parts.helm import CourseHelm, DirectRudder, RateHelm, ScheduledOrder, TurningHelm, ZigzagHelm


def ask(helm: type[Component], name: str, **values: float) -> float:
    evaluation = Evaluation(join("helm", helm), values | {"T_s": 0.5})
    sides: dict[str, Any] = evaluation.right_hand_sides("equals") | evaluation.right_hand_sides("next")
    return float(sides[name])


ZIGZAG = {"helm_start": 10.0, "helm_course": 0.4, "helm_rudder": 0.3, "helm_heading": 0.2, "helm_clock": 50.0}
TURN = {"helm_start": 10.0, "helm_course": 0.4, "helm_rudder": 0.3, "helm_turn": 9.4, "helm_clock": 50.0}


@pytest.mark.parametrize(("clock", "order"), [(0.0, 0.0), (9.5, 0.0), (9.9, 0.3), (10.0, 0.3)])
def test_the_rudder_is_amidships_on_the_approach(clock: float, order: float) -> None:
    """Half an interval early counts as on time: the clock adds up rounding."""
    assert ask(ZigzagHelm, "delta_order", **ZIGZAG | {"helm_clock": clock}, psi=0.4, helm_side=1.0) == order
    assert ask(TurningHelm, "delta_order", **TURN | {"helm_clock": clock}, psi=0.4, helm_released=0.0) == order


@pytest.mark.parametrize(("rudder", "psi", "side", "after"), [
    (0.3, 0.59, 1.0, 1.0), (0.3, 0.61, 1.0, -1.0), (0.3, 0.61, -1.0, -1.0), (0.3, 0.19, -1.0, 1.0),
    (-0.3, 0.19, 1.0, -1.0), (-0.3, 0.61, 1.0, 1.0), (-0.3, 0.61, -1.0, 1.0),
])  # fmt: skip
def test_a_zigzag_is_reversed_on_the_side_of_the_swing(rudder: float, psi: float, side: float, after: float) -> None:
    values = ZIGZAG | {"helm_rudder": rudder, "psi": psi, "helm_side": side}
    assert ask(ZigzagHelm, "helm_side", **values) == after
    assert ask(ZigzagHelm, "delta_order", **values) == side * rudder


def test_the_clock_ticks() -> None:
    assert ask(ZigzagHelm, "helm_clock", **ZIGZAG, psi=0.0, helm_side=1.0) == 50.5


def test_a_turn_is_released_once_and_for_good() -> None:
    assert ask(TurningHelm, "helm_released", **TURN, psi=9.7, helm_released=0.0) == 0
    assert ask(TurningHelm, "helm_released", **TURN, psi=9.9, helm_released=0.0) == 1
    assert ask(TurningHelm, "helm_released", **TURN, psi=-9.1, helm_released=0.0) == 1
    assert ask(TurningHelm, "helm_released", **TURN, psi=0.0, helm_released=1.0) == 1
    assert ask(TurningHelm, "delta_order", **TURN, psi=0.0, helm_released=1.0) == 0


def test_a_course_is_steered_within_the_limit() -> None:
    law = {"helm_gain": 2.0, "helm_damping": 10.0, "helm_limit": 0.3, "helm_schedule": 1.0}
    assert ask(CourseHelm, "delta_order", **law, psi=0.95, r=0.002) == pytest.approx(2 * 0.05 - 0.02)
    assert ask(CourseHelm, "delta_order", **law, psi=0.0, r=0.0) == 0.3
    assert ask(CourseHelm, "delta_order", **law, psi=2.0, r=0.0) == -0.3


def test_a_rate_is_sought() -> None:
    law = {"helm_gain": 20.0, "helm_reset": 30.0, "helm_limit": 0.3, "helm_schedule": 0.01, "helm_integral": 0.06}
    assert ask(RateHelm, "delta_order", **law, r=0.004) == pytest.approx(20 * (0.006 + 0.002))
    assert ask(RateHelm, "delta_order", **law, r=0.1) == -0.3
    assert ask(RateHelm, "helm_integral", **law, r=0.004) == pytest.approx(0.06 + 0.5 * 0.006)


def test_orders_are_passed_on() -> None:
    assert ask(ScheduledOrder, "delta_order", helm_schedule=0.123) == 0.123
    assert ask(DirectRudder, "delta", delta_order=0.123) == 0.123
