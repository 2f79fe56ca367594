"""Units at the border: a value without one, with a wrong one, or with no angle, is refused."""

from math import pi

import pytest
from hypothesis import given as given_values
from hypothesis import strategies as st

from shipid.declaration import units
from shipid.foundation.errors import UnitError


@pytest.mark.parametrize(
    ("value", "wanted", "si"),
    [
        ("9 kn", "m/s", 9 * 1852 / 3600),
        ("180 deg", "rad", pi),
        ("30 deg/min", "rad/s", pi / 360),
        ("0.4 s^2/deg^2", "s^2/rad^2", 0.4 * (180 / pi) ** 2),
        ("0.4 s²/deg²", "s^2/rad^2", 0.4 * (180 / pi) ** 2),
        ("0.4 s**2/deg**2", "s^2/rad^2", 0.4 * (180 / pi) ** 2),
        ("20 °", "rad", pi / 9),
        ("1600 mil", "rad", pi / 2),
        ("-320 mils", "deg", -18.0),
        ("60 rpm", "rps", 1.0),
        ("2 rps", "1/s", 2.0),
        ("2 1/s", "rps", 2.0),
        ("120 rev/min", "1/s", 2.0),
        ("-1.5e3 m", "km", -1.5),
        ((2.0, "km"), "m", 2000.0),
        ("3", "1", 3.0),
        (3, "1", 3.0),
        ("1.7 -", "1", 1.7),
        ("−2.7 × 10⁻⁶ 1/s", "1/s", -2.7e-6),
    ],
)
def test_values_come_in_with_a_unit(value: object, wanted: str, si: float) -> None:
    assert units.to_si(value, wanted) == pytest.approx(si, rel=1e-12)


def test_the_published_cubic_coefficient_is_three_thousand_times_itself() -> None:
    ratio = units.to_si("0.4 s^2/deg^2", "s^2/rad^2") / units.to_si("0.4 s^2/rad^2", "s^2/rad^2")
    assert ratio == pytest.approx(3282.8, abs=0.1)


@pytest.mark.parametrize(
    ("value", "wanted", "words"),
    [
        (9.0, "m/s", r"the speed is the bare number 9, with no unit, where the unit m/s is needed\. Write 9 m/s"),
        ("9", "rad", r"bare number 9.*Write 9 rad or 9 deg: shipid does not guess"),
        ("9 kg", "m/s", r"the speed needs the unit m/s, and kg does not fit it"),
        ("0.4 s^2", "s^2/rad^2", r"s² does not say which angle it counts in\. .*s²/rad² or s²/deg²"),
        ("5 1/s", "rad/s", r"1/s does not say which angle"),
        ("0.4 s^2*deg^2", "s^2/rad^2", r"s²·deg² does not say which angle it counts in"),
        ("2 1/deg", "rad", r"1/deg does not say which angle it counts in"),
        ("2 deg", "1/rad", r"deg does not say which angle it counts in"),
        ("2 m/deg", "m/rad^2", r"m/deg does not say which angle it counts in"),
        ("nan m", "m", r"does not start with a number"),
        ("kn", "m/s", r"'kn' does not start with a number"),
        ("1 floz_per_league_", "m", r"is not a unit"),
        ("1 2 m", "m", r"contains a number|is not a unit"),
        ("20 degC", "K", r"has an offset"),
        (float("inf"), "1", r"not a finite number"),
        ("1e999 m", "m", r"not a finite number"),
    ],
)
def test_what_does_not_fit_says_what_was_needed(value: object, wanted: str, words: str) -> None:
    with pytest.raises(UnitError, match=words):
        units.to_si(value, wanted, "the speed")


@pytest.mark.parametrize(
    ("text", "power"),
    [
        ("deg/s", 1),
        ("rpm", 0),
        ("s^2*deg^2", 2),
        ("s^2/deg^2", -2),
        ("s²/rad²", -2),
        ("1/deg", -1),
        ("1/s", 0),
        ("1", 0),
    ],
)
def test_the_power_of_the_angle_has_a_sign(text: str, power: float) -> None:
    assert units.angle_exponent(text) == power


