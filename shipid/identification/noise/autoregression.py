"""Correlation of residuals in time and between signals: a vector autoregression, and its spectrum.

Waves disturb heading and rate together at a frequency to which the coefficients are insensitive; the error of a slightly
wrong model lasts for many samples, at the frequency of the manoeuvre. The effect of noise on the coefficients depends on its
power at the frequencies to which they are sensitive: the whole spectrum is needed, not only effective samples. It comes from a
vector autoregression of the residuals (Yule-Walker), of the order that the Bayesian information criterion finds; order zero,
white noise independent between signals, is one of them, and is found where the residuals are white.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len

#: Orders that are tried.
ORDERS = (1, 2, 3, 4, 5, 6, 8, 10, 13, 16, 20, 25, 30)
#: Smallest number of samples for each number of the autoregression.
SAMPLES = 10
#: How often an autoregression is corrected for the part of the noise that a fit absorbed.
CORRECTIONS = 4


@dataclass(frozen=True, eq=False)
class Autoregression:
    """An autoregression of residuals: ``e(t) = sum over k of A(k) e(t - k) + w(t)``.

    Attributes
    ----------
    steps : ndarray, shape (order, signals, signals)
        The A(k).
    drive : ndarray, shape (signals, signals)
        Covariance of w.
    """

    steps: np.ndarray
    drive: np.ndarray

    @property
    def order(self) -> int:
        """Number of past samples; 0 for white noise."""
        return len(self.steps)

    @functools.cached_property
    def white(self) -> bool:
        """Whether it is white noise, independent between signals."""
        return not self.order and not np.any(self.drive - np.diag(np.diag(self.drive)))

    @property
    def stable(self) -> bool:
        """Whether it dies out, and its drive is a covariance."""
        if self.white:
            return bool((np.diag(self.drive) >= 0).all())
        if not np.isfinite(self.steps).all() or np.linalg.eigvalsh(self.drive).min() < 0:
            return False
        signals, size = len(self.drive), self.order * len(self.drive)
        companion = np.eye(size, k=-signals)
        if size:
            companion[:signals] = self.steps.transpose(1, 0, 2).reshape(signals, size)
        return size == 0 or bool(np.abs(np.linalg.eigvals(companion)).max() < 1)

    def shaped(self, jacobian: np.ndarray) -> np.ndarray:
        """Return Z with Z'Z = J'CJ, C being the covariance of the residuals, shape (rows, unknowns).

        Parameters
        ----------
        jacobian : ndarray, shape (signals, N, unknowns)
            Derivatives of the residuals.
        """
        if self.white:
            return np.asarray((np.sqrt(np.diag(self.drive))[:, None, None] * jacobian).reshape(-1, jacobian.shape[2]))
        if not self.order:
            shaped = np.einsum("ji,jnq->inq", _root(self.drive), jacobian)
            return np.asarray(shaped.reshape(-1, jacobian.shape[2]))
        spectrum, gains, length = self._spectra(jacobian)
        weights = np.full(spectrum.shape[1], 2.0 / length)
        weights[[0, -1]] = 1.0 / length
        shaped = np.sqrt(weights)[:, None] * np.einsum("fji,jfq->ifq", gains.conj(), spectrum, optimize=True)
        flat = shaped.reshape(-1, jacobian.shape[2])
        return np.concatenate([flat.real, flat.imag])

    def spread(self, jacobian: np.ndarray) -> np.ndarray:
        """Return CJ, C being the covariance of the residuals, shape (signals, N, unknowns).

        Parameters
        ----------
        jacobian : ndarray, shape (signals, N, unknowns)
            Derivatives of the residuals.
        """
        if not self.order:
            return np.asarray(np.einsum("ij,jnq->inq", self.drive, jacobian))
        spectrum, gains, length = self._spectra(jacobian)
        density = gains @ gains.conj().transpose(0, 2, 1)
        whole = np.fft.irfft(np.einsum("fij,jfq->ifq", density, spectrum, optimize=True), length, axis=1)
        return np.asarray(whole[:, : jacobian.shape[1]])

    def _spectra(self, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
        """Transform of the Jacobian over twice its length, and the filter from a white unit drive to the residuals."""
        signals, count, _ = jacobian.shape
        length = next_fast_len(2 * count, real=True) // 2 * 2
        length = length if length >= 2 * count else 2 * count
        spectrum = np.fft.rfft(jacobian, length, axis=1)
        turns = np.exp(-2j * np.pi * np.arange(spectrum.shape[1])[:, None] * np.arange(1, self.order + 1) / length)
        filters = np.eye(signals) - np.tensordot(turns, self.steps, axes=1)
        return spectrum, np.linalg.solve(filters, np.broadcast_to(_root(self.drive), filters.shape)), length


def _root(matrix: np.ndarray) -> np.ndarray:
    """A root R of a covariance, R R' = matrix, whatever its rank."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(vectors * np.sqrt(np.clip(values, 0.0, None)))


