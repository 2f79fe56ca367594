"""Channels that hold a value: written on change, or repeated from a slower sensor."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.holding import held_on_change, repeats_of

T = np.arange(0, 200, 0.5)
RUDDER = np.clip(3 * (T - 20), 0, 20) - np.clip(3 * (T - 80), 0, 40) + np.clip(3 * (T - 150), 0, 20)
HEADING = 25 * np.sin(2 * np.pi * T / 90)


def on_change(values, digit):
    coarse = np.round(values / digit) * digit
    return np.where(np.concatenate(([True], np.diff(coarse) != 0)), coarse, np.nan), coarse


@pytest.mark.parametrize(
    ("values", "digit"), [(RUDDER, 1.0), (RUDDER, 0.5), (25 * np.sin(2 * np.pi * np.clip(T - 30, 0, None) / 90), 1.0)]
)
def test_what_is_written_on_change_holds(values, digit):
    written, coarse = on_change(values, digit)
    held = held_on_change(T, written)
    last = np.flatnonzero(np.isfinite(written))[-1]
    np.testing.assert_array_equal(held[: last + 1], coarse[: last + 1])
    assert np.isnan(held[last + 1 :]).all()


def test_a_hole_is_not_held():
    written, _ = on_change(RUDDER, 1.0)
    written[(T > 85) & (T < 140)] = np.nan
    held = held_on_change(T, written)
    assert np.isnan(held[(T > 86) & (T < 139)]).all() and np.isfinite(held[(T > 35) & (T < 78)]).all()


@pytest.mark.parametrize("share", [0.3, 0.8])
def test_samples_missing_at_random_are_not_held(share):
    random = np.random.default_rng(4)
    gone = random.random(T.size) < share
    assert held_on_change(T, np.where(gone, np.nan, np.round(8 * T))) is None
    assert held_on_change(T, np.where(gone, np.nan, np.round(HEADING + random.normal(0, 0.2, T.size), 2))) is None


@pytest.mark.parametrize("beat", [3, 10])
@pytest.mark.parametrize("digit", [0.0, 1.0])
def test_repeats_of_a_slow_sensor(beat, digit):
    rows = np.arange(1200)
    fine = 25 * np.sin(2 * np.pi * rows / 900)
    slow = fine[(rows // beat) * beat]
    slow = np.round(slow / digit) * digit if digit else slow
    repeats = repeats_of(slow)
    np.testing.assert_array_equal(np.flatnonzero(~repeats) % beat, 0)
    assert (~repeats).sum() >= 0.95 * len(rows) / beat


def test_coarse_digits_are_no_repeats():
    rows = np.arange(1200)
    assert repeats_of(np.round(25 * np.sin(2 * np.pi * rows / 900))) is None
    assert repeats_of(np.floor(0.1 * rows)) is None  # a steady turn in whole degrees
    assert repeats_of(25 * np.sin(2 * np.pi * rows / 900)) is None
