"""The prime system: factors, starts and bounds of coefficients, and what a scale that is not known leaves open."""

import math

import pytest

from shipid import find_model
from shipid.declaration.scale import Scale, prime_exponents
from shipid.foundation.errors import UnitError


@pytest.mark.parametrize(
    ("text", "exponents"),
    [("1/s", (0, -1)), ("s", (0, 1)), ("m", (1, 0)), ("s^2/rad^2", (0, 2)), ("m/s", (1, -1)), ("1", (0, 0))],
)
def test_the_prime_system(text: str, exponents: tuple[float, float]) -> None:
    assert prime_exponents(text) == exponents


def test_the_prime_system_scales_with_length_and_speed() -> None:
    assert Scale(45.0, 5.0).factor("1/s") == pytest.approx(5.0 / 45.0)
    assert Scale(45.0, 5.0).factor("s^2/rad^2") == pytest.approx(81.0)
    assert Scale(45.0, 5.0).factor("m/rad") == pytest.approx(45.0)
    with pytest.raises(UnitError, match="kg is not made of lengths and times"):
        prime_exponents("kg")


def test_start_and_bounds_follow_the_scale() -> None:
    entry = find_model("nomoto")["K"]
    small, large = Scale(10.0, 2.0), Scale(20.0, 2.0)
    assert entry.quantity.prime
    assert small.start_of(entry) == pytest.approx(2 * large.start_of(entry))  # K is per second: U/L
    assert small.bounds_of(entry)[1] == pytest.approx(2 * large.bounds_of(entry)[1])
    assert small.start_of(entry) == pytest.approx(entry.number("start") * 2.0 / 10.0)
    assert small.unit_time == 5.0


def test_what_is_declared_without_prime_is_not_scaled() -> None:
    entry = find_model("de-keizer")["K"]
    assert not entry.quantity.prime
    assert Scale(10.0, 2.0).start_of(entry) == entry.number("start")
    assert Scale(None, None).start_of(entry) == entry.number("start")


@pytest.mark.parametrize("scale", [Scale(None, 5.0), Scale(45.0, None), Scale(0.0, 5.0), Scale(45.0, 0.0)])
def test_a_scale_that_is_not_known_gives_no_number(scale: Scale) -> None:
    entry = find_model("nomoto")["K"]
    assert not scale.known
    assert math.isnan(scale.unit_time)
    assert math.isnan(scale.factor("1/s"))
    assert scale.factor("1") == 1.0
    assert scale.start_of(entry) is None
    low, high = scale.bounds_of(entry)
    assert (low == 0.0 or math.isinf(low)) and math.isinf(high)