def autoregression_of(residual: np.ndarray, *others: np.ndarray) -> Autoregression:
    """Return the autoregression of the residuals of one trial, or of several together.

    Parameters
    ----------
    residual, *others : ndarray, shape (signals, N)
        Residuals at regular samples, in units of their standard deviation; one array for each trial.
    """
    every = (residual, *others)
    signals, count = len(residual), sum(e.shape[1] for e in every)
    none = np.zeros((0, signals, signals))
    if not all(np.isfinite(e).all() for e in every) or count < 8:
        return Autoregression(none, np.eye(signals))
    shortest = min(e.shape[1] for e in every)
    most = max((p for p in ORDERS if p * signals * SAMPLES <= count and p < shortest), default=0)
    weights = [e.shape[1] / count for e in every]
    lags = [sum(w * lag for w, lag in zip(weights, row)) for row in zip(*(_lags(e, most) for e in every))]
    diagonal = np.diag(np.diag(lags[0]))
    if (np.diag(diagonal) <= 0).any():
        return Autoregression(none, diagonal)
    price = np.log(count) / count
    best, least = Autoregression(none, diagonal), float(np.log(np.diag(diagonal)).sum())
    for order in (p for p in (0, *ORDERS) if p <= most):
        found = _yule_walker(lags, order)
        sign, size = np.linalg.slogdet(found.drive)
        numbers = order * signals**2 + signals * (signals - 1) / 2
        if sign > 0 and size + numbers * price < least:
            best, least = found, size + numbers * price
    return best


def colour(model: Autoregression, residual: np.ndarray) -> float:
    """Return by how much an autoregression is likelier than white noise, independent between signals.

    Parameters
    ----------
    model : Autoregression
        Of the residuals.
    residual : ndarray, shape (signals, N)
        Those residuals.

    Returns
    -------
    float
        Logarithm of the ratio of likelihoods, less the price of the numbers of the autoregression (Bayesian information criterion).
    """
    signals, count = residual.shape
    if model.white:
        return 0.0
    white = float(np.log(np.mean(residual**2, axis=1)).sum())
    numbers = model.order * signals**2 + signals * (signals - 1) / 2
    return 0.5 * float(count * (white - np.linalg.slogdet(model.drive)[1]) - numbers * np.log(count))


