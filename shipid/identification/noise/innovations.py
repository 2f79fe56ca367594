"""Innovations of a filter at the maximum of the likelihood: whether they are white, and what their colour does to the coefficients.

Where they are not white the noise model is wrong, and the inverse information is not the covariance. It is replaced by the
sandwich ``I^-1 M I^-1`` (Huber 1967; White 1982), M from the spectrum of the innovations, by the same autoregression that the
residuals of output error are given.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shipid.foundation.statistics import LjungBox, ljung_box
from shipid.identification.noise.autoregression import CORRECTIONS, Autoregression, autoregression_of, corrected

#: Lags of the test, in samples.
_LAGS = 20
#: Share of the rows in which every sensor has a sample from which the sensors are taken together.
_TOGETHER = 0.8
#: Stretches of fewer samples show no spectrum.
_FEWEST = 50
#: One stretch: innovations in standard deviations and their slopes, shapes (sensors, N) and (sensors, N, unknowns).
Stretch = tuple[np.ndarray, np.ndarray]


def whiteness(stretches: Sequence[Stretch], sensor: int) -> LjungBox:
    """Return the test of Ljung and Box (1978) of one sensor's innovations, over all stretches.

    Parameters
    ----------
    stretches : sequence of (ndarray, ndarray)
        See `Stretch`.
    sensor : int
        Which one.
    """
    series = (e[sensor][np.isfinite(e[sensor])] for e, _ in stretches)
    return sum((ljung_box(s, min(_LAGS, s.size // 5)) for s in series), LjungBox(0.0, 0))


def scatter_of(stretches: Sequence[Stretch], information: np.ndarray, inverse: np.ndarray) -> np.ndarray:
    """Return the covariance of the gradient of the likelihood under innovations as they are, shape (unknowns, unknowns).

    Parameters
    ----------
    stretches : sequence of (ndarray, ndarray)
        See `Stretch`; the unknowns of the slopes are all unknowns.
    information, inverse : ndarray, shape (unknowns, unknowns)
        Expected information, with what is known beforehand, and its inverse.

    Returns
    -------
    ndarray
        The information itself where every innovation is white.
    """
    every = [_used(*series) for stretch in stretches for series in _series(*stretch)]
    noises = [autoregression_of(e) for e, _, _ in every]
    for _ in range(CORRECTIONS):
        # What the fit absorbed of the noise, which is less than all that is known: part of that was known beforehand.
        power = np.zeros_like(information)
        for noise, (_, block, at) in zip(noises, every):
            power[at] += _power(noise, block)
        absorbed = inverse @ power @ inverse
        noises = [
            corrected(noise, e, block, inverse[at], absorbed[at]) if noise.order else noise
            for noise, (e, block, at) in zip(noises, every)
        ]
    scatter = information.copy()
    for noise, (_, block, at) in zip(noises, every):
        if noise.order:
            scatter[at] += _power(noise, block) - np.einsum("snp,snq->pq", block, block)
    return scatter


def _used(innovations: np.ndarray, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, ...]]:
    """Innovations, their slopes by the unknowns that they depend on, and the place of those in a matrix of all."""
    used = np.flatnonzero(np.abs(slopes).max(axis=(0, 1)) > 0)
    return innovations, slopes[:, :, used], np.ix_(used, used)


def _power(noise: Autoregression, slopes: np.ndarray) -> np.ndarray:
    """Covariance of the gradient under a noise, shape (unknowns, unknowns)."""
    shaped = noise.shaped(slopes)
    return np.asarray(shaped.T @ shaped)


def _series(innovations: np.ndarray, slopes: np.ndarray) -> list[Stretch]:
    """Series without holes: all sensors together where they are sampled together, else each by itself."""
    there = np.isfinite(innovations)
    together = there.all(axis=0)
    if together.sum() >= max(_FEWEST, _TOGETHER * there.any(axis=0).sum()):
        return [(innovations[:, together], slopes[:, together])]
    return [
        (innovations[i : i + 1, row], slopes[i : i + 1, row]) for i, row in enumerate(there) if row.sum() >= _FEWEST
    ]
