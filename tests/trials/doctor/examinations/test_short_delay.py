"""A rudder that is logged two samples early or late."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from shipid.trials.doctor.check_trial import check_trial
from shipid.trials.trial import Trial


@pytest.mark.parametrize(
    ("late", "words"), [(-2.0, "about 2 s before it acts"), (2.0, "about 2 s after the ship has"), (0.0, None)]
)
def test_a_rudder_two_samples_off_is_found(late, words):
    """A first-order ship, sampled every second: half a time between two executes is thirty times as long."""
    step, every = 0.1, 10
    t = np.arange(0, 300, step)
    psi, r, delta = np.zeros(t.size), np.zeros(t.size), np.zeros(t.size)
    order, now, rate, heading = 0.0, 0.0, 0.0, 0.0
    for k, when in enumerate(t):
        order = 20.0 if order == 0 and when >= 10 else -order if order * heading >= 20.0 * abs(order) > 0 else order
        now += np.clip(order - now, -3 * step, 3 * step)
        rate += step * (0.08 * now - rate) / 12
        heading += step * rate
        psi[k], r[k], delta[k] = heading, rate, now
    rng = np.random.default_rng(1)

    def sampled(y, scatter):
        return y[::every] + scatter * rng.standard_normal(t[::every].size)

    frame = pd.DataFrame({
        "t [s]": t[::every], "psi [deg]": sampled(psi, 0.1), "r [deg/s]": sampled(r, 0.02),
        "delta [deg]": sampled(np.interp(t - late, t, delta), 0.1),
    })  # fmt: skip
    found = check_trial(Trial.from_frame(frame))
    latency = [f for f in found.findings if f.kind == "latency" and f.channel == "delta"]
    assert (
        not latency if words is None else words in latency[0].message and latency[0].serious and not latency[0].repaired
    )


def test_a_rudder_that_moves_as_one_sine_shows_no_delay():
    """Any shift of a sine is that of another time constant: a slow push beside it was taken for a rudder 4.5 s early, for certain."""
    t = np.arange(0, 120, 0.5)
    delta, push = 10 * np.sin(t / 8), 1 + 0.2 * np.sin(t / 17)
    r = np.zeros(t.size)
    for k in range(1, t.size):  # quick and heavily damped, as a yacht
        r[k] = r[k - 1] + 0.5 * (0.45 * delta[k - 1] - 0.25 * push[k - 1] - 0.9 * r[k - 1])
    noise = np.random.default_rng(1).standard_normal((2, t.size))
    frame = pd.DataFrame({
        "t [s]": t, "psi [deg]": np.cumsum(r) * 0.5 + 0.2 * noise[0], "r [deg/s]": r + 0.02 * noise[1], "delta [deg]": delta
    })  # fmt: skip
    assert not [f for f in check_trial(Trial.from_frame(frame)).findings if f.kind == "latency"]
