from __future__ import annotations

import os
import shutil
from pathlib import Path

# Workers share the processors: matrices of a few rows and columns, multiplied by threads that wait for each other, cost a tenth more.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pandas as pd
import pytest
from scipy.signal import lfilter

import shipid
from shipid import Component, given, parameter, state

NOISE = {"psi": "0.2 deg", "r": "0.02 deg/s", "u": "0.1 m/s", "v": "0.1 m/s"}

#: Sailed in real time, at 64 times its pace: where everything else is compiled and done it is not disturbed.
LAST = "bridge/page/test_full_track.py"
#: The files that take longest, about in that order, and two with a browser never side by side at the beginning. Begun last, one of
#: them is left to one worker while the others are idle.
SLOW = (
    "cli/test_results.py",
    "cli/test_environment.py",
    "bridge/page/test_page_notices.py",
    "report/test_write_report.py",
    "bridge/page/test_page_reading.py",
    "identification/test_recovery.py",
    "bridge/core/test_core.py",
    "identification/test_missing_samples.py",
    "prediction/sailing/test_sail_route.py",
    "cli/test_bridge.py",
    "report/test_pages.py",
    "cli/test_outputs.py",
    "identification/test_compare_models.py",
    "bridge/page/test_page_console.py",
    "cli/test_filter.py",
    "identification/validation/test_predictions.py",
    "bridge/server/test_server.py",
)


def pytest_collection_modifyitems(items):
    """Put the files that take longest first; the others, and the tests of a file, keep their order."""
    here = Path(__file__).parent
    rank = {here / name: place for place, name in enumerate(SLOW)} | {here / LAST: len(SLOW) + 1}
    assert all(path.exists() for path in rank), "a file has another name now"
    items.sort(key=lambda item: rank.get(item.path, len(SLOW)))


class Drift(Component):
    """A rate of turn that is a multiple of the rudder and a constant: linear in both coefficients."""

    psi = state("rad", "heading", wraps=True)
    delta = given("rad", "rudder angle")
    gain = parameter("1/s", "rate of turn per rudder angle", start=0.1, low=-10, high=10)
    swing = parameter("rad/s", "rate of turn without rudder", start=0.001, low=-1, high=1)

    @psi.rate
    def turn(self):
        """Made up for its closed form."""
        return self.gain * self.delta + self.swing


@pytest.fixture(scope="session")
def drift():
    """The linear model: heading = psi0 + gain * integral of delta + swing * t."""
    return shipid.join("drift", Drift)


@pytest.fixture(scope="session")
def drifting():
    """Make a record of the linear model with noise on its heading, and the matrix of its linear regression.

    The noise is white, or of first order where its correlation from sample to sample is given.
    """

    def make(sigma: float, count: int, seed: int, rudder: float = np.deg2rad(10), correlation: float = 0.0):
        t = np.arange(count, dtype=float)
        delta = rudder * np.sign(np.sin(2 * np.pi * t / 60))
        # Between samples the rudder runs straight: the integral is the trapezoid's.
        turned = np.concatenate([[0.0], np.cumsum(0.5 * (delta[1:] + delta[:-1]))])
        design = np.column_stack([turned, t, np.ones(count)])
        white = np.random.default_rng(seed).standard_normal(count)
        noise = sigma * lfilter([np.sqrt(1 - correlation**2)], [1.0, -correlation], white)
        psi = design @ np.array([0.05, 1e-4, 0.0]) + noise
        table = pd.DataFrame({"t [s]": t, "delta [rad]": delta, "psi [rad]": psi, "u [m/s]": np.full(count, 5.0)})
        return shipid.Trial.from_frame(table, name="linear"), design

    return make


@pytest.fixture(scope="session")
def sail():
    """Simulate a named model, with sensors for all speeds."""

    def make(model: str, ship: str, manoeuvre: str = "zigzag:20/20", noise=NOISE, **options) -> shipid.Trial:
        return shipid.simulate(shipid.find_model(model), ship, manoeuvre, noise=noise, **options)

    return make


@pytest.fixture(scope="session")
def truth_of():
    """The coefficients a ship has, SI."""

    def values(model: str, ship: str, speed: float | None = None) -> dict[str, float]:
        found = shipid.find_ship(ship)
        return found.values(shipid.find_model(model), speed=speed or found.particular("speed", "m/s"))

    return values


# Of a module: while Playwright runs, its event loop is that of the process, and other tests need one of their own.
@pytest.fixture(scope="module")
def browser():
    """Debian's Chromium, driven by Playwright; where one of them is not installed there is nothing to test with."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("no Chromium on this machine")
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield running
        running.close()
