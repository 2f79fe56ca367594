"""A rudder that goes over from the other side is ordered while it is still there, not where it passes midships."""

import numpy as np
import pandas as pd
import pytest

from shipid.trials.errors import NotAManoeuvreError
from shipid.trials.measuring.measure import measure
from shipid.trials.trial import Trial


def turn_from(opposite, hold, rate, interval, order=False, noise=0.05):
    """Sail a turn with 35 deg of rudder to starboard, out of `hold` s on the other side, with Nomoto's model; when it is ordered [s]."""
    t = np.arange(0, hold + 360, 0.05)
    ordered = np.select([t < 40, t < 40 + hold, t < 290 + hold], [0.0, opposite, 35.0], 0.0)
    delta, psi, r, angle, heading = np.zeros_like(t), np.zeros_like(t), 0.0, 0.0, 40.0
    for k, target in enumerate(ordered):
        delta[k], psi[k] = angle, heading
        angle += float(np.clip(target - angle, -0.05 * rate, 0.05 * rate))
        heading += 0.05 * r
        r += 0.05 * (0.08 * angle - r) / 12
    every = slice(0, None, round(interval / 0.05))
    rng = np.random.default_rng(1)
    table = {"t [s]": t[every], "psi [deg]": psi[every] + 0.03 * rng.standard_normal(len(t[every]))}
    table["delta [deg]"] = delta[every] + noise * rng.standard_normal(len(t[every]))
    if order:
        table["delta_order [deg]"] = ordered[every]
    return Trial.from_frame(pd.DataFrame(table), name="turn"), 40.0 + hold


@pytest.mark.parametrize("order", [False, True])
@pytest.mark.parametrize(
    ("opposite", "hold", "rate", "interval"),
    [(-35, 20, 3, 0.2), (-15, 20, 5, 1.0), (-35, 10, 2, 1.0), (-35, 4, 3, 1.0), (-15, 4, 2, 0.2), (-8, 30, 3, 0.2)],
)
def test_turn_begun_from_the_other_side(opposite, hold, rate, interval, order):
    """The rudder held there, only touching it, and reversed on its way there."""
    trial, when = turn_from(opposite, hold, rate, interval, order)
    found = measure(trial)
    assert found.kind == "turning circle"
    assert found.first_execute == pytest.approx(when, abs=max(found.execute_within, 0.1))
    assert found.execute_within < 0.6


@pytest.mark.parametrize("order", [False, True])
@pytest.mark.parametrize(("rate", "interval"), [(2, 0.2), (3, 1.0), (5, 0.2)])
def test_the_second_of_two_turns_keeps_the_end_of_the_first(rate, interval, order):
    """Its order is given before the first is over; and the first has no pull-out while the rudder goes over."""
    trial, when = turn_from(-35, 90, rate, interval, order)
    found = measure(trial, manoeuvre=2)
    assert found.kind == "turning circle" and found.side == "starboard"
    assert found.first_execute == pytest.approx(when, abs=max(found.execute_within, 0.1))
    assert found.times[2] is not None


def test_a_record_that_begins_on_the_way_over_does_not_know_the_order():
    trial, when = turn_from(-35, 20, 2, 0.2)
    with pytest.raises(NotAManoeuvreError, match="begins with the rudder over already"):
        measure(trial.window(when + 4, when + 200))


def test_a_helm_that_wanders_is_no_opposite_plate():
    """The order meets a helm somewhere on its way: the uncertainty covers it."""
    trial, when = turn_from(0, 10, 3, 0.2)
    frame = pd.DataFrame({"t [s]": trial["t"], "psi [rad]": trial["psi"]})
    wave = np.radians(4) * np.sin(2 * np.pi * trial["t"] / 9)
    frame["delta [rad]"] = trial["delta"] + wave * (trial["t"] < when)
    found = measure(Trial.from_frame(frame, name="wandering"))
    assert abs(found.first_execute - when) < found.execute_within < 3
