"""Channels of coarse steps: thresholds told from digits, and ramps drawn through what is known of them."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.signals.coarse import ramps_of, threshold_of

T = np.arange(0.0, 240.0, 0.5)
ORDERS = np.select([T < 10, T < 50, T < 110, T < 170], [0.0, 20.0, -20.0, 20.0], -20.0)
RUDDER = np.interp(
    T, [0, 10, 16.667, 50, 63.333, 110, 123.333, 170, 183.333, 240], [0, 0, 20, 20, -20, -20, 20, 20, -20, -20]
)
NOISE = np.random.default_rng(2).normal(0, 0.02, T.size)
HEADING = 25 * np.sin(2 * np.pi * T / 90) + NOISE


def written(values, threshold):
    """The same channel, written again only when it has moved by more than a threshold."""
    result, last = values.copy(), values[0]
    for k, now in enumerate(values):
        last = now if abs(now - last) > threshold else last
        result[k] = last
    return result


@pytest.mark.parametrize("threshold", [1.0, 2.5])
def test_a_threshold_is_told(threshold):
    assert threshold_of(written(HEADING, threshold)) == pytest.approx(threshold, rel=0.15)


@pytest.mark.parametrize(
    "values", [HEADING, np.round(HEADING), np.round(HEADING / 0.5) * 0.5, RUDDER, ORDERS, np.round(RUDDER), HEADING[(np.arange(T.size) // 6) * 6]]
)  # fmt: skip
def test_digits_ramps_and_slow_sensors_have_no_threshold(values):
    assert threshold_of(values) is None


@pytest.mark.parametrize("digit", [5.0, 10.0])
def test_ramps_of_a_rounded_rudder_are_lines(digit):
    rounded = np.round((RUDDER + NOISE) / digit) * digit
    found = ramps_of(T, rounded)
    assert found is not None and found.step == digit
    on_ramp = (T > 52) & (T < 61)
    np.testing.assert_allclose(found.y[on_ramp], RUDDER[on_ramp], atol=0.8)
    assert np.abs(rounded - RUDDER)[on_ramp].max() > 0.4 * digit
    np.testing.assert_array_equal(found.y[(T > 20) & (T < 48)], 20.0)


def test_ramps_of_a_rudder_written_past_a_threshold_are_lines():
    held = written(RUDDER + NOISE, 3.2)
    found = ramps_of(T, held)
    on_ramp = (T > 53) & (T < 60)
    np.testing.assert_allclose(found.y[on_ramp], RUDDER[on_ramp], atol=0.1)
    assert np.abs(held - RUDDER)[on_ramp].max() > 1.4


@pytest.mark.parametrize(
    "values", [RUDDER + NOISE, RUDDER, ORDERS, np.repeat([0.0, 15, 10, 5, 0, -5, -10, -15, -10, -5, 0, 5, 10, 15, 0, 0], 30)]
)  # fmt: skip
def test_fine_rudders_orders_and_spirals_have_no_coarse_ramps(values):
    assert ramps_of(T, values) is None
