"""Whether data determine a coefficient: one rule."""

import math

import pytest

from shipid.estimation.standing import DETERMINED, NEAR_ZERO, UNKNOWN, standing_of
from shipid.foundation.statistics import interval_95


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"value": 0.008, "std": 0.022, "size": 1.0}, NEAR_ZERO),  # De Keizer's alpha3, which was "yes"
        ({"value": -0.008, "std": 0.022, "size": 1.0}, NEAR_ZERO),
        ({"value": 0.0, "std": 0.022, "size": 1.0}, NEAR_ZERO),
        ({"value": 0.008, "std": 0.022}, UNKNOWN),  # nothing is known of its size
        ({"value": 0.008, "std": 0.022, "size": 1.0, "low": 0.0}, UNKNOWN),  # it cannot be zero
        ({"value": 0.3, "std": 0.6, "size": 1.0}, UNKNOWN),
        ({"value": 0.3, "std": 0.14, "size": 1.0}, DETERMINED),
        ({"value": -0.3, "std": 0.14}, DETERMINED),
        ({"value": 0.3, "std": 0.14, "before": 0.15}, UNKNOWN),  # the data have added little
        ({"value": 0.3, "std": 0.14, "before": 0.2}, DETERMINED),
        ({"value": 0.3, "std": math.inf, "size": 1.0}, UNKNOWN),
        ({"value": math.nan, "std": 0.1, "size": 1.0}, UNKNOWN),
    ],
)
def test_the_rule(given, expected):
    standing, why = standing_of(**given)
    assert standing == expected
    assert bool(why) == (expected != DETERMINED) and (not why or why.endswith("."))


@pytest.mark.parametrize("std", [1e-6, 0.2, 0.49, 0.499, 0.501, 0.52, 3.0, 1e6])
@pytest.mark.parametrize("value", [1.0, -1.0, 1e-8])
def test_what_is_determined_has_a_sign(value, std):
    standing, _ = standing_of(value, std * abs(value), size=1.0)
    low, high = interval_95(value, std * abs(value))
    assert (standing == DETERMINED) <= (low * high > 0)


def test_no_share_of_a_value_near_zero_is_printed():
    assert "more than a hundred times its value" in standing_of(1e-9, 2.0, size=1.0)[1]


def test_an_interval_that_leaves_zero_out_is_not_said_to_hold_it():
    """A standard deviation between 50 and 51 % of the value."""
    standing, why = standing_of(-0.33, 0.167, low=-1.0, size=0.4)
    assert (
        standing == "not determined" and why == "its standard deviation is 51 % of its value, and has to be below 50 %."
    )
