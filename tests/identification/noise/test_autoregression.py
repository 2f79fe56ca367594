"""The autoregression of residuals against closed forms, and the covariance it gives against simulated noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov, toeplitz
from scipy.signal import lfilter

from shipid.identification.noise.autoregression import Autoregression, autoregression_of, colour, corrected, whitened
from shipid.identification.noise.residual_groups import gathered


def first_order(phi: float, count: int, seed: int) -> np.ndarray:
    noise = np.random.default_rng(seed).standard_normal(count + 500)
    return lfilter([np.sqrt(1 - phi**2)], [1.0, -phi], noise)[500:]


#: Two signals, of which the first drives the second: A(1), A(2) and the covariance of what drives both.
COUPLED = np.array([[[0.7, 0.0], [0.4, 0.5]], [[0.1, -0.2], [0.3, 0.1]]])
DRIVE = np.array([[1.0, 0.3], [0.3, 0.5]])


def coupled(count: int, seed: int) -> np.ndarray:
    """The residuals that the definition of the autoregression gives, shape (2, count)."""
    driven = np.random.default_rng(seed).standard_normal((count + 500, 2)) @ np.linalg.cholesky(DRIVE).T
    for t in range(2, len(driven)):
        driven[t] += COUPLED[0] @ driven[t - 1] + COUPLED[1] @ driven[t - 2]
    return driven[500:].T


def coupled_covariance(count: int) -> np.ndarray:
    """Their covariance, shape (2, count, 2, count): Lyapunov's equation of the pair of samples (e(t), e(t - 1))."""
    step = np.block([[COUPLED[0], COUPLED[1]], [np.eye(2), np.zeros((2, 2))]])
    both = solve_discrete_lyapunov(step, np.kron(np.diag([1.0, 0.0]), DRIVE))
    lags = [(np.linalg.matrix_power(step, k) @ both)[:2, :2] for k in range(count)]
    whole = np.empty((2, count, 2, count))
    for late in range(count):
        for early in range(late + 1):
            whole[:, late, :, early] = lags[late - early]
            whole[:, early, :, late] = lags[late - early].T
    return whole


def test_white_residuals_are_of_order_zero():
    rng = np.random.default_rng(1)
    orders = [autoregression_of(rng.standard_normal((3, 500))).order for _ in range(100)]
    assert np.mean(np.array(orders) > 0) <= 0.02


def test_a_first_order_process_is_found():
    found = autoregression_of(np.array([first_order(0.9, 20_000, 2)]))
    # The standard error of the coefficient is sqrt((1 - phi^2) / N) = 0.003.
    assert found.order == 1
    assert found.steps[0, 0, 0] == pytest.approx(0.9, abs=0.012)


def test_the_colour_of_a_first_order_process_is_its_likelihood_ratio():
    rng = np.random.default_rng(5)
    white = rng.standard_normal((1, 40_000))
    slow = lfilter([1.0], [1.0, -0.5], white)
    # One step of .5 takes the variance from 4/3 to 1, and has one number to pay for.
    assert colour(autoregression_of(slow), slow) == pytest.approx(
        20_000 * np.log(4 / 3) - 0.5 * np.log(40_000), rel=0.06
    )
    assert colour(autoregression_of(white), white) == 0.0


def test_white_noise_is_corrected_as_one_that_is_correlated_by_nothing():
    rng = np.random.default_rng(6)
    residual, slopes = rng.standard_normal((2, 90)), rng.standard_normal((2, 90, 3))
    flat = np.linalg.inv(np.einsum("inq,inp->qp", slopes, slopes))
    drive = np.diag([0.9, 1.2])
    nearly = drive + np.array([[0.0, 1e-12], [1e-12, 0.0]])
    one, other = (
        corrected(Autoregression(np.zeros((0, 2, 2)), d), residual, slopes, flat, 1.1 * flat) for d in (drive, nearly)
    )
    assert one.white
    assert np.diag(one.drive) == pytest.approx(np.diag(other.drive), rel=1e-9)


def test_the_spectrum_gives_the_covariance_matrix():
    """J'CJ and CJ with C the Toeplitz matrix of phi^|k|, two signals that are independent."""
    phi, count = 0.8, 200
    c = toeplitz(phi ** np.arange(count))
    found = Autoregression(np.array([np.diag([phi, 0.0])]), np.diag([1 - phi**2, 4.0]))
    jacobian = np.random.default_rng(3).standard_normal((2, count, 3))
    wanted = jacobian[0].T @ c @ jacobian[0] + 4.0 * jacobian[1].T @ jacobian[1]
    shaped = found.shaped(jacobian)
    assert shaped.T @ shaped == pytest.approx(wanted, rel=1e-8)
    assert found.spread(jacobian)[0] == pytest.approx(c @ jacobian[0], rel=1e-8)


def test_signals_that_drive_each_other_have_the_covariance_of_lyapunov():
    count = 240
    c = coupled_covariance(count)
    colour = Autoregression(COUPLED, DRIVE)
    jacobian = np.random.default_rng(4).standard_normal((2, count, 3))
    shaped = colour.shaped(jacobian)
    assert shaped.T @ shaped == pytest.approx(np.einsum("inp,injm,jmq->pq", jacobian, c, jacobian), rel=1e-8)
    assert colour.spread(jacobian) == pytest.approx(np.einsum("injm,jmq->inq", c, jacobian), rel=1e-8, abs=1e-8)