def corrected(
    model: Autoregression, residual: np.ndarray, jacobian: np.ndarray, flat: np.ndarray, cover: np.ndarray
) -> Autoregression:
    """Return the autoregression corrected for the part of the noise that the fit absorbed.

    The residuals of a fit are the noise less its part along the Jacobian, and that part is slow: without the correction the
    power at low frequencies comes out too small, by a fifth where a trial is 50 correlation times long.

    Parameters
    ----------
    model : Autoregression
        Of the residuals as they are.
    residual : ndarray, shape (signals, N)
        Those residuals.
    jacobian : ndarray, shape (signals, N, unknowns)
        Their derivatives; of white noise any rows with the same products.
    flat, cover : ndarray, shape (unknowns, unknowns)
        Inverse of the information matrix of the search, and covariance of the unknowns under that noise alone.

    Returns
    -------
    Autoregression
        Of the same order; the one given where the corrected one would not be stable.
    """
    count = residual.shape[1]
    # Residual = (I - P) noise with P = J flat J', so its covariance is C - PC - CP + PCP.
    if model.white:
        powers = np.diag(model.drive)
        absorbed = [((rows @ (2 * power * flat - cover)) * rows).sum() for rows, power in zip(jacobian, powers)]
        found = Autoregression(model.steps, np.diag(np.mean(residual**2, axis=1) + np.array(absorbed) / count))
        return found if found.stable else model
    along = model.spread(jacobian) @ flat
    back = jacobian @ cover
    lags = _lags(residual, model.order)
    for k, lag in enumerate(lags):
        late, early = slice(k, None), slice(0, count - k)
        for one, two, sign in ((jacobian, along, 1), (along, jacobian, 1), (back, jacobian, -1)):
            lag += sign * np.tensordot(one[:, late], two[:, early], axes=((1, 2), (1, 2))) / count
    found = _yule_walker(lags, model.order)
    return found if found.stable else model


def whitened(model: Autoregression, series: np.ndarray) -> tuple[np.ndarray, float]:
    """Return columns less what the past tells of them, in units of the drive, and the logarithm of the volume that these units span.

    The price of the numbers of the autoregression is in it, by the criterion that found its order: a long one describes the answer
    to a rudder as well as an effect does.

    Parameters
    ----------
    model : Autoregression
        The noise.
    series : ndarray, shape (signals, N, columns)
        Series along the second axis.

    Returns
    -------
    white : ndarray, shape (rows, columns)
        Under that noise independent, of unit variance.
    log_volume : float
        Twice the negative log-likelihood is this and the square of a white column.
    """
    # The same samples whatever the order: likelihoods of one record are compared.
    order, count = model.order, series.shape[1]
    first = min(ORDERS[-1], count // SAMPLES)
    left = series[:, first:].copy()
    for k, step in enumerate(model.steps, start=1):
        left -= np.einsum("ij,jnq->inq", step, series[:, first - k : count - k])
    size = len(model.drive)
    root = np.linalg.cholesky(model.drive + 1e-12 * np.trace(model.drive) * np.eye(size))
    white = np.linalg.solve(root, left.reshape(size, -1)).reshape(left.shape)
    log_volume = 2 * float(np.log(np.diag(root)).sum()) * left.shape[1]
    return white.reshape(-1, series.shape[2]), log_volume + order * size**2 * float(np.log(count))


def _lags(residual: np.ndarray, most: int) -> list[np.ndarray]:
    """Autocovariances E e(t + k) e(t)', the biased estimate."""
    count = residual.shape[1]
    return [residual[:, k:] @ residual[:, : count - k].T / count for k in range(most + 1)]


def _yule_walker(lags: list[np.ndarray], order: int) -> Autoregression:
    """Solve the Yule-Walker equations; the autocovariances are the biased ones, so that the answer is stable."""
    signals = len(lags[0])
    if not order:
        return Autoregression(np.zeros((0, signals, signals)), 0.5 * (lags[0] + lags[0].T))
    # Block row k, column j: E e(t - k) e(t - j)' = Gamma(j - k), Gamma(-l) = Gamma(l)'.
    every = np.array([*(lag.T for lag in lags[order - 1 : 0 : -1]), *lags[:order]])
    place = np.arange(order)
    blocks = every[order - 1 + place - place[:, None]]
    matrix = blocks.transpose(0, 2, 1, 3).reshape(order * signals, order * signals)
    right = np.vstack([lags[k].T for k in range(1, order + 1)])
    matrix[np.diag_indices_from(matrix)] *= 1 + 1e-9
    solved = np.linalg.solve(matrix, right)
    steps = solved.reshape(order, signals, signals).transpose(0, 2, 1)
    drive = lags[0] - sum(a @ lags[k].T for k, a in enumerate(steps, start=1))
    return Autoregression(steps, 0.5 * (drive + drive.T))
