from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter

from shipid import Component, Model, Trial, find_model, given, join, parameter, simulate, state

TRUTH = np.array([0.95, 0.08])


class FirstOrder(Component):
    """The first-order process the studies of recursive identification use."""

    y = state("1", "output")
    v = given("1", "input")
    a = parameter("1", "pole", start=0.5, low=-5, high=5)
    b = parameter("1", "gain", start=0.5, low=-5, high=5)

    @y.next
    def process(self):
        """Passenier (1989), eq. (4.65)."""
        return self.a * self.y + self.b * self.v


@pytest.fixture(scope="session")
def first_order() -> Model:
    return join("first-order", FirstOrder)


@pytest.fixture(scope="session")
def noisy() -> Callable[..., dict[str, np.ndarray]]:
    """A record of y = .95 y + .08 v under a square wave, with noise on what is measured."""

    def make(sigma: float, seed: int = 0, count: int = 1500) -> dict[str, np.ndarray]:
        k = np.arange(count)
        v = np.where(k % 120 < 60, 1.0, -1.0)
        y = lfilter([0.0, TRUTH[1]], [1.0, -TRUTH[0]], v)
        return {"t": k.astype(float), "v": v, "y": y + sigma * np.random.default_rng(seed).standard_normal(count)}

    return make


@pytest.fixture(scope="session")
def trial() -> Trial:
    """A noisy zig-zag of the ship the yaw filter was made for."""
    return simulate(find_model("de-keizer"), "soesterberg", "zigzag:15/15", noise={"r": "0.02 deg/s", "u": "0.05 m/s"})
