from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from shipid.trials.trial import Trial

ROOT = Path(__file__).resolve().parents[2]
FORMATS = ROOT / "studies" / "formats"
DATA = ROOT.parent / "shared" / "data"


@pytest.fixture
def campaign():
    """Read a file of one of the four campaigns; skip where the trial data are absent."""
    from shipid.trials.logs.reading import read_trial

    def read(name: str, file: str, window=None) -> Trial:
        path = DATA / name / file
        if not path.exists():
            pytest.skip(f"the trial data of {name} are not on this machine")
        return read_trial(path, FORMATS / f"{name}.toml", window)

    return read


@pytest.fixture
def log(tmp_path):
    """Write a text file and return its path."""

    def write(text: str | bytes, name: str = "log.csv") -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.fixture
def table() -> str:
    """A sound log of 20 samples as CSV text."""
    rows = "".join(f"{0.5 * k},{10 + 0.3 * k:.4f},0.6,{5 if k > 3 else 0}\n" for k in range(20))
    return "t [s],psi [deg],r [deg/s],delta [deg]\n" + rows


def make_sine(
    amplitude=30.0, switch=20.0, rudder=20.0, period=100.0, start=20.0, interval=0.5, side=1,
    course=0.0, noise=0.0, seed=1,
):  # fmt: skip
    """Make a zig-zag whose heading is a sine: overshoot, period and times in closed form.

    The heading leaves the course at `start` as ``side A sin(w (t - start))``; the rudder is reversed when the
    heading passes the switch value on its way out. Returns the trial, the reversals [s], the time to check yaw [s].
    """
    w = 2 * np.pi / period
    # It ends just before a fifth reversal.
    t = np.arange(0, start + period * (1.98 + np.arcsin(switch / amplitude) / (2 * np.pi)), interval)
    psi = course + side * amplitude * np.sin(w * np.clip(t - start, 0, None))
    first = np.arcsin(switch / amplitude)
    executes = start + (first + np.pi * np.arange(4)) / w
    sign = np.where(t < start, 0.0, side * (-1.0) ** np.searchsorted(executes, t, side="right"))
    if noise:
        psi = psi + np.random.default_rng(seed).normal(0, noise, len(t))
    frame = pd.DataFrame(
        {"t [s]": t, "psi [deg]": psi, "delta_order [deg]": rudder * sign, "u [m/s]": 5.0, "v [m/s]": 0.0}
    )
    return Trial.from_frame(frame, name="sine"), executes, (np.pi / 2 - first) / w


@pytest.fixture(scope="session")
def sine():
    """The function that makes a zig-zag in closed form."""
    return make_sine
