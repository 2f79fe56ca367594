"""Numbers as they are printed."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from shipid.foundation.numbers import (
    NO_NUMBER,
    brief,
    estimate,
    fixed,
    interval,
    moment,
    number,
    percent,
    spread,
    uncertain,
    uncertain_text,
)
from shipid.foundation.numbers import given as as_given

FLOATS = st.floats(allow_nan=True, allow_infinity=True)


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [
        (1.5937, 0.00602, "1.5937 ± 0.0060"),
        (-0.0247, 0.0215, "−0.025 ± 0.021"),
        (0.00012345, 2e-6, "(1.234 ± 0.020) × 10⁻⁴"),
        (56789.0, 1234.0, "56800 ± 1200"),
        (0.9996, 0.0996, "1.00 ± 0.10"),
        (3e-9, 2.0, "0.0 ± 2.0"),
        (1.0, None, "1.000"),
        (None, 1.0, NO_NUMBER),
        (float("nan"), 1.0, NO_NUMBER),
    ],
)
def test_two_digits_of_the_standard_deviation_decide(value, std, shown):
    assert uncertain(value, std) == shown


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [
        (1.5937, 0.00602, "1.5937 ± 0.0060"),
        (-0.0247, 0.0215, "-0.025 ± 0.021"),
        (0.99, 0.0996, "0.99 ± 0.10"),
        (1.23456e-7, 2e-9, "(1.235 ± 0.020) × 10⁻⁷"),
        (7.654321e6, 1234.0, "(7.6543 ± 0.0012) × 10⁶"),
        (0.32, 0.0041, "0.3200 ± 0.0041"),
        (-3.1, 13000.0, "0 ± 13000"),
        (3.2e-8, 4e-10, "(3.200 ± 0.040) × 10⁻⁸"),
        (3.2e6, 4e3, "(3.2000 ± 0.0040) × 10⁶"),
        (1500.0, 520.0, "1500 ± 520"),
        (1.25, None, "1.25"),
        (-2.5e-8, None, "-2.5 × 10⁻⁸"),
        (float("inf"), 1.0, NO_NUMBER),
    ],
)
def test_the_same_for_a_terminal(value, std, shown):
    assert uncertain_text(value, std) == shown


@given(FLOATS, FLOATS)
def test_no_number_is_ever_nan_or_infinite_text(value, std):
    for text in (
        number(value),
        fixed(value, 2),
        uncertain(value, std),
        interval((value, value), std),
        as_given(value),
        uncertain_text(value, std),
    ):
        assert "nan" not in text
        assert "inf" not in text


@pytest.mark.parametrize(
    ("value", "std", "shown"),
    [(0.016129, 2.4e-6, "± 0.0000024"), (1.2e-7, 3e-9, "± 3.0 × 10⁻⁹"), (42.3588, 0.043, "± 0.043")],
)
def test_a_spread_beside_a_value_has_its_decimals(value, std, shown):
    assert spread(value, std) == shown


def test_given_numbers_get_no_digits():
    assert [as_given(v) for v in (15.5, 320.0, 0.0, 2.3e-7)] == ["15.5", "320", "0", "2.3 × 10⁻⁷"]


@pytest.mark.parametrize(
    ("value", "digits", "text"), [(0.99999997, 4, "1.000"), (9.9999, 3, "10.0"), (0.000999999, 3, "0.00100")]
)
def test_digits_are_those_of_the_rounded_number(value, digits, text):
    """0.99999997 and 1 stand in one column, and look alike."""
    assert number(value, digits) == text


def test_a_percentage_has_a_space():
    assert [percent(0.4321), percent(0.4321, 1), percent(4.33)] == ["43 %", "43.2 %", "433 %"]


def test_a_terminal_shows_no_more_than_seven_figures():
    """A record without noise has intervals of rounding errors: they allow no twelve figures, on no page and on no terminal."""
    assert uncertain_text(0.45189912345678, 1e-14) == "0.4518991 ± 1.0 × 10⁻¹⁴"
    assert uncertain(0.45189912345678, 1e-14).startswith("0.4518991 ± ")
    assert uncertain_text(1234567.89012, 0.00012) == "1.234568 × 10⁶ ± 1.2 × 10⁻⁴"


@pytest.mark.parametrize(
    ("value", "ends", "factor", "shown"),
    [
        (1.350123, (0.77631, 1.92394), 1.0, ("1.35", "0.78 to 1.92")),
        (5.0372, (4.2971, 5.7773), 57.29578, ("289", "246 to 331")),
        (-0.07665, (-0.288, 0.1348), 1.0, ("−0.08", "−0.29 to 0.13")),
        (1.2e-7, (1.0e-7, 1.4e-7), 1.0, ("1.20 × 10⁻⁷", "(1.00 to 1.40) × 10⁻⁷")),
        (2.0, (2.0, 2.0), 1.0, ("2.00", "")),
        (2.0, None, 1.0, ("2.00", "")),
        (None, None, 1.0, (NO_NUMBER, "")),
        (1.0, (float("nan"), float("nan")), 1.0, ("1.00", "")),
    ],
)
def test_a_value_has_the_digits_of_its_interval(value, ends, factor, shown):
    assert estimate(value, ends, factor) == shown


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (141.4, 2, "140"), (-141.4, 2, "-140"), (99.6, 2, "100"), (1234.5, 3, "1230"), (0.5, 2, "0.5"), (2.0, 3, "2"), (0.00012, 2, "0.00012"),
        (-0.0, 3, "0"), (3e-5, 2, "3 × 10⁻⁵"), (2.5e8, 2, "2.5 × 10⁸"), (float("nan"), 2, NO_NUMBER), (None, 2, NO_NUMBER),
    ],
)  # fmt: skip
def test_a_number_in_a_sentence_is_written_out(value, digits, text):
    assert brief(value, digits) == text


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.0, "0"), (-0.001, "0"), (12.5, "12.5"), (123.456, "123.46"), (259223.75, "259223.75"), (1.7e9, "1700000000")],
)
def test_a_moment_keeps_every_second_and_can_be_typed(seconds, said):
    assert moment(seconds) == said


def test_a_moment_that_is_none_is_said():
    assert moment(None) == moment(float("nan")) == NO_NUMBER
