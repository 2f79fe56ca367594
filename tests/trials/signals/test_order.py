from __future__ import annotations

import numpy as np
import pytest

from shipid.trials.signals.order import lag_behind_order, order_against_feedback


def record(interval=0.5, rate=3.0, wait=0.0):
    """Orders of 20 deg to and fro, and a rudder that follows after a while."""
    fine = np.arange(0, 240, 0.05)
    order = np.where(fine < 10.2, 0.0, np.where((fine - 10.2) % 100 < 50, 20.0, -20.0))
    rudder, angle = np.zeros(fine.size), 0.0
    for k, now in enumerate(fine):
        rudder[k] = angle
        ordered = order[max(k - round(wait / 0.05), 0)]
        angle += float(np.clip(ordered - angle, -rate * 0.05, rate * 0.05))
        del now
    every = slice(0, None, round(interval / 0.05))
    return fine[every], order[every], rudder[every]


@pytest.mark.parametrize("interval", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("wait", [0.0, 2.0])
def test_an_order_that_the_rudder_follows(interval, wait):
    t, order, rudder = record(interval, wait=wait)
    noisy = rudder + np.random.default_rng(1).normal(0, 0.05, t.size)
    assert order_against_feedback(t, order, noisy) == ""
    assert order_against_feedback(t, order, noisy + 1.5) == ""  # and one that reads to one side


@pytest.mark.parametrize("late", [1.0, 3.0, 8.0])
def test_an_order_after_the_rudder_is_none(late):
    t, order, rudder = record()
    later = order[np.maximum(np.arange(t.size) - round(late / 0.5), 0)]
    assert "after the rudder" in order_against_feedback(t, later, rudder)


def test_an_order_of_the_other_sign_or_a_copy_is_none():
    t, order, rudder = record()
    assert "other side" in order_against_feedback(t, -order, rudder)
    assert "copy" in order_against_feedback(t, rudder, rudder)
    assert order_against_feedback(t, order, order) == ""  # both step: which of them is logged twice is not known
    assert order_against_feedback(t, 0 * order, rudder) == ""


@pytest.mark.parametrize("interval", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("wait", [0.0, 2.0, 6.0])
def test_how_long_a_rudder_sets_out_after_its_order(interval, wait):
    t, order, rudder = record(interval, wait=wait)
    noisy = rudder + np.random.default_rng(1).normal(0, 0.05, t.size)
    assert lag_behind_order(t, order, noisy) == pytest.approx(wait, abs=0.1 + 0.5 * interval)


def test_a_rudder_that_does_not_follow_has_no_lag():
    t, order, rudder = record()
    assert lag_behind_order(t, order, 0 * rudder) is None
    assert lag_behind_order(t, 0 * order, rudder) is None
