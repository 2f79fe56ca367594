"""Channels that hold a value: written on change, or repeated from a slower sensor."""

from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.holding import held_on_change, repeats_of
from shipid.trials.trial import Trial

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


def test_an_order_in_few_rows_of_a_table_holds_until_the_next():
    """Taken as stamps of its own the orders were up to a row late, and between them lines: of the other sign than the rudder."""
    t = np.arange(60.0)
    order = np.full(60, np.nan)
    order[[0, 10, 25, 40]] = [0.0, 20.0, -20.0, 20.0]
    trial = Trial.from_frame({"t [s]": t, "psi [deg]": np.sin(t / 10), "delta_order [deg]": order})
    np.testing.assert_allclose(np.degrees(trial["delta_order"]), np.repeat([0.0, 20.0, -20.0, 20.0], [10, 15, 15, 20]))
    assert any("delta_order is written only when it changes, in 4 of 60 rows" in note for note in trial.source.notes)
    # Rows of its own are stamps of its own.
    alone = np.where(np.isfinite(order), np.nan, np.sin(t / 10))
    apart = Trial.from_frame({"t [s]": t, "psi [deg]": alone, "delta_order [deg]": order})
    assert np.isfinite(apart["delta_order"]).sum() == 4
