from __future__ import annotations

import itertools

import numpy as np
import pandas as pd
import pytest

from shipid.trials.trial import Trial


def sail_zigzag(
    switch=20.0, rudder=20.0, rudder_rate=3.0, gain=0.08, lag=12.0, start=10.0, duration=240.0, course=350.0, side=1
):
    """Sail a zig-zag with Nomoto's model and a rudder of finite rate, in steps of 0.01 s.

    Returns times [s], heading, rudder and order [deg], the times of the orders and the overshoots beyond them [deg].
    """
    step = 0.01
    t = np.arange(0, duration + step / 2, step)
    psi, delta, order = np.zeros(t.size), np.zeros(t.size), np.zeros(t.size)
    rate, heading, angle, ordered = 0.0, 0.0, 0.0, 0.0
    orders: list[float] = []
    for k, now in enumerate(t):
        if not orders and now >= start - 1e-9:
            ordered = side * rudder
            orders.append(float(now))
        elif orders and np.sign(ordered) * heading >= switch:
            ordered = -ordered
            orders.append(float(now))
        psi[k], delta[k], order[k] = heading, angle, ordered
        angle += float(np.clip(ordered - angle, -rudder_rate * step, rudder_rate * step))
        heading += step * rate
        rate += step * (gain * angle - rate) / lag
    edges = [*np.searchsorted(t, orders[1:]), t.size - 1]
    overshoots = [float(np.abs(psi[a:b]).max()) - abs(float(psi[a])) for a, b in itertools.pairwise(edges)]
    return t, psi + course, delta, order, np.array(orders), np.array(overshoots)


@pytest.fixture(scope="session")
def sailed():
    """Zig-zags by their settings, each sailed once."""
    done = {}

    def sail(**settings):
        key = tuple(sorted(settings.items()))
        if key not in done:
            done[key] = sail_zigzag(**settings)
        return done[key]

    return sail


@pytest.fixture
def logged(sailed):
    """A zig-zag as a trial: sampled, with noise, with or without the order; and the truth."""

    def log(interval=0.5, noise=0.0, order=False, rudder=True, seed=1, **settings):
        t, psi, delta, ordered, orders, overshoots = sailed(**settings)
        every = slice(0, None, round(interval / 0.01))
        noisy = np.random.default_rng(seed).normal(0, noise, len(t[every])) if noise else 0.0
        table = {"t [s]": t[every], "psi [deg]": psi[every] + noisy, "u [m/s]": np.full(len(t[every]), 8.0)}
        if rudder:
            table["delta [deg]"] = delta[every]
        if order:
            table["delta_order [deg]"] = ordered[every]
        return Trial.from_frame(pd.DataFrame(table), name="logged"), orders, overshoots

    return log