def test_signals_that_drive_each_other_are_found():
    colour = autoregression_of(coupled(40_000, 5))
    assert colour.order == 2
    # The standard errors of the coefficients, of which this is four, are 0.008 at the most (Luetkepohl 2005, 3.2).
    assert colour.steps == pytest.approx(COUPLED, abs=0.03)
    assert colour.drive == pytest.approx(DRIVE, abs=0.03)


def test_no_more_past_samples_are_taken_than_there_are():
    """Four signals of first order: a second past sample has 16 numbers, which reach 16 log(500) once in 10^13 times."""
    found = [
        autoregression_of(np.array([first_order(0.6, 500, 4 * seed + k) for k in range(4)])).order for seed in range(60)
    ]
    assert found == [1] * 60


def test_of_signals_that_drive_each_other_everything_is_put_back():
    """Unknowns for every sample leave no residual: what is put back is the whole covariance, but for the ends."""
    count = 400
    everything = np.eye(2 * count).reshape(2, count, 2 * count)
    colour = Autoregression(COUPLED, DRIVE)
    shaped = colour.shaped(everything)
    found = corrected(colour, np.zeros((2, count)), everything, np.eye(2 * count), shaped.T @ shaped)
    # A lag of k samples is an average of N - k products over N.
    assert found.steps == pytest.approx(COUPLED, abs=0.02)
    assert found.drive == pytest.approx(DRIVE, abs=0.03)


def test_what_is_new_in_each_sample_is_white():
    """And of derivatives the same combination is taken."""
    rng, count = np.random.default_rng(3), 4000
    drive = np.linalg.cholesky(DRIVE) @ rng.standard_normal((2, count))
    series = drive.copy()
    for t in range(len(COUPLED), count):
        series[:, t] += sum(a @ series[:, t - k] for k, a in enumerate(COUPLED, start=1))
    white, _ = whitened(Autoregression(COUPLED, DRIVE), np.stack([series, 2 * series], axis=2))
    new = np.linalg.solve(np.linalg.cholesky(DRIVE), drive)
    assert white[:, 0] == pytest.approx(new[:, count - len(white) // 2 :].ravel(), abs=1e-6)
    assert white[:, 1] == pytest.approx(2 * white[:, 0])


def test_what_a_fit_took_up_is_put_back():
    """A regression on slow waves takes the slow noise: the power at low frequencies is right after the correction."""
    phi, count = 0.9, 400
    t = np.arange(count) / count
    slow = np.column_stack([np.cos(np.pi * k * t) for k in range(8)])
    slow /= np.linalg.norm(slow, axis=0)
    flat = np.linalg.inv(slow.T @ slow)
    plain, mended = [], []
    for seed in range(60):
        noise = first_order(phi, count, seed)
        residual = np.array([noise - slow @ (flat @ (slow.T @ noise))])
        jacobian = slow[None]
        found = autoregression_of(residual)
        plain.append(np.square(found.shaped(jacobian)).sum(axis=0)[0])
        for _ in range(3):
            shaped = found.shaped(jacobian)
            found = corrected(found, residual, jacobian, flat, flat @ shaped.T @ shaped @ flat)
        mended.append(np.square(found.shaped(jacobian)).sum(axis=0)[0])
    true = float(slow[:, 0] @ toeplitz(phi ** np.arange(count)) @ slow[:, 0])
    assert np.mean(plain) < 0.8 * true
    # 60 spectra of 400 samples scatter by some 5 % in their mean.
    assert np.mean(mended) == pytest.approx(true, rel=0.15)


@pytest.mark.parametrize("residual", [np.zeros((2, 100)), np.full((2, 100), np.inf), np.ones((1, 4))])
def test_residuals_that_say_nothing(residual):
    assert autoregression_of(residual).order == 0


def test_an_autoregression_that_does_not_die_out_is_not_stable():
    assert not Autoregression(np.array([[[1.01]]]), np.eye(1)).stable
    assert not Autoregression(np.array([[[0.5]]]), -np.eye(1)).stable
    assert Autoregression(np.array([[[0.5]], [[0.4]]]), np.eye(1)).stable


def test_long_records_are_gathered_without_loss_where_a_ship_answers():
    rng = np.random.default_rng(6)
    t = np.linspace(0, 1, 4321)
    slow = np.stack([np.sin(2 * np.pi * 5 * t), np.cos(2 * np.pi * 3 * t)], axis=1)[None]
    sums = gathered(slow, 4)
    assert sums.shape == (1, 1081, 2)
    assert sums[0].T @ sums[0] == pytest.approx(slow[0].T @ slow[0], rel=1e-3, abs=1)
    noise = rng.standard_normal((1, 4321))
    assert np.mean(gathered(noise, 4) ** 2) == pytest.approx(1, abs=0.1)
    assert gathered(noise, 1) is noise
