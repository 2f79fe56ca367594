"""A parameter that is bounded below by zero and starts there: it has no logarithm, and is a state within its bounds."""

from __future__ import annotations

import numpy as np
import pytest

import shipid
from shipid import Component, given, join, parameter, state
from shipid.foundation.errors import UsageError


class Damped(Component):
    """Rate of turn with a quadratic damping that may be absent."""

    r = state("rad/s", "rate of turn, positive to starboard")
    delta = given("rad", "rudder angle, positive turns to starboard")
    a = parameter("1/s^2", "yaw acceleration per rudder angle", start=0.5, low=0.01, high=20, prime=True)
    c = parameter("1/rad", "quadratic damping", start=0.0, low=0.0, high=50.0)

    @r.rate
    def yaw(self):
        """The square of the rate."""
        return self.a * self.delta - self.c * abs(self.r) * self.r


MODEL = join("damped", Damped)


def kalman(**options) -> shipid.ExtendedKalmanFilter:
    return shipid.ExtendedKalmanFilter(
        MODEL, "soesterberg", measured={"r": "0.01 deg/s"}, estimated=["a", "c"], model_noise=False, **options
    )


def record(c: float = 8.0) -> dict[str, np.ndarray]:
    """A square wave of rudder, and the rate of turn of a ship with that damping, by Euler's small steps."""
    t = np.arange(0.0, 900.0, 1.0)
    delta = np.deg2rad(15) * np.sign(np.sin(t / 30))
    r = np.zeros(t.size)
    for k in range(t.size - 1):
        rate = r[k]
        for _ in range(20):
            rate += 0.05 * (1e-4 * delta[k] - c * abs(rate) * rate)
        r[k + 1] = rate
    noise = np.random.default_rng(1).normal(0, np.deg2rad(0.01), t.size)
    return {"t": t, "delta": delta, "r": r + noise}


def test_it_is_found_from_zero():
    ekf = kalman(start={"a": "2e-4 1/s^2"}, hold="zero")
    assert set(ekf.model.states) == {"r", "log_a", "c"}
    run, place = ekf.filter(record()), ekf.model.states.index("c")
    assert np.isfinite(run.x).all() and (run.x[:, place] >= 0).all()
    assert run.x[-1, place] == pytest.approx(8.0, abs=4 * run.std[-1, place])
    assert run.std[-1, place] < 2.0


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"log": ["a", "c"]}, r"the first value of 'c' is 0 1/rad, and zero or less has no logarithm"),
        (
            {"start": {"c": "-1 1/rad"}},
            r"the first value of 'c' is -1 1/rad, and a positive parameter cannot be negative",
        ),
        ({"start": {"a": "-1e-4 1/s^2"}}, r"the first value of 'a' is -0\.0001 1/s\^2.* Give start=\{'a': \.\.\.\}"),
    ],
)
def test_what_has_no_logarithm_is_said(options, says):
    with pytest.raises(UsageError, match=says):
        kalman(**options)