@pytest.mark.parametrize("text", ["", "1", "-", "rad", "1/s", "m*s/rad^2", "s^2/rad^2", "m/rad"])
def test_coherent_units(text: str) -> None:
    assert units.is_coherent_si(text)


@pytest.mark.parametrize("text", ["deg", "kn", "s^2/deg^2", "km", "h", "rpm"])
def test_units_that_need_a_factor(text: str) -> None:
    assert not units.is_coherent_si(text)


@given_values(
    st.floats(-1e6, 1e6, allow_subnormal=False), st.sampled_from(["deg", "rad", "kn", "m/s", "km", "s^2/deg^2"])
)
def test_there_and_back(number: float, unit: str) -> None:
    si = {"deg": "rad", "rad": "rad", "kn": "m/s", "m/s": "m/s", "km": "m", "s^2/deg^2": "s^2/rad^2"}[unit]
    there = units.to_si((number, unit), si)
    assert units.to_si((there, si), unit) == pytest.approx(number, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("s^2/deg^2", "s²/deg²"),
        ("1", "1"),
        ("-", "1"),
        ("m*s", "m·s"),
        ("1/s^2", "1/s²"),
        ("m/(rad s)", "m/(rad s)"),
        ("m/(s^2 rad^2)", "m/(s² rad²)"),
        ("m / (s ** 2 * rad)", "m/(s²·rad)"),
        ("m^(-2)", "m⁻²"),
    ],
)
def test_units_as_they_are_printed(text: str, shown: str) -> None:
    assert units.pretty(text) == shown
    assert units.same_dimension(shown, text)


@pytest.mark.parametrize(
    "text",
    [
        "deg^9^9^9", "deg^9 ^9", "9**9", "9**(1*9**9)", "((9*m)**99)**99", "m**(9**9)", "m^999", "m**1e9", "9⁹⁹⁹", "1000 m", "deg/s" * 13,
    ],
)  # fmt: skip
def test_what_no_unit_holds_is_refused_before_it_is_computed(text: str) -> None:
    with pytest.raises(UnitError, match="longer than 60 characters, or has numbers or powers that no unit has"):
        units.unit(text)


@pytest.mark.parametrize("text", ["deg\0", "deg\0/s", "m/\x1b[2Js", "kn\u202e"])
def test_a_unit_with_a_character_that_steers_a_terminal_is_none(text: str) -> None:
    with pytest.raises(UnitError, match="is not a unit"):
        units.unit(text)


@pytest.mark.parametrize("text", ["s^2/deg^2", "m**0.333333", "m/s^(-1)", "(m/s)^2", "kg·m²", "m**(1/3)", "1/(m*s)"])
def test_powers_that_units_have_are_read(text: str) -> None:
    assert units.unit(text).dimensionality


def test_a_power_that_overflows_is_refused() -> None:
    with pytest.raises(UnitError, match="not a unit that can be converted to SI"):
        units.unit("Ym^99")


@pytest.mark.parametrize(("value", "wanted"), [("12.6 rad/s", "rps"), ("720 deg/s", "rpm"), ("2 rps", "rad/s")])
def test_a_shaft_is_counted_and_not_turned_through_an_angle(value: str, wanted: str) -> None:
    with pytest.raises(UnitError, match="shaft speed"):
        units.to_si(value, wanted, "the shaft speed")


def test_a_broken_power_is_not_raised():
    assert (
        units.pretty("rad/s^1.5") == "rad/s^1.5"
        and units.pretty("m/(rad s)") == "m/(rad s)"
        and units.pretty("s^-2") == "s⁻²"
    )


def test_at_sea_nm_is_a_nautical_mile() -> None:
    assert units.factor("nm", "m") == units.factor("NM", "m") == 1852.0
    assert units.factor("nm/min", "m/s") == pytest.approx(1852 / 60)
