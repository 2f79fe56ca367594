"""Simulated scans: targets with steady velocities, missed detections, clutter all over, noise."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from shipid.encounter.plots.plots import Plots, Sensor, make_plots
from shipid.encounter.plots.read_plots import Detections
from shipid.encounter.plots.ship_path import ShipPath

#: The scene: a square around the sensor, m.
REACH = 2000.0


@pytest.fixture(scope="session")
def scene() -> Callable[..., Detections]:
    """Return what makes a scene of targets that begin at a position with a velocity."""

    def make(
        targets: list[tuple[float, float, float, float]],
        *,
        scans: int = 60,
        interval: float = 2.0,
        noise: float = 5.0,
        clutter: float = 3.0,
        detection: float = 0.9,
        latency: float = 0.0,
        said: float | None = None,
        hidden: tuple[int, int] = (0, 0),
        seed: int = 0,
    ) -> Detections:
        chance = np.random.default_rng(seed)
        times = interval * np.arange(scans)
        states = np.array(targets, float).reshape(-1, 4)
        t, z, looks = [], [], []
        for k, now in enumerate(times):
            found = []
            for x, y, vx, vy in states:
                if chance.random() < detection and not hidden[0] <= k < hidden[1]:
                    age = now - latency
                    found.append(np.array([x + vx * age, y + vy * age]) + noise * chance.standard_normal(2))
            found += list(chance.uniform(-REACH, REACH, (chance.poisson(clutter), 2)))
            looks += [] if found else [now]
            t += [now] * len(found)
            z += found
        place = np.array(z).reshape(-1, 2)
        sensor = Sensor(position_std=max(noise, 1.0), latency=latency if said is None else said)
        plots: Plots = make_plots(
            np.array(t), place[:, 0], place[:, 1], sensors=(sensor,), looks=np.array(looks), looks_sensor=np.zeros(len(looks), int)
        )  # fmt: skip
        truth = tuple(
            ShipPath(f"target {i + 1}", times, x + vx * times, y + vy * times)
            for i, (x, y, vx, vy) in enumerate(states)
        )
        own = ShipPath("own ship", times, np.zeros(scans), np.zeros(scans))
        return Detections("scene", plots, own, truth=truth)

    return make
