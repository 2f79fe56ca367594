"""The noise of the sensors: as large as stated, white, and of each column by itself."""

from __future__ import annotations

import numpy as np
import pytest

from shipid import Trial, simulate
from shipid.foundation.aliases import Plain
from shipid.parts.sensors import standard_noise
from shipid.trials.manoeuvres.noise import parse_noise

DEG = np.pi / 180


def zigzag(**options: Plain) -> Trial:
    return simulate("de-keizer", "soesterberg", "zigzag:20/20", **options)


def test_noise_has_the_stated_standard_deviation() -> None:
    """A standard deviation of N samples scatters by 1/sqrt(2 N): 0.7 % at 10 001 samples, of which five are allowed."""
    clean = zigzag(duration="1000 s", sampling="0.1 s")
    noisy = zigzag(duration="1000 s", sampling="0.1 s", noise="psi=0.2 deg,r=0.02 deg/s,u=0.1 m/s")
    for name, deviation in (("psi", 0.2 * DEG), ("r", 0.02 * DEG), ("u", 0.1)):
        error = noisy[name] - clean[name]
        assert error.std() == pytest.approx(deviation, rel=0.035)
        assert abs(error.mean()) < 5 * deviation / 100
        assert abs(np.corrcoef(error[1:], error[:-1])[0, 1]) < 0.05
    for name in ("x", "y", "delta"):
        assert np.array_equal(noisy[name], clean[name])


def test_noise_on_one_column_leaves_the_others_alone() -> None:
    one, both = (zigzag(noise=n) for n in ("psi=0.2 deg", "psi=0.2 deg,r=0.02 deg/s"))
    assert np.array_equal(one["psi"], both["psi"])
    assert not np.array_equal(one["r"], both["r"])


def test_sensors_do_not_show_the_sway() -> None:
    assert {"u", "v"} <= set(zigzag().table)
    assert "v" not in zigzag(noise="standard").table
    assert {"u", "v"}.isdisjoint(zigzag(noise="psi=0.2 deg").table)


def test_noise_in_words() -> None:
    assert parse_noise("standard") == standard_noise()
    assert parse_noise("none") == parse_noise(None) == {}
    assert parse_noise({"psi": 0.01, "r": "1 deg/s"}) == pytest.approx({"psi": 0.01, "r": DEG})
