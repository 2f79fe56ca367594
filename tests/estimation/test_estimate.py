"""One rule for what an estimate says of a coefficient, and numbers that are none."""

import json

import numpy as np
import pytest

from shipid import find_model
from shipid.estimation.estimate import Estimate, estimate_of

GAIN = find_model("de-keizer")["K"]


@pytest.mark.parametrize(
    ("value", "std", "determined"),
    [(2.0, 0.99, True), (2.0, 1.0, False), (-2.0, 0.99, True), (0.0, 0.0, False), (2.0, np.inf, False),
     (np.nan, 1.0, False), (np.inf, 1.0, False)],
)  # fmt: skip
def test_determined_is_a_standard_deviation_below_half_of_the_value(value: float, std: float, determined: bool) -> None:
    assert estimate_of(GAIN, value, std).identifiable is determined


def test_an_interval_is_normal_unless_it_is_given() -> None:
    plain = estimate_of(GAIN, 1.6, 0.1)
    assert plain.ci95 == pytest.approx((1.6 - 1.959964 * 0.1, 1.6 + 1.959964 * 0.1), rel=1e-6)
    assert estimate_of(GAIN, 1.6, 0.1, ci95=(1.4, 1.9)).ci95 == (1.4, 1.9)


def test_a_reason_goes_before_a_small_standard_deviation() -> None:
    lost = estimate_of(GAIN, 1.6, 0.1, standing=("not determined", "the recursion diverged."))
    assert not lost.identifiable and lost.why == "the recursion diverged."


def test_what_is_no_number_is_none_and_prints() -> None:
    for value, std in ((np.nan, 0.1), (np.inf, np.inf), (1.6, np.nan)):
        none = estimate_of(GAIN, value, std)
        assert none.ci95 is None and not none.identifiable
        json.dumps(none.to_dict(), allow_nan=False)
        assert "±" not in str(none) and "nan" not in str(none)
    assert str(estimate_of(GAIN, 1.6, 0.1)).startswith("K                    1.60 ± 0.10       yaw gain")


def test_the_other_form_is_named_by_what_it_is() -> None:
    """A coefficient with a unit has a form in the prime system, one without may have a dimensional form."""
    own = Estimate("K", "1/s", "gain", 0.05, 0.01, (0.03, 0.07), "determined", prime=1.6, prime_unit="1")
    assert own.to_dict()["normalised"] == 1.6 and own.to_dict()["normalised_unit"] == "1"
    other = Estimate("K", "1", "gain", 1.6, 0.1, (1.4, 1.8), "determined", prime=0.05, prime_unit="1/s")
    assert other.to_dict()["dimensional"] == 0.05 and "normalised" not in other.to_dict()
