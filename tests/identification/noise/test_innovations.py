"""Colour of innovations and what it does to the coefficients, against sums over autocovariances."""

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from shipid.identification.noise.innovations import scatter_of, whiteness

N, PHI = 4000, 0.8


def coloured(rng, count=N):
    return lfilter([np.sqrt(1 - PHI**2)], [1.0, -PHI], rng.standard_normal(count))


def test_white_innovations_leave_the_information():
    rng = np.random.default_rng(5)
    series, slopes = rng.standard_normal((2, N)), rng.standard_normal((2, N, 3))
    information = np.einsum("snp,snq->pq", slopes, slopes)
    assert scatter_of([(series, slopes)], information, np.linalg.inv(information)) == pytest.approx(information)
    assert whiteness([(series, slopes)], 0).p_value > 0.01


@pytest.mark.parametrize("holes", [False, True])
def test_slow_colour_counts_at_slow_slopes(holes):
    """A constant slope sees the power at frequency zero: (1 + phi) / (1 - phi) times that of white noise."""
    rng = np.random.default_rng(6)
    series = np.vstack([coloured(rng), coloured(rng)])
    slopes = np.zeros((2, N, 2))
    slopes[0, :, 0] = slopes[1, :, 1] = 1.0
    if holes:
        series[0, ::3] = np.nan
        slopes[0, ::3] = 0.0
    information = np.einsum("snp,snq->pq", slopes, slopes)
    scatter = scatter_of([(series, slopes)], information, np.linalg.inv(information))
    assert scatter[1, 1] / information[1, 1] == pytest.approx((1 + PHI) / (1 - PHI), rel=0.3)
    assert scatter[0, 0] / information[0, 0] > 4
    assert whiteness([(series, slopes)], 0).p_value < 1e-6


def test_the_power_that_a_fit_took_up_is_put_back_once():
    """A regression on slow waves, beside one that a belief holds as firmly as the record does."""
    count, waves, phi = 400, 8, 0.9
    t = np.arange(count) / count
    slow = np.column_stack([np.cos(np.pi * k * t) for k in range(waves)])
    slow /= np.linalg.norm(slow, axis=0)
    beliefs = np.diag([0.0] * (waves - 1) + [1.0])
    information = slow.T @ slow + beliefs
    inverse = np.linalg.inv(information)
    found = []
    for seed in range(60):
        drive = np.random.default_rng(seed).standard_normal(count + 200)
        noise = lfilter([np.sqrt(1 - phi**2)], [1.0, -phi], drive)[200:]
        innovations = noise - slow @ (inverse @ (slow.T @ noise))
        found.append(scatter_of([(innovations[None], slow[None])], information, inverse))
    true = slow.T @ toeplitz(phi ** np.arange(count)) @ slow + beliefs
    # 60 spectra of 400 samples scatter by some 5 % in their mean.
    assert np.diag(np.mean(found, axis=0)) == pytest.approx(np.diag(true), rel=0.09)
