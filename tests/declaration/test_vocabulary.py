"""The vocabulary: every field consistent in itself, and numbers shown as a reader expects them."""

import math

import numpy as np
import pytest

from shipid.declaration import units
from shipid.declaration.vocabulary import FIELDS, angle, compass, display_unit, label, shown, to_display


@pytest.mark.parametrize("name", FIELDS)
def test_a_field_says_everything_in_units_that_fit(name: str) -> None:
    field = FIELDS[name]
    assert field.name == name
    assert units.factor(field.display, field.unit) > 0
    assert field.label[:1].isupper() and field.meaning and field.missing


def test_angles_are_shown_in_degrees_whatever_they_belong_to() -> None:
    assert display_unit("psi", "rad") == "deg"
    assert display_unit("my angle", "rad") == "deg"
    assert display_unit("my gain", "1/s") == "1/s"
    assert to_display(math.pi, "psi") == pytest.approx(180.0)
    assert np.allclose(to_display(np.array([0.0, 0.1]), "my rate", "rad/s"), np.rad2deg([0.0, 0.1]))
    assert shown(math.radians(10.25), "delta") == "10.25 deg"
    assert shown(0.5, "my gain", "1/s") == "0.5 1/s"
    assert shown(0.5, "my number", "1") == "0.5"
    assert angle(math.radians(3.0)) == "3 deg"


def test_a_heading_has_three_digits_and_is_never_360() -> None:
    shown_as = {7.04: "007.0", 359.94: "359.9", 359.96: "000.0", -0.01: "000.0", -90.0: "270.0", 725.0: "005.0"}
    assert {d: compass(math.radians(d)) for d in shown_as} == shown_as
    assert compass(math.radians(359.6), 0) == "000" and compass(np.float64(math.radians(45)), 0) == "045"


def test_a_label_outside_the_vocabulary_is_the_beginning_of_the_meaning() -> None:
    assert label("r") == "Rate of turn"
    assert label("gamma", "sway speed per rate of turn, positive") == "Sway speed per rate of turn"
    assert label("gamma") == "gamma"


def test_an_angle_that_is_none_is_zero_without_a_sign():
    assert [angle(v, 3) for v in (8.4e-250, -0.0, -0.1)] == ["0 deg", "0 deg", "-5.73 deg"]
