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


def scatter(manoeuvre, **how):
    """The noise on the first hundred headings of a simulated trial, before and at the beginning of the manoeuvre [deg]."""
    noisy, quiet = (
        simulate("nomoto", "zeefakkel", manoeuvre, noise=noise, sampling="0.1 s", **how)["psi"][:100]
        for noise in ("psi=0.2 deg", "none")
    )
    return np.degrees(noisy - quiet)


def test_trials_of_one_seed_do_not_share_their_noise():
    """Whoever fits them together takes it for independent: the same noise twice makes intervals too narrow by the root of two."""
    ten, twenty, slow = scatter("zigzag:10/10"), scatter("zigzag:20/20"), scatter("zigzag:10/10", speed="2 m/s")
    assert np.array_equal(ten, scatter("zigzag:10/10")) and not np.array_equal(ten, scatter("zigzag:10/10", seed=1))
    # Three standard errors of a correlation of a hundred pairs.
    for one, other in ((ten, twenty), (ten, slow), (twenty, slow)):
        assert abs(np.corrcoef(one, other)[0, 1]) < 0.3
        assert np.std(one) == pytest.approx(0.2, rel=0.25)
