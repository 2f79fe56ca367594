"""Guards: margins declared with a model, apart from its derived quantities, checked for their unit."""

from __future__ import annotations

import pytest

from shipid import Component, guard, join, state
from shipid.declaration.model import Evaluation
from shipid.foundation.errors import DeclarationError, UnitError


class Plain(Component):
    """A guard with numbers of its own."""

    u = state("m/s", "speed")
    slow = guard("m/s", "it is faster than u itself")

    @u.rate
    def push(self):
        """Nothing pushes."""
        return 0.0

    @slow.equals
    def margin(self):
        """Twice the speed less three times."""
        return 2 * self.u - 3 * self.u


def test_a_guard_is_a_kind_of_its_own():
    model = join("plain", Plain)
    assert model.guards == ("slow",)
    assert "slow" not in model.derived + model.outputs + model.inputs
    assert Evaluation(model, {"u": 4.0})["slow"] == -4.0


def test_a_guard_needs_its_equation():
    with pytest.raises(
        DeclarationError, match=r"guard 'bare' of Bare has no equation: add a method under @bare\.equals"
    ):

        class Bare(Component):
            """Without a margin."""

            bare = guard("1", "never")


def test_the_unit_of_a_margin_is_checked():
    class Wrong(Component):
        """A margin in the wrong unit."""

        x = state("m", "position")
        kept = guard("m/s", "too far")

        @x.rate
        def still(self):
            """It rests."""
            return 0.0

        @kept.equals
        def margin(self):
            """A length."""
            return self.x

    with pytest.raises(UnitError, match=r"Wrong\.margin.*kept needs m/s, and the equation gives m"):
        join("wrong", Wrong)


def test_components_share_a_guard_they_inherit():
    from shipid.models import BechYaw, Surge, VanLeeuwenSway

    assert join("both", BechYaw, Surge, VanLeeuwenSway).guards == ("way_kept",)
