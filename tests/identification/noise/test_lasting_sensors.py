"""Noise of the sensors that lasts is told from noise that drives the ship by the likelihoods of both."""

import numpy as np
import pytest
from scipy.signal import lfilter

from shipid.identification.noise.lasting_sensors import lasting_sensors

N, PHI = 1000, 0.9
SIGMA = np.array([2e-3, 3e-4])


def white(rng):
    return rng.standard_normal((2, N))


def drifting(rng):
    return lfilter([np.sqrt(1 - PHI**2)], [1.0, -PHI], white(rng), axis=1)


def log_likelihood_of_white(series):
    return sum(-0.5 * e.size * (np.log(2 * np.pi * np.var(e) * s**2) + 1) for e in series for s, e in zip(SIGMA, e))


def test_white_noise_does_not_last():
    series = [white(np.random.default_rng(k)) for k in (1, 2)]
    assert lasting_sensors(series, SIGMA, 6, log_likelihood_of_white(series) - 1e3, 6) is None


def test_the_likelihood_of_drift_is_that_of_its_innovations():
    series = [drifting(np.random.default_rng(k)) for k in (1, 2)]
    before = log_likelihood_of_white(series)
    found = lasting_sensors(series, SIGMA, 6, before, 6)
    # A sample of a first-order process adds log(1 / (1 - phi^2)) / 2 to the likelihood of white noise of its power.
    # phi is found to 0.02, and half of that is bias: a tenth of this number.
    expected = 0.5 * 4 * N * np.log(1 / (1 - PHI**2))
    assert found is not None and found.sensors - found.ship == pytest.approx(expected, rel=0.15)
    assert "higher by" in found.words and found.to_dict()["log_likelihood_ship"] == found.ship


def test_a_filter_that_explains_as_much_is_kept():
    series = [drifting(np.random.default_rng(k)) for k in (1, 2)]
    found = lasting_sensors(series, SIGMA, 6, log_likelihood_of_white(series), 6)
    assert lasting_sensors(series, SIGMA, 6, found.sensors + 5 * np.log(2 * N), 6) is None


def test_missing_samples_and_short_records():
    rng = np.random.default_rng(3)
    series = drifting(rng)
    series[0, 100:150] = np.nan
    assert lasting_sensors([series], SIGMA, 6, log_likelihood_of_white([drifting(rng)]), 6) is not None
    assert lasting_sensors([series[:, :30]], SIGMA, 6, -1e9, 6) is None
    assert lasting_sensors([np.zeros((2, N))], SIGMA, 6, -1e9, 6) is None
